"""Independent components of a model: they share nothing, so that each is checked against its own events.

A link whose place the recording takes joins its two ends no longer: a client and the Agent then have no variable, no
channel and no location test in common, and any run of the one goes with any run of the other. What is left between them
is that an arrival comes after what was sent. `separated` makes that certain by cutting the windows of the two so that
they do not overlap; then the runs of the parts, put together by their times, are a run of the whole.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Container, Iterable, Iterator
from itertools import accumulate
from typing import NamedTuple

from tachk.base.records import dataclass, replace
from tachk.base.words import Direction
from tachk.model.expressions import Constant, Expression, Index, LocationTest, Reference, Variable
from tachk.model.network import Network, Process
from tachk.model.recording import RecordingMap
from tachk.model.traversal import (
    children,
    process_expressions,
    walk,
    with_bodies,
    written_variables,
)
from tachk.model.types import ChannelType, element_type
from tachk.recordings.conformance.event_streams import EventStream, EventStreams, channel_variable
from tachk.recordings.conformance.trace_automata import cases, channel_of_stream

_Element = tuple[Variable, int | None]
"""A variable or channel, or its element with a constant first index."""
_Thing = _Element | tuple[str, int]
"""Such an element, or the process or stream with a number."""


@dataclass(frozen=True, slots=True)
class IndependentComponent:
    """Attributes:
    processes: numbers of processes in the network.
    streams: numbers of streams.
    """

    processes: tuple[int, ...]
    streams: tuple[int, ...]


def components_of(network: Network, mapping: RecordingMap, streams: EventStreams) -> tuple[IndependentComponent, ...]:
    """The finest division of what is left of the network in parts that share nothing but the time."""
    modelled = mapping.modelled(network)
    shared = _shareable(network, [network.processes[number] for number in modelled], streams)
    groups = _Groups()
    for number in modelled:
        groups.join(("process", number), _things_of(shared, network.processes[number]))
    for number, stream in enumerate(streams.streams):
        groups.join(("stream", number), _things_of_stream(shared, stream))
    found: dict[_Thing, tuple[list[int], list[int]]] = {}
    for number in modelled:
        found.setdefault(groups.first(("process", number)), ([], []))[0].append(number)
    for number in range(len(streams.streams)):
        found.setdefault(groups.first(("stream", number)), ([], []))[1].append(number)
    return tuple(IndependentComponent(tuple(processes), tuple(own)) for processes, own in found.values())


def are_independent(network: Network, processes: Iterable[int], streams: EventStreams) -> bool:
    """True if no event from outside can come in the midst of what a process does in committed locations.

    Other parts may have to act before such an event, and in the whole network they could not.
    """
    channels = {channel_variable(stream.visible.channel) for stream in streams.streams if not stream.outputs}
    edges = ((network.processes[number], edge) for number in processes for edge in network.processes[number].edges)
    return not any(
        process.locations[edge.source].committed
        and edge.synchronisation is not None
        and edge.synchronisation.direction is Direction.RECEIVE
        and channel_variable(edge.synchronisation.channel) in channels
        for process, edge in edges
    )


def restricted(streams: EventStreams, component: IndependentComponent) -> EventStreams:
    """The streams of a component, without the demands that events of other components come before."""
    place = {number: new for new, number in enumerate(component.streams)}
    own = (streams.streams[number] for number in component.streams)
    return replace(
        streams,
        streams=tuple(
            replace(
                stream,
                needed=tuple(tuple((place[q], count) for q, count in needs if q in place) for needs in stream.needed),
            )
            for stream in own
        ),
    )


def separated(streams: EventStreams, components: Iterable[IndependentComponent], delay: int = 0) -> EventStreams | None:
    """The streams with narrower windows, in which no event comes earlier than an event of another part that it needs.

    Windows that overlap are cut so much later than the needed event was recorded. Two such events may then still
    happen at the same time, so each also waits for what its own part has sent at that time and was recorded before:
    then the events of a time can be put in an order in which each comes after what it needs. None where there is no
    room for that.
    """
    part_of = {number: n for n, component in enumerate(components) for number in component.streams}
    earliest = [list(stream.earliest) for stream in streams.streams]
    latest = [list(stream.latest) for stream in streams.streams]
    needed = [list(stream.needed) for stream in streams.streams]
    cuts: dict[int, list[_WindowCut]] = defaultdict(list)
    for number, stream in enumerate(streams.streams):
        for place, needs in enumerate(stream.needed):
            for other, count in needs:
                if part_of[other] == part_of[number]:
                    continue
                low = max(earliest[other][count - 1], earliest[number][place])
                high = min(latest[other][count - 1], latest[number][place])
                if low <= high:
                    time = min(max(streams.streams[other].recorded[count - 1] + delay, low), high)
                    latest[other][count - 1] = time
                    earliest[number][place] = time
                    order = streams.streams[other].events[count - 1]
                    cuts[time].append(_WindowCut(order, (other, count), (number, place)))
                elif latest[other][count - 1] > earliest[number][place]:
                    return None
    for group in cuts.values():
        for one in group:
            own = part_of[one.arrival[0]]
            before = [each.sent for each in group if each.order < one.order and part_of[each.sent[0]] == own]
            needed[one.arrival[0]][one.arrival[1]] += tuple(before)
    for lows, highs in zip(earliest, latest, strict=True):
        lows[:] = accumulate(lows, max)
        highs[:] = reversed(list(accumulate(reversed(highs), min)))
    narrowed = zip(streams.streams, earliest, latest, needed, strict=True)
    return replace(
        streams,
        streams=tuple(
            replace(q, earliest=tuple(lows), latest=tuple(highs), needed=tuple(needs))
            for q, lows, highs, needs in narrowed
        ),
    )


class _WindowCut(NamedTuple):
    """Two windows that meet: the place of the needed event in the recording, it, and what needs it."""

    order: int
    sent: tuple[int, int]
    arrival: tuple[int, int]


# ---- variables of processes and streams -----------------------------------------------------------------------------


class _Groups:
    """Things that are joined, by union and find. A whole array is joined to all its elements."""

    def __init__(self) -> None:
        self.above: dict[_Thing, _Thing] = {}
        self.elements: dict[Variable, set[int | None]] = {}

    def first(self, thing: _Thing) -> _Thing:
        while thing in self.above:
            thing = self.above[thing]
        return thing

    def _unify(self, one: _Thing, other: _Thing) -> None:
        one, other = self.first(one), self.first(other)
        if one != other:
            self.above[other] = one

    def _touch(self, things: Iterable[_Element]) -> None:
        for variable, index in things:
            known = self.elements.setdefault(variable, set())
            known.add(index)
            if None in known:
                for each in known:
                    self._unify((variable, None), (variable, each))

    def join(self, what: tuple[str, int], things: Iterable[_Thing]) -> None:
        for thing in things:
            self._unify(what, thing)
            if isinstance(thing[0], Variable):
                self._touch([(thing[0], thing[1])])


def _things_of(shared: Container[Variable], process: Process) -> Iterator[_Thing]:
    expressions = with_bodies(process_expressions(process))
    yield from _things(shared, expressions)
    nodes = (node for expression in expressions for node in walk(expression))
    yield from (("process", node.process) for node in nodes if isinstance(node, LocationTest))


def _things_of_stream(shared: Container[Variable], stream: EventStream) -> Iterator[_Thing]:
    for indices in cases(stream):
        yield from _things(shared, [channel_of_stream(stream, indices)])
    yield from _things(shared, [expression for _, expression in stream.visible.columns])


def _variables(expression: Expression) -> Iterator[Variable]:
    return (node.variable for node in walk(expression) if isinstance(node, Reference))


def _things(shared: Container[Variable], expressions: Iterable[Expression]) -> Iterator[_Element]:
    """The variables and channels that occur and can be shared, with their first index where it is constant."""
    for expression in expressions:
        match expression:
            case Reference(variable):
                if variable in shared:
                    yield variable, None
            case Index(Reference(variable), Constant(index)):
                if variable in shared:
                    yield variable, index
            case _:
                yield from _things(shared, children(expression))


def _shareable(network: Network, processes: Iterable[Process], streams: EventStreams) -> frozenset[Variable]:
    """The channels, and the variables that are part of the state and may change."""
    changed = written_variables([e for process in processes for e in process_expressions(process)])
    for stream in streams.streams:
        changed |= {variable for _, column in stream.visible.columns for variable in _variables(column)}
    return frozenset(
        variable
        for variable in network.all_variables()
        if isinstance(element_type(variable.type), ChannelType)
        or (variable in changed and not network.resets(variable))
    )
