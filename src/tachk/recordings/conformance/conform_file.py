"""A file of recorded events is held against a model that has been read."""

from __future__ import annotations

import re
from collections import defaultdict, deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from pathlib import Path

from tachk.base.arguments import check_argument
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.exact_numbers import is_whole
from tachk.base.job import StoppedError, limited
from tachk.base.records import replace
from tachk.base.time_units import SPELLINGS, length_of
from tachk.engine.options import Limits
from tachk.frontend.loaded import LoadedModel
from tachk.frontend.scope import ValueSymbol
from tachk.model.expressions import Constant
from tachk.model.recording import RecordingMap
from tachk.model.timestamp_uncertainty import Allowances
from tachk.recordings.captures import capture_reader, capture_readers
from tachk.recordings.conformance.conform import Conformance, conform
from tachk.recordings.conformance.event_streams import Constants
from tachk.recordings.conformance.event_tables import read_events
from tachk.recordings.conformance.events import Cell, EventLog, RecordedEvent
from tachk.recordings.conformance.location_columns import with_location_variables
from tachk.recordings.conformance.nearest_log import WORK_BUDGET, smallest_edit
from tachk.recordings.conformance.question import ExplanationDetail, Question

_DURATION = re.compile(r"\s*(\d{1,20}(?:\.\d{1,20})?)\s*([a-zµμ]*)\s*", re.IGNORECASE)
LARGEST = 2**14
"""Units of the model up to which the least tolerance is looked for."""


def duration(text: str, time_unit: str) -> Fraction:
    """A duration such as ``5ms`` in units of the model; without a unit it is in these. Raises UsageError."""
    found = _DURATION.fullmatch(text)
    unit = "" if found is None else SPELLINGS.get(found[2].lower(), found[2])
    length = length_of(unit) if unit else None
    if found is None or (unit and length is None):
        raise UsageError(f"`{text}` is not a duration", "write a number and a unit, such as 5ms")
    if length is None:
        return Fraction(found[1])
    own = length_of(time_unit) if time_unit else None
    if own is None:
        raise UsageError("the model does not say how long its time unit is", f"leave out the unit: {found[1]}")
    return Fraction(found[1]) * length / own


INPUT, OUTPUT = "input", "output"


def allowances_of(tolerance: str | None, late: str | Mapping[str, str] | None, time_unit: str) -> Allowances:
    """What a caller says of how exact recorded times are. Raises UsageError.

    Args:
        tolerance: a duration.
        late: a duration, or durations by ``input`` and ``output``.
    """
    sides = dict(late) if isinstance(late, Mapping) else {} if late is None else {INPUT: late, OUTPUT: late}
    for side in sides:
        if side not in (INPUT, OUTPUT):
            raise UsageError(f"`{side}` has no lateness of its own", "name `input` or `output`")
    for side, amount in sides.items():
        check_argument(f"late[{side!r}]", amount, "str")
    lengths = {side: duration(amount, time_unit) for side, amount in sides.items()}
    allowed = None if tolerance is None else duration(tolerance, time_unit)
    return Allowances(allowed, lengths.get(INPUT), lengths.get(OUTPUT))


def least(conforms_within: Callable[[Fraction], Conformance]) -> Conformance:
    """The result with the least whole tolerance that accepts; the result with the largest one, if all reject or one is
    undecided. A larger tolerance allows all that a smaller one does."""
    found = conforms_within(Fraction(0))
    low, high = 0, 0
    while found.accepted is False and high < LARGEST:
        low, high = high, max(2 * high, 1)
        found = conforms_within(Fraction(high))
    if not found.accepted:
        return found
    while high - low > 1:
        middle = (low + high) // 2
        tried = conforms_within(Fraction(middle))
        if tried.accepted:
            high, found = middle, tried
        else:
            low = middle
    return found


WRITTEN, CLIENT, DETAIL = "written", "client", "detail"
_WRITES = (WRITTEN, "written_best_effort")


def with_log(recording: EventLog, log: EventLog) -> EventLog:
    """The recording with the events of a log. Times of a log beside a capture are since 1970.

    Events after the end of the recording, or of its client in it, are left out. Raises UsageError for a log that has
    nothing to do with the recording.
    """
    samples: dict[Cell | None, deque[int]] = defaultdict(deque)
    for number, event in enumerate(recording.events):
        if event.name in _WRITES and _is_sample(event.cells.get(DETAIL)):
            samples[event.cells.get(CLIENT)].extend([number] * _samples_in(event.cells.get(DETAIL)))
    added: list[RecordedEvent] = []
    before: dict[Cell | None, int] = {}
    for event, time in zip(log.events, _times(recording, log), strict=True):
        client = _client(event)
        if event.name != WRITTEN:
            if time < _end(recording, client):
                added.append(
                    RecordedEvent(time, event.name, event.cells, f"{log.source}, {event.place}", before.get(client))
                )
        elif samples[client]:
            number = samples[client].popleft()
            if not samples[client] or samples[client][0] != number:
                before[client] = number
    if log.events and not added:
        raise UsageError(
            f"nothing of {log.source} happens while {recording.source} is recorded",
            "beside a capture the times of a log are since 1970: `time [s]`, or `time [ns]`",
        )
    return _merged(recording, added)


