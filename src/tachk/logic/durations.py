"""Bounds of intervals as numbers in one unit of time."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError, Label
from tachk.base.records import replace
from tachk.base.time_units import length_of
from tachk.logic.constant_values import Evaluate, value_of
from tachk.syntax.formula import Duration, Formula, Interval
from tachk.syntax.formulas.build import unknown_unit
from tachk.syntax.formulas.printer import print_number
from tachk.syntax.rewrite import rewrite


def resolve(
    formula: Formula,
    evaluate: Evaluate,
    unit: str,
    remedy: str = "say what a time unit is with `time_unit = 1 s;` in the model, or leave the unit out",
) -> Formula:
    """The formula with every bound a number in the unit of the model or the trace, without a unit of its own.

    Args:
        evaluate: the value of a constant; arithmetic on constants is exact. Raises InputError where there is none.
        unit: what one unit of time is, such as ``1 ms``, ``10 us`` or ``s``; empty where it is not given.
        remedy: how to say it, for the message about a bound with a unit where the unit of time is not given.

    Raises:
        InputError: with all that is wrong: a unit that cannot be converted, a negative bound, an upper bound below the
            lower one, what ``evaluate`` reports.
    """
    resolver = _DurationResolver(evaluate, unit, remedy)
    result = rewrite(formula, resolver.change)
    if resolver.found:
        raise InputError(sorted(resolver.found, key=lambda diagnostic: diagnostic.span.start))
    return result


def scaled(formula: Formula, factor: Fraction) -> Formula:
    """The formula with every bound that is a number ``factor`` times as long."""

    def change(node: Any) -> Any:
        match node:
            case Duration(value=Fraction() as value):
                return replace(node, value=value * factor)
            case _:
                return node

    return formula if factor == 1 else rewrite(formula, change)


class _DurationResolver:
    """Changes durations innermost first, then looks at the intervals that they make."""

    def __init__(self, evaluate: Evaluate, unit: str, remedy: str) -> None:
        self.evaluate = evaluate
        self.unit = unit
        self.remedy = remedy
        self.found: list[Diagnostic] = []

    def change(self, node: Any) -> Any:
        match node:
            case Duration():
                value = self.value(node)
                return node if value is None else replace(node, value=value, unit="")
            case Interval(
                lower=Duration(value=Fraction() as lower) as first, upper=Duration(value=Fraction() as upper) as last
            ):
                if lower > upper:
                    self.found.append(
                        Diagnostic(
                            "E0505",
                            "this interval ends before it begins",
                            node.span,
                            "the lower bound comes first",
                            (
                                Label(first.span, f"from {print_number(lower)}"),
                                Label(last.span, f"to {print_number(upper)}"),
                            ),
                        )
                    )
            case _:
                pass
        return node

    def value(self, duration: Duration) -> Fraction | None:
        """The length in units of the model or the trace; None after a report."""
        number = self.number(duration)
        if number is None:
            return None
        if number < 0:
            self.found.append(
                Diagnostic(
                    "E0504",
                    f"the bound is negative: {print_number(number)}" if _is_computed(duration) else "a negative bound",
                    duration.span,
                    "bounds are distances from now; O, H and S look back",
                )
            )
            return None
        return number * self.scale(duration) if duration.unit else number

    def number(self, duration: Duration) -> Fraction | None:
        if isinstance(duration.value, Fraction):
            return duration.value
        try:
            return value_of(duration.value, self.evaluate)
        except InputError as error:
            self.found += error.diagnostics
            return None

    def scale(self, duration: Duration) -> Fraction:
        """The number of units of the model or the trace that make the duration's unit; 0 after a report."""
        own, common = length_of(duration.unit), length_of(self.unit)
        if own is None:
            self.found.append(unknown_unit(duration.unit, duration.span))
        elif common is None:
            known = f"the time unit is {self.unit}, which has no length in {duration.unit}" if self.unit else ""
            self.found.append(
                Diagnostic(
                    "E0506",
                    known or f"a bound in {duration.unit}, but the length of one unit of time is unknown",
                    duration.span,
                    self.remedy,
                )
            )
        else:
            return own / common
        return Fraction(0)


def _is_computed(duration: Duration) -> bool:
    return not isinstance(duration.value, Fraction)
