"""Conditions made of conditions, told where the last of them is."""

from __future__ import annotations

from collections.abc import Sequence

from tachk.model.expressions import BOOL, Binary, Expression, Unary
from tachk.operators import BinaryOperator, UnaryOperator


def negation(condition: Expression) -> Expression:
    """The condition under a ``not``, as it stands; `tachk.compiler.fold.negate` simplifies."""
    return Unary(UnaryOperator.NOT, condition, BOOL, condition.span)


def both(one: Expression | None, other: Expression) -> Expression:
    """Both conditions; None is always true."""
    return other if one is None else Binary(BinaryOperator.AND, one, other, BOOL, other.span)


def either(one: Expression, other: Expression) -> Expression:
    return Binary(BinaryOperator.OR, one, other, BOOL, other.span)


def any_of(conditions: Sequence[Expression]) -> Expression:
    """One or more conditions, one of which holds, as a balanced tree: there may be thousands."""
    if len(conditions) == 1:
        return conditions[0]
    middle = (len(conditions) + 1) // 2
    return either(any_of(conditions[:middle]), any_of(conditions[middle:]))
