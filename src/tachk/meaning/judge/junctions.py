"""Predicates split into conjunctions and disjunctions, quantified ones included, whose parts have no order.

That is what they mean as long as no part is a run-time error.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import partial
from typing import Any

from tachk.base.operators import BinaryOperator, UnaryOperator
from tachk.base.records import dataclass
from tachk.meaning.constraints import FALSE, TRUE, Disjunction, certain
from tachk.model.evaluate import Environment
from tachk.model.expressions import Binary, Expression, Quantifier, QuantifierKind, Unary, Variable
from tachk.model.traversal import asks_deadlock
from tachk.model.types import ScalarLike, bounds

Sets = frozenset[frozenset[tuple[int, int, int]]]
"""A disjunction of conjunctions of clock constraints."""


@dataclass(frozen=True, eq=False)
class PredicateAtom:
    """A part that is not split: an expression, or its negation, where some variables have values."""

    expression: Expression
    positive: bool
    bound: tuple[tuple[Variable, int], ...]

    def truth(self, scratch: Environment) -> tuple[tuple[Sets, Sets], ...]:
        """The sets where it is true for certain and where perhaps, without a deadlock and with one: two pairs, which
        are equal if the expression does not contain `deadlock`."""
        for variable, value in self.bound:
            scratch.bind(variable, value)
        found: list[Any] = []
        with_deadlock = asks_deadlock(self.expression)
        for dead in (False, True) if with_deadlock else (False,):
            scratch.deadlock = partial(bool, dead)
            ways = (certain(self.expression, scratch, not self.positive, unknown) for unknown in (FALSE, TRUE))
            found.append(tuple(map(sets, ways)))
        return tuple(found if with_deadlock else found * 2)


@dataclass(frozen=True, eq=False)
class Junction:
    """A conjunction, or else a disjunction."""

    conjunctive: bool
    parts: tuple[Part, ...]


Part = PredicateAtom | Junction


def part_of(expression: Expression, positive: bool = True, bound: tuple[tuple[Variable, int], ...] = ()) -> Part:
    """A predicate, or its negation, split into its parts."""
    while isinstance(expression, Unary) and expression.operator is UnaryOperator.NOT:
        expression, positive = expression.operand, not positive
    conjunctive = _joins(expression)
    if conjunctive is None:
        return PredicateAtom(expression, positive, bound)
    conjunctive = conjunctive is positive
    parts: list[Part] = []
    for inner, is_positive, its_bound in _operands(expression, positive, bound):
        part = part_of(inner, is_positive, its_bound)
        same = isinstance(part, Junction) and part.conjunctive is conjunctive
        parts += part.parts if isinstance(part, Junction) and same else (part,)
    return Junction(conjunctive, tuple(parts))


def atoms(part: Part) -> Iterator[PredicateAtom]:
    if isinstance(part, PredicateAtom):
        yield part
    else:
        for inner in part.parts:
            yield from atoms(inner)


def sets(condition: Disjunction) -> Sets:
    """A disjunction without order, and without what another part of it contains."""
    parts = {frozenset(part) for part in condition}
    return frozenset(part for part in parts if not any(other < part for other in parts))


def _joins(expression: Expression) -> bool | None:
    """True if an expression is a conjunction, False if it is a disjunction; None for other expressions."""
    if isinstance(expression, Quantifier) and expression.kind is not QuantifierKind.SUM:
        return expression.kind is QuantifierKind.FORALL
    if isinstance(expression, Binary) and expression.operator in (
        BinaryOperator.AND,
        BinaryOperator.OR,
        BinaryOperator.IMPLY,
    ):
        return expression.operator is BinaryOperator.AND
    return None


def _operands(
    expression: Expression, positive: bool, bound: tuple[tuple[Variable, int], ...]
) -> Iterable[tuple[Expression, bool, tuple[tuple[Variable, int], ...]]]:
    if isinstance(expression, Quantifier):
        assert isinstance(expression.variable.type, ScalarLike)
        low, high = bounds(expression.variable.type)
        for value in range(low, high + 1):
            yield expression.body, positive, (*bound, (expression.variable, value))
    elif isinstance(expression, Binary):
        yield expression.left, positive is not (expression.operator is BinaryOperator.IMPLY), bound
        yield expression.right, positive, bound
