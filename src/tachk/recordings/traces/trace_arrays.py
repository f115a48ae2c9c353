"""Traces that are in memory already: data frames, dictionaries of arrays or lists."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import IntEnum
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tachk import _core
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.recordings.traces.arrivals import arriving
from tachk.recordings.traces.decimal_times import USUAL_DECIMALS
from tachk.recordings.traces.logs.cell_texts import mixed_column
from tachk.recordings.traces.logs.labels import Labels
from tachk.recordings.traces.trace import FloatTimes, Ticks, Trace, Values, later_beginning, rounding_note
from tachk.recordings.traces.trace_header import TraceHeader, agreed_unit, known_unit, read_header

_FIRST_BLOCK = 1 << 8
_BLOCK = 1 << 15

_SAMPLES = 1 << 8
"""Rows whose times show in how many decimals all of them may be whole."""


class _TimeFault(IntEnum):
    """Faults of floating-point times; the numbers are those of `CountedTimes::Fault` in ticks.hpp."""

    NONE = 0
    NOT_FINITE = 1
    TOO_LARGE = 2
    MERGED = 3
    BACKWARDS = 4


@dataclass(frozen=True, slots=True, eq=False)
class CountedTimes:
    """Attributes:
    ticks: not decreasing, the first is 0.
    first: what the clock showed then, in ticks.
    rounded: to how many decimals some were; None: none was.
    """

    ticks: Ticks | FloatTimes
    first: int
    ticks_per_unit: int
    rounded: int | None = None


@dataclass(frozen=True, slots=True, eq=False)
class TableRecording:
    """Attributes:
    cells: the columns in the order of the header.
    supposing: see `supposed`.
    dated: the times were dates.
    decimals: times that are whole numbers are counted in so many decimals of the unit.
    """

    name: str
    header: TraceHeader
    cells: Sequence[Any] = field(repr=False)
    supposing: bool = False
    dated: bool = False
    decimals: int = 0

    @property
    def unit(self) -> str:
        return agreed_unit(known_unit(_own_unit(self._times())), self.header.unit or None, self.name)

    @property
    def columns(self) -> tuple[str, ...]:
        return self.header.columns

    def read(self, columns: Collection[str] | None = None) -> Trace:
        arrivals = arriving(columns or (), self.columns)
        wanted = None if columns is None else [name for name in columns if name not in arrivals]
        places = self.header.numbers(wanted, self.name)
        known = self._first_known(places)
        begin = max(known.values(), default=0)
        times = self._instants(begin)
        supposing = isinstance(times.ticks, FloatTimes)
        held: dict[str, Values] = {}
        texts = Labels()
        for name, place in places.items():
            cells = _behind(self.cells[place], known[name])
            if (words := _texts_in(cells)) is not None:
                held[name] = texts.codes(words, name, self.name, known[name])[begin - known[name] :]
                continue
            supposed = _supposed_values(cells) if supposing else None
            values = held_values(cells, name, self.name) if supposed is None else supposed
            held[name] = _from(values, begin - known[name])
        for name, parts in arrivals.items():
            own = self.header.numbers(parts, self.name).values()
            held[name] = np.bitwise_or.reduce([present(_behind(self.cells[place], begin)) for place in own])
        for name, values in held.items():
            if len(values) != len(times.ticks):
                count = len(times.ticks)
                raise UsageError(f"{self.name}: column {name!r} has {len(values)} values for {count} times")
        trace = replace(texts.on(trace_of(self.name, times, self.unit, held)), dated=self.dated)
        return replace(trace, notes=(*trace.notes, later_beginning(begin))) if begin else trace

    def _first_known(self, places: Mapping[str, int]) -> dict[str, int]:
        """The first row in which each column has a value. Raises UsageError for a column that never has one."""
        known = {}
        for name, place in places.items():
            row = _first_known(self.cells[place])
            if row is None:
                raise UsageError(
                    f"{self.name}: column {name!r} never has a value",
                    "the trace begins with the first row in which every column that a formula reads has one",
                )
            known[name] = row
        return known

    def _instants(self, begin: int) -> CountedTimes:
        """The times from a row on."""
        times = self._times()
        if begin == 0:
            return (_supposed_times(times) if self.supposing else None) or self._exact(times)
        counted = self._exact(times)
        assert not isinstance(counted.ticks, FloatTimes)
        later = counted.ticks[begin:]
        gone = int(later[0]) if len(later) else 0
        return replace(counted, ticks=later - gone, first=counted.first + gone)

    def _exact(self, times: NDArray[Any]) -> CountedTimes:
        return whole_ticks(times, self.decimals, self.name) if self.decimals else exact_ticks(times, self.name)

    def supposed(self) -> TableRecording:
        """The same, but times in floating point and numbers are supposed to be in order where a few samples are. The
        first monitor of the trace sees whether they are; else the trace has to be read without supposing that."""
        return replace(self, supposing=True)

    def _times(self) -> NDArray[Any]:
        """The times as an array; instants with a time zone as those of universal time."""
        cells = self.cells[self.header.time]
        if getattr(getattr(cells, "dtype", None), "tz", None) is not None:
            return np.asarray(cells.to_numpy(dtype="datetime64[ns]"))
        return np.asarray(cells)


def open_table(data: Any, time: str | None = None, unit: str | None = None, name: str = "the trace") -> TableRecording:
    """Opens a pandas data frame, or a mapping from names to arrays or lists.

    A data frame without a time column is measured by its index. Raises UsageError.
    """
    if isinstance(data, Mapping):
        names = [str(key) for key in data]
        cells = list(data.values())
        header = read_header(names, time, unit, name)
        return TableRecording(name, header, cells, dated=are_dates(cells[header.time]))
    if not (hasattr(data, "columns") and hasattr(data, "index")):
        raise UsageError(
            f"a value of type {type(data).__name__} is not a trace",
            "give the path of a file, a data frame, or a dictionary of arrays: {'time': [...], 'speed': [...]}",
        )
    names = [str(column) for column in data.columns]
    cells = [data[column] for column in data.columns]
    try:
        header = read_header(names, time, unit, name)
    except UsageError:
        if time is not None and time != data.index.name:
            raise
        header = read_header([str(data.index.name or "index"), *names], str(data.index.name or "index"), unit, name)
        cells.insert(0, data.index)
    return TableRecording(name, header, cells, dated=are_dates(cells[header.time]))


def are_dates(times: Any) -> bool:
    """True if a column holds instants of a calendar."""
    return getattr(getattr(times, "dtype", None), "kind", "") == "M"


def trace_of(name: str, times: CountedTimes, unit: str, columns: Mapping[str, Values]) -> Trace:
    """The trace that begins with the first row. Raises UsageError for no rows."""
    if len(times.ticks) == 0:
        raise UsageError(f"{name} has no rows", "the verdict needs at least the state at the beginning")
    end = times.ticks.last if isinstance(times.ticks, FloatTimes) else int(times.ticks[-1])
    origin = Fraction(times.first, times.ticks_per_unit)
    notes = () if times.rounded is None else (rounding_note(times.rounded),)
    return Trace(name, times.ticks, columns, end, times.ticks_per_unit, unit, origin, notes=notes)


def _supposed_times(times: NDArray[Any]) -> CountedTimes | None:
    """Times in floating point, if a sample of them is whole in fewer decimals than times are rounded to."""
    if times.dtype != np.float64 or times.ndim != 1 or not times.flags.c_contiguous or len(times) == 0:
        return None
    sample = np.append(times[:: max(1, len(times) // _SAMPLES)], times[-1])
    ticks = np.empty(len(sample), dtype=np.int64)
    first, decimals, fault, *_ = _core.count_times(sample, USUAL_DECIMALS, ticks)
    if fault != _TimeFault.NONE or decimals >= USUAL_DECIMALS:
        return None
    return CountedTimes(FloatTimes(times, decimals, first, int(ticks[-1])), first, 10**decimals)


def _supposed_values(values: Any) -> NDArray[np.float64] | None:
    """The values of a column of numbers that are not truth values, as they are."""
    array = values.to_numpy() if hasattr(values, "to_numpy") else values
    plain = isinstance(array, np.ndarray) and array.dtype == np.float64 and array.ndim == 1 and array.flags.c_contiguous
    return None if not plain or _is_truth(array) else array


def exact_ticks(times: NDArray[Any], name: str) -> CountedTimes:
    """Times as ticks.

    Floating-point times are taken for the decimal numbers that they print as. Where that needs too many decimals, they
    are rounded to `USUAL_DECIMALS`, or to as many more as keep different times of neighbours different. Instants and
    durations of NumPy are counted in seconds. Raises UsageError, also for times that go backwards.
    """
    if times.ndim != 1:
        raise UsageError(f"{name}: the times are not a one-dimensional array")
    if times.dtype.kind in "mM":
        if np.isnat(times).any():
            raise UsageError(f"{name}: a time is missing")
        step, count = np.datetime_data(times.dtype)
        per_second = {"s": 1, "ms": 10**3, "us": 10**6, "ns": 10**9}.get(step)
        if per_second is None or count != 1:
            return exact_ticks(times.astype(f"{times.dtype.kind}8[ns]"), name)
        return whole_times(times.astype(np.int64), per_second, name)
    if times.dtype.kind in "iu":
        if times.dtype == np.uint64 and len(times) and int(times.max()) > 2**62:
            raise UsageError(f"{name}: the times are too large")
        return whole_times(np.ascontiguousarray(times, dtype=np.int64), 1, name)
    if times.dtype.kind == "O" and all(isinstance(time, (int, Fraction)) for time in times):
        return _rational_ticks([Fraction(time) for time in times], name)
    try:
        if times.dtype.kind == "f" and times.dtype.itemsize < np.dtype(np.float64).itemsize:
            times = times.astype(np.str_)  # it prints as fewer digits than the same number with 64 bits
        numbers = np.ascontiguousarray(times, dtype=np.float64)
    except OverflowError:
        raise UsageError(f"{name}: the times are too large") from None
    except (TypeError, ValueError):
        raise UsageError(f"{name}: the times are not numbers") from None
    ticks = np.empty(len(numbers), dtype=np.int64)  # NumPy takes pages for large arrays that are large too
    first, decimals, kind, row, rounded = _core.count_times(numbers, USUAL_DECIMALS, ticks)
    match _TimeFault(kind):
        case _TimeFault.NOT_FINITE:
            raise UsageError(f"{name}: the time of row {row} is missing or infinite (rows are counted from 0)")
        case _TimeFault.TOO_LARGE:
            raise UsageError(f"{name}: the time {numbers[row]} of row {row} is too large (rows are counted from 0)")
        case _TimeFault.MERGED:
            raise UsageError(
                f"{name}: the times of rows {row - 1} and {row} differ by {abs(numbers[row] - numbers[row - 1]):.3g}, "
                "too little to be counted beside the largest time (rows are counted from 0)",
                "round the times, for example numpy.round(times, 9), or begin them at 0",
            )
        case _TimeFault.BACKWARDS:
            raise _backwards(name, row)
        case _TimeFault.NONE:
            return CountedTimes(ticks, first, 10**decimals, decimals if rounded else None)


def whole_ticks(times: Ticks, decimals: int, name: str) -> CountedTimes:
    """Times that are counted in so many decimals, in ticks as large as can be. Raises UsageError as `whole_times`."""
    scale = 10**decimals
    common = math.gcd(scale, int(np.gcd.reduce(times))) if len(times) else scale
    return whole_times(times // common, scale // common, name)


def whole_times(times: Ticks, ticks_per_unit: int, name: str) -> CountedTimes:
    """Times that are ticks already. Raises UsageError for times that go backwards, or are too far from 0."""
    if len(times) == 0:
        return CountedTimes(times, 0, ticks_per_unit)
    first, last = int(times[0]), int(times[-1])
    if max(abs(first), abs(last)) > 2**62:
        raise UsageError(f"{name}: the times are too large")
    row = _core.first_backwards(times)
    if row is not None:
        raise _backwards(name, row)
    return CountedTimes(times - first if first else times, first, ticks_per_unit)


def _backwards(name: str, row: int) -> UsageError:
    return UsageError(
        f"{name}: the time of row {row} lies before that of the row above (rows are counted from 0)",
        "sort the rows by time; of several rows with the same time, the last one counts",
    )


def _rational_ticks(times: Sequence[Fraction], name: str) -> CountedTimes:
    """Counted from the first one on: a clock may show the nanoseconds since 1970."""
    scale = math.lcm(*(time.denominator for time in times))
    first = times[0] if times else Fraction(0)
    ticks = [int((time - first) * scale) for time in times]
    row = next((row for row, tick in enumerate(ticks) if abs(tick) > 2**62), None)
    if row is not None:
        fine = "--decimals 9 rounds them to nine decimals"
        far = "leave out the rows with such a time: it is too far from that of the first row"
        raise UsageError(
            f"{name}: the times need more than 64 bits to be counted exactly, that of row {row} among them (rows are "
            "counted from 0)",
            far if abs(times[row] - first) * 10**9 > 2**62 else fine,
        )
    return replace(whole_times(np.array(ticks, dtype=np.int64), scale, name), first=int(first * scale))


def held_values(values: Any, column: str, name: str, before: float | None = None) -> Values:
    """The values of a column; a missing one (None, NaN, NaT) means that the value before stays.

    A column with no values but 0 and 1 holds truth values, as in a file. Numbers are not copied where they need not be.

    Args:
        before: the value before the first row, if there is one.

    Raises UsageError.
    """
    array = cells_of(values)
    if array.ndim != 1:
        raise UsageError(f"{name}: column {column!r} is not a one-dimensional array")
    if array.dtype.kind == "b":
        return array.astype(np.uint8)
    known: NDArray[np.bool_] | None = None
    if array.dtype.kind == "O":
        known = np.array([not is_missing(value) for value in array], dtype=bool)
        truths = [isinstance(value, (bool, np.bool_)) for value in array[known]]
        if any(truths) and not all(truths):
            _check_kinds(array[known], column, name)
        if len(truths) and all(truths):
            if before in (None, 0, 1):
                flags = np.zeros(len(array), dtype=np.uint8)
                flags[known] = array[known].astype(np.uint8)
                return _hold(flags, known, column, name, before)
        array = np.where(known, array, 0)
    if array.dtype.kind not in "iufO":
        raise _no_numbers(column, name)
    try:
        numbers = np.ascontiguousarray(array, dtype=np.float64)
    except OverflowError:
        raise UsageError(
            f"{name}: column {column!r} has an integer that is larger than any number of 64 bits"
        ) from None
    except (TypeError, ValueError):
        raise _no_numbers(column, name, array) from None
    if known is not None or not _core.all_finite(numbers):
        known = ~np.isnan(numbers) if known is None else known & ~np.isnan(numbers)
        numbers = np.asarray(_hold(numbers, known, column, name, before), dtype=np.float64)
    return numbers.astype(np.uint8) if _is_truth(numbers) else numbers


def cells_of(values: Any) -> NDArray[Any]:
    """The cells of a column as an array, in which those of a list are of the kinds that they have there."""
    if hasattr(values, "to_numpy"):
        return np.asarray(values.to_numpy())
    if isinstance(values, (list, tuple)) and len(kinds := set(map(type, values))) > 1 and kinds & {bool, np.bool_, str}:
        array = np.empty(len(values), dtype=object)
        array[:] = values
        return array
    return np.asarray(values)


def present(values: Any) -> NDArray[np.uint8]:
    """1 for each cell of a column that has a value, else 0."""
    array = cells_of(values)
    if array.dtype.kind == "O":
        return np.array([not is_missing(value) for value in array], dtype=np.uint8)
    if array.dtype.kind in "fmM":
        return np.asarray(array == array, dtype=np.uint8)
    return np.ones(len(array), dtype=np.uint8)


def _is_truth(numbers: NDArray[np.float64]) -> bool:
    edges = (0, *range(_FIRST_BLOCK, len(numbers), _BLOCK), len(numbers))
    blocks = (numbers[begin:end] for begin, end in pairwise(edges))
    return all(bool(((block == 0) | (block == 1)).all()) for block in blocks)


def _hold(values: Values, known: NDArray[np.bool_], column: str, name: str, before: float | None) -> Values:
    if known.all():
        return values
    if not known[0] and before is not None:
        values, known = values.copy(), known.copy()
        values[0], known[0] = before, True
    if not known[0]:
        raise UsageError(
            f"{name}: column {column!r} has no value in the first row",
            "a missing value means that the value stays, so the first row has to give one",
        )
    last: NDArray[np.int64] = np.maximum.accumulate(np.where(known, np.arange(len(values)), 0))
    return values[last]


def _texts_in(values: Any) -> Sequence[Any] | None:
    """The cells of a column whose first value is a text."""
    if getattr(getattr(values, "dtype", None), "kind", "O") not in "OUT":
        return None
    array = cells_of(values)
    if array.ndim != 1 or array.dtype.kind not in "OUT":
        return None
    first = next((value for value in array if isinstance(value, str) or (value is not None and value == value)), None)
    return array.tolist() if isinstance(first, str) else None


def _first_known(values: Any) -> int | None:
    """The first row with a value; None if no row has one. For something that is not a column, 0: `_hold` refuses it."""
    try:
        first = [*values[:1]]
    except (IndexError, KeyError, TypeError):
        return 0
    if not first or not is_missing(first[0]):
        return 0
    known = np.flatnonzero(present(values))
    return int(known[0]) if len(known) else None


def _behind(values: Any, begin: int) -> Any:
    """A column from a row on."""
    if begin == 0:
        return values
    return values.iloc[begin:] if hasattr(values, "iloc") else values[begin:]


def _from(values: Values, row: int) -> Values:
    """The values held from a row on; rows that are left out do not decide whether they are truth values."""
    later = values[row:]
    if row == 0 or later.dtype != np.float64:
        return later
    numbers = np.asarray(later, dtype=np.float64)
    return numbers.astype(np.uint8) if _is_truth(numbers) else numbers


def is_missing(value: object) -> bool:
    """True if a cell means that the value stays."""
    return value is None or (isinstance(value, float) and math.isnan(value)) or type(value).__name__ == "NAType"


def _check_kinds(values: NDArray[Any], column: str, name: str) -> None:
    """Raises UsageError for a number beside truth values that is not 0 or 1."""
    for value in values:
        if not isinstance(value, (bool, np.bool_, str)) and value not in (0, 1):
            raise mixed_column(name, column, value)


def _no_numbers(column: str, name: str, values: NDArray[Any] | None = None) -> UsageError:
    text = next((value for value in (() if values is None else values) if isinstance(value, str)), None)
    if text is not None:
        return UsageError(
            f"{name}: column {column!r} has numbers or truth values, and the text {text!r}",
            "a column has values of one kind",
        )
    return UsageError(
        f"{name}: column {column!r} holds neither numbers nor truth values",
        "columns that no formula reads may hold anything",
    )


def _own_unit(times: NDArray[Any]) -> str:
    return "s" if times.dtype.kind in "mM" else ""
