"""Edits of a recording near an event, tried on the events near it, from the states of the components before.

A long recording takes seconds to be held against a model, and there are some hundred edits to try. So each part of the
model goes on from a state in which a run of it was shortly before the event, and only to shortly behind it. Parts whose
events an edit leaves alone are not searched again. Such an edit is only likely: a further search decides if the whole
recording is a run with it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from tachk.base.job import check_job
from tachk.base.records import dataclass, replace
from tachk.engine.compiler.lower import lower
from tachk.engine.options import Limits, Options, SearchOrder
from tachk.engine.outcome import INTERRUPTED, Status
from tachk.engine.zone import explore
from tachk.model.network import Network
from tachk.model.recording import RecordingMap
from tachk.recordings.conformance.components import restricted
from tachk.recordings.conformance.conform import Conformance, Reached
from tachk.recordings.conformance.edits import Edit, edited, edits
from tachk.recordings.conformance.event_streams import Constants, EventStreams, make_streams
from tachk.recordings.conformance.events import EventLog
from tachk.recordings.conformance.rejection import FinalState, end_of
from tachk.recordings.conformance.resumed import resumed
from tachk.recordings.conformance.trace_product import TraceProduct, trace_product

_BEFORE = 60
"""So many events before the one that does not fit the parts go on from where they were."""
_BEHIND = range(40, 160)
"""So many events behind it are looked at: up to the longest silence there."""
_STATES = 20_000
"""So many states at most are stored for each edit and part."""
WORK_BUDGET = 12_000
"""The budget of a search for an edit, in edges that are compiled and states that are explored; a few
seconds."""
_STATES_OF_EDGE = 5
"""So many states are explored in the time in which one edge is compiled."""


@dataclass(frozen=True, slots=True)
class EditSearch:
    """The result of a search for an edit.

    Attributes:
        edit: the first that makes the recording a run.
        untried: how many there are that were not tried; 0 where there is an edit.
    """

    edit: Edit | None
    untried: int = 0


@dataclass(frozen=True, slots=True)
class Start:
    """The state from which a component of the model goes on.

    Attributes:
        reached: the run that has led there.
        end: the state; None: the component begins in its initial state.
    """

    reached: Reached
    end: FinalState | None


def smallest_edit(
    network: Network,
    mapping: RecordingMap,
    recording: EventLog,
    constants: Constants,
    found: Conformance,
    limits: Limits,
    accepts: Callable[[EventLog], bool],
    work: int | None = None,
) -> EditSearch:
    """The first edit near the event where a recording leaves a model that makes it a run.

    Args:
        found: says where it leaves the model.
        limits: of each search.
        accepts: whether a whole recording is a run.
        work: no further edit is tried after so many edges have been compiled; None: all are tried.

    Raises StoppedError.
    """
    rejection = found.refusal
    if rejection is None or rejection.event is None:
        return EditSearch(None)
    nearest_search = NearestLogSearch(network, mapping, recording, constants, found, limits)
    origin, scale = found.streams.origin, found.streams.scale
    place = nearest_search.numbers.index(rejection.event)
    likely = list(edits(nearest_search.recording, place, rejection.enabled_events, origin, scale))
    for number, edit in enumerate(likely):
        if work is not None and nearest_search.work >= work:
            return EditSearch(None, len(likely) - number)
        if nearest_search.accepts(edited(nearest_search.recording, edit, scale)):
            whole = replace(edit, event=nearest_search.numbers[edit.event])
            if accepts(edited(recording, whole, scale)):
                return EditSearch(whole)
    return EditSearch(None)


class NearestLogSearch:
    """Attributes:
    numbers: of the events of the recording that are near; by default from 60 before the one that does not fit to the
        longest silence of the 40 to 160 behind it.
    recording: these events.
    work: how many edges have been compiled; states that were explored count as edges, too.
    """

    def __init__(
        self,
        network: Network,
        mapping: RecordingMap,
        recording: EventLog,
        constants: Constants,
        found: Conformance,
        limits: Limits,
        before: int = _BEFORE,
        behind: range = _BEHIND,
    ) -> None:
        assert found.refusal is not None
        event = found.refusal.event if found.refusal.event is not None else len(recording.events)
        self.network, self.mapping, self.constants = network, mapping, constants
        self.uncertainty = found.uncertainty
        self.limits = limits
        self.work = 0
        self.known: list[dict[object, bool]] = [{} for _ in found.reached]
        base = max(event - before, 0)
        begun = [_start(reached, base) for reached in found.reached]
        self.starts = [start for start, _ in begun]
        happened = set(range(base)).difference(*(missing for _, missing in begun))
        top = _top(recording, event, behind)
        self.numbers = [number for number in range(top) if number not in happened]
        self.recording = replace(_cut(recording, self.numbers, top), start=found.streams.origin)

    def accepts(self, recording: EventLog) -> bool:
        """True if each part of the model has a run along these events."""
        streams = make_streams(self.network, self.mapping, recording, self.constants, self.uncertainty)
        return all(self.part(start, known, streams) for start, known in zip(self.starts, self.known, strict=True))

    def part(self, start: Start, known: dict[object, bool], streams: EventStreams) -> bool:
        component = start.reached.component
        own = restricted(streams, component)
        key = tuple((q.values, q.earliest, q.latest, q.needed, q.optional, q.quiet_until) for q in own.streams)
        if key not in known:
            product = trace_product(self.network, self.mapping, own, component.processes)
            later = product if start.end is None else resumed(product, start.reached.product, start.end)
            known[key] = later is None or self._reaches(later)
        return known[key]

    def _reaches(self, product: TraceProduct) -> bool:
        check_job()
        limits = self.limits.of_states(_STATES)
        program, goals = lower(product.network, [product.done], product.tables)
        outcome = explore(program, goals, Options(order=SearchOrder.DFS), limits)
        if outcome.reason == INTERRUPTED:
            raise KeyboardInterrupt
        self.work += sum(len(process.edges) for process in product.network.processes)
        self.work += outcome.statistics.states_explored // _STATES_OF_EDGE
        return outcome.goals[0].status is Status.REACHED


def _start(reached: Reached, base: int) -> tuple[Start, set[int]]:
    """The start of a component before it has done any event from a number on; and the events with smaller numbers that
    it has not done by then."""
    streams = reached.streams.streams
    counts = [0] * len(streams)
    length = 0
    for transition in reached.path:
        stream = reached.product.stream_of(transition)
        if stream is not None and counts[stream] < len(streams[stream].events):
            if streams[stream].events[counts[stream]] >= base:
                break
            counts[stream] += 1
        length += 1
    missing = {
        number
        for stream, count in zip(streams, counts, strict=True)
        for number in stream.events[count:]
        if number < base
    }
    if not length:
        return Start(reached, None), missing
    path, actions = reached.path[:length], reached.actions[:length]
    return Start(reached, end_of(reached.product, reached.program, path, actions)), missing


def _top(recording: EventLog, event: int, behind: range) -> int:
    """The number of the event before which the recording is cut: behind the longest silence shortly behind an event."""
    events = recording.events
    if event + behind.stop >= len(events):
        return len(events)
    return max((event + n for n in behind), key=lambda n: events[n].time - events[n - 1].time)


def _cut(recording: EventLog, numbers: Sequence[int], top: int) -> EventLog:
    """The recording with these events alone, as far as before an event."""
    place = {number: n for n, number in enumerate(numbers)}
    events = [recording.events[number] for number in numbers]
    end = recording.end if top == len(recording.events) else recording.events[top - 1].time
    return replace(
        recording,
        events=tuple(e if e.after is None else replace(e, after=place.get(e.after)) for e in events),
        end=end,
        closings=tuple(closing for closing in recording.closings if closing.time <= end),
    )
