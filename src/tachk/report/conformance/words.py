"""What moments of a recording and its events are called."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

from tachk.recordings.conformance.conform import Conformance
from tachk.recordings.conformance.edits import Edit
from tachk.recordings.conformance.events import RecordedEvent
from tachk.recordings.conformance.refusal import PossibleEvent


def moment(found: Conformance, units: int | Fraction) -> str:
    """A time of the model as a time of the recording."""
    return recorded_time(found, Fraction(units) / found.queues.scale + found.queues.origin)


def recorded_time(found: Conformance, time: Fraction) -> str:
    """A time of the recording as a person reads it; nanoseconds of a capture as milliseconds."""
    if found.recording.unit == 1:
        return f"{float(time) / 1e6:.3f} ms"
    return f"{float(time):.6f}".rstrip("0").rstrip(".")


def event_text(event: RecordedEvent) -> str:
    """``light(on=1, level=7)``"""
    cells = ", ".join(f"{name}={value}" for name, value in event.cells.items() if value != "")
    return f"{event.name}({cells})"


def offer_text(found: Conformance, offer: PossibleEvent) -> str:
    """``sent(link=0, kind=HEARTBEAT)``: with the words that the recording has for values."""
    return _said(found, offer.name, offer.cells)


def _said(found: Conformance, event: str, cells: Iterable[tuple[str, int]]) -> str:
    names = found.queues.names
    return f"{event}({', '.join(f'{name}={names.get(name, {}).get(value, value)}' for name, value in cells)})"


def edit_text(found: Conformance, edit: Edit) -> str:
    """``line 4, light(on=0), had come 15 ms later``"""
    event = found.recording.events[edit.event]
    name = f"{event.place}, {event_text(event)},"
    match edit.what:
        case "lost":
            return f"{name} had been lost"
        case "doubled":
            return f"{name} had come twice"
        case "changed":
            return f"{event.place} had been {_said(found, event.name, edit.cells)}"
        case "added":
            time = event.time + edit.by / found.queues.scale
            return f"{_said(found, edit.name, edit.cells)} had come, too, at {recorded_time(found, time)}"
        case _:
            later = "later" if edit.by > 0 else "earlier"
            return f"{name} had come {units_text(Fraction(abs(edit.by)), found.time_unit)} {later}"


def units_text(amount: Fraction, unit: str) -> str:
    """An amount of units of the model."""
    number, _, name = unit.rpartition(" ")
    value = amount * Fraction(number or 1)
    return f"{float(value):g} {name}".rstrip()
