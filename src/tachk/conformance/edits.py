"""The smallest edit of a recording that would make it a run: one event less, one twice, or one at another time."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from fractions import Fraction

from tachk.conformance.events import Event, Recording
from tachk.records import dataclass

_NEAR = 6
"""So many events before and behind the one that does not fit are tried."""
_SHIFTS = tuple(sign * 2**n for n in range(11) for sign in (1, -1))


@dataclass(frozen=True, slots=True)
class Edit:
    """Attributes:
    event: the number of the event.
    what: ``lost``, ``doubled`` or ``moved``.
    by: how much later, in units of the model, if it was moved.
    """

    event: int
    what: str
    by: int = 0


def smallest_edit(
    recording: Recording, event: int, scale: Fraction, accepts: Callable[[Recording], bool]
) -> Edit | None:
    """The first edit near an event with which the recording is accepted: losses, then copies, then the least moves.

    Args:
        scale: units of the model in a unit of the recording.
    """
    for edit in _edits(recording, event):
        if accepts(edited(recording, edit, scale)):
            return edit
    return None


def _edits(recording: Recording, event: int) -> Iterator[Edit]:
    near = range(max(event - _NEAR, 0), min(event + _NEAR + 1, len(recording.events)))
    around = sorted(near, key=lambda n: abs(n - event))
    for what in ("lost", "doubled"):
        yield from (Edit(n, what) for n in around)
    yield from (Edit(event, "moved", by) for by in _SHIFTS)


def edited(recording: Recording, edit: Edit, scale: Fraction) -> Recording:
    """The recording after an edit, sorted by time."""
    numbered = list(enumerate(recording.events))
    match edit.what:
        case "lost":
            del numbered[edit.event]
        case "doubled":
            numbered.insert(edit.event, (-1, recording.events[edit.event]))
        case _:
            event = recording.events[edit.event]
            numbered[edit.event] = (edit.event, replace(event, time=event.time + edit.by / scale))
    numbered.sort(key=lambda pair: pair[1].time)
    place = {old: new for new, (old, _) in enumerate(numbered)}
    return replace(recording, events=_renumbered([event for _, event in numbered], place))


def _renumbered(events: Sequence[Event], place: dict[int, int]) -> tuple[Event, ...]:
    return tuple(e if e.after is None else replace(e, after=place.get(e.after)) for e in events)
