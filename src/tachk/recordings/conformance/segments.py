"""A long recording is followed segment by segment, so that neither time nor memory grows with what is behind.

A segment is some thousand events, and some more that lie ahead. A run along all of them is searched for, made with
exact times and judged; its part in the segment is a part of a run of the whole, if the parts behind it go on from the
state in which it ends. What lies ahead makes that likely. Where no such run is found, some segments are followed again
as one; where that does not help either, the whole recording has to be searched at once.

The state at the end of a segment is a single one, with its clocks: all segments together are one run, and only an
answer that there is one can be found so.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections import Counter, deque
from collections.abc import Mapping, Sequence
from math import ceil, floor

from tachk.base.diagnostics.diagnostic import InternalError
from tachk.base.job import check_job
from tachk.base.records import dataclass, field, replace
from tachk.engine.compiler.lower import lower
from tachk.engine.compiler.program import Program
from tachk.engine.exact.exact_run import RunState, timed_path
from tachk.engine.options import Limits, Options
from tachk.engine.outcome import INTERRUPTED, Statistics
from tachk.engine.zone import explore
from tachk.meaning.dbm import Zone, bound_value, raw_bound
from tachk.model.network import Network
from tachk.model.recording import RecordingMap
from tachk.model.selections import check_selections
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.components import (
    IndependentComponent,
    are_independent,
    components_of,
    restricted,
    separated,
)
from tachk.recordings.conformance.event_streams import Constants, EventStreams, behind, make_streams, origin_of
from tachk.recordings.conformance.events import END, EventLog, excerpt
from tachk.recordings.conformance.rejection import FinalState, end_in_slots
from tachk.recordings.conformance.resumed import resumed
from tachk.recordings.conformance.trace_product import TraceProduct, trace_product

SEGMENT = 30_000
"""So many events a segment has."""
LONG = SEGMENT
"""Recordings with more events are followed segment by segment."""
AHEAD = 500
"""A run goes along with so many events more."""
_STATES_OF_EVENT = 60
"""So many states are stored for each event of a segment at most."""
_BACK = 3
"""So many segments at most are followed again."""


@dataclass(frozen=True, slots=True)
class LongRun:
    """A run of a part of the model that goes along with its events, too long to be held.

    Attributes:
        modelled: the numbers in the model of its processes.
        transitions: how many it has.
        taken: how often it takes edges, each by the numbers of its process and of it.
    """

    modelled: tuple[int, ...]
    transitions: int
    taken: Mapping[tuple[int, int], int]


@dataclass(frozen=True, slots=True)
class Followed:
    """Attributes:
    streams: those of the model, without their events.
    runs: of all parts of the model.
    """

    streams: EventStreams
    statistics: Statistics
    runs: tuple[LongRun, ...]


@dataclass(frozen=True, slots=True)
class _Segment:
    """Attributes:
    first: the number of its first event, behind all that may not have happened before.
    top: the number of the event behind those that lie ahead.
    until: the time at which it ends, in units of the model; None: it is the last one.
    """

    first: int
    top: int
    until: int | None


@dataclass(frozen=True, slots=True)
class _SegmentEnd:
    """The state of a component at the end of a segment.

    Attributes:
        product: with which it was reached; None at the start.
        end: the state.
        now: the time, in units of the model.
        happened: for each stream the number of the last event that has happened; -1 for none.
        transitions, taken: as in `LongRun`, up to here.
    """

    happened: tuple[int, ...]
    product: TraceProduct | None = None
    end: FinalState | None = None
    now: int = 0
    transitions: int = 0
    taken: Mapping[tuple[int, int], int] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class _Checkpoint:
    """Attributes:
    next: the number of the event where the next segment begins.
    begin: the time up to which components have done everything, in units of the model.
    """

    next: int
    begin: int
    reached: tuple[_SegmentEnd, ...]


class SegmentSearch:
    """The search for a run along a recording, segment by segment.

    Args:
        uncertainty: of recorded times.
        divide: follow parts that share nothing one by one.

    Raises UsageError for a recording that does not fit the model.
    """

    def __init__(
        self,
        network: Network,
        mapping: RecordingMap,
        recording: EventLog,
        constants: Constants,
        uncertainty: TimestampUncertainty,
        options: Options,
        limits: Limits,
        divide: bool,
    ) -> None:
        self.network, self.mapping, self.constants = network, mapping, constants
        self.uncertainty, self.options, self.limits = uncertainty, options, limits
        self.origin, self.scale = origin_of(network, recording, uncertainty)
        self.recording = replace(recording, start=self.origin)
        self.delay = max(ceil(uncertainty.largest), 1)
        self.modelled = mapping.modelled(network)
        last = len(recording.events)
        self.shape = self._streams(_Segment(max(last - 1, 0), last, None))  # tells early what is too late for clocks
        whole = IndependentComponent(self.modelled, tuple(range(len(self.shape.streams))))
        parts = components_of(network, mapping, self.shape) if divide else (whole,)
        self.components = parts if are_independent(network, self.modelled, self.shape) else (whole,)
        self.cut_later = deque([0, ceil(uncertainty.tolerance)] if len(self.components) > 1 else [0])
        self.statistics: Statistics | None = None

    def followed(self) -> Followed | None:
        """A run, if one is found so. There may be one if not. Raises StoppedError."""
        start = tuple(_SegmentEnd((-1,) * len(component.streams)) for component in self.components)
        behind_us = deque([_Checkpoint(0, 0, start)], maxlen=_BACK)
        size, again = SEGMENT, 0
        while True:
            check_job()
            here = behind_us[-1]
            segment = self._segment(here, size)
            reached = self._follow(here, segment)
            if reached is None and len(self.cut_later) > 1:
                self.cut_later.popleft()  # never back again: what was cut early happened early
            elif reached is None:
                again += 1
                if len(behind_us) < 2 or again >= _BACK:
                    return None
                behind_us.pop()
                size = segment.top - behind_us[-1].next
            elif segment.until is None:
                return self._found(reached)
            else:
                behind_us.append(_Checkpoint(here.next + size, segment.until, reached))
                size, again = SEGMENT, 0

    def _segment(self, here: _Checkpoint, size: int) -> _Segment:
        """The segment of so many events from here on."""
        events = self.recording.events
        first = self._at(here.begin - 4 * self.delay - 1) if here.next else 0
        target = here.next + size
        if target + AHEAD >= len(events):
            return _Segment(first, len(events), None)
        until = self._time(target)
        top = max(self._at(until + 6 * self.delay + 1), target + AHEAD)
        return _Segment(first, top, until) if top < len(events) else _Segment(first, len(events), None)

    def _time(self, event: int) -> int:
        """When it was recorded, in units of the model."""
        return floor((self.recording.events[event].time - self.origin) * self.scale)

    def _at(self, time: int) -> int:
        """The number of the first event that was not recorded before a time."""
        return bisect_left(range(len(self.recording.events)), time, key=self._time)

    def _streams(self, segment: _Segment) -> EventStreams:
        part = excerpt(self.recording, segment.first, segment.top)
        return make_streams(self.network, self.mapping, part, self.constants, self.uncertainty)

    def _follow(self, here: _Checkpoint, segment: _Segment) -> tuple[_SegmentEnd, ...] | None:
        streams: EventStreams | None = self._streams(segment)
        if len(self.components) > 1 and streams is not None:
            streams = separated(streams, self.components, self.cut_later[0])
        if streams is None:
            return None
        found = []
        for component, before in zip(self.components, here.reached, strict=True):
            reached = self._component(component, before, streams, segment)
            if reached is None:
                return None
            found.append(reached)
        return tuple(found)

    def _component(
        self, component: IndependentComponent, before: _SegmentEnd, streams: EventStreams, segment: _Segment
    ) -> _SegmentEnd | None:
        """The state at the end of a segment, on a run along all of it."""
        check_job()
        all_own = restricted(streams, component)
        first = segment.first
        own = behind(
            all_own,
            [bisect_right(q.events, last - first) for q, last in zip(all_own.streams, before.happened, strict=True)],
        )
        to_the_end = segment.until is None and len(self.components) > 1
        product = fresh = trace_product(self.network, self.mapping, own, component.processes, to_the_end)
        check_selections(product.network)
        setting = 0
        if before.product is not None and before.end is not None:
            later = resumed(product, before.product, before.end)
            if later is None:
                return None
            product, setting = later, before.end.zones[0].dimension
        program, goals = lower(product.network, [product.done], product.tables)
        most = _STATES_OF_EVENT * (1_000 + segment.top - first)
        outcome = explore(program, goals, self.options, self.limits.of_states(most))
        if outcome.reason == INTERRUPTED:
            raise KeyboardInterrupt
        self.statistics = outcome.statistics if self.statistics is None else self.statistics.then(outcome.statistics)
        actions = outcome.goals[0].actions
        run = None if actions is None else timed_path(program, goals[0], actions)
        if actions is None or run is None or isinstance(run, str):
            return None
        setter = len(fresh.network.processes)
        if any(program.edges[action[0]].process != setter for action in actions[:setting]):
            raise InternalError("something happened before the state was set from which a segment goes on")
        ticks, unit = run.moments.ticks, run.moments.unit
        count = len(actions)
        if segment.until is not None:
            offset = ticks[setting - 1] - before.now * unit if setting else 0
            count = max(bisect_right(ticks, segment.until * unit + offset, hi=len(actions)), setting)
        taken = Counter(before.taken)
        _count(taken, product, program, actions[setting:count])
        transitions = before.transitions + count - setting
        if segment.until is None:
            return _SegmentEnd((), None, None, 0, transitions, taken)
        state = run.state_after(count)
        if state is None or any(tick % unit for tick in state.clocks):
            return None
        end = _final_state(product, state, unit)
        now = bound_value(end.zones[0][end.values[product.now][0], 0])
        happened = tuple(
            first + stream.events[position - 1] if position else last
            for stream, position, last in zip(
                own.streams, (end.values[p][0] for p in product.positions), before.happened, strict=True
            )
        )
        end = replace(end, locations=end.locations[: len(fresh.network.processes)])
        return _SegmentEnd(happened, fresh, end, now, transitions, taken)

    def _found(self, reached: Sequence[_SegmentEnd]) -> Followed:
        runs = tuple(
            LongRun(component.processes, each.transitions, each.taken)
            for component, each in zip(self.components, reached, strict=True)
        )
        events = self.recording.events
        known = {visible.event for visible in self.mapping.visible}
        other = sum(event.name not in known and event.name != END for event in events)
        assert self.statistics is not None
        return Followed(replace(self.shape, other=other), self.statistics, runs)


def _final_state(product: TraceProduct, state: RunState, unit: int) -> FinalState:
    """The state, with a zone that is a point."""
    values = (0, *(tick // unit for tick in state.clocks))
    bounds = tuple(raw_bound(value - other, strict=False) for value in values for other in values)
    return end_in_slots(product, state.slots, Zone(len(values), bounds))


def _count(
    taken: Counter[tuple[int, int]], product: TraceProduct, program: Program, actions: Sequence[Sequence[int]]
) -> None:
    """Counts the edges of the model that a path takes."""
    numbers = Counter(edge for action in actions for edge in action)
    for number, times in numbers.items():
        edge = program.edges[number]
        if edge.process in product.places_of_modelled:
            taken[product.modelled[edge.process - product.first_modelled], edge.edge] += times
