"""Traces in HDF5 files, read by h5py: data sets of one dimension, named with dots after the groups that they are in.

The time of a data set is the one called ``time``, ``t`` or ``timestamp`` in its group, or in the next group above that
has one. A data set of two dimensions with a row for each time gives a column for each place in a row, ``force[2]``, and
one of records a column for each field.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.optional_packages import optional_packages
from tachk.recordings.traces.arrivals import arriving
from tachk.recordings.traces.logs.foreign import library_errors
from tachk.recordings.traces.logs.joined import JoinedRecording
from tachk.recordings.traces.logs.message_fields import MOST_ELEMENTS
from tachk.recordings.traces.trace import Trace, TraceSource
from tachk.recordings.traces.trace_arrays import TableRecording
from tachk.recordings.traces.trace_header import (
    TIME_NAMES,
    TraceHeader,
    agreed_unit,
    known_unit,
    name_and_unit,
    no_such_column,
    without_unit,
)


@dataclass(frozen=True, slots=True)
class _DataSetPlace:
    """A data set, and what of it: a field of its records, a column of its rows, or all."""

    path: str
    part: str | int | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Hdf5Table:
    """The data sets of a group that have the same times."""

    name: str
    unit: str
    time: _DataSetPlace = field(repr=False)
    places: Mapping[str, _DataSetPlace] = field(repr=False)

    @property
    def columns(self) -> tuple[str, ...]:
        return tuple(self.places)

    def read(self, columns: Collection[str] | None = None) -> Trace:
        arrivals = arriving(columns or (), self.columns)
        parts = [part for parts in arrivals.values() for part in parts]
        requested = self.columns if columns is None else (*columns, *parts)
        wanted = tuple(dict.fromkeys(name for name in requested if name not in arrivals))
        for name in wanted:
            if name not in self.places:
                raise no_such_column(name, self.columns, self.name)
        with _opened_file(Path(self.name)) as file:
            cells = [_values(file, place) for place in (self.time, *(self.places[name] for name in wanted))]
        header = TraceHeader(("time", *wanted), 0, self.unit)
        return TableRecording(self.name, header, cells).read(wanted if columns is None else columns)

    def named_values(self) -> Mapping[str, Mapping[str, int]]:
        """The values of each column that is an enumeration, by their names."""
        return self.enumerations(self.columns)

    def enumerations(self, columns: Collection[str]) -> Mapping[str, Mapping[str, int]]:
        """For those of some columns that are enumerations the values by their names."""
        import h5py

        found: dict[str, Mapping[str, int]] = {}
        with _opened_file(Path(self.name)) as file:
            for name, place in self.places.items():
                if name not in columns:
                    continue
                dtype = file[place.path].dtype
                dtype = dtype[place.part] if isinstance(place.part, str) else dtype
                if known := h5py.check_enum_dtype(dtype):
                    found[name] = {key: int(value) for key, value in known.items()}
        return found


def open_hdf5(path: Path, time: str | None, unit: str | None) -> TraceSource:
    """Finds the data sets of a file. Raises UsageError, also where h5py is not installed."""
    with optional_packages():
        import h5py  # noqa: F401
    with _opened_file(path) as file:
        tables = list(_tables(file, "", None, time, unit, str(path)))
    if not tables:
        names = f"called {time!r}" if time else f"called {', '.join(TIME_NAMES[:-1])} or {TIME_NAMES[-1]}"
        raise UsageError(
            f"{path} has no data set {names} with others of its length", "say which one is the time with --time NAME"
        )
    places = {column: (number, column) for number, table in enumerate(tables) for column in table.columns}
    return JoinedRecording(str(path), tuple(tables), places) if len(tables) > 1 else tables[0]


@contextmanager
def _opened_file(path: Path) -> Iterator[Any]:
    import h5py

    with library_errors(path, "HDF5 file"), h5py.File(path, "r") as file:
        yield file


def _tables(
    group: Any, prefix: str, above: tuple[_DataSetPlace, int, str] | None, time: str | None, unit: str | None, name: str
) -> Iterator[Hdf5Table]:
    """One for each group with data sets as long as the time that counts there.

    Args:
        above: the time of the groups above, its length and its unit.
    """
    sets = {key: item for key, item in group.items() if hasattr(item, "shape") and item.shape}
    places: dict[str, tuple[_DataSetPlace, int]] = {}
    for key, item in sets.items():
        for column, place in _places(key, item):
            if f"{prefix}{column}" in places:
                raise UsageError(f"{name} has two columns {prefix + column!r}", "rename one of them")
            places[f"{prefix}{column}"] = place, item.shape[0]
    clock, chosen = above, None
    for column, (place, length) in places.items():
        last = column.rpartition(".")[2]
        if (last.lower() in TIME_NAMES) if time is None else time in (column, last, place.path.lstrip("/")):
            clock, chosen = (place, length, _unit_of(group.file[place.path], place)), column
            break
    if clock is not None:
        own = agreed_unit(known_unit(clock[2]), unit, name)
        columns = {col: place for col, (place, length) in places.items() if length == clock[1] and col != chosen}
        if columns:
            yield Hdf5Table(name, own, clock[0], columns)
    for key, item in group.items():
        if not hasattr(item, "shape"):
            yield from _tables(item, f"{prefix}{without_unit(key)}.", clock, time, unit, name)


def _places(key: str, item: Any) -> Iterator[tuple[str, _DataSetPlace]]:
    name = without_unit(key)
    if item.ndim == 1 and item.dtype.names:
        yield from ((f"{name}.{without_unit(part)}", _DataSetPlace(item.name, part)) for part in item.dtype.names)
    elif item.ndim == 1:
        yield name, _DataSetPlace(item.name)
    elif item.ndim == 2 and item.shape[1] <= MOST_ELEMENTS:
        yield from ((f"{name}[{number}]", _DataSetPlace(item.name, number)) for number in range(item.shape[1]))


def _unit_of(item: Any, place: _DataSetPlace) -> str:
    """The unit of a time in its name, ``time [ms]``, or in an attribute: ``ms``, or ``seconds since 1970-01-01`` of
    netCDF."""
    named = place.part if isinstance(place.part, str) else item.name.rpartition("/")[2]
    if own := name_and_unit(named)[1]:
        return own
    stated = next((item.attrs[key] for key in ("units", "unit", "Units", "Unit") if key in item.attrs), "")
    text = stated.decode("utf-8", "replace") if isinstance(stated, bytes) else str(stated)
    return text.partition(" since ")[0].strip()


def _values(file: Any, place: _DataSetPlace) -> Any:
    item = file[place.path]
    values = item[:, place.part] if isinstance(place.part, int) else item[()]
    if isinstance(place.part, str):
        values = values[place.part]
    return plain_texts(values)


def plain_texts(values: Any) -> Any:
    """Texts of bytes as texts."""
    if values.dtype.kind == "S":
        return np.char.decode(values, "utf-8", "replace").astype(object)
    if values.dtype.kind == "O":
        texts = [value.decode("utf-8", "replace") if isinstance(value, bytes) else value for value in values]
        return np.array(texts, dtype=object)
    return values
