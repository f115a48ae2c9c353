"""Values that seldom change, row by row."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from tachk.base.records import dataclass
from tachk.xrce.packets import Numbers

Table = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class SignalChanges:
    """``rows``: ascending; ``values``: what several signals are from each of these rows on, a line for each."""

    rows: Numbers
    values: Table

    def spread(self, signal: int, count: int, before: int = 0) -> Numbers:
        """A signal in each of so many rows.

        Args:
            before: its value before the first change.
        """
        values = np.concatenate([[before], self.values[:, signal]])
        return values[np.searchsorted(self.rows, np.arange(count), side="right")]


class ChangeLog:
    """Collects changes; of several ones in a row the last one counts."""

    __slots__ = ("_rows", "_values", "_width")

    def __init__(self, width: int) -> None:
        """Args:
        width: how many signals.
        """
        self._width = width
        self._rows: list[int] = []
        self._values: list[tuple[int, ...]] = []

    def note(self, row: int, values: tuple[int, ...]) -> None:
        if self._rows and self._rows[-1] == row:
            self._values[-1] = values
        else:
            self._rows.append(row)
            self._values.append(values)

    def __bool__(self) -> bool:
        return bool(self._rows)

    def take(self, first: int) -> SignalChanges:
        """The collected changes; nothing of them is kept.

        Args:
            first: the row that is the first one of the block.
        """
        rows = np.array(self._rows, np.int64) - first
        changes = SignalChanges(rows, np.array(self._values, np.int64).reshape(-1, self._width))
        self._rows, self._values = [], []
        return changes
