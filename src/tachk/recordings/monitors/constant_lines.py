"""The lines ``const T = 2 s`` of a file of formulas: numbers and durations, which may be computed from each other."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError, UsageError
from tachk.base.diagnostics.suggestion import did_you_mean
from tachk.base.exact_numbers import exact_number
from tachk.base.operators import BinaryOperator
from tachk.base.span import Span
from tachk.base.time_units import NANOSECONDS, SPELLINGS
from tachk.logic.constant_values import value_of
from tachk.syntax import ast
from tachk.syntax.formula import Atom, Duration, Formula
from tachk.syntax.formulas.build import unknown_unit
from tachk.syntax.formulas.parser import parse_formula
from tachk.syntax.walk import nodes_of_kind

_LINE = re.compile(r"const\s+(?:(?:double|int)\s+)?(?P<name>[A-Za-z_]\w*)\s*=\s*(?P<value>[^;]*?)\s*;?", re.DOTALL)
_UNIT = re.compile(r"(?P<value>.*[\w.)])\s+(?P<unit>[A-Za-zµμ]+)|(?P<number>.*\d\.?)(?P<close>[A-Za-zµμ]+)", re.DOTALL)


@dataclass(frozen=True, slots=True)
class ConstantLines:
    """Attributes:
    numbers: values of constants without a unit.
    durations: in nanoseconds, those of constants with one.
    """

    numbers: Mapping[str, Fraction]
    durations: Mapping[str, Fraction]


@dataclass(frozen=True, slots=True)
class _ConstantLine:
    """The value of a constant and its unit, empty where it has none."""

    expression: ast.Expression
    unit: str


@dataclass(slots=True)
class ConstantReader:
    """Reads constants one by one; `values` computes them when all are there.

    Attributes:
        definitions: other values, in the unit that the line gives the constant.
    """

    definitions: Mapping[str, str] = field(default_factory=dict)
    lines: dict[str, _ConstantLine] = field(default_factory=dict)
    found: list[Diagnostic] = field(default_factory=list)

    def take(self, span: Span) -> bool:
        """True if this is the line of a constant, which is noted then, or what is wrong with it."""
        match = _LINE.fullmatch(span.text)
        if match is None:
            return False
        start, end = (span.start + match.start("value"), span.start + match.end("value"))
        name, value, unit = match["name"], Span(span.source, start, end), ""
        if (split := _UNIT.fullmatch(match["value"])) is not None:
            unit = split["unit"] or split["close"]
            whole = split["value"] or split["number"]
            spelled = unit if unit in NANOSECONDS else SPELLINGS.get(unit.lower())
            if spelled is None:
                place = Span(span.source, end - len(unit), end)
                self.found.append(unknown_unit(unit, place))
                return True
            value, unit = Span(span.source, start, start + len(whole)), spelled
        if name in self.lines:
            self.found.append(Diagnostic("E0202", f"the constant `{name}` is there twice", span))
            return True
        formula, found = parse_formula(value)
        if not isinstance(formula, Atom):
            help_ = "a constant is a number, or computed from numbers and constants, with a unit if it is a time: 2.5 s"
            self.found += found or [Diagnostic("E0602", f"`{value.text}` is not a constant number", value, help_)]
            return True
        self.lines[name] = _ConstantLine(formula.expression, unit)
        return True

    def values(self) -> ConstantLines:
        """All constants, whatever their order. What is wrong is noted in `found`."""
        numbers: dict[str, Fraction] = {}
        durations: dict[str, Fraction] = {}
        for name, line in self.lines.items():
            try:
                is_time = self._is_time(name, line.expression.span, ())
                value = self._value(name, line.expression.span)
            except InputError as error:
                self.found += error.diagnostics
                continue
            (durations if is_time else numbers)[name] = value
        return ConstantLines(numbers, durations)

    def _value(self, name: str, place: Span) -> Fraction:
        line = self.lines[name]

        def named(expression: ast.Expression) -> Fraction:
            if isinstance(expression, ast.NameExpression):
                return self._value(expression.name, expression.span)
            raise _wrong(expression.span, f"`{expression.span.text}` is not a constant number")

        given = self._defined(name)
        value = value_of(line.expression, named) if given is None else given
        return value * NANOSECONDS[line.unit] if line.unit else value

    def _defined(self, name: str) -> Fraction | None:
        if (text := self.definitions.get(name)) is None:
            return None
        try:
            return exact_number(text)
        except ValueError:
            raise UsageError(f"-D {name}={text}: expected a number", "such as -D T=2.5") from None

    def _is_time(self, name: str, place: Span, above: tuple[str, ...]) -> bool:
        if name not in self.lines:
            raise _wrong(place, f"there is no constant `{name}`", did_you_mean(name, self.lines), "E0201")
        if name in above:
            circle = " -> ".join((*above[above.index(name) :], name))
            raise _wrong(place, f"a constant is computed from itself: {circle}")
        line = self.lines[name]
        inner = self._kind(line.expression, (*above, name))
        if inner and line.unit:
            raise _wrong(
                line.expression.span, f"`{line.expression.span.text}` has a unit already", "leave one of them out"
            )
        return inner or bool(line.unit)

    def _kind(self, expression: ast.Expression, above: tuple[str, ...]) -> bool:
        """True if an expression is a time; its constants are those of ``above``."""
        match expression:
            case ast.NameExpression(name=name, span=span):
                return self._is_time(name, span, above)
            case ast.UnaryExpression(operand=operand):
                return self._kind(operand, above)
            case ast.BinaryExpression(operator=operator, left=left, right=right, span=span):
                first, second = self._kind(left, above), self._kind(right, above)
                return _joined_kind(operator, first, second, span)
            case _:
                return False


def _joined_kind(operator: BinaryOperator, first: bool, second: bool, span: Span) -> bool:
    match operator:
        case BinaryOperator.MULTIPLY if not (first and second):
            return first or second
        case BinaryOperator.DIVIDE if first or not second:
            return first and not second
        case BinaryOperator.ADD | BinaryOperator.SUBTRACT if first == second:
            return first
        case _ if not (first or second):
            return False
        case _:
            raise _wrong(span, f"the units in `{span.text}` do not fit together", None, "E0134")


def doubled_units(formula: Formula, durations: Mapping[str, Fraction]) -> Iterator[Diagnostic]:
    """A finding for each bound that gives a unit to a constant which has one."""
    for duration in nodes_of_kind(formula, Duration):
        for name in nodes_of_kind(duration, ast.NameExpression):
            if duration.unit and name.name in durations:
                yield Diagnostic("E0134", f"`{name.name}` has a unit already", duration.span, f"write {name.name}")


def _wrong(span: Span, message: str, help: str | None = None, code: str = "E0602") -> InputError:
    return InputError([Diagnostic(code, message, span, help)])
