"""The choice of cells of a box that have to be decided so that all are known.

A cell is a combination of values. Along axes that are known to be monotone one answer stands for many: where the states
that are looked for are reached, they are reached in every cell with more behaviour, and where they are not, in none
with less. So each line along one such axis is bisected, and what was found on other lines shortens it: in a box of k
monotone axes of m values this decides O(m^(k-1) log m) cells, the border between the two regions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from enum import IntEnum
from itertools import product

import numpy as np
from numpy.typing import NDArray

from tachk.base.records import dataclass


class CellStatus(IntEnum):
    OPEN = 0
    """Nothing is known yet."""
    REACHED = 1
    UNREACHED = 2
    UNKNOWN = 3
    """It was tried without success."""


class AxisKind(IntEnum):
    """The direction in which the behaviour depends on a value."""

    LESS = -1
    """It shrinks, or stays, as the value grows."""
    ANY = 0
    """Nothing is known."""
    MORE = 1
    """It grows, or stays."""
    SAME = 2
    """It does not depend on it."""


Cell = tuple[int, ...]
"""The number of the value on each axis."""

Statuses = NDArray[np.int8]


@dataclass(frozen=True, slots=True)
class PendingCell:
    """Attributes:
    cell: what is to be decided.
    left: about how many more cells will be, this one included.
    """

    cell: Cell
    left: int


def walk(
    statuses: Statuses,
    axes: Sequence[AxisKind],
    decide: Callable[[PendingCell], CellStatus],
    may_infer: Callable[[Sequence[Cell]], bool],
) -> None:
    """Decides every cell, in place.

    Args:
        statuses: all OPEN, one for each cell.
        decide: the status of one cell, REACHED, UNREACHED or UNKNOWN.
        may_infer: whether in a box with these extreme cells one answer may stand for others; if not, each of its cells
            is decided by itself.
    """
    free = [number for number, axis in enumerate(axes) if axis is AxisKind.ANY]
    bound = [number for number, axis in enumerate(axes) if axis is not AxisKind.ANY]
    combinations = list(product(*(range(statuses.shape[number]) for number in free)))
    for done, values in enumerate(combinations):
        fixed = dict(zip(free, values, strict=True))
        infers = bool(bound) and may_infer(_extremes(statuses.shape, fixed))
        box = _CellBox(statuses, tuple(axes) if infers else (AxisKind.ANY,) * len(axes), fixed, decide)
        box.settle(len(combinations) - done)


def _extremes(shape: Sequence[int], fixed: dict[int, int]) -> list[Cell]:
    ends = ({fixed[n]} if n in fixed else {0, size - 1} for n, size in enumerate(shape))
    return sorted(product(*ends))


@dataclass(frozen=True, slots=True)
class _CellBox:
    """The cells with given values on some axes.

    Attributes:
        axes: of all, ANY where one answer does not stand for others.
        fixed: the numbers of the given values, by axis.
    """

    statuses: Statuses
    axes: tuple[AxisKind, ...]
    fixed: dict[int, int]
    decide: Callable[[PendingCell], CellStatus]

    def settle(self, boxes: int) -> None:
        """Decides the cells of the box, of which there are so many left."""
        lines = list(self._lines())
        along = self._along()
        steps = 1 if along is None else self.statuses.shape[along].bit_length()
        for number, line in enumerate(lines):
            left = steps * (len(lines) * boxes - number)
            pending = [(0, 1 if along is None else self.statuses.shape[along])]
            while pending:
                low, high = pending.pop()
                cells = ((place, self._at(line, along, place)) for place in range(low, high))
                undecided = [(place, cell) for place, cell in cells if self.statuses[cell] == CellStatus.OPEN]
                if undecided:
                    middle, cell = undecided[len(undecided) // 2]
                    self._note(cell, self.decide(PendingCell(cell, left)))
                    # After an unknown answer both halves are open, else at most one is.
                    pending += [(middle + 1, high), (low, middle)]

    def _along(self) -> int | None:
        """The axis that is bisected: the longest of those that can be."""
        usable = [
            n for n, axis in enumerate(self.axes) if n not in self.fixed and axis in (AxisKind.LESS, AxisKind.MORE)
        ]
        return max(usable, key=lambda n: self.statuses.shape[n], default=None)

    def _lines(self) -> Iterator[Cell]:
        """A cell of each line, those in the middle first: what is found there shortens the lines on both sides."""
        along = self._along()
        choices = []
        for number, (size, axis) in enumerate(zip(self.statuses.shape, self.axes, strict=True)):
            if number in self.fixed:
                choices.append([self.fixed[number]])
            elif number == along or axis is AxisKind.SAME:
                choices.append([0])
            else:
                choices.append(_middle_first(size))
        yield from product(*choices)

    def _at(self, line: Cell, along: int | None, place: int) -> Cell:
        return tuple(place if number == along else value for number, value in enumerate(line))

    def _note(self, cell: Cell, status: CellStatus) -> None:
        where: list[int | slice] = []
        for number, (value, axis) in enumerate(zip(cell, self.axes, strict=True)):
            upwards = (axis is AxisKind.MORE) is (status is CellStatus.REACHED)
            if number in self.fixed or axis is AxisKind.ANY:
                where.append(value)
            elif axis is AxisKind.SAME:
                where.append(slice(None))
            elif status is CellStatus.UNKNOWN:
                where.append(value)
            else:
                where.append(slice(value, None) if upwards else slice(0, value + 1))
        part = self.statuses[tuple(where)]
        new = (part == CellStatus.OPEN) | (part == CellStatus.UNKNOWN)
        self.statuses[tuple(where)] = np.where(new, np.int8(status), part)


def _middle_first(size: int) -> list[int]:
    """The numbers below a size, each in the middle of the longest gap between those before it."""
    order: list[int] = []
    gaps = [(0, size)]
    for low, high in gaps:
        if low < high:
            middle = (low + high) // 2
            order.append(middle)
            gaps += [(low, middle), (middle + 1, high)]
    return order
