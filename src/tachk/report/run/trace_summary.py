"""What is news in a run: the moves that the model marks (``/// ! lost``), with their times."""

from __future__ import annotations

from tachk.meaning.run_view import ProcessMove, TraceView, TransitionView
from tachk.model.quantity import duration

_TIMES_TOLD = 3


def news_line(trace: TraceView, time_unit: str) -> str:
    """One sentence part for each kind of news, in the order of first occurrence; empty where nothing is marked.

    ``send[PUB_UP][DATA] lost at 3 s; subscriber falls asleep at 0 s``
    """
    found: dict[str, list[str]] = {}
    for number, step in enumerate(trace.steps, start=1):
        for move in () if step.event is None else step.event.moves:
            if move.news and step.event is not None:
                time = step.state.time
                when = f"in step {number}" if time is None else f"at {duration(time, time_unit)}"
                found.setdefault(_words(step.event, move), []).append(when)
    return "; ".join(f"{words} {_told(times)}" for words, times in found.items())


def _words(event: TransitionView, move: ProcessMove) -> str:
    """A hidden process is named by what it does it to."""
    actor = event.channel if move.hidden and event.channel else move.process
    return f"{actor} {' '.join(move.doc.split())}"


def _told(times: list[str]) -> str:
    if len(times) <= _TIMES_TOLD:
        return ", ".join(times)
    return f"{len(times)} times from {times[0].split(' ', 1)[1]} to {times[-1].split(' ', 1)[1]}"
