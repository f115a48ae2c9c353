"""Mutants of a system: its model with one change, as a programmer could make it.

Most operators are those of Aichernig, Lorber and Nickovic, "Time for mutants: model-based mutation testing with timed
automata" (TAP 2013), section 4. Edges with another source are left out; edges that are missing are added.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from enum import StrEnum
from typing import TypeVar

from tachk.base.operators import COMPARISONS, BinaryOperator, UnaryOperator
from tachk.base.records import dataclass, replace
from tachk.base.words import Direction
from tachk.model.connectives import negation
from tachk.model.expressions import INT, Assign, Binary, Constant, Expression, Unary
from tachk.model.network import Edge, Location, Network, Process
from tachk.model.recording import RecordingMap
from tachk.model.types import ClockType
from tachk.recordings.conformance.event_streams import channel_variable

_TARGETS = 2
"""An edge is led to so many other locations, those behind its target in the order of the template."""


class MutationOperator(StrEnum):
    """The kinds of changes. The value is what messages say."""

    EARLIER_BOUND = "bound smaller"
    LATER_BOUND = "bound larger"
    NEGATED_GUARD = "guard negated"
    OTHER_TARGET = "other target"
    NO_RESET = "clocks not set"
    SILENT = "sends nothing"
    NO_EDGE = "edge missing"
    EARLIER_LIMIT = "invariant smaller"
    LATER_LIMIT = "invariant larger"


@dataclass(frozen=True, slots=True)
class SystemMutant:
    """Attributes:
    process: the number of the process that is changed.
    edge, location: the number of what is changed in it; one of them is None.
    detail: which bound or target, in words; empty if there is only one.
    same_untaken: where no run of the model takes the edge, the mutant does what the model does.
    """

    operator: MutationOperator
    process: int
    edge: int | None
    location: int | None
    detail: str
    same_untaken: bool
    network: Network


def system_mutants(network: Network, mapping: RecordingMap, shift: int) -> Iterator[SystemMutant]:
    """The mutants of the processes that a recording does not replace, in the order of processes and edges.

    Args:
        shift: bounds are changed by so many units, which has to be more than the times of recordings are inexact.
    """
    visible = {channel_variable(each.channel) for each in mapping.visible}
    for number, process in enumerate(network.processes):
        if number in mapping.replaced:
            continue
        for place, edge in enumerate(process.edges):
            for operator, detail, changed in _of_edge(process, edge, shift):
                whole = _with_edge(network, number, place, changed)
                same_untaken = operator is MutationOperator.OTHER_TARGET and not _has_limited_target(process, edge)
                yield SystemMutant(operator, number, place, None, detail, same_untaken, whole)
            sync = edge.synchronisation
            if sync is not None and sync.direction is Direction.SEND and channel_variable(sync.channel) in visible:
                silent = _with_edge(network, number, place, replace(edge, synchronisation=None))
                yield SystemMutant(MutationOperator.SILENT, number, place, None, "", False, silent)
            rest = _without_edge(process, place)
            missing = _with_process(network, number, rest)
            same_untaken = rest.locations is process.locations and not _hinders_others(process, edge)
            yield SystemMutant(MutationOperator.NO_EDGE, number, place, None, "", same_untaken, missing)
        for place, location in enumerate(process.locations):
            for operator, detail, limited in _of_location(location, shift):
                limited_process = replace(process, locations=_with(process.locations, place, limited))
                whole = _with_process(network, number, limited_process)
                yield SystemMutant(operator, number, None, place, detail, False, whole)


def _has_limited_target(process: Process, edge: Edge) -> bool:
    """True if an invariant may keep the edge from being taken, so that it can be with another target."""
    return process.locations[edge.target].invariant is not None


def _hinders_others(process: Process, edge: Edge) -> bool:
    """True if the edge may stop a broadcast, or the time, though it is not taken: its guard holds, and what is behind
    it is refused, by an invariant of its target or of a process that its updates concern."""
    return edge.synchronisation is not None and (bool(edge.updates) or _has_limited_target(process, edge))


def _of_edge(process: Process, edge: Edge, shift: int) -> Iterator[tuple[MutationOperator, str, Edge]]:
    if edge.guard is not None:
        for larger, operator in ((-shift, MutationOperator.EARLIER_BOUND), (shift, MutationOperator.LATER_BOUND)):
            for comparison, guard in _shifted(edge.guard, larger):
                yield operator, f"{comparison.span.text} by {shift}", replace(edge, guard=guard)
        yield MutationOperator.NEGATED_GUARD, "", replace(edge, guard=negation(edge.guard))
    count = len(process.locations)
    for step in range(1, min(_TARGETS, count - 1) + 1):
        target = (edge.target + step) % count
        yield MutationOperator.OTHER_TARGET, process.locations[target].name, replace(edge, target=target)
    others = tuple(update for update in edge.updates if not _sets_clock(update))
    if len(others) < len(edge.updates):
        yield MutationOperator.NO_RESET, "", replace(edge, updates=others)


def _of_location(location: Location, shift: int) -> Iterator[tuple[MutationOperator, str, Location]]:
    if location.invariant is not None:
        for larger, operator in ((-shift, MutationOperator.EARLIER_LIMIT), (shift, MutationOperator.LATER_LIMIT)):
            for comparison, invariant in _shifted(location.invariant, larger):
                yield operator, f"{comparison.span.text} by {shift}", replace(location, invariant=invariant)


def _shifted(condition: Expression, shift: int) -> Iterator[tuple[Expression, Expression]]:
    """The comparisons of clocks with numbers in a condition, each with the condition in which its number is larger."""
    match condition:
        case Binary(BinaryOperator.AND | BinaryOperator.OR | BinaryOperator.IMPLY, left, right):
            yield from _rebuilt(left, shift, lambda inner: replace(condition, left=inner))
            yield from _rebuilt(right, shift, lambda inner: replace(condition, right=inner))
        case Unary(UnaryOperator.NOT, operand):
            yield from _rebuilt(operand, shift, lambda inner: replace(condition, operand=inner))
        case Binary(operator, left, right) if operator in COMPARISONS:
            of_clocks = isinstance(left.type, ClockType), isinstance(right.type, ClockType)
            if of_clocks == (True, False):
                yield condition, replace(condition, right=_more(right, shift))
            elif of_clocks == (False, True):
                yield condition, replace(condition, left=_more(left, shift))


def _rebuilt(
    part: Expression, shift: int, whole: Callable[[Expression], Expression]
) -> Iterator[tuple[Expression, Expression]]:
    return ((comparison, whole(changed)) for comparison, changed in _shifted(part, shift))


def _more(number: Expression, shift: int) -> Expression:
    return Binary(BinaryOperator.ADD, number, Constant(shift), INT, number.span)


def _sets_clock(update: Expression) -> bool:
    """An assignment to a clock; calls of functions that set clocks are left as they are."""
    return isinstance(update, Assign) and isinstance(update.target.type, ClockType)


def _without_edge(process: Process, place: int) -> Process:
    """A system that does not act stays where it is: if nothing else that it does ends an invariant, that is gone, too,
    for time does not stop in a real system."""
    source = process.edges[place].source
    edges = (*process.edges[:place], *process.edges[place + 1 :])
    if any(edge.source == source and edge.begins for edge in edges):
        return replace(process, edges=edges)
    idle = replace(process.locations[source], invariant=None, urgent=False, committed=False)
    return replace(process, edges=edges, locations=_with(process.locations, source, idle))


T = TypeVar("T")


def _with(parts: tuple[T, ...], place: int, part: T) -> tuple[T, ...]:
    return (*parts[:place], part, *parts[place + 1 :])


def _with_edge(network: Network, number: int, place: int, edge: Edge) -> Network:
    process = network.processes[number]
    return _with_process(network, number, replace(process, edges=_with(process.edges, place, edge)))


def _with_process(network: Network, number: int, process: Process) -> Network:
    return replace(network, processes=_with(network.processes, number, process))
