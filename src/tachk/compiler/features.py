"""What a network and a query use that not every analysis can handle, asked before any work is done."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from math import prod

from tachk.compiler.conditions import reads_clock
from tachk.compiler.fold import Known, fold, known_values
from tachk.compiler.goal import check_predicate, mentions_time
from tachk.compiler.intervals import interval
from tachk.compiler.slot_layout import cell_range
from tachk.diagnostics.diagnostic import Diagnostic, UnsupportedError
from tachk.diagnostics.span import Span
from tachk.model.expressions import (
    Binary,
    Constant,
    Deadlock,
    Expression,
    Field,
    Index,
    Quantifier,
    Reference,
    Unary,
)
from tachk.model.network import Direction, Edge, Location, Network, Process
from tachk.model.query import Query, QueryKind
from tachk.model.traversal import children, walk
from tachk.model.types import ChannelType, ClockType
from tachk.operators import COMPARISONS, BinaryOperator, UnaryOperator

MAXIMAL_SELECTIONS = 10_000_000
"""Combinations of the values of one edge's select labels; each is tried against the guard."""


class Feature(StrEnum):
    PRIORITIES = "priorities"
    """Some channel or process has a priority of its own."""
    STOPWATCHES = "stopwatches"
    """Some location stops a clock."""
    DIAGONALS = "clock differences"
    """Two clocks are compared with each other."""
    URGENT_CLOCK_GUARDS = "clock guards on urgent channels"
    """A moment at which an urgent synchronisation becomes possible lies inside a delay."""
    BROADCAST_CLOCK_GUARDS = "clock guards of broadcast receivers"
    """Whether a process takes part in a broadcast depends on clocks."""
    STRICT_BOUNDS = "strict clock bounds"
    """Integer delays do not suffice."""
    DEADLOCK = "deadlock"
    """The predicate asks whether any action is possible."""


@dataclass(frozen=True, slots=True)
class FeatureUse:
    """One place where a feature is used; ``what`` names the thing: ``the edge A -> B of P``."""

    feature: Feature
    what: str
    span: Span


@dataclass(frozen=True, slots=True)
class FeatureSet:
    """The features of a network, or of a network with a query, in the order of the text."""

    uses: tuple[FeatureUse, ...]

    def __contains__(self, feature: Feature) -> bool:
        return any(use.feature is feature for use in self.uses)

    def of(self, feature: Feature) -> tuple[FeatureUse, ...]:
        return tuple(use for use in self.uses if use.feature is feature)


def network_features(network: Network) -> FeatureSet:
    """What a network uses. Raises UnsupportedError for a clock rate other than 0 and 1."""
    return FeatureSet(tuple(_network_uses(network, known_values(network, []))))


def query_features(query: Query) -> FeatureSet:
    """What the formula of a query uses."""
    uses: list[FeatureUse] = []
    for expression in (() if query.predicate is None else (query.predicate,)) + query.operands:
        uses.extend(_condition_uses(expression, f"the query {query.name}"))
        if any(isinstance(node, Deadlock) for node in walk(expression)):
            uses.append(FeatureUse(Feature.DEADLOCK, f"the query {query.name}", expression.span))
    return FeatureSet(tuple(uses))


def check_selections(network: Network) -> None:
    """Raises UnsupportedError where the select labels of an edge have too many combinations of values to try."""
    for process in network.processes:
        for edge in process.edges:
            sizes = [high - low + 1 for low, high in (cell_range(variable.type) for variable in edge.selects)]
            if prod(sizes) > MAXIMAL_SELECTIONS:
                raise UnsupportedError(
                    Diagnostic(
                        "E0708",
                        f"the select labels of this edge have {prod(sizes)} combinations of values",
                        edge.spans[0],
                        "select from smaller ranges, or replace a select by a variable that is set step by step",
                    )
                )


def check_supported(network: Network, query: Query) -> None:
    """Raises UnsupportedError, naming the place, if the reachability engine cannot decide the query."""
    if query.target is None:
        raise UnsupportedError(
            Diagnostic(
                "E0720",
                f"queries with `{query.kind.value}` are not checked yet",
                query.span,
                _ALTERNATIVES.get(query.kind),
            )
        )
    _check_urgency(network)
    _check_rates(network)
    if mentions_time(query.target):
        check_predicate(query.target, known_values(network, [query.target]))


def _check_urgency(network: Network) -> None:
    for process in network.processes:
        for edge in process.edges:
            for use in _edge_uses(process, edge) if _is_urgent(edge) else ():
                if use.feature is Feature.URGENT_CLOCK_GUARDS:
                    raise UnsupportedError(
                        Diagnostic(
                            "E0721",
                            f"{use.what} compares a clock in its guard and synchronises over an urgent channel",
                            use.span,
                            "put the clock condition on an edge of its own in front of it, "
                            "so that the process waits in a location until the synchronisation may happen",
                        )
                    )


def _is_urgent(edge: Edge) -> bool:
    channel = None if edge.synchronisation is None else edge.synchronisation.channel.type
    return isinstance(channel, ChannelType) and channel.urgent


