"""Event logs: events with the times at which they were recorded."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from tachk.base.records import dataclass, field, replace

Cell = int | str
"""A number, or the name of a constant of the model; ``true`` and ``false`` are 1 and 0."""


END = "end"
"""The name of the last row of a recording that goes on behind its last event."""


@dataclass(frozen=True, slots=True)
class RecordedEvent:
    """Attributes:
    time: since the start of the recording, in its unit.
    name: what kind of event it is.
    cells: what it says, by column.
    place: where it stands in the file, for messages: ``line 5``, ``packet 17``.
    after: the number of an event, from 0, that must have happened before: that a message was sent, if this is its
        arrival. None if there is none.
        optional: it may have happened or not: whether the message arrived was not observed.
        inferred: it is known from what the model then did: though it comes from outside, it has happened before it was
            recorded, as that has.
        passes: the number of a place past which goes what a participant sends and what comes to it, so that this is
            recorded in one order: it had sent what passed the place before this came by. None: nothing such is known.
    """

    time: Fraction
    name: str
    cells: Mapping[str, Cell]
    place: str
    after: int | None = None
    optional: bool = False
    inferred: bool = False
    passes: int | None = None


@dataclass(frozen=True, slots=True)
class Closing:
    """Events with a value in a column are recorded only up to a time.

    Attributes:
        by_sender: they end with one that their sender did itself, so whatever it did before has been recorded before.
    """

    column: str
    value: int
    time: Fraction
    by_sender: bool = False


@dataclass(frozen=True, slots=True)
class EventLog:
    """Attributes:
    source: the name of the file.
    events: in the order in which they were recorded; times do not decrease.
    unit: nanoseconds of a unit of the times; None: they are in units of the model.
    start: the time at which the system was started; None: shortly before the first event.
    end: until when was recorded.
    closings: of which events less was recorded.
    epoch: nanoseconds since 1970 at time 0, where that is known.
    words: by column, names of constants of the model that its cells may have, in this recording or not.
    constants: values that constants of the model must have for the numbers of the recording to mean the same in it.
    """

    source: str
    events: Sequence[RecordedEvent]
    unit: Fraction | None
    start: Fraction | None
    end: Fraction
    closings: tuple[Closing, ...] = ()
    epoch: int = 0
    words: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    constants: Mapping[str, int] = field(default_factory=dict)


def excerpt(log: EventLog, first: int, top: int) -> EventLog:
    """The events from a number on and before another one, recorded up to the last of them; of the last events of the
    recording up to its end."""
    events = tuple(_earlier_by(event, first) for event in log.events[first:top])
    end = log.end if top >= len(log.events) or not events else events[-1].time
    closings = tuple(closing for closing in log.closings if closing.time <= end)
    return replace(log, events=events, end=end, closings=closings)


def _earlier_by(event: RecordedEvent, first: int) -> RecordedEvent:
    """The event where the recording begins with the event of this number."""
    if event.after is None or not first:
        return event
    return replace(event, after=event.after - first if event.after >= first else None)
