"""Storage of symbolic execution: numbered slots; each branch has changes of its own."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

from tachk.engine.smt.terms import Formula, SymbolicNumber, choose, conj, neg

Slot = tuple[int, int]
"""A segment and a position in it."""

STATE = 0
"""The segment of the variables of the network."""
CLOCK_SOURCE = 1
"""At the number of a clock: the clock whose value before all updates it has; 0 for none."""
CLOCK_VALUE = 2
"""At the number of a clock: how much more it is."""

_T = TypeVar("_T")


@dataclass(slots=True)
class Storage:
    """Attributes:
    slots: what they hold on the path that is being executed.
    ranges: smallest and largest value of each slot of a segment.
    """

    slots: dict[Slot, SymbolicNumber]
    ranges: dict[int, Sequence[tuple[int, int]]]
    segments: int = CLOCK_VALUE + 1
    journal: dict[Slot, SymbolicNumber | None] = field(default_factory=dict)
    """The values of slots before the current branch."""

    def new_segment(self, values: Sequence[SymbolicNumber], ranges: Sequence[tuple[int, int]]) -> int:
        segment = self.segments
        self.segments += 1
        self.ranges[segment] = ranges
        for position, value in enumerate(values):
            self.write((segment, position), value)
        return segment

    def write(self, slot: Slot, value: SymbolicNumber) -> None:
        self.journal.setdefault(slot, self.slots.get(slot))
        self.slots[slot] = value

    def undone(self, action: Callable[[], _T]) -> tuple[_T, dict[Slot, SymbolicNumber]]:
        """Does something and takes it back: what it gave, and the slots that it changed."""
        outer, self.journal = self.journal, {}
        result = action()
        changes = {slot: self.slots[slot] for slot in self.journal}
        for slot, old in self.journal.items():
            if old is None:
                del self.slots[slot]
            else:
                self.slots[slot] = old
        self.journal = outer
        return result, changes

    def apply(self, changes: Mapping[Slot, SymbolicNumber], condition: Formula = True) -> None:
        """Makes changes where a condition holds."""
        for slot, value in changes.items():
            self.write(slot, choose(condition, value, self.slots.get(slot, value)))

    def join(
        self, condition: Formula, then: Mapping[Slot, SymbolicNumber], otherwise: Mapping[Slot, SymbolicNumber]
    ) -> None:
        """Makes the changes of one of two branches."""
        for slot in {**then, **otherwise}:
            before = self.slots.get(slot, then.get(slot, otherwise.get(slot)))
            assert before is not None
            self.write(slot, choose(condition, then.get(slot, before), otherwise.get(slot, before)))

    def snapshot(self) -> dict[Slot, SymbolicNumber]:
        return dict(self.slots)

    def continue_from(self, exits: Iterable[tuple[Formula, dict[Slot, SymbolicNumber]]], segments: int) -> None:
        """Goes on where one of several paths has left off, in the segments that were there before they parted."""
        known = list(exits)
        merged: dict[Slot, SymbolicNumber] = {}
        for number, (condition, snapshot) in enumerate(reversed(known)):
            for slot, value in snapshot.items():
                if slot[0] < segments:
                    merged[slot] = value if number == 0 else choose(condition, value, merged.get(slot, value))
        for slot, value in merged.items():
            if self.slots.get(slot) is not value:
                self.write(slot, value)


Alternative = tuple[Formula, int, int]
"""A place under a condition: the condition, a segment, and a position in it."""


@dataclass(frozen=True, slots=True)
class SymbolicPlace:
    """The place of a value: one of several, each with the condition that it is this one."""

    alternatives: tuple[Alternative, ...]

    def moved(self, offset: int) -> SymbolicPlace:
        return SymbolicPlace(
            tuple((condition, segment, start + offset) for condition, segment, start in self.alternatives)
        )


def place_at(segment: int, position: int = 0) -> SymbolicPlace:
    return SymbolicPlace(((True, segment, position),))


def either(condition: Formula, then: SymbolicPlace, otherwise: SymbolicPlace) -> SymbolicPlace:
    if isinstance(condition, bool):
        return then if condition else otherwise
    return SymbolicPlace(
        tuple((conj(condition, c), s, p) for c, s, p in then.alternatives)
        + tuple((conj(neg(condition), c), s, p) for c, s, p in otherwise.alternatives)
    )
