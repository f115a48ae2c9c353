"""Storage of symbolic execution: numbered cells; each branch has changes of its own."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

from tachk.engine.smt.terms import Formula, SymbolicNumber, choose, conj, neg

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

    cells: dict[Cell, SymbolicNumber]
    ranges: dict[int, Sequence[tuple[int, int]]]
    segments: int = CLOCK_VALUE + 1
    journal: dict[Cell, SymbolicNumber | None] = field(default_factory=dict)
    """The values of cells before the current branch."""

    def new_segment(self, values: Sequence[SymbolicNumber], ranges: Sequence[tuple[int, int]]) -> int:
        segment = self.segments
        self.segments += 1
        self.ranges[segment] = ranges
        for position, value in enumerate(values):
            self.write((segment, position), value)
        return segment

    def write(self, cell: Cell, value: SymbolicNumber) -> None:
        self.journal.setdefault(cell, self.cells.get(cell))
        self.cells[cell] = value

    def undone(self, action: Callable[[], _T]) -> tuple[_T, dict[Cell, SymbolicNumber]]:
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

    def apply(self, changes: Mapping[Cell, SymbolicNumber], condition: Formula = True) -> None:
        """Makes changes where a condition holds."""
        for cell, value in changes.items():
            self.write(cell, choose(condition, value, self.cells.get(cell, value)))

    def join(
        self, condition: Formula, then: Mapping[Cell, SymbolicNumber], otherwise: Mapping[Cell, SymbolicNumber]
    ) -> None:
        """Makes the changes of one of two branches."""
        for cell in {**then, **otherwise}:
            before = self.cells.get(cell, then.get(cell, otherwise.get(cell)))
            assert before is not None
            self.write(cell, choose(condition, then.get(cell, before), otherwise.get(cell, before)))

    def snapshot(self) -> dict[Cell, SymbolicNumber]:
        return dict(self.cells)

    def continue_from(self, exits: Iterable[tuple[Formula, dict[Cell, SymbolicNumber]]], segments: int) -> None:
        """Goes on where one of several paths has left off, in the segments that were there before they parted."""
        known = list(exits)
        merged: dict[Cell, SymbolicNumber] = {}
        for number, (condition, snapshot) in enumerate(reversed(known)):
            for cell, value in snapshot.items():
                if cell[0] < segments:
                    merged[cell] = value if number == 0 else choose(condition, value, merged.get(cell, value))
        for cell, value in merged.items():
            if self.cells.get(cell) is not value:
                self.write(cell, value)


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
