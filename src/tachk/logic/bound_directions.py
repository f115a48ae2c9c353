"""The direction of bounds in a temporal formula: with a longer window for what must come it is true more often, with a
longer one in which something must stay less often.

Follows from the meaning of the operators: what an operator on a window demands grows or shrinks with each end of the
window, and connectives keep the direction, a negation turns it around.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from tachk.base.operators import BinaryOperator, PrefixOperator
from tachk.syntax import ast
from tachk.syntax.formula import (
    Always,
    And,
    Atom,
    Change,
    Duration,
    Eventually,
    Fall,
    Formula,
    Historically,
    Implies,
    Interval,
    Not,
    Once,
    Or,
    Rise,
    Since,
    TruthConstant,
    Until,
    WeakUntil,
)

Easier = bool | None
"""True if more of something makes a formula true more often, False if less often; None: neither is known."""

Directions = Iterator[tuple[ast.Expression, Easier]]


def bound_directions(formula: Formula, easier: Easier = True) -> Directions:
    """The parameters in the bounds of a formula, each with the effect of increasing it.

    Args:
        easier: whether the formula is true more often where a part is; False below a negation.
    """
    match formula:
        case TruthConstant() | Atom() | Change():
            return
        case Not(operand=operand):
            yield from bound_directions(operand, _turned(easier))
        case And(operands=parts) | Or(operands=parts):
            for part in parts:
                yield from bound_directions(part, easier)
        case Implies(left=left, right=right):
            yield from bound_directions(left, _turned(easier))
            yield from bound_directions(right, easier)
        case Eventually(interval=interval, operand=operand) | Once(interval=interval, operand=operand):
            yield from _of_window(interval, easier)
            yield from bound_directions(operand, easier)
        case Always(interval=interval, operand=operand) | Historically(interval=interval, operand=operand):
            yield from _of_window(interval, _turned(easier))
            yield from bound_directions(operand, easier)
        case Until(interval=interval, left=left, right=right) | Since(interval=interval, left=left, right=right):
            yield from _of_window(interval, easier)
            yield from bound_directions(left, easier)
            yield from bound_directions(right, easier)
        case WeakUntil(left=left, right=right):
            yield from bound_directions(left, easier)
            yield from bound_directions(right, easier)
        case Rise(operand=operand) | Fall(operand=operand):
            yield from bound_directions(operand, None)


def directions_in(expression: ast.Expression, easier: Easier) -> Directions:
    """The same for the names in a single bound."""
    match expression:
        case ast.IntegerLiteral() | ast.FloatLiteral():
            return
        case ast.UnaryExpression(operator=PrefixOperator.MINUS, operand=operand):
            yield from directions_in(operand, _turned(easier))
        case ast.BinaryExpression(operator=BinaryOperator.ADD, left=left, right=right):
            yield from directions_in(left, easier)
            yield from directions_in(right, easier)
        case ast.BinaryExpression(operator=BinaryOperator.SUBTRACT, left=left, right=right):
            yield from directions_in(left, easier)
            yield from directions_in(right, _turned(easier))
        case ast.BinaryExpression(operator=BinaryOperator.MULTIPLY, left=ast.IntegerLiteral(), right=right):
            yield from directions_in(right, easier)
        case ast.BinaryExpression(operator=BinaryOperator.MULTIPLY, left=left, right=ast.IntegerLiteral()):
            yield from directions_in(left, easier)
        case ast.BinaryExpression(left=left, right=right):
            yield from directions_in(left, None)
            yield from directions_in(right, None)
        case ast.UnaryExpression(operand=operand):
            yield from directions_in(operand, None)
        case ast.NameExpression():
            yield expression, easier
        case _:
            yield expression, None


def _of_window(interval: Interval, easier: Easier) -> Directions:
    """``easier``: whether a longer window makes the formula true more often."""
    yield from _of_duration(interval.lower, _turned(easier))
    if interval.upper is not None:
        yield from _of_duration(interval.upper, easier)


def _of_duration(duration: Duration, easier: Easier) -> Directions:
    if not isinstance(duration.value, Fraction):
        yield from directions_in(duration.value, easier)


def _turned(easier: Easier) -> Easier:
    return None if easier is None else not easier
