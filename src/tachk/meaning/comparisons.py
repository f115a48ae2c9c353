"""The comparisons of clocks on which the truth of a predicate can depend in a discrete state.

No normal form is made: the work is that of reading the predicate once, each instance of what is quantified by itself.
"""

from __future__ import annotations

from collections.abc import Iterator

from tachk.base.job import check_job
from tachk.base.operators import BinaryOperator, UnaryOperator
from tachk.meaning.constraints import FALSE, TRUE, disjunctive
from tachk.meaning.dbm import Constraint
from tachk.model.evaluate import Environment, evaluate
from tachk.model.expressions import (
    Binary,
    Comma,
    Conditional,
    Expression,
    Quantifier,
    QuantifierKind,
    Unary,
    Variable,
)
from tachk.model.fault import EvaluationFault
from tachk.model.traversal import depends_on_clocks
from tachk.model.types import ClockType, ScalarLike, bounds

Dependence = bool | frozenset[Constraint]
"""The truth of a predicate, or its comparisons of clocks: a predicate that cannot be evaluated depends on none."""


def comparisons(predicate: Expression, environment: Environment) -> frozenset[Constraint]:
    """Constraints on clocks such that the truth of a predicate cannot change unless that of one of them does.

    Raises ValueError for a comparison that is not a difference constraint.
    """
    found = _dependence(predicate, environment)
    return frozenset() if isinstance(found, bool) else found


def _dependence(predicate: Expression, environment: Environment) -> Dependence:
    check_job()
    if not depends_on_clocks(predicate):
        try:
            return evaluate(predicate, environment) != 0
        except EvaluationFault:
            return frozenset()
    match predicate:
        case Unary(UnaryOperator.NOT, operand):
            return _negated(_dependence(operand, environment))
        case Binary(BinaryOperator.AND | BinaryOperator.OR as operator, left, right):
            return _joined((_dependence(each, environment) for each in (left, right)), operator is BinaryOperator.OR)
        case Binary(BinaryOperator.IMPLY, left, right):
            return _joined(iter((_negated(_dependence(left, environment)), _dependence(right, environment))), True)
        case Binary(_, left, right) if isinstance(left.type, ClockType) or isinstance(right.type, ClockType):
            return _of_comparison(predicate, environment)
        case Binary(_, left, right):
            return _either(_dependence(left, environment), _dependence(right, environment))
        case Conditional(test, then, otherwise):
            ways = _dependence(then, environment), _dependence(otherwise, environment)
            chosen = _dependence(test, environment)
            return ways[not chosen] if isinstance(chosen, bool) else chosen | _either(*ways)
        case Quantifier(kind, variable, body):
            assert isinstance(variable.type, ScalarLike)
            low, high = bounds(variable.type)
            instances = (_instance(body, variable, value, environment) for value in range(low, high + 1))
            return _joined(instances, kind is QuantifierKind.EXISTS)
        case Comma(items):
            return _dependence(items[-1], environment)
        case _:
            raise ValueError(f"{predicate.span}: a condition on clocks cannot have this form")


def _instance(body: Expression, variable: Variable, value: int, environment: Environment) -> Dependence:
    environment.bind(variable, value)
    return _dependence(body, environment)


def _of_comparison(comparison: Expression, environment: Environment) -> Dependence:
    try:
        found = disjunctive(comparison, environment)
    except EvaluationFault:
        return frozenset()
    if found in (TRUE, FALSE):
        return found == TRUE
    return frozenset(constraint for conjunction in found for constraint in conjunction)


def _negated(found: Dependence) -> Dependence:
    return not found if isinstance(found, bool) else found


def _joined(parts: Iterator[Dependence], decisive: bool) -> Dependence:
    """A disjunction (which a true part decides) or a conjunction (which a false one decides)."""
    whole: Dependence = not decisive
    for part in parts:
        if part is decisive:
            return decisive
        if not isinstance(part, bool):
            whole = part if isinstance(whole, bool) else whole | part
    return whole


def _either(one: Dependence, other: Dependence) -> frozenset[Constraint]:
    return frozenset().union(*(part for part in (one, other) if not isinstance(part, bool)))
