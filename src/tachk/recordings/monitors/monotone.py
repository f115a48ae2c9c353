"""The monotonicity of a formula in a parameter: a larger value makes it easier to satisfy, or harder.

Truth is ordered false < undetermined < true. Conjunction, disjunction and the temporal operators never fall in this
order where an operand rises, or where the window of an F or until grows; G turns that of its window round, and negation
everything. A formula is monotone in a parameter where all its occurrences agree.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction

from tachk.base.operators import BinaryOperator, PrefixOperator
from tachk.syntax import ast
from tachk.syntax import formula as syntax
from tachk.syntax.walk import nodes_of_kind


class Monotonicity(Enum):
    """The effect of a larger value."""

    EASIER = 1
    HARDER = -1
    UNKNOWN = 0

    @property
    def reversed(self) -> Monotonicity:
        return Monotonicity(-self.value)


@dataclass(frozen=True, slots=True)
class Occurrence:
    """A place of the parameter.

    Attributes:
        threshold: the comparison it stands in; None: it stands in a bound of time, or elsewhere.
        slope: by how much a bound of time grows with the parameter; None for other places.
    """

    effect: Monotonicity
    threshold: ast.BinaryExpression | None = None
    slope: Fraction | None = None


def occurrences(formula: syntax.Formula, name: str) -> tuple[Occurrence, ...]:
    """All places of a parameter in a formula."""
    return tuple(_within(formula, name, Monotonicity.EASIER))


def joint_effect(found: tuple[Occurrence, ...]) -> Monotonicity:
    """The joint effect of all occurrences."""
    effects = {occurrence.effect for occurrence in found}
    return effects.pop() if len(effects) == 1 else Monotonicity.UNKNOWN


def _within(formula: syntax.Formula, name: str, rising: Monotonicity) -> Iterator[Occurrence]:
    """Args: rising: what a formula that becomes easier here does to the whole."""
    match formula:
        case syntax.TruthConstant():
            return
        case syntax.Atom(expression=expression):
            yield from _in_condition(expression, name, rising)
        case syntax.Change(expression=expression):
            yield from _unknown(expression, name)
        case syntax.Not(operand=operand):
            yield from _within(operand, name, rising.reversed)
        case syntax.And(operands=operands) | syntax.Or(operands=operands):
            for operand in operands:
                yield from _within(operand, name, rising)
        case syntax.Implies(left=left, right=right):
            yield from _within(left, name, rising.reversed)
            yield from _within(right, name, rising)
        case syntax.Rise(operand=operand) | syntax.Fall(operand=operand):
            yield from _unknown(operand, name)
        case syntax.Eventually(interval=interval, operand=operand) | syntax.Once(interval=interval, operand=operand):
            yield from _in_window(interval, name, rising)
            yield from _within(operand, name, rising)
        case (
            syntax.Always(interval=interval, operand=operand) | syntax.Historically(interval=interval, operand=operand)
        ):
            yield from _in_window(interval, name, rising.reversed)
            yield from _within(operand, name, rising)
        case (
            syntax.Until(interval=interval, left=left, right=right)
            | syntax.Since(interval=interval, left=left, right=right)
        ):
            yield from _in_window(interval, name, rising)
            yield from _within(left, name, rising)
            yield from _within(right, name, rising)
        case syntax.WeakUntil(left=left, right=right):
            yield from _within(left, name, rising)
            yield from _within(right, name, rising)


def _in_window(interval: syntax.Interval, name: str, growing: Monotonicity) -> Iterator[Occurrence]:
    """Args: growing: what a larger window does."""
    yield from _in_bound(interval.lower, name, growing.reversed)
    if interval.upper is not None:
        yield from _in_bound(interval.upper, name, growing)


def _in_bound(duration: syntax.Duration, name: str, rising: Monotonicity) -> Iterator[Occurrence]:
    if isinstance(duration.value, Fraction) or not _names(duration.value, name):
        return
    slope = _slope(duration.value, name)
    if slope is None:
        yield Occurrence(Monotonicity.UNKNOWN)
    else:
        yield Occurrence(_times(rising, slope), slope=slope)


def _in_condition(expression: ast.Expression, name: str, rising: Monotonicity) -> Iterator[Occurrence]:
    if not _names(expression, name):
        return
    match expression:
        case ast.UnaryExpression(operator=PrefixOperator.NOT, operand=operand):
            yield from _in_condition(operand, name, rising.reversed)
        case ast.BinaryExpression(operator=BinaryOperator.AND | BinaryOperator.OR, left=left, right=right):
            yield from _in_condition(left, name, rising)
            yield from _in_condition(right, name, rising)
        case ast.BinaryExpression(operator=BinaryOperator.IMPLY, left=left, right=right):
            yield from _in_condition(left, name, rising.reversed)
            yield from _in_condition(right, name, rising)
        case ast.BinaryExpression(operator=operator, left=left, right=right) if operator in _EASIER_ON_THE_RIGHT:
            first, second = _slope(left, name), _slope(right, name)
            if first is None or second is None:
                yield Occurrence(Monotonicity.UNKNOWN, expression)
            else:
                grows = second - first
                yield Occurrence(_times(rising, grows if _EASIER_ON_THE_RIGHT[operator] else -grows), expression)
        case _:
            yield from _unknown(expression, name)


_EASIER_ON_THE_RIGHT = {
    BinaryOperator.LESS: True,
    BinaryOperator.LESS_EQUAL: True,
    BinaryOperator.GREATER: False,
    BinaryOperator.GREATER_EQUAL: False,
}
"""True if a larger right side makes a comparison easier."""


def _times(effect: Monotonicity, slope: Fraction) -> Monotonicity:
    if slope == 0:
        return Monotonicity.UNKNOWN
    return effect if slope > 0 else effect.reversed


def _slope(expression: ast.Expression, name: str) -> Fraction | None:
    """By how much an expression grows with a name; None where it is not a multiple of it, and a rest without it."""
    if not _names(expression, name):
        return Fraction(0)
    match expression:
        case ast.NameExpression():
            return Fraction(1)
        case ast.UnaryExpression(operator=PrefixOperator.MINUS, operand=operand):
            slope = _slope(operand, name)
            return None if slope is None else -slope
        case ast.UnaryExpression(operator=PrefixOperator.PLUS, operand=operand):
            return _slope(operand, name)
        case ast.BinaryExpression(
            operator=BinaryOperator.ADD | BinaryOperator.SUBTRACT as operator, left=left, right=right
        ):
            first, second = _slope(left, name), _slope(right, name)
            if first is None or second is None:
                return None
            return first + second if operator is BinaryOperator.ADD else first - second
        case ast.BinaryExpression(operator=BinaryOperator.MULTIPLY, left=left, right=right):
            for factor, other in ((left, right), (right, left)):
                if (number := _number(factor)) is not None and (slope := _slope(other, name)) is not None:
                    return number * slope
            return None
        case ast.BinaryExpression(operator=BinaryOperator.DIVIDE, left=left, right=right):
            divisor, slope = _number(right), _slope(left, name)
            return slope / divisor if divisor and slope is not None else None
        case _:
            return None


def _number(expression: ast.Expression) -> Fraction | None:
    match expression:
        case ast.IntegerLiteral(value=value):
            return Fraction(value)
        case ast.FloatLiteral(text=text):
            return Fraction(text)
        case ast.UnaryExpression(operator=PrefixOperator.MINUS, operand=operand):
            number = _number(operand)
            return None if number is None else -number
        case _:
            return None


def _unknown(node: object, name: str) -> Iterator[Occurrence]:
    if _names(node, name):
        yield Occurrence(Monotonicity.UNKNOWN)


def _names(node: object, name: str) -> bool:
    return any(each.name == name for each in nodes_of_kind(node, ast.NameExpression))
