"""Edges that the invariant of their own source location keeps from ever being taken: most often a typing mistake."""

from __future__ import annotations

from collections.abc import Iterator

from tachk.base.diagnostics.diagnostic import Label
from tachk.base.job import check_job
from tachk.base.operators import BinaryOperator
from tachk.base.span import Span
from tachk.frontend.context import Context
from tachk.model.expressions import Binary, Constant, Expression
from tachk.model.network import Edge, Network, Process
from tachk.model.types import ClockType

_BELOW = (BinaryOperator.LESS, BinaryOperator.LESS_EQUAL, BinaryOperator.EQUAL)
_ABOVE = (BinaryOperator.GREATER, BinaryOperator.GREATER_EQUAL, BinaryOperator.EQUAL)
_STRICT = (BinaryOperator.LESS, BinaryOperator.GREATER)

Bound = tuple[Expression, BinaryOperator, int, Span]
"""A clock, how it compares with a number, and where that is said."""


def warn_of_impossible_edges(network: Network, context: Context) -> None:
    """Warns of edges whose guard contradicts the invariant of their source in every process of the template."""
    contradictions: dict[Span, tuple[str, Bound, Bound] | None] = {}
    for process in network.processes:
        check_job()
        for edge in process.edges:
            found = _contradiction(process, edge)
            if found is None:
                contradictions[edge.spans[0]] = None
            else:
                contradictions.setdefault(edge.spans[0], (process.locations[edge.source].name, *found))
    for contradiction in contradictions.values():
        if contradiction is not None:
            location, demanded, allowed = contradiction
            context.findings.add(
                "W0411",
                demanded[3],
                f"this is never true in `{location}`, because of its invariant: the edge is never taken",
                "change the guard or the invariant",
                (Label(allowed[3], "the invariant"),),
            )


def _contradiction(process: Process, edge: Edge) -> tuple[Bound, Bound] | None:
    """A comparison of the guard and one of the invariant that no value of the clock meets together."""
    invariant = process.locations[edge.source].invariant
    if edge.guard is None or invariant is None:
        return None
    allowed = list(_bounds(invariant))
    return next((pair for one in _bounds(edge.guard) for other in allowed if _exclude(*(pair := (one, other)))), None)


def _bounds(condition: Expression) -> Iterator[Bound]:
    """The comparisons of a clock with a number that a conjunction consists of, among others."""
    match condition:
        case Binary(BinaryOperator.AND, left, right):
            yield from _bounds(left)
            yield from _bounds(right)
        case Binary(operator, left, Constant(value)) if isinstance(left.type, ClockType):
            yield left, operator, value, condition.span
        case Binary(operator, Constant(value), right) if isinstance(right.type, ClockType):
            yield right, operator.mirrored, value, condition.span


def _exclude(one: Bound, other: Bound) -> bool:
    """Whether no value of one clock satisfies both."""
    (clock, first, low, _), (same, second, high, _) = one, other
    if clock != same:
        return False
    if first in _ABOVE and second in _BELOW:
        return low > high or (low == high and (first in _STRICT or second in _STRICT))
    if first in _BELOW and second in _ABOVE:
        return low < high or (low == high and (first in _STRICT or second in _STRICT))
    return False
