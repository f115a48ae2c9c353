"""What symbolic execution writes to: numbered cells; the changes of one branch are kept apart from those of another."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

from tachk.engine.smt.terms import Formula, Number, choose, conj, neg

Cell = tuple[int, int]
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
    cells: what they hold on the path that is being executed.
    ranges: smallest and largest value of each cell of a segment.
    """

    cells: dict[Cell, Number]
    ranges: dict[int, Sequence[tuple[int, int]]]
    segments: int = CLOCK_VALUE + 1
    journal: dict[Cell, Number | None] = field(default_factory=dict)
    """What cells held before the current branch."""

    def new_segment(self, values: Sequence[Number], ranges: Sequence[tuple[int, int]]) -> int:
        segment = self.segments
        self.segments += 1
        self.ranges[segment] = ranges
        for position, value in enumerate(values):
            self.write((segment, position), value)
        return segment

    def write(self, cell: Cell, value: Number) -> None:
        self.journal.setdefault(cell, self.cells.get(cell))
        self.cells[cell] = value

    def apart(self, action: Callable[[], _T]) -> tuple[_T, dict[Cell, Number]]:
        """Does something and takes it back: what it gave, and the cells that it changed."""
        outer, self.journal = self.journal, {}
        result = action()
        changes = {cell: self.cells[cell] for cell in self.journal}
        for cell, old in self.journal.items():
            if old is None:
                del self.cells[cell]
            else:
                self.cells[cell] = old
        self.journal = outer
        return result, changes

    def apply(self, changes: Mapping[Cell, Number], condition: Formula = True) -> None:
        """Makes changes where a condition holds."""
        for cell, value in changes.items():
            self.write(cell, choose(condition, value, self.cells.get(cell, value)))

    def join(self, condition: Formula, then: Mapping[Cell, Number], otherwise: Mapping[Cell, Number]) -> None:
        """Makes the changes of one of two branches."""
        for cell in {**then, **otherwise}:
            before = self.cells.get(cell, then.get(cell, otherwise.get(cell)))
            assert before is not None
            self.write(cell, choose(condition, then.get(cell, before), otherwise.get(cell, before)))

    def snapshot(self) -> dict[Cell, Number]:
        return dict(self.cells)

    def continue_from(self, exits: Iterable[tuple[Formula, dict[Cell, Number]]], segments: int) -> None:
        """Goes on where one of several paths has left off, in the segments that were there before they parted."""
        known = list(exits)
        merged: dict[Cell, Number] = {}
        for number, (condition, snapshot) in enumerate(reversed(known)):
            for cell, value in snapshot.items():
                if cell[0] < segments:
                    merged[cell] = value if number == 0 else choose(condition, value, merged.get(cell, value))
        for cell, value in merged.items():
            if self.cells.get(cell) is not value:
                self.write(cell, value)


Alternative = tuple[Formula, int, int]
"""Where a condition holds: a segment and a position in it."""


@dataclass(frozen=True, slots=True)
class Place:
    """Where a value is: one of several places, each with the condition that it is this one."""

    alternatives: tuple[Alternative, ...]

    def moved(self, offset: int) -> Place:
        return Place(tuple((condition, segment, start + offset) for condition, segment, start in self.alternatives))


def place_at(segment: int, position: int = 0) -> Place:
    return Place(((True, segment, position),))


def either(condition: Formula, then: Place, otherwise: Place) -> Place:
    if isinstance(condition, bool):
        return then if condition else otherwise
    return Place(
        tuple((conj(condition, c), s, p) for c, s, p in then.alternatives)
        + tuple((conj(neg(condition), c), s, p) for c, s, p in otherwise.alternatives)
    )
