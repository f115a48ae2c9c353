"""Logs of applications beside a recording: what no packet tells, such as when an application calls the run function.

A log is a file of events, which become events of the recording. But its rows `written` stand for samples that the
recording shows anyway, each for the next one of its client, also where a message carries several: what the log tells
behind the row of the last sample of a message happened after the message was put into the stream.
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.exact_numbers import is_whole
from tachk.recordings.captures import capture_readers
from tachk.recordings.conformance.events import Cell, EventLog, RecordedEvent

WRITTEN, CLIENT, DETAIL = "written", "client", "detail"
_WRITES = (WRITTEN, "written_best_effort")


def with_log(recording: EventLog, log: EventLog) -> EventLog:
    """The recording with the events of a log. Times of a log beside a capture are since 1970.

    What is told behind the end of the recording, or of its client in it, is left out. Raises UsageError for a log that
    has nothing to do with the recording.
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
    """Less than 0 is what the client asks for or creates."""
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
