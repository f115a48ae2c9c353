"""Parts of a model that share nothing, so that each can be held against its own events.

A link whose place the recording takes joins its two ends no longer: a client and the Agent then have no variable, no
channel and no location test in common, and any run of the one goes with any run of the other. What is left between them
is that an arrival comes after what was sent. `set_apart` makes that certain by cutting the windows of the two so that
they do not overlap; then the runs of the parts, put together by their times, are a run of the whole.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Container, Iterable, Iterator
from dataclasses import replace
from itertools import accumulate
from typing import NamedTuple

from tachk.base.records import dataclass
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
from tachk.recordings.conformance.queue_processes import cases, channel_of_queue
from tachk.recordings.conformance.queues import Queue, Queues, channel_variable

_Element = tuple[Variable, int | None]
"""A variable or channel, or its element with a constant first index."""
_Thing = _Element | tuple[str, int]
"""Such an element, or the process or queue with a number."""


@dataclass(frozen=True, slots=True)
class IndependentComponent:
    """Attributes:
    processes: numbers of processes in the network.
    queues: numbers of queues.
    """

    processes: tuple[int, ...]
    queues: tuple[int, ...]


def parts_of(network: Network, mapping: RecordingMap, queues: Queues) -> tuple[IndependentComponent, ...]:
    """The finest division of what is left of the network in parts that share nothing but the time."""
    kept = [number for number in range(len(network.processes)) if number not in mapping.replaced]
    shared = _shareable(network, [network.processes[number] for number in kept], queues)
    groups = _Groups()
    for number in kept:
        groups.join(("process", number), _things_of(shared, network.processes[number]))
    for number, queue in enumerate(queues.queues):
        groups.join(("queue", number), _things_of_queue(shared, queue))
    found: dict[_Thing, tuple[list[int], list[int]]] = {}
    for number in kept:
        found.setdefault(groups.first(("process", number)), ([], []))[0].append(number)
    for number in range(len(queues.queues)):
        found.setdefault(groups.first(("queue", number)), ([], []))[1].append(number)
    return tuple(IndependentComponent(tuple(processes), tuple(own)) for processes, own in found.values())


def can_be_apart(network: Network, processes: Iterable[int], queues: Queues) -> bool:
    """Whether no event from outside can come in the midst of what a process does in committed locations.

    Other parts may have to act before such an event, and in the whole network they could not.
    """
    channels = {channel_variable(queue.visible.channel) for queue in queues.queues if not queue.outputs}
    edges = ((network.processes[number], edge) for number in processes for edge in network.processes[number].edges)
    return not any(
        process.locations[edge.source].committed
        and edge.synchronisation is not None
        and edge.synchronisation.direction is Direction.RECEIVE
        and channel_variable(edge.synchronisation.channel) in channels
        for process, edge in edges
    )


def restricted(queues: Queues, part: IndependentComponent) -> Queues:
    """The queues of a part. That an event of another part must have come before is forgotten."""
    place = {number: new for new, number in enumerate(part.queues)}
    own = (queues.queues[number] for number in part.queues)
    return replace(
        queues,
        queues=tuple(
            replace(
                queue,
                needed=tuple(tuple((place[q], count) for q, count in needs if q in place) for needs in queue.needed),
            )
            for queue in own
        ),
    )


def set_apart(queues: Queues, parts: Iterable[IndependentComponent], delay: int = 0) -> Queues | None:
    """The queues with narrower windows, in which no event comes earlier than an event of another part that it needs.

    Windows that overlap are cut so much later than the needed event was recorded. Two such events may then still
    happen at the same time, so each also waits for what its own part has sent at that time and was recorded before:
    then the events of a time can be put in an order in which each comes after what it needs. None where there is no
    room for that.
    """
    part_of = {number: n for n, part in enumerate(parts) for number in part.queues}
    earliest = [list(queue.earliest) for queue in queues.queues]
    latest = [list(queue.latest) for queue in queues.queues]
    needed = [list(queue.needed) for queue in queues.queues]
    cuts: dict[int, list[_WindowCut]] = defaultdict(list)
    for number, queue in enumerate(queues.queues):
        for place, needs in enumerate(queue.needed):
            for other, count in needs:
                if part_of[other] == part_of[number]:
                    continue
                low = max(earliest[other][count - 1], earliest[number][place])
                high = min(latest[other][count - 1], latest[number][place])
                if low <= high:
                    time = min(max(queues.queues[other].recorded[count - 1] + delay, low), high)
                    latest[other][count - 1] = time
                    earliest[number][place] = time
                    order = queues.queues[other].events[count - 1]
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
    narrowed = zip(queues.queues, earliest, latest, needed, strict=True)
    return replace(
        queues,
        queues=tuple(
            replace(q, earliest=tuple(lows), latest=tuple(highs), needed=tuple(needs))
            for q, lows, highs, needs in narrowed
        ),
    )


class _WindowCut(NamedTuple):
    """Two windows that meet: the place of the needed event in the recording, it, and what needs it."""

    order: int
    sent: tuple[int, int]
    arrival: tuple[int, int]


# ---- what processes and queues touch --------------------------------------------------------------------------------


class _Groups:
    """Things that are joined, by union and find. A whole array is joined to all its elements."""

    def __init__(self) -> None:
        self.above: dict[_Thing, _Thing] = {}
        self.elements: dict[Variable, set[int | None]] = {}

    def first(self, thing: _Thing) -> _Thing:
        while thing in self.above:
            thing = self.above[thing]
        return thing

    def _unite(self, one: _Thing, other: _Thing) -> None:
        one, other = self.first(one), self.first(other)
        if one != other:
            self.above[other] = one

    def _touch(self, things: Iterable[_Element]) -> None:
        for variable, index in things:
            known = self.elements.setdefault(variable, set())
            known.add(index)
            if None in known:
                for each in known:
                    self._unite((variable, None), (variable, each))

    def join(self, what: tuple[str, int], things: Iterable[_Thing]) -> None:
        for thing in things:
            self._unite(what, thing)
            if isinstance(thing[0], Variable):
                self._touch([(thing[0], thing[1])])


def _things_of(shared: Container[Variable], process: Process) -> Iterator[_Thing]:
    expressions = with_bodies(process_expressions(process))
    yield from _things(shared, expressions)
    nodes = (node for expression in expressions for node in walk(expression))
    yield from (("process", node.process) for node in nodes if isinstance(node, LocationTest))


def _things_of_queue(shared: Container[Variable], queue: Queue) -> Iterator[_Thing]:
    for indices in cases(queue):
        yield from _things(shared, [channel_of_queue(queue, indices)])
    yield from _things(shared, [expression for _, expression in queue.visible.columns])


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


def _shareable(network: Network, processes: Iterable[Process], queues: Queues) -> frozenset[Variable]:
    """The channels, and the variables that are part of the state and may change."""
    changed = written_variables([e for process in processes for e in process_expressions(process)])
    for queue in queues.queues:
        changed |= {variable for _, column in queue.visible.columns for variable in _variables(column)}
    return frozenset(
        variable
        for variable in network.all_variables()
        if isinstance(element_type(variable.type), ChannelType)
        or (variable in changed and not network.resets(variable))
    )
