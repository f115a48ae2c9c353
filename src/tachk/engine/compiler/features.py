"""Features of a network and a query that not every analysis can handle, checked before any work is done."""

from __future__ import annotations

from collections.abc import Iterator

from tachk.analysis.fold import Known, fold, known_values
from tachk.analysis.intervals import interval
from tachk.base.diagnostics.diagnostic import Diagnostic, UnsupportedError
from tachk.base.operators import COMPARISONS
from tachk.base.records import dataclass, replace
from tachk.base.span import Span
from tachk.base.words import Direction
from tachk.engine.compiler.goal import check_predicate, mentions_time
from tachk.engine.compiler.hybrid import refuse_hybrid
from tachk.model.connectives import negation
from tachk.model.expressions import (
    Binary,
    Constant,
    Deadlock,
    Expression,
)
from tachk.model.network import Edge, Network, Process
from tachk.model.query import Query
from tachk.model.traversal import reads_clock, walk
from tachk.model.types import ChannelType


@dataclass(frozen=True, slots=True)
class Use:
    """One place of a network; ``what`` names it: ``the edge A -> B of P``."""

    what: str
    span: Span


def stopwatches(network: Network) -> Iterator[Use]:
    """The rates that stop a clock in some state. Raises UnsupportedError for a rate other than 0 and 1."""
    known = known_values(network, [])
    for process in network.processes:
        for location in process.locations:
            for _, rate in location.rates:
                if rate_of(rate, known) != Constant(1):
                    yield Use(f"the location {process.name}.{location.name}", rate.span)


def urgent_clock_guards(network: Network) -> Iterator[Use]:
    """The clock guards of edges over urgent channels: the moment at which such a synchronisation becomes possible lies
    inside a delay. Receivers of a broadcast, which wait for no process, are not among them."""
    for process in network.processes:
        for edge in process.edges:
            if edge.guard is not None and _is_urgent(edge) and reads_clock(edge.guard):
                names = process.locations[edge.source].name, process.locations[edge.target].name
                yield Use(f"the edge {names[0]} -> {names[1]} of {process.name}", edge.guard.span)


def _is_urgent(edge: Edge) -> bool:
    if edge.synchronisation is None:
        return False
    channel = edge.synchronisation.channel.type
    assert isinstance(channel, ChannelType)
    receives = channel.broadcast and edge.synchronisation.direction is Direction.RECEIVE
    return channel.urgent and not receives


def check_supported(network: Network, query: Query) -> None:
    """Raises UnsupportedError, naming the place, if no engine can decide the query."""
    _check_urgency(network)
    _check_rates(network)
    stopped = query.avoided is not None and next(stopwatches(network), None) is not None
    for predicate in _compiled_predicates(query):
        if stopped:
            _check_no_deadlock(predicate)
        if mentions_time(predicate):
            check_predicate(predicate, known_values(network, [predicate]))


def _compiled_predicates(query: Query) -> Iterator[Expression]:
    """The predicates that become goals of a search; for `lower_obligation` also their negations."""
    goal = query.target or query.predicate
    if goal is not None:
        yield goal
    if query.avoided is not None:
        for predicate in (query.avoided, query.begins):
            if predicate is not None:
                yield from (predicate, negation(predicate))


def check_simulated(network: Network) -> None:
    """Raises UnsupportedError, naming the place, if the network cannot be simulated."""
    _check_urgency(network)
    _check_rates(network)


def check_units(network: Network) -> None:
    """Raises UnsupportedError, naming the place, if the network cannot be a unit of co-simulation."""
    check_simulated(network)
    refuse_hybrid(network, "a unit of co-simulation")
    if network.has_priorities:
        processes = {process.priority for process in network.processes}
        named = [v for v in network.all_variables() if set(v.priorities) - {network.default_priority}]
        span = network.processes[0].span if len(processes) > 1 or not named else named[0].span
        raise UnsupportedError(
            Diagnostic(
                "E0723", "units of co-simulation have no priorities", span, "leave them out, or simulate the model"
            )
        )


def uncomputed_chances(network: Network) -> tuple[Diagnostic, ...]:
    """Warnings about rates and weights that no simulation can compute; a search does not look at them."""
    chances = [location.exponential_rate for process in network.processes for location in process.locations]
    chances += [
        edge.branch.weight for process in network.processes for edge in process.edges if edge.branch is not None
    ]
    wrong = [replace(chance, code="W0722") for chance in chances if isinstance(chance, Diagnostic)]
    return tuple({str(found.span): found for found in wrong}.values())


def undrawn_ends(network: Network) -> tuple[Diagnostic, ...]:
    """Warnings about locations whose invariant ends although their process can only receive, in a network with
    exponential delays: who acts then is tachk's reading, see docs/simulation.md."""
    drawing = [number for number, process in enumerate(network.processes) if _draws_exponentially(process)]
    found = {}
    for number, process in enumerate(network.processes):
        if not set(drawing) - {number}:
            continue
        acting = {edge.source for edge in process.edges if not _only_receives(edge)}
        for place, location in enumerate(process.locations):
            waits = location.invariant is not None and not (location.urgent or location.committed)
            if waits and place not in acting and _limits_time(location.invariant):
                found[str(location.span)] = _undrawn_end(process.name, location.name, location.span)
    return tuple(found.values())


def _draws_exponentially(process: Process) -> bool:
    acting = {edge.source for edge in process.edges if not _only_receives(edge)}
    return any(process.locations[place].exponential_rate is not None for place in acting)


def _only_receives(edge: Edge) -> bool:
    return edge.synchronisation is not None and edge.synchronisation.direction is Direction.RECEIVE


def _limits_time(invariant: Expression | None) -> bool:
    return invariant is not None and any(
        isinstance(part, Binary)
        and part.operator in COMPARISONS
        and (reads_clock(part.left) or reads_clock(part.right))
        for part in walk(invariant)
    )


def _undrawn_end(process: str, location: str, span: Span) -> Diagnostic:
    return Diagnostic(
        "W0724",
        f"the invariant of {process}.{location} ends, and the process has no edge of its own to take then",
        span,
        "in simulations a process with an exponential delay is made to act at that moment; give the process an edge "
        "of its own, or the other one an invariant, to leave nothing open",
    )


def _check_no_deadlock(predicate: Expression) -> None:
    for part in walk(predicate):
        if isinstance(part, Deadlock):
            raise UnsupportedError(
                Diagnostic(
                    "E0720",
                    "`deadlock` is not checked in queries about runs of a model with stopwatches",
                    part.span,
                    "let all clocks run, or ask E<> deadlock, whose answer is right or unknown",
                )
            )


def _check_urgency(network: Network) -> None:
    for use in urgent_clock_guards(network):
        raise UnsupportedError(
            Diagnostic(
                "E0721",
                f"{use.what} compares a clock in its guard and synchronises over an urgent channel",
                use.span,
                "put the clock condition on an edge of its own in front of it, "
                "so that the process waits in a location until the synchronisation may happen",
            )
        )


def _check_rates(network: Network) -> None:
    rates = [rate for p in network.processes for location in p.locations for _, rate in location.rates]
    if rates:
        known = known_values(network, [])
        for rate in rates:
            rate_of(rate, known)


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
