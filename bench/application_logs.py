"""What the applications of the recorded clients did, from their logs, as events that go into a recording.

The scripted client notes when a run function has returned, but not when it is called. It calls the next one at once,
so these are the times of the calls. Where it writes several samples one after the other, it sends each of them and
calls no run function in between: it is outside until the last one is written. Where it calls in slices, the log has
their number, and calls are as far apart as they fit into that time. While it sets its session up, or waits for samples,
the log does not tell when it calls.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

from bench.conformance import logs_of_clients
from tachk.recordings.conformance.conform_file import with_log as with_application
from tachk.recordings.conformance.events import EventLog, RecordedEvent

CALLED, LEFT, BACK, TOLD_ALL, TOLD_SOME = range(5)
BLOCKED_SLICE = 250
"""Milliseconds for which the client runs before it tries a refused write again."""

WORDS = {
    "ready": (TOLD_ALL,),
    "flushed": (CALLED,),
    "run_done": (CALLED,),
    "confirm_begin": (CALLED,),
    "sleep_begin": (LEFT,),
    "sleep_end": (BACK,),
    "recv_begin": (TOLD_SOME,),
    "recv_end": (TOLD_ALL, CALLED),
    "run_session_time_begin": (TOLD_SOME,),
}


def with_log(recording: EventLog, truth: dict[str, Any]) -> EventLog:
    """The recording with the log of all applications in it."""
    for client, log in enumerate(logs_of_clients(truth)):
        rows = tuple(
            RecordedEvent(Fraction(time), "written", {"client": client}, "log")
            if what is None
            else RecordedEvent(Fraction(time), "told", {"client": client, "what": what}, "log")
            for time, what in _told(log)
        )
        if rows:
            told = EventLog(f"log of client {client}", rows, Fraction(1), None, rows[-1].time)
            recording = with_application(recording, told)
    return recording


def _told(log: list[dict[str, Any]]) -> Iterator[tuple[int, int | None]]:
    """When the application did what; None: it wrote a sample."""
    away = False
    for entry, following in zip(log, [*log[1:], log[-1]], strict=True):
        begin, end = entry["t_wall_ns"], following["t_wall_ns"]
        match entry["event"]:
            case "write_blocked":
                slices = round((end - begin) / BLOCKED_SLICE / 1_000_000)
            case "slice_begin":
                slices = next(e["slices"] for e in log if e["event"] == "slice_end" and e["t_wall_ns"] >= begin)
            case "write" if entry.get("ok"):
                slices = 0
                yield begin, None
            case "flushed" if following["event"] == "write" or away:
                slices = 0
                if following["event"] == "write" and not away:
                    yield begin, LEFT
                elif following["event"] != "write":
                    yield begin, BACK
                away = following["event"] == "write"
            case event:
                slices = 0
                yield from ((begin, what) for what in WORDS.get(event, ()))
        yield from ((begin + n * (end - begin) // slices, CALLED) for n in range(slices))
