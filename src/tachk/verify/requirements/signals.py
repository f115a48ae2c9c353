"""Free signals: what requirements speak of, as variables that may have any value at any time.

A number matters only by its order among the constants that it is compared with, so a signal with k of them has 2k + 1
values: below the first, the first, between the first two, and so on.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from types import MappingProxyType

from tachk.base.diagnostics.diagnostic import InputError
from tachk.base.operators import COMPARISONS, CONNECTIVES, BinaryOperator, PrefixOperator
from tachk.base.span import NOWHERE, Span
from tachk.logic.constant_values import value_of
from tachk.syntax import ast
from tachk.syntax.formula import Atom, Change, Formula
from tachk.syntax.formulas.printer import print_number
from tachk.syntax.printing.expression_printer import print_expression
from tachk.syntax.walk import nodes_of_kind


class NotFollowed(Exception):
    """A requirement, or a part of it, says more than what this analysis can follow.

    Attributes:
        reason: a clause that makes sense after "it is not followed:".
    """

    def __init__(self, span: Span, reason: str) -> None:
        super().__init__(reason)
        self.span = span
        self.reason = reason


@dataclass(frozen=True, slots=True)
class RequirementSignal:
    """``constants``: ascending, what a number is compared with; empty for a truth value."""

    name: str
    constants: tuple[Fraction, ...] = ()

    @property
    def largest(self) -> int:
        return 2 * len(self.constants) if self.constants else 1

    def shown(self, value: int) -> str:
        """A value that stands for all of the same order."""
        if not self.constants:
            return "true" if value else "false"
        where, is_constant = divmod(value, 2)
        if is_constant:
            return print_number(self.constants[where])
        if where == 0:
            return f"< {print_number(self.constants[0])}"
        if where == len(self.constants):
            return f"> {print_number(self.constants[-1])}"
        return f"{print_number(self.constants[where - 1])} .. {print_number(self.constants[where])}"


@dataclass(frozen=True, slots=True)
class Signals:
    """The signals of a set of requirements; that of number i is the variable ``PREFIXi``."""

    all: tuple[RequirementSignal, ...]
    numbers: dict[str, int] = field(compare=False)

    @property
    def are_numbers(self) -> dict[str, bool]:
        return {signal.name: bool(signal.constants) for signal in self.all}

    def named_in(self, formula: Formula) -> frozenset[int]:
        """The numbers of the signals of a formula for which there are signals."""
        names = (signal.name for signal in signals_of([formula]).all)
        return frozenset(self.numbers[name] for name in names)

    def encoded(self, expression: ast.Expression, prefix: str) -> ast.Expression:
        """A condition over the variables."""
        match expression:
            case ast.BooleanLiteral():
                return expression
            case ast.UnaryExpression(operator=PrefixOperator.NOT, operand=operand):
                return ast.UnaryExpression(NOWHERE, PrefixOperator.NOT, self.encoded(operand, prefix))
            case ast.BinaryExpression(operator=operator, left=left, right=right) if operator in CONNECTIVES:
                both = self.encoded(left, prefix), self.encoded(right, prefix)
                return ast.BinaryExpression(NOWHERE, operator, *both)
            case ast.BinaryExpression(operator=operator):
                place, operator, value = _comparison(expression)
                number = self.numbers[place]
                order = 2 * self.all[number].constants.index(value) + 1
                return ast.BinaryExpression(NOWHERE, operator, _variable(prefix, number), _integer(order))
            case _:
                number = self.numbers[print_expression(expression)]
                return ast.BinaryExpression(NOWHERE, BinaryOperator.EQUAL, _variable(prefix, number), _integer(1))


def signals_of(formulas: Iterable[Formula], numbers: Mapping[str, bool] = MappingProxyType({})) -> Signals:
    """The signals that formulas mention.

    Args:
        numbers: of signals that other formulas mention, whether they are numbers, not truth values.

    Raises NotFollowed for conditions that are more than truth values and comparisons of numbers with constants.
    """
    found: dict[str, set[Fraction]] = {}
    kinds = dict(numbers)
    for formula in formulas:
        for change in nodes_of_kind(formula, Change):
            raise NotFollowed(change.span, "`change` looks at values, and here only their order is known")
        for atom in nodes_of_kind(formula, Atom):
            _collect(atom.expression, found, kinds)
    signals = tuple(RequirementSignal(name, tuple(sorted(constants))) for name, constants in sorted(found.items()))
    return Signals(signals, {signal.name: number for number, signal in enumerate(signals)})


def _collect(expression: ast.Expression, found: dict[str, set[Fraction]], kinds: dict[str, bool]) -> None:
    match expression:
        case ast.BooleanLiteral():
            return
        case ast.UnaryExpression(operator=PrefixOperator.NOT, operand=operand):
            _collect(operand, found, kinds)
        case ast.BinaryExpression(operator=operator, left=left, right=right) if operator in CONNECTIVES:
            _collect(left, found, kinds)
            _collect(right, found, kinds)
        case ast.BinaryExpression(operator=operator) if operator in COMPARISONS:
            place, _, value = _comparison(expression)
            _note(expression.span, place, True, kinds)
            found.setdefault(place, set()).add(value)
        case ast.NameExpression() | ast.MemberExpression():
            place = print_expression(expression)
            _note(expression.span, place, False, kinds)
            found.setdefault(place, set())
        case _:
            raise NotFollowed(expression.span, f"`{expression.span.text}` is computed from signals")


def _note(span: Span, place: str, is_number: bool, kinds: dict[str, bool]) -> None:
    if kinds.setdefault(place, is_number) != is_number:
        raise NotFollowed(span, f"`{place}` is used as a truth value and as a number")


def _comparison(expression: ast.BinaryExpression) -> tuple[str, BinaryOperator, Fraction]:
    """The signal, the operator with the signal on its left, and the constant."""
    left, right, operator = expression.left, expression.right, expression.operator
    if not isinstance(left, ast.NameExpression | ast.MemberExpression):
        left, right, operator = right, left, _MIRRORED.get(operator, operator)
    if not isinstance(left, ast.NameExpression | ast.MemberExpression):
        raise NotFollowed(expression.span, f"`{expression.span.text}` is computed from signals")

    def unknown(part: ast.Expression) -> Fraction:
        raise NotFollowed(expression.span, f"`{expression.span.text}` compares a signal with what is not a number")

    try:
        return print_expression(left), operator, value_of(right, unknown)
    except InputError as error:
        raise NotFollowed(expression.span, error.diagnostics[0].message) from error


_MIRRORED = {
    BinaryOperator.LESS: BinaryOperator.GREATER,
    BinaryOperator.GREATER: BinaryOperator.LESS,
    BinaryOperator.LESS_EQUAL: BinaryOperator.GREATER_EQUAL,
    BinaryOperator.GREATER_EQUAL: BinaryOperator.LESS_EQUAL,
}


def _variable(prefix: str, number: int) -> ast.Expression:
    return ast.NameExpression(NOWHERE, f"{prefix}{number}")


def _integer(value: int) -> ast.Expression:
    return ast.IntegerLiteral(NOWHERE, value)