def _samples_in(detail: Cell | None) -> int:
    return max((reader.samples_in(detail) for reader in capture_readers()), default=1)


def _is_sample(detail: Cell | None) -> bool:
    """A number below 0 is an object that the client requests or creates."""
    return not isinstance(detail, int) or detail >= 0


def _client(event: RecordedEvent) -> Cell | None:
    cell = event.cells.get(CLIENT)
    return int(cell) if isinstance(cell, str) and is_whole(cell.strip()) else cell


def _end(recording: EventLog, client: Cell | None) -> Fraction:
    ends = (c.time for c in recording.closings if c.column == CLIENT and c.value == client)
    return min([recording.end, *ends])


def _times(recording: EventLog, log: EventLog) -> Iterator[Fraction]:
    """In the unit of the recording, since its start. Raises UsageError."""
    if (recording.unit is None) != (log.unit is None):
        bare, other = (log, recording) if log.unit is None else (recording, log)
        raise UsageError(
            f"the times of {bare.source} have no unit, those of {other.source} have one", "name the column `time [ms]`"
        )
    scale = Fraction(1) if recording.unit is None or log.unit is None else log.unit / recording.unit
    return (event.time * scale - recording.epoch for event in log.events)


def _merged(recording: EventLog, added: Sequence[RecordedEvent]) -> EventLog:
    """``after`` of what is added names events of the recording."""
    known = list(enumerate(recording.events))
    numbered = sorted([*known, *((-1, event) for event in added)], key=lambda pair: pair[1].time)
    place = {old: new for new, (old, _) in enumerate(numbered)}
    events = (e if e.after is None else replace(e, after=place[e.after]) for _, e in numbered)
    return replace(recording, events=tuple(events))


AUTO = "auto"
_STATES_OF_EDIT = 20_000
_STATES_OF_EVENT = 20
"""So many states at most, and so many more for each event, are stored when a recording is held against the model with
an edit."""


def conform_file(loaded: LoadedModel, name: str, recording: str, question: Question, limits: Limits) -> Conformance:
    """As `tachk.api.model.conform`. Raises UsageError, UnsupportedError, StoppedError."""
    with limited(limits.seconds):
        return _conform_file(loaded, name, recording, question, limits)


def _conform_file(loaded: LoadedModel, name: str, recording: str, question: Question, limits: Limits) -> Conformance:
    network, mapping = with_location_variables(loaded.network, recording_map(loaded, name))
    events = read_recording(Path(recording), question, loaded)
    constants = constants_of(loaded)
    tolerance = None if question.tolerance == AUTO else question.tolerance
    allowances = allowances_of(tolerance, question.late, network.time_unit).over(mapping.allowances)

    def conforms_within(allowed: Allowances) -> Conformance:
        explain = question.explanation is not ExplanationDetail.NONE
        return conform(network, mapping, events, constants, allowed.uncertainty(), limits=limits, explain=explain)

    if question.tolerance == AUTO:
        return least(lambda tolerance: conforms_within(replace(allowances, tolerance=tolerance)))
    found = conforms_within(allowances)
    if found.accepted is not False or found.refusal is None or found.refusal.event is None:
        return found

    def accepts(other: EventLog) -> bool:
        few = limits.of_states(_STATES_OF_EDIT + _STATES_OF_EVENT * len(other.events))
        tried = conform(network, mapping, other, constants, found.uncertainty, limits=few, run=False, explain=False)
        return tried.accepted is True

    try:
        work = None if question.explanation is ExplanationDetail.FULL else WORK_BUDGET
        search = smallest_edit(network, mapping, events, constants, found, limits, accepts, work)
        return replace(found, edit=search.edit, untried=search.untried)
    except StoppedError:
        return replace(found, left_out="whether an edit of the recording would make it a run")


def recording_map(loaded: LoadedModel, name: str) -> RecordingMap:
    """What a model says of recordings. Raises UsageError where it says nothing."""
    if loaded.recording is None:
        raise UsageError(
            f"{name} does not say how recordings are read", "write `recording { visible channel as event(); }` into it"
        )
    return loaded.recording


def read_recording(path: Path, question: Question, loaded: LoadedModel) -> EventLog:
    """A capture of packets, or a file of events; with the logs of applications. Raises UsageError, InputError.

    Args:
        loaded: the model, which has to have room for what is recorded.
    """
    reader = capture_reader(path)
    if reader is None:
        recording = read_events(path, question.unit)
    elif question.unit is not None:
        raise UsageError("a capture has its own times: it takes no unit")
    else:
        recording = reader.read_events(path, question.ports)
    for log in question.applications:
        recording = with_log(recording, read_events(Path(log)))
    for reader in capture_readers():
        reader.check_room(recording, constants_of(loaded))
    return recording


def constants_of(loaded: LoadedModel) -> Constants:
    """The values of the constants of a model, by name."""

    def constant(name: str) -> int | None:
        symbol = loaded.scope.lookup(name)
        found = symbol.expression if isinstance(symbol, ValueSymbol) else None
        return found.value if isinstance(found, Constant) else None

    return constant
