"""The values of one subformula over the whole of a trace, in cells of time (docs/logic.md)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray


class Truth(IntEnum):
    """Three truth values; UNDETERMINED: the trace ends too early to decide."""

    FALSE = 0
    TRUE = 1
    UNDETERMINED = 2

    def __bool__(self) -> bool:
        raise TypeError("a verdict has three values: compare it with Truth.TRUE, Truth.FALSE or Truth.UNDETERMINED")

    def __str__(self) -> str:
        return self.word

    def __format__(self, spec: str) -> str:
        return format(self.word, spec)

    @property
    def negated(self) -> Truth:
        """The truth of the negation."""
        return self if self is Truth.UNDETERMINED else Truth(1 - self)

    @property
    def word(self) -> str:
        """``true``, ``false`` or ``undetermined``."""
        return self.name.lower()


@dataclass(frozen=True, slots=True, eq=False)
class CellRuns:
    """Stretches of cells that do not touch, ascending: the first and the last cell of each."""

    first: NDArray[np.int64]
    last: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.first)

    def meets(self, other: CellRuns) -> NDArray[np.bool_]:
        """For each run of cells whether one of the others has a cell in common with it."""
        place = np.searchsorted(other.last, self.first)
        found = place < len(other)
        found[found] = other.first[place[found]] <= self.last[found]
        return found

    def around(self, cell: int) -> tuple[int, int] | None:
        """The stretch that holds a cell."""
        place = int(np.searchsorted(self.last, cell))
        if place == len(self) or self.first[place] > cell:
            return None
        return int(self.first[place]), int(self.last[place])


@dataclass(frozen=True, slots=True, eq=False)
class NodeSignal:
    """Attributes:
    starts: the first cell of each piece, ascending, the first one 0; neighbours may have the same value.
    values: `Truth` of each piece.
    cells: how many cells there are; the last piece ends before this one.
    """

    starts: NDArray[np.int64]
    values: NDArray[np.uint8]
    cells: int

    def at(self, cell: int) -> Truth:
        """The value in a cell; beyond the trace nothing is determined."""
        if cell >= self.cells:
            return Truth.UNDETERMINED
        return Truth(int(self.values[self._piece(cell)]))

    def first(self, value: Truth, begin: int, end: int) -> int | None:
        """The first cell of ``begin .. end`` (inclusive) with a value, within the trace."""
        begin, end = max(begin, 0), min(end, self.cells - 1)
        if begin > end:
            return None
        low, high = self._piece(begin), self._piece(end)
        found = np.flatnonzero(self.values[low : high + 1] == value)
        return max(int(self.starts[low + int(found[0])]), begin) if len(found) else None

    def last(self, value: Truth, begin: int, end: int) -> int | None:
        """The last cell of ``begin .. end`` (inclusive) with a value, within the trace."""
        begin, end = max(begin, 0), min(end, self.cells - 1)
        if begin > end:
            return None
        low, high = self._piece(begin), self._piece(end)
        found = np.flatnonzero(self.values[low : high + 1] == value)
        return min(self._end(low + int(found[-1])), end) if len(found) else None

    def run(self, cell: int) -> tuple[int, int]:
        """The first and the last cell of the longest stretch around a cell with the value it has."""
        value = self.at(cell)
        piece = self._piece(cell)
        others = np.flatnonzero(self.values[piece + 1 :] != value)
        last = self._end(piece + int(others[0])) if len(others) else self.cells - 1
        others = np.flatnonzero(self.values[:piece] != value)
        first = int(self.starts[int(others[-1]) + 1]) if len(others) else 0
        return first, last

    def stretches(self) -> list[tuple[int, int, Truth]]:
        """The longest stretches of one value: first cell, last cell, value."""
        changes = np.concatenate(([0], np.flatnonzero(self.values[1:] != self.values[:-1]) + 1))
        starts = self.starts[changes].tolist()
        ends = [start - 1 for start in starts[1:]] + [self.cells - 1]
        values = self.values[changes].tolist()
        return [(start, end, Truth(value)) for start, end, value in zip(starts, ends, values, strict=True)]

    def runs(self, value: Truth, begin: int, end: int) -> CellRuns:
        """The longest stretches of one value within the cells ``begin .. end`` (inclusive) of the trace."""
        same = self.values == value
        first = self.starts[same & ~np.concatenate(([False], same[:-1]))]
        ends = np.append(self.starts[1:] - 1, self.cells - 1)
        last = ends[same & ~np.concatenate((same[1:], [False]))]
        overlapping = (first <= end) & (last >= begin)
        return CellRuns(np.maximum(first[overlapping], begin), np.minimum(last[overlapping], end))

    def _piece(self, cell: int) -> int:
        return int(np.searchsorted(self.starts, cell, side="right")) - 1

    def _end(self, piece: int) -> int:
        return int(self.starts[piece + 1]) - 1 if piece + 1 < len(self.starts) else self.cells - 1
