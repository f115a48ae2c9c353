"""Recordings whose columns change at instants of their own: messages of many kinds, files of several rates.

Each column keeps its value until its next one. The trace begins when every requested column has a value, as some are
unknown before; it ends with the last instant of all.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.recordings.traces.arrivals import arriving, topic_of
from tachk.recordings.traces.trace import Trace
from tachk.recordings.traces.trace_arrays import TableRecording
from tachk.recordings.traces.trace_header import TraceHeader, no_such_column

_TIME = "time"


@dataclass(frozen=True, slots=True, eq=False)
class ColumnChanges:
    """The changes of a column: numbers of instants in ascending order, and its values from then on."""

    rows: NDArray[np.int64]
    values: Any


@dataclass(frozen=True, slots=True, eq=False)
class SparseRecording:
    """Attributes:
    times: of all instants in order, as ``trace_arrays.exact_ticks`` takes them.
    changes: of each column; rows of the same number are one instant.
    dated: the times were dates.
    decimals: times that are whole numbers are counted in so many decimals of the unit.
    """

    name: str
    unit: str
    times: NDArray[Any] = field(repr=False)
    changes: Mapping[str, ColumnChanges] = field(repr=False)
    dated: bool = False
    decimals: int = 0

    @property
    def columns(self) -> tuple[str, ...]:
        return tuple(self.changes)

    def read(self, columns: Collection[str] | None = None) -> Trace:
        arrivals = arriving(columns or (), self.columns)
        arrivals |= {name: (name,) for name in columns or () if name in self.changes and topic_of(name) is not None}
        wanted = self.columns if columns is None else tuple(name for name in self.columns if name in columns)
        wanted = tuple(name for name in wanted if name not in arrivals)
        for name in columns or ():
            if name not in self.changes and name not in arrivals:
                raise no_such_column(name, self.columns, self.name)
        known = [int(self.changes[name].rows[0]) for name in wanted if len(self.changes[name].rows)]
        if len(known) < len(wanted):
            empty = next(name for name in wanted if not len(self.changes[name].rows))
            raise UsageError(f"{self.name}: column {empty!r} never has a value")
        begin = max(known, default=0)
        instants = np.arange(begin, len(self.times))
        cells: list[Any] = [self.times[begin:]]
        for name in wanted:
            place = np.searchsorted(self.changes[name].rows, instants, side="right") - 1
            cells.append(np.asarray(self.changes[name].values)[place])
        header = TraceHeader((_TIME, *wanted), 0, self.unit)
        trace = TableRecording(self.name, header, cells, dated=self.dated, decimals=self.decimals).read(list(wanted))
        flags = {name: self._arrived(parts, instants) for name, parts in arrivals.items()}
        return replace(trace, columns={**trace.columns, **flags}) if flags else trace

    def _arrived(self, columns: Collection[str], instants: NDArray[np.int64]) -> NDArray[np.uint8]:
        rows = np.concatenate([self.changes[name].rows for name in columns])
        return np.isin(instants, rows).astype(np.uint8)


def sparse(
    name: str,
    unit: str,
    events: Sequence[tuple[int | Fraction, Mapping[str, Any]]],
    instants: NDArray[np.datetime64] | None = None,
    dated: bool = False,
) -> SparseRecording:
    """The recording of messages in the order of time: what each gives a value. None gives none.

    Args:
        instants: the times of the events, where they are those of a calendar.
        dated: the times were written as dates.
    """
    rows: dict[str, list[int]] = {}
    values: dict[str, list[Any]] = {}
    for number, (_, given) in enumerate(events):
        for column, value in given.items():
            places = rows.setdefault(column, [])
            held = values.setdefault(column, [])
            if value is not None:
                places.append(number)
                held.append(value)
    times: NDArray[Any] = np.empty(len(events), dtype=object) if instants is None else instants
    if instants is None:
        times[:] = [time for time, _ in events]
    changes = {
        column: ColumnChanges(np.array(places, np.int64), array_of(values[column])) for column, places in rows.items()
    }
    return SparseRecording(name, unit, times, changes, dated)


def array_of(values: list[Any]) -> NDArray[Any]:
    """One-dimensional, whatever the values are."""
    kinds = {type(value) for value in values}
    if kinds <= {int, float}:
        return np.array(values, dtype=np.float64)
    if kinds == {bool}:
        return np.array(values, dtype=bool)
    array = np.empty(len(values), dtype=object)
    array[:] = values
    return array
