"""The oracle of lines between rows and of robustness in time: whether a formula is worth more than a level.

A formula is worth more than c at an instant if it is true there once every atom is replaced by "the atom is worth more
than c" (under a negation: not worth more than -c). For this, atoms are all that has to be known; operators are those of
`tests.support.exact_monitor`, over signals that are constant between exact rational instants, at which lines cross the
level. So a claimed robustness r is checked from its definition, without computing one: the formula is worth more than
r - e, and not more than r + e. Levels have to be generic, as r - e and r + e are: at a level that the formula attains,
"more than" and "not less than" differ. The truth is that without a level, where comparisons are exact.

Atoms are worth, at an instant t up to the end of the trace:

- on lines: a comparison the distance of its sides, whose numbers lie on straight lines from row to row, flags and
  everything after the last row held;
- in time, with all values held (Donze, Maler 2010): an atom that is true is worth the time for which it goes on to be
  true (ahead), or has been true within the trace (behind); one that is false minus the time for which it goes on to be
  false, or has been. At the end of the trace the time ahead is only known to be at least that up to the end. A change
  of a value is worth 0 where it happens, else minus the time to the next one, or since the last one.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Protocol

from tachk.base.operators import BinaryOperator, PrefixOperator
from tachk.syntax import ast
from tachk.syntax import formula as syntax
from tests.support.exact_monitor import (
    ExactSignal,
    ahead,
    before,
    behind,
    change_of,
    combined,
    signal_of,
    weak_until,
)
from tests.support.exact_trace import (
    FALSE,
    TRUE,
    UNKNOWN,
    ExactTrace,
    Number,
    Scalar,
    Value,
    condition,
    is_condition,
    is_truth,
    number,
)

Level = Fraction | None
"""None: whether it is true."""


class Worth(Protocol):
    """What conditions without connectives are worth."""

    @property
    def trace(self) -> ExactTrace: ...

    def above(self, atom: ast.Expression, level: Level) -> ExactSignal:
        """Where an atom is worth more than a level."""
        ...

    def change(self, expression: ast.Expression, level: Level) -> ExactSignal:
        """Where the change of a value is worth more than a level."""
        ...


def above(formula: syntax.Formula, worth: Worth, level: Level = None) -> ExactSignal:
    """Where a formula is worth more than a level; UNKNOWN where that depends on how the trace goes on."""
    trace = worth.trace
    opposite = None if level is None else -level

    def inner(part: syntax.Formula) -> ExactSignal:
        return above(part, worth, level)

    match formula:
        case syntax.TruthConstant(value=value):
            return _constant(value)
        case syntax.Atom(expression=expression):
            return _condition(expression, worth, level)
        case syntax.Change(expression=expression) if is_condition(expression):
            atom = syntax.Atom(formula.span, expression)
            falls = syntax.Fall(formula.span, atom), syntax.Fall(formula.span, syntax.Not(formula.span, atom))
            return inner(syntax.Or(formula.span, falls))
        case syntax.Change(expression=expression):
            return worth.change(expression, level)
        case syntax.Not(operand=operand):
            return _negated(above(operand, worth, opposite))
        case syntax.And(operands=operands):
            return combined([inner(operand) for operand in operands], lambda left, right: left & right)
        case syntax.Or(operands=operands):
            return combined([inner(operand) for operand in operands], lambda left, right: left | right)
        case syntax.Implies(left=left, right=right):
            return inner(syntax.Or(formula.span, (syntax.Not(left.span, left), right)))
        case syntax.Rise(operand=operand):
            now, earlier = inner(operand), above(operand, worth, opposite)
            return signal_of({*now.points, *earlier.points}, lambda t: now.value(t) & ~before(earlier, t))
        case syntax.Fall(operand=operand):
            now, earlier = above(operand, worth, opposite), inner(operand)
            return signal_of({*now.points, *earlier.points}, lambda t: ~now.value(t) & before(earlier, t))
        case syntax.Eventually(interval=interval, operand=operand):
            return ahead(interval, _constant(True), inner(operand), trace)
        case syntax.Always(interval=interval, operand=operand):
            return inner(_dual(formula, syntax.Eventually(formula.span, interval, syntax.Not(operand.span, operand))))
        case syntax.Until(interval=interval, left=left, right=right):
            return ahead(interval, inner(left), inner(right), trace)
        case syntax.WeakUntil(left=left, right=right):
            return inner(weak_until(formula, left, right))
        case syntax.Once(interval=interval, operand=operand):
            return behind(interval, _constant(True), inner(operand))
        case syntax.Historically(interval=interval, operand=operand):
            return inner(_dual(formula, syntax.Once(formula.span, interval, syntax.Not(operand.span, operand))))
        case syntax.Since(interval=interval, left=left, right=right):
            return behind(interval, inner(left), inner(right))


def is_worth(
    formula: syntax.Formula, worth: Worth, instant: Fraction, low: Number, high: Number, tolerance: Fraction
) -> bool:
    """Whether the bounds of what a formula is worth at an instant are these, as far as the tolerance can tell."""

    def truth(level: Number) -> bool | None:
        if isinstance(level, float):
            level = Fraction(10**12) * (1 if level > 0 else -1)
        return above(formula, worth, level).value(instant).truth

    least = low == -math.inf or truth(low - tolerance) is True
    not_more = low == math.inf or truth(low + tolerance) is not True
    most = high == math.inf or truth(high + tolerance) is False
    not_less = high == -math.inf or truth(high - tolerance) is not False
    return least and not_more and most and not_less


@dataclass(frozen=True, slots=True)
class OnLines:
    """Numbers lie on straight lines from row to row."""

    trace: ExactTrace

    def state(self, instant: Fraction) -> Mapping[str, Scalar]:
        trace = self.trace
        row = max(index for index, time in enumerate(trace.times) if time <= instant)
        following = [time for time in trace.times if time > instant]
        values: dict[str, Scalar] = {}
        for name, column in trace.columns.items():
            here = column[row]
            values[name] = here
            if following and not isinstance(here, bool):
                target = max(index for index, time in enumerate(trace.times) if time == following[0])
                share = (instant - trace.times[row]) / (following[0] - trace.times[row])
                values[name] = here + (column[target] - here) * share
        return values

    def above(self, atom: ast.Expression, level: Level) -> ExactSignal:
        points = sorted({*self.trace.times, self.trace.end})
        inside = {instant for start, end in pairwise(points) for instant in self._crossings(atom, level, start, end)}

        def at(instant: Fraction) -> Value:
            if instant > self.trace.end:
                return UNKNOWN
            worth = condition(atom, self.state(instant))
            return worth if level is None else TRUE if worth.low > level else FALSE

        return signal_of({*points, *inside}, at)

    def change(self, expression: ast.Expression, level: Level) -> ExactSignal:
        """Of what does not move."""
        return change_of(self.trace, lambda state: number(expression, state))

    def _crossings(self, atom: ast.Expression, level: Level, start: Fraction, end: Fraction) -> Iterator[Fraction]:
        match atom:
            case ast.BinaryExpression(left=left, right=right) if is_condition(atom):
                difference = self._number(ast.BinaryExpression(atom.span, BinaryOperator.SUBTRACT, left, right))
                breaks = [start, *sorted({*self._breaks(left, start, end), *self._breaks(right, start, end)}), end]
            case _:
                difference = self._number(atom)
                breaks = [start, *self._breaks(atom, start, end), end]
        for first, last in pairwise(breaks):
            yield first
            for target in {Fraction(0), *(() if level is None else (level, -level))}:
                yield from _attained(lambda t, target=target: difference(t) - target, first, last)  # type: ignore[misc]

    def _breaks(self, expression: ast.Expression, start: Fraction, end: Fraction) -> list[Fraction]:
        """The instants strictly between two rows at which the lines of a value have an end."""
        parts: tuple[ast.Expression, ...] = ()
        zeros: tuple[ast.Expression, ...] = ()
        match expression:
            case ast.UnaryExpression(operand=operand):
                parts = (operand,)
            case ast.BinaryExpression(operator=operator, left=left, right=right):
                parts = (left, right)
                if operator in {BinaryOperator.MINIMUM, BinaryOperator.MAXIMUM}:
                    zeros = (ast.BinaryExpression(expression.span, BinaryOperator.SUBTRACT, left, right),)
            case ast.CallExpression(function=ast.NameExpression(name="abs"), arguments=arguments):
                parts = zeros = arguments
            case ast.CallExpression(arguments=arguments):
                parts = arguments
                pairs = [(a, b) for n, a in enumerate(arguments) for b in arguments[n + 1 :]]
                zeros = tuple(ast.BinaryExpression(expression.span, BinaryOperator.SUBTRACT, a, b) for a, b in pairs)
            case _:
                pass
        found = {instant for part in parts for instant in self._breaks(part, start, end)}
        for first, last in pairwise([start, *sorted(found), end]):
            for zero in zeros:
                found.update(_attained(self._number(zero), first, last))
        return sorted(found)

    def _number(self, expression: ast.Expression) -> Callable[[Fraction], Fraction]:
        return lambda instant: number(expression, self.state(instant))


@dataclass(frozen=True, slots=True)
class InTime:
    """Atoms are worth the time for which they go on to be as they are, or have been so."""

    trace: ExactTrace
    looks_ahead: bool

    def worth(self, runs: list[tuple[Fraction, bool]], instant: Fraction) -> tuple[Number, Number]:
        """The bounds at an instant.

        Args:
            runs: the instants at which the truth of the atom changes, the first one 0, and what it becomes.
        """
        run = max(index for index, (start, _) in enumerate(runs) if start <= instant)
        start, truth = runs[run]
        last = run + 1 == len(runs)
        if not self.looks_ahead:
            since = instant - start
            return (since, since) if truth else (-since, -since)
        left = (self.trace.end if last else runs[run + 1][0]) - instant
        most = math.inf if last else left
        return (left, most) if truth else (-most, -left)

    def above(self, atom: ast.Expression, level: Level) -> ExactSignal:
        trace = self.trace
        runs: list[tuple[Fraction, bool]] = []
        for time in sorted(set(trace.times)):
            truth = condition(atom, trace.state_at(time) or {}).truth is True
            if not runs or runs[-1][1] is not truth:
                runs.append((time, truth))
        turns = [start for start, _ in runs] + [trace.end]
        shifts = {Fraction(0), *(() if level is None else (level, -level))}

        def at(instant: Fraction) -> Value:
            if instant > trace.end:
                return UNKNOWN
            low, high = self.worth(runs, instant)
            if level is None:
                return condition(atom, trace.state_at(instant) or {})
            return TRUE if low > level else FALSE if high <= level else UNKNOWN

        return signal_of({turn + shift for turn in turns for shift in shifts}, at)

    def change(self, expression: ast.Expression, level: Level) -> ExactSignal:
        """A change is worth 0; any other instant minus the time to the next one, or since the last one."""
        trace = self.trace
        changes = change_of(trace, lambda state: number(expression, state))
        if level is None:
            return changes
        instants = [time for time in sorted(set(trace.times)) if changes.value(time).truth is True]

        def at(instant: Fraction) -> Value:
            if instant > trace.end:
                return UNKNOWN
            low: Number = Fraction(0)
            high: Number = low
            if instant not in instants and self.looks_ahead:
                following = [time for time in instants if time > instant]
                high = instant - (following[0] if following else trace.end)
                low = high if following else -math.inf
            elif instant not in instants:
                low = high = max((time for time in instants if time < instant), default=Fraction(0)) - instant
            return TRUE if low > level else FALSE if high <= level else UNKNOWN

        turns = [Fraction(0), *instants, trace.end]
        return signal_of({turn + shift for turn in turns for shift in (0, level, -level)}, at)


def _condition(expression: ast.Expression, worth: Worth, level: Level) -> ExactSignal:
    """A condition with its connectives, which are those of formulas."""
    opposite = None if level is None else -level

    def either(left: ast.Expression, right: ast.Expression, same: bool) -> ExactSignal:
        one, other = _condition(left, worth, level), _condition(right, worth, level)
        not_one, not_other = (_negated(_condition(side, worth, opposite)) for side in (left, right))
        pairs = ((one, other), (not_one, not_other)) if same else ((one, not_other), (not_one, other))
        return combined([combined(list(pair), lambda a, b: a & b) for pair in pairs], lambda a, b: a | b)

    match expression:
        case ast.UnaryExpression(operator=PrefixOperator.NOT, operand=operand):
            return _negated(_condition(operand, worth, opposite))
        case ast.BinaryExpression(operator=BinaryOperator.AND | BinaryOperator.OR as operator, left=left, right=right):
            sides = [_condition(left, worth, level), _condition(right, worth, level)]
            return combined(sides, (lambda a, b: a & b) if operator == BinaryOperator.AND else (lambda a, b: a | b))
        case ast.BinaryExpression(operator=BinaryOperator.IMPLY, left=left, right=right):
            sides = [_negated(_condition(left, worth, opposite)), _condition(right, worth, level)]
            return combined(sides, lambda a, b: a | b)
        case ast.BinaryExpression(operator=BinaryOperator.XOR, left=left, right=right):
            return either(left, right, same=False)
        case ast.BinaryExpression(
            operator=BinaryOperator.EQUAL | BinaryOperator.NOT_EQUAL as operator, left=left, right=right
        ) if _compares_truth(left, right, worth):
            return either(left, right, same=operator == BinaryOperator.EQUAL)
        case _:
            return worth.above(expression, level)


def _compares_truth(left: ast.Expression, right: ast.Expression, worth: Worth) -> bool:
    state = worth.trace.state_at(Fraction(0)) or {}
    return is_truth(left, state) and is_truth(right, state)


def _attained(function: Callable[[Fraction], Fraction], start: Fraction, end: Fraction) -> Iterator[Fraction]:
    """Where a function that is linear between two instants is 0 there."""
    first, second = start + (end - start) / 3, start + (end - start) * 2 / 3
    here, there = function(first), function(second)
    if here != there:
        zero = first + (second - first) * here / (here - there)
        if start < zero < end:
            yield zero


def _constant(value: bool) -> ExactSignal:
    return signal_of({Fraction(0)}, lambda _: TRUE if value else FALSE)


def _negated(signal: ExactSignal) -> ExactSignal:
    return signal_of(signal.points, lambda t: ~signal.value(t))


def _dual(formula: syntax.Formula, existential: syntax.Formula) -> syntax.Formula:
    return syntax.Not(formula.span, existential)
