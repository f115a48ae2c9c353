"""Conditions made of conditions, each at the place of the last of them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from tachk.base.operators import BinaryOperator, UnaryOperator
from tachk.model.expressions import BOOL, Binary, Constant, Expression, LocationTest, Unary
from tachk.model.network import Network


def negation(condition: Expression) -> Expression:
    """The condition under a ``not``, as it stands; `tachk.analysis.fold.negate` simplifies."""
    return Unary(UnaryOperator.NOT, condition, BOOL, condition.span)


def as_number(condition: Expression) -> Expression:
    """1 where the condition is true, else 0, also where it is a number other than these."""
    return Binary(BinaryOperator.NOT_EQUAL, condition, Constant(0), BOOL)


def is_set(flag: Expression) -> Expression:
    """The condition that a variable that is 0 or 1 is 1."""
    return Binary(BinaryOperator.EQUAL, flag, Constant(1), BOOL)


def both(one: Expression | None, other: Expression) -> Expression:
    """Both conditions; None is always true."""
    return other if one is None else Binary(BinaryOperator.AND, one, other, BOOL, other.span)


def either(one: Expression, other: Expression) -> Expression:
    return Binary(BinaryOperator.OR, one, other, BOOL, other.span)


def is_conjunction(condition: Expression, positive: bool = True) -> bool | None:
    """True if a condition, or (not positive) its negation, joins two conditions by "and", False if by "or"; None if by
    neither."""
    if not isinstance(condition, Binary) or condition.operator.decided_by is None:
        return None
    return (condition.operator is BinaryOperator.AND) is positive


def sides(condition: Binary, positive: bool = True) -> tuple[tuple[Expression, bool], tuple[Expression, bool]]:
    """The two operands of `is_conjunction`: each as it stands or (False) its negation."""
    left_positive = positive is not (condition.operator is BinaryOperator.IMPLY)
    return (condition.left, left_positive), (condition.right, positive)


def conjuncts(condition: Expression | None) -> Iterator[Expression]:
    """The conditions that are joined by ``&&``, in order; of None, which is always true, none."""
    pending = [] if condition is None else [condition]
    while pending:
        part = pending.pop()
        if isinstance(part, Binary) and part.operator is BinaryOperator.AND:
            pending += [part.right, part.left]
        else:
            yield part


def is_any_committed(network: Network) -> Expression:
    """The condition that some process of the network is in a committed location."""
    tests: list[Expression] = [
        LocationTest(number, location)
        for number, process in enumerate(network.processes)
        for location, place in enumerate(process.locations)
        if place.committed
    ]
    return any_of(tests) if tests else Constant(0, BOOL)


def any_of(conditions: Sequence[Expression]) -> Expression:
    """One or more conditions, one of which holds, as a balanced tree: there may be thousands."""
    if len(conditions) == 1:
        return conditions[0]
    middle = (len(conditions) + 1) // 2
    return either(any_of(conditions[:middle]), any_of(conditions[middle:]))
