"""A recorded trace: columns of values over exact time.

Columns keep their values from the instant of one row to that of the next, or numbers move in straight lines; of
several rows for one instant the last one counts. What a row says and what lies between them: docs/monitoring.md.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from fractions import Fraction
from math import lcm
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from tachk.diagnostics.diagnostic import UsageError

Ticks = NDArray[np.int64]
Values = NDArray[np.float64] | NDArray[np.uint8]
"""Numbers, or truth values as 0 and 1."""

LARGEST_TICK = 2**58
"""Later instants are refused, so that sums of instants and bounds of formulas fit into 64 bits."""


class Interpolation(StrEnum):
    """What columns of numbers do between two rows: they keep their values, or move in straight lines. Truth values
    always keep theirs, and after the last row everything does."""

    CONSTANT = "constant"
    LINEAR = "linear"


@dataclass(frozen=True, slots=True, eq=False)
class Trace:
    """Attributes:
    name: where it comes from, as messages print it.
    times: of the rows, in ticks since the trace begins: not decreasing, the first is 0.
    columns: one value for each row; numbers as float64, truth values as uint8.
    end: in ticks; not before the last row. The trace includes it.
    ticks_per_unit: how many ticks make one unit of time.
    unit: ``ms``, ``s``, ...; empty if nobody has said it.
    origin: what the clock of the recording showed when the trace began, in units.
    interpolation: what numbers do between rows.
    """

    name: str
    times: Ticks
    columns: Mapping[str, Values]
    end: int
    ticks_per_unit: int = 1
    unit: str = ""
    origin: Fraction = Fraction(0)
    interpolation: Interpolation = Interpolation.CONSTANT

    def __post_init__(self) -> None:
        if len(self.times) == 0 or self.times[0] != 0 or self.end < self.times[-1]:
            raise ValueError("a trace has rows, begins at 0 and ends with or after the last one")
        if any(len(values) != len(self.times) for values in self.columns.values()):
            raise ValueError("every column has a value in every row")

    @property
    def rows(self) -> int:
        return len(self.times)

    def clock(self, tick: int | Fraction) -> Fraction:
        """What the clock of the recording showed at a tick, in units."""
        return self.origin + Fraction(tick) / self.ticks_per_unit

    def moves(self, column: str) -> bool:
        """Whether the values of a column lie on lines between the rows."""
        return self.interpolation is Interpolation.LINEAR and self.columns[column].dtype.kind == "f"

    def value(self, column: str, tick: Fraction) -> float:
        """The value of a column at an instant from the first row on."""
        values = self.columns[column]
        row = int(self.times.searchsorted(int(tick), side="right")) - 1
        here = float(values[row])
        if row + 1 == self.rows or not self.moves(column):
            return here
        start, stop = int(self.times[row]), int(self.times[row + 1])
        there = float(values[int(self.times.searchsorted(stop, side="right")) - 1])
        return here + (there - here) * float((tick - start) / (stop - start))

    def refined(self, ticks_per_unit: int) -> Trace:
        """The same trace counted so finely that ``1 / ticks_per_unit`` is a whole number of ticks too.

        Raises UsageError if the times no longer fit.
        """
        wanted = lcm(self.ticks_per_unit, ticks_per_unit)
        if wanted == self.ticks_per_unit:
            return self
        factor = wanted // self.ticks_per_unit
        if self.end * factor > LARGEST_TICK:
            raise UsageError(
                f"{self.name} is too long to be counted in {wanted} ticks per unit of time",
                "times and bounds with fewer decimals, or a shorter trace, can be counted",
            )
        return replace(self, times=self.times * factor, end=self.end * factor, ticks_per_unit=wanted)


class Recording(Protocol):
    """A trace that has been opened: its columns are known, its rows are not read yet."""

    @property
    def name(self) -> str: ...

    @property
    def unit(self) -> str:
        """The unit of its times; empty if it does not say."""
        ...

    @property
    def columns(self) -> tuple[str, ...]:
        """The names of everything but the time, in order."""
        ...

    def read(self, columns: Collection[str] | None = None) -> Trace:
        """The trace with these columns only, or all of them. What the others hold does not matter.

        Raises:
            InputError: something in the file is wrong.
            UsageError: a column is not there.
        """
        ...
