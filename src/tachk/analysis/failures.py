"""Expressions that may meet a run-time error, by the ranges of variables."""

from __future__ import annotations

from collections.abc import Sequence

from tachk.analysis.conditions import conjuncts
from tachk.analysis.fold import Known, fold, fold_place, is_integer
from tachk.analysis.interpreter import slots
from tachk.analysis.intervals import IntervalDomain
from tachk.base.operators import COMPARISONS, BinaryOperator
from tachk.base.words import Direction
from tachk.model.expressions import Binary, Constant, Expression, Reference
from tachk.model.network import Edge, Location
from tachk.model.traversal import written_variables
from tachk.model.variable_layout import slot_range


class _CanFailError(Exception):
    """Something that is evaluated can be a run-time error."""


class FailureDomain(IntervalDomain):
    """Ends with the first expression that can be a run-time error."""

    __slots__ = ()

    def can_fail(self, fails: bool = True) -> None:
        if fails:
            raise _CanFailError


def can_fail(expression: Expression, known: Known) -> bool:
    """True if evaluating the expression can be a run-time error in some state. Conservative: what is not plain can.

    ``x / y``, for one, cannot where the range of ``y`` leaves out 0, and ``n = m`` cannot where all of ``m`` fits.
    """
    return _fails(expression, FailureDomain(known))


def _fails(expression: Expression, domain: FailureDomain) -> bool:
    try:
        slots(fold_place(expression, domain.facts), domain)
    except _CanFailError:
        domain.forget(written_variables([expression]))
        return True
    return False


def location_can_fail(location: Location, known: Known) -> bool:
    """True if the invariant or a rate of a location can be a run-time error."""
    invariant = () if location.invariant is None else (location.invariant,)
    return any(can_fail(expression, known) for expression in (*invariant, *(rate for _, rate in location.rates)))


def edge_can_fail(edge: Edge, known: Known, updates: Sequence[Expression] | None = None) -> bool:
    """True if something of an edge can be a run-time error.

    Args:
        updates: the updates to look at, and nothing but them; all of the edge if there are none.
    """
    evaluated = edge.updates if updates is None else updates
    domain = FailureDomain(known)
    fails = edge.guard is not None and _assumed_fails(fold(edge.guard, known), domain)
    if updates is None and edge.synchronisation is not None:
        fails = fails or _fails(edge.synchronisation.channel, domain)
    if updates is None and fails:
        return True
    if edge.synchronisation is not None and edge.synchronisation.direction is Direction.RECEIVE:
        domain.narrow.clear()  # what the sender does comes between the guard of a receiver and its updates
    return any(_fails(update, domain) and update in evaluated for update in edge.updates)


def _assumed_fails(guard: Expression, domain: FailureDomain) -> bool:
    """True if a guard can fail, each part of it behind those to its left. The domain learns the ranges of variables
    where the guard holds, as far as it compares them with constants."""
    fails = False
    for part in conjuncts(guard):
        fails = _fails(part, domain) or fails
        match part:
            case Binary(operator, Reference(variable), Constant(value)) if is_integer(variable.type):
                pass
            case Binary(operator, Constant(value), Reference(variable)) if operator in COMPARISONS and is_integer(
                variable.type
            ):
                operator = operator.mirrored
            case _:
                continue
        low, high = domain.narrow.get(variable, slot_range(variable.type))
        match operator:
            case BinaryOperator.EQUAL:
                low, high = max(low, value), min(high, value)
            case BinaryOperator.LESS:
                high = min(high, value - 1)
            case BinaryOperator.LESS_EQUAL:
                high = min(high, value)
            case BinaryOperator.GREATER:
                low = max(low, value + 1)
            case BinaryOperator.GREATER_EQUAL:
                low = max(low, value)
            case _:
                pass
        if low <= high:
            domain.narrow[variable] = low, high
    return fails
