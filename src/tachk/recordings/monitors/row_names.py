"""Names for rows in formulas: `arrived(hb)`, that a row gives a value, and `time`, when the last row was.

The columns of a trace come first: `time` means a column of this name where there is one. Values of `time` are those
that the clock of the recording shows, in the unit of the trace, and are held until the next row, as others are.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tachk.recordings.monitors.formulas import NamedFormula
from tachk.recordings.traces.arrivals import arriving, belongs, counted, topic_of
from tachk.recordings.traces.trace import Ticks, Trace
from tachk.recordings.traces.trace_arrays import present

TIME = "time"
"""The name of the time of a row."""


def row_columns(formulas: Iterable[NamedFormula], columns: Collection[str]) -> tuple[str, ...]:
    """The names in formulas that say something of rows, where the trace has these columns."""
    names = sorted({name for named in formulas for name in named.columns})
    arrivals = {*arriving(names, columns), *(name for name in columns if topic_of(name) is not None)}
    return tuple(name for name in names if name in arrivals or (name == TIME and name not in columns))


def with_row_columns(trace: Trace, names: Collection[str]) -> Trace:
    """A trace with the values of such names. Arrivals are there as truth values of rows."""
    if not names:
        return trace
    added: dict[str, Any] = {
        name: counted(np.asarray(trace.columns[name]), trace.times) for name in names if name != TIME
    }
    if TIME in names:
        first = int(trace.origin * trace.ticks_per_unit)
        added[TIME] = (trace.times + first).astype(np.float64) / trace.ticks_per_unit
    return replace(trace, columns={**trace.columns, **added})


@dataclass(frozen=True, slots=True)
class RowNames:
    """The same row by row, where columns are not known beforehand.

    Attributes:
        names: that say something of rows.
        first: the time of the first row; None before it, and where it is not a number.
        counts: how often something has arrived since that instant.
        begins: what arrives at it.
    """

    names: tuple[str, ...]
    first: Fraction | None = None
    counts: Mapping[str, float] = field(default_factory=dict)
    begins: frozenset[str] = frozenset()

    def row(self, time: Any, values: Mapping[str, Any]) -> tuple[dict[str, Any], RowNames]:
        """The values of a row with those of the names, and what is known after it."""
        known = [name for name, value in values.items() if not (value is None or value != value)]
        flags = {
            name: np.array([any(belongs(column, topic) for column in known)])
            for name in self.names
            if (topic := topic_of(name)) is not None
        }
        instant = _exact(time)
        first = instant if self.first is None else self.first
        added, after = self._after(first, np.array([instant == first]), flags)
        at = {TIME: float(instant)} if TIME in self.names and instant is not None else {}
        return {**at, **{name: float(column[0]) for name, column in added.items()}, **values}, after

    def rows(self, times: Ticks, columns: Mapping[str, Any], decimals: int) -> tuple[dict[str, Any], RowNames]:
        """Many rows, likewise. Columns of arrivals may be there as truth values of rows."""
        if len(times) == 0:
            return dict(columns), self
        scale = 10**decimals
        first = Fraction(int(times[0]), scale) if self.first is None else self.first
        flags = {name: _flags(name, columns, len(times)) for name in self.names if topic_of(name) is not None}
        ticks = first * scale
        at_first = np.asarray(times) == int(ticks) if ticks.denominator == 1 else np.zeros(len(times), dtype=bool)
        added, after = self._after(first, at_first, flags)
        at = {TIME: np.asarray(times) / scale} if TIME in self.names else {}
        others = {name: column for name, column in columns.items() if name not in added}
        return {**at, **added, **others}, after

    def _after(
        self, first: Fraction | None, at_first: NDArray[np.bool_], flags: Mapping[str, NDArray[np.bool_]]
    ) -> tuple[dict[str, NDArray[np.float64]], RowNames]:
        begins = self.begins | {name for name, arrived in flags.items() if (arrived & at_first).any()}
        columns, counts = {}, {}
        for name, arrived in flags.items():
            count = np.cumsum(arrived & ~at_first) + self.counts.get(name, 0.0)
            columns[name] = np.where(count > 0, count, -np.inf if name in begins else np.inf)
            counts[name] = float(count[-1])
        return columns, replace(self, first=first, counts=counts, begins=begins)


def _flags(name: str, columns: Mapping[str, Any], count: int) -> NDArray[np.bool_]:
    """In which rows something arrives."""
    if name in columns:
        return np.asarray(columns[name], dtype=bool)
    parts = [present(column) != 0 for part, column in columns.items() if belongs(part, topic_of(name) or "")]
    arrived: NDArray[np.bool_] = np.any(parts, axis=0) if parts else np.zeros(count, dtype=bool)
    return arrived


def _exact(time: Any) -> Fraction | None:
    """A time as the decimal number that it prints as; None if it is not a number, which monitors refuse."""
    try:
        return Fraction(str(time) if isinstance(time, float) else time)
    except (TypeError, ValueError, OverflowError):
        return None
