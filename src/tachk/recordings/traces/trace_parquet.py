"""Traces in Parquet files, read by pyarrow."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.optional_packages import optional_packages
from tachk.recordings.traces.arrivals import arriving
from tachk.recordings.traces.trace import Trace
from tachk.recordings.traces.trace_arrays import TableRecording, are_dates
from tachk.recordings.traces.trace_header import TraceHeader, agreed_unit, known_unit, read_header


@dataclass(frozen=True, slots=True, eq=False)
class ParquetRecording:
    """Attributes:
    raw: the names of the columns as they stand in the file, with their units.
    time_unit: what the type of the time column gives, such as ``s`` for instants and durations.
    rows: those of the file that are read; None: all.
    called: what reports call the trace; None: as its file.
    held: columns that have been read, whole: the runs of a file share them. None: nothing is kept.
    """

    name: str
    header: TraceHeader
    raw: tuple[str, ...]
    time_unit: str
    rows: slice | None = None
    called: str | None = None
    held: dict[str, Any] | None = None

    @property
    def unit(self) -> str:
        return agreed_unit(self.time_unit, self.header.unit or None, self.name)

    @property
    def columns(self) -> tuple[str, ...]:
        return self.header.columns

    def read(self, columns: Collection[str] | None = None) -> Trace:
        arrivals = arriving(columns or (), self.columns)
        parts = {part for parts in arrivals.values() for part in parts}
        table = self.table(None if columns is None else ({*columns} - arrivals.keys()) | parts)
        return table.read(table.columns if columns is None else columns)

    def table(self, columns: Collection[str] | None = None) -> TableRecording:
        """Some columns in memory. Raises UsageError."""
        places = self.header.numbers(columns, self.name)
        wanted = [self.raw[self.header.time], *(self.raw[place] for place in places.values())]
        names = (self.header.names[self.header.time], *places)
        held = {} if self.held is None else self.held
        held.update(self._cells([raw for raw in wanted if raw not in held]))
        cells = [held[raw] for raw in wanted]
        if self.rows is not None:
            cells = [each[self.rows] for each in cells]
        return TableRecording(
            self.called or self.name, TraceHeader(names, 0, self.unit), cells, dated=are_dates(cells[0])
        )

    def _cells(self, wanted: Sequence[str]) -> dict[str, Any]:
        """Whole columns of the file, by their names in it. Raises UsageError."""
        if not wanted:
            return {}
        try:
            table = _parquet().read_table(self.name, columns=list(dict.fromkeys(wanted)))
            return {raw: _numpy(raw, table.column(raw), self.name) for raw in wanted}
        except (OSError, ValueError, NotImplementedError) as error:
            raise _unreadable(self.name, error) from None


def open_parquet(path: str | Path, time: str | None = None, unit: str | None = None) -> ParquetRecording:
    """Reads the schema of a file. Raises UsageError, also where pyarrow is not installed."""
    parquet = _parquet()
    try:
        schema = parquet.read_schema(str(path))
    except FileNotFoundError:
        raise UsageError(f"there is no file {path}") from None
    except (OSError, ValueError, NotImplementedError) as error:
        raise _unreadable(str(path), error) from None
    raw = tuple(schema.names)
    header = read_header(raw, time, unit, str(path))
    kind = str(schema.types[header.time])
    own = "s" if kind.startswith(("timestamp", "duration")) else ""
    return ParquetRecording(str(path), header, raw, known_unit(own))


def _unreadable(path: str, error: Exception) -> UsageError:
    """pyarrow's errors about the content of a file are subclasses of built-in ones."""
    reason = (str(error).splitlines() or [type(error).__name__])[0]
    if "footer" in reason and _begins_as_parquet(path):
        return UsageError(
            f"{path} is cut off: a Parquet file says at its end what it holds, and that is missing",
            "write it again, to its end",
        )
    return UsageError(f"{path} is not a readable Parquet file: {reason}")


def _begins_as_parquet(path: str) -> bool:
    with open(path, "rb") as stream:
        return stream.read(4) == b"PAR1"


def _numpy(raw: str, column: Any, path: str) -> Any:
    """A column as NumPy array; decimal numbers become exact fractions, nulls None or NaN. Raises UsageError."""
    import pyarrow as pa

    if pa.types.is_decimal(column.type):
        import numpy as np

        return np.array([None if v is None else _fraction(v) for v in column.to_pylist()], dtype=object)
    try:
        return column.to_numpy()
    except pa.ArrowException:  # its class says nothing: "unknown error" for bytes that are no text
        try:
            column.validate(full=True)
        except pa.ArrowInvalid as invalid:
            error = invalid
        raise UsageError(f"{path} is damaged: column {raw!r} cannot be read: {error}") from None


def _fraction(value: Any) -> Any:
    from fractions import Fraction

    return Fraction(value)


def _parquet() -> Any:
    with optional_packages():
        import pyarrow.parquet as parquet
    return parquet
