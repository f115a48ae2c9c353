"""The smallest edit of a recording that would make it a run: one event less, one more, one that says something else, or
one at another time.

A message and its arrivals are one event here: a message that was not sent did not arrive, and one that is put in
arrives as one like it, or is lost.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

from tachk.base.exact_numbers import is_whole
from tachk.base.records import dataclass, replace
from tachk.recordings.conformance.events import Cell, EventLog, RecordedEvent
from tachk.recordings.conformance.rejection import PossibleEvent

_NEIGHBOURS = 6
"""So many events before and behind the one that does not fit are tried."""
_SHIFTS = tuple(sign * 2**n for n in range(11) for sign in (1, -1))


@dataclass(frozen=True, slots=True)
class Edit:
    """Attributes:
    event: the number of the event; the number of the next event if one is added.
    what: ``lost``, ``doubled``, ``moved``, ``changed`` or ``added``.
    by: the shift of a moved event in units of the model; the time of an added event relative to the next one.
    name: the name of an added event.
    cells: the values of an added or changed event.
    arrives: True if the added event arrives at its receiver.
    """

    event: int
    what: str
    by: int = 0
    name: str = ""
    cells: tuple[tuple[str, Cell], ...] = ()
    arrives: bool = False


def edits(
    recording: EventLog, event: int, enabled_events: Sequence[PossibleEvent], origin: Fraction, scale: Fraction
) -> Iterator[Edit]:
    """The edits near an event, the smallest first: this event lost, doubled, moved to where the model would have it, or
    in other words, another one put in; its neighbours lost or doubled; this one moved.

    Args:
        enabled_events: the events that the model allows there.
        origin: the time of the recording at which the model starts.
        scale: units of the model in a unit of the recording.
    """
    neighbours = range(max(event - _NEIGHBOURS, 0), min(event + _NEIGHBOURS + 1, len(recording.events)))
    around = sorted(neighbours, key=lambda n: abs(n - event))
    yield from (Edit(event, what) for what in ("lost", "doubled"))
    now = (recording.events[event].time - origin) * scale
    for possible in enabled_events:
        yield from _of_enabled_event(recording, event, possible, round(now))
    for what in ("lost", "doubled"):
        yield from (Edit(n, what) for n in around[1:])
    yield from (Edit(event, "moved", by) for by in _SHIFTS)


def _of_enabled_event(recording: EventLog, event: int, possible: PossibleEvent, now: int) -> Iterator[Edit]:
    """The edits that replace an event by an enabled one, or add the enabled one before it."""
    here = recording.events[event]
    shift = max(possible.earliest - now, 0) + min((now if possible.latest is None else possible.latest) - now, 0)
    if here.name == possible.name:
        if _says(recording, here, possible.cells):
            yield from [Edit(event, "moved", shift)] if shift else []
        elif not shift:
            yield Edit(event, "changed", cells=possible.cells)
    for arrives in (False, True) if _like(recording, event, possible.name, possible.cells) is not None else (False,):
        yield Edit(event, "added", shift, possible.name, possible.cells, arrives)


def edited(recording: EventLog, edit: Edit, scale: Fraction) -> EventLog:
    """The recording after an edit, sorted by time."""
    numbered: list[tuple[int, RecordedEvent]] = list(enumerate(recording.events))
    event = recording.events[edit.event]
    match edit.what:
        case "lost":
            numbered = [(n, e) for n, e in numbered if n != edit.event and e.after != edit.event]
        case "doubled":
            numbered.insert(edit.event, (-1, event))
        case "changed":
            others = {n for n, e in numbered if n == edit.event or (e.after == edit.event and e.cells == event.cells)}
            numbered = [(n, _saying(e, edit.cells) if n in others else e) for n, e in numbered]
        case "added":
            numbered[edit.event : edit.event] = _added(recording, edit, event.time + edit.by / scale)
        case _:
            numbered[edit.event] = (edit.event, replace(event, time=event.time + edit.by / scale))
    numbered.sort(key=lambda pair: pair[1].time)
    place = {old: new for new, (old, _) in enumerate(numbered)}
    return replace(recording, events=_renumbered([event for _, event in numbered], place))


def _added(recording: EventLog, edit: Edit, time: Fraction) -> Iterator[tuple[int, RecordedEvent]]:
    """The event that is put in, and its arrival."""
    number = len(recording.events)
    yield number, RecordedEvent(time, edit.name, dict(edit.cells), "put in")
    like = _like(recording, edit.event, edit.name, edit.cells) if edit.arrives else None
    if like is not None:
        arrival = next(e for e in recording.events if e.after == like)
        later = time + arrival.time - recording.events[like].time
        yield number + 1, RecordedEvent(later, arrival.name, dict(edit.cells), "put in", number)


def _like(recording: EventLog, event: int, name: str, cells: tuple[tuple[str, Cell], ...]) -> int | None:
    """The number of an event near this one that arrived and is most like one that is put in; None if there is none."""
    arrived = {e.after for e in recording.events if e.after is not None}
    like = [n for n in arrived if recording.events[n].name == name]

    def same(number: int) -> int:
        return sum(_value(recording, name, recording.events[number].cells.get(name)) == cell for name, cell in cells)

    return max(like, key=lambda n: (same(n), -abs(n - event)), default=None)


def _says(recording: EventLog, event: RecordedEvent, cells: tuple[tuple[str, Cell], ...]) -> bool:
    return all(_value(recording, name, event.cells.get(name)) == cell for name, cell in cells)


def _value(recording: EventLog, column: str, cell: object) -> object:
    """The value of a cell, as the model has it where that is known here: a number, or a word of the recording."""
    if not isinstance(cell, str):
        return cell
    words = recording.words.get(column, ())
    return words.index(cell) if cell in words else int(cell) if is_whole(cell.removeprefix("-")) else cell


def _saying(event: RecordedEvent, cells: tuple[tuple[str, Cell], ...]) -> RecordedEvent:
    return replace(event, cells={**event.cells, **dict(cells)})


def _renumbered(events: Sequence[RecordedEvent], place: dict[int, int]) -> tuple[RecordedEvent, ...]:
    return tuple(e if e.after is None else replace(e, after=place.get(e.after)) for e in events)
