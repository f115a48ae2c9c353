"""Opens a trace, whatever it is kept in."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from tachk.diagnostics.diagnostic import UsageError
from tachk.runtime.trace import Recording, Trace
from tachk.runtime.trace_arrays import open_table

CSV_SUFFIXES = (".csv", ".tsv", ".txt")
"""A file without an ending is read as CSV too."""
PARQUET_SUFFIXES = (".parquet", ".pq")
VCD_SUFFIXES = (".vcd",)
TRACE_SUFFIXES = CSV_SUFFIXES + PARQUET_SUFFIXES + VCD_SUFFIXES
"""By which a file is known to be a trace. Nobody else lists them."""


def is_csv(path: Path) -> bool:
    """Whether a file of this name is read as comma-separated values."""
    return path.suffix.lower() in (*CSV_SUFFIXES, "")


class _Ready:
    """A trace that has been read."""

    def __init__(self, trace: Trace) -> None:
        self._trace = trace

    @property
    def name(self) -> str:
        return self._trace.name

    @property
    def unit(self) -> str:
        return self._trace.unit

    @property
    def columns(self) -> tuple[str, ...]:
        return tuple(self._trace.columns)

    def read(self, columns: object = None) -> Trace:
        return self._trace


def open_trace(source: Any, time: str | None = None, unit: str | None = None) -> Recording:
    """Opens a file by its ending, a data frame, a mapping from names to arrays, or a `Trace`.

    Args:
        time: the name of the time column; without it ``time``, ``t`` or ``timestamp``.
        unit: of the times, such as ``ms``; without it what the file says.

    Raises:
        InputError: something in the file is wrong.
        UsageError: it cannot be read, or is no trace.
    """
    if isinstance(source, Trace):
        return _Ready(source)
    if not isinstance(source, (str, os.PathLike)):
        return open_table(source, time, unit)
    path = Path(source)
    suffix = path.suffix.lower()
    if path.is_dir():
        raise UsageError(f"{path} is a folder, not a trace")
    if suffix in VCD_SUFFIXES:
        from tachk.runtime.trace_vcd import open_vcd

        if time is not None:
            raise UsageError("a value change dump has no time column to choose")
        return open_vcd(path, unit)
    if suffix in PARQUET_SUFFIXES:
        from tachk.runtime.trace_parquet import open_parquet

        return open_parquet(path, time, unit)
    if is_csv(path) or not path.is_file():
        from tachk.runtime.trace_csv import open_csv

        return open_csv(path, time, unit)
    raise UsageError(f"unknown kind of trace: {path}", f"known endings: {', '.join(TRACE_SUFFIXES)}")