def _check_rates(network: Network) -> None:
    rates = [rate for p in network.processes for location in p.locations for _, rate in location.rates]
    if rates:
        known = known_values(network, [])
        for rate in rates:
            rate_of(rate, known)


_ALTERNATIVES = {
    QueryKind.EVENTUALLY: "with a known deadline T, the formula F[0, T] p asks for p in time",
    QueryKind.LEADS_TO: "with a known deadline T, the formula G (p -> F[0, T] q) asks for an answer in time",
    QueryKind.SUPREMUM: "check A[] x <= c for a constant c",
    QueryKind.INFIMUM: "check A[] x >= c for a constant c",
    QueryKind.BOUNDS: "check A[] x >= c and A[] x <= d for constants c and d",
}


# ---- uses -----------------------------------------------------------------------------------------------------------


def _network_uses(network: Network, known: Known) -> Iterator[FeatureUse]:
    for variable in network.all_variables():
        if any(p != network.default_priority for p in variable.priorities):
            yield FeatureUse(Feature.PRIORITIES, f"the channel {variable.name}", variable.span)
    for process in network.processes:
        if process.priority != network.processes[0].priority:
            yield FeatureUse(Feature.PRIORITIES, f"the process {process.name}", process.span)
        for location in process.locations:
            yield from _location_uses(process, location, known)
        for edge in process.edges:
            yield from _edge_uses(process, edge)


def _location_uses(process: Process, location: Location, known: Known) -> Iterator[FeatureUse]:
    what = f"the location {process.name}.{location.name}"
    if location.invariant is not None:
        yield from _condition_uses(location.invariant, what)
    for _, rate in location.rates:
        if rate_of(rate, known) != Constant(1):
            yield FeatureUse(Feature.STOPWATCHES, what, rate.span)


def _edge_uses(process: Process, edge: Edge) -> Iterator[FeatureUse]:
    if edge.guard is None:
        return
    names = process.locations[edge.source].name, process.locations[edge.target].name
    what = f"the edge {names[0]} -> {names[1]} of {process.name}"
    yield from _condition_uses(edge.guard, what)
    if edge.synchronisation is None or not reads_clock(edge.guard):
        return
    channel = edge.synchronisation.channel.type
    assert isinstance(channel, ChannelType)
    receives_broadcast = channel.broadcast and edge.synchronisation.direction is Direction.RECEIVE
    if receives_broadcast:
        yield FeatureUse(Feature.BROADCAST_CLOCK_GUARDS, what, edge.guard.span)
    elif channel.urgent:
        yield FeatureUse(Feature.URGENT_CLOCK_GUARDS, what, edge.guard.span)


def _condition_uses(condition: Expression, what: str) -> Iterator[FeatureUse]:
    for operator, comparison in _clock_comparisons(condition, True):
        if operator in (BinaryOperator.LESS, BinaryOperator.GREATER, BinaryOperator.NOT_EQUAL):
            yield FeatureUse(Feature.STRICT_BOUNDS, what, comparison.span)
        clocks = [node for node in walk(comparison) if _is_clock(node)]
        if len(clocks) > 1:
            yield FeatureUse(Feature.DIAGONALS, what, comparison.span)


def _is_clock(node: Expression) -> bool:
    return isinstance(node, Reference | Index | Field) and isinstance(node.type, ClockType)


def _clock_comparisons(condition: Expression, positive: bool) -> Iterator[tuple[BinaryOperator, Binary]]:
    """The comparisons of clocks in a condition, with the operators they have once negations are pushed inwards."""
    match condition:
        case Unary(UnaryOperator.NOT, operand):
            yield from _clock_comparisons(operand, not positive)
        case Binary(BinaryOperator.IMPLY, left, right):
            yield from _clock_comparisons(left, not positive)
            yield from _clock_comparisons(right, positive)
        case Binary(BinaryOperator.AND | BinaryOperator.OR, left, right):
            yield from _clock_comparisons(left, positive)
            yield from _clock_comparisons(right, positive)
        case Quantifier(_, _, body):
            yield from _clock_comparisons(body, positive)
        case Binary(operator) if operator in COMPARISONS and any(_is_clock(node) for node in walk(condition)):
            yield (operator if positive else operator.negated), condition
        case _:
            for child in children(condition):
                yield from _clock_comparisons(child, True)
                yield from _clock_comparisons(child, False)


def rate_of(rate: Expression, known: Known) -> Expression:
    """The folded rate of a clock. Raises UnsupportedError unless it is 0 or 1 in every state."""
    folded = fold(rate, known)
    low, high = interval(folded, known)
    if low < 0 or high > 1:
        what = f"the clock rate {low}" if low == high else f"a clock rate that may lie anywhere in [{low}, {high}]"
        raise UnsupportedError(
            Diagnostic(
                "E0710",
                f"{what} is not 0 or 1",
                rate.span,
                "only stopped (0) and running (1) clocks can be checked symbolically",
            )
        )
    return folded if not isinstance(folded, Constant) else Constant(folded.value)
