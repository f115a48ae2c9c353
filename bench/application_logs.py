"""What the applications of the recorded clients did, from their logs, as events that go into a recording.

The scripted client notes when a run function has returned, but not when it is called. It calls the next one at once,
so these are the times of the calls. Where it calls in slices, the log has their number, and calls are as far apart as
they fit into that time. While it sets its session up, or waits for samples, the log does not tell when it calls.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from typing import Any

from bench.conformance import logs_of_clients
from tachk.conformance.events import Event, Recording

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


def with_log(recording: Recording, truth: dict[str, Any]) -> Recording:
    """The recording with the log of all applications in it."""
    told = [
        Event(Fraction(time - recording.epoch), "told", {"client": client, "what": what}, f"log of client {client}")
        for client, log in enumerate(logs_of_clients(truth))
        for time, what in _told(log)
    ]
    ends = {closing.value: closing.time for closing in recording.closings if closing.column == "client"}
    told = [event for event in told if event.time < ends.get(int(event.cells["client"]), recording.end)]
    numbered = sorted(enumerate([*recording.events, *told]), key=lambda pair: pair[1].time)
    place = {old: new for new, (old, _) in enumerate(numbered)}
    events = (e if e.after is None else replace(e, after=place[e.after]) for _, e in numbered)
    return replace(recording, events=tuple(events))


def _told(log: list[dict[str, Any]]) -> Iterator[tuple[int, int]]:
    for entry, following in zip(log, [*log[1:], log[-1]], strict=True):
        begin, end = entry["t_wall_ns"], following["t_wall_ns"]
        match entry["event"]:
            case "write_blocked":
                slices = round((end - begin) / BLOCKED_SLICE / 1_000_000)
            case "slice_begin":
                slices = next(e["slices"] for e in log if e["event"] == "slice_end" and e["t_wall_ns"] >= begin)
            case event:
                slices = 0
                yield from ((begin, what) for what in WORDS.get(event, ()))
        yield from ((begin + n * (end - begin) // slices, CALLED) for n in range(slices))
