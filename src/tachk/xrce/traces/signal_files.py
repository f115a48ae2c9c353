"""Traces of captures as tables and files, which can be read again."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.optional_packages import optional_packages
from tachk.base.whole_files import whole_file, whole_text
from tachk.recordings.traces.trace import Trace, Values

_PER_SECOND = 10**9


def write_signals(trace: Trace, path: Path) -> None:
    """Writes a table of a trace in nanoseconds, as CSV or Parquet, by the ending of the file.

    In CSV a cell is empty where the value stays. Raises UsageError for other endings, and for Parquet without pyarrow.
    """
    match path.suffix.lower():
        case ".csv":
            _write_csv(trace, path)
        case ".parquet" | ".pq":
            _write_parquet(trace, path)
        case _:
            raise UsageError(f"{path}: signals are written as .csv or .parquet")


def table_of(trace: Trace) -> dict[str, NDArray[np.generic]]:
    """Columns with one row for each instant, what `pandas.DataFrame` takes; ``time`` is a duration.

    Of several rows for one instant only the last one is there, for only that one counts.
    """
    last = np.append(np.diff(trace.times) > 0, True)
    columns: dict[str, NDArray[np.generic]] = {"time": trace.times[last].astype("timedelta64[ns]")}
    for name, values in trace.columns.items():
        columns[name] = values[last].astype(bool) if values.dtype.kind == "u" else values[last]
    return columns


def _write_parquet(trace: Trace, path: Path) -> None:
    with optional_packages():
        import pyarrow
        from pyarrow import parquet
    with whole_file(path) as part:
        parquet.write_table(pyarrow.table(table_of(trace)), part)


def _write_csv(trace: Trace, path: Path) -> None:
    times = [f"{time // _PER_SECOND}.{time % _PER_SECOND:09d}" for time in trace.times.tolist()]
    with whole_text(path, newline="") as out:
        rows = csv.writer(out, lineterminator="\n")
        rows.writerow([f"time [{trace.unit}]", *trace.columns])
        rows.writerows(zip(times, *(_cells(values) for values in trace.columns.values()), strict=True))


def _cells(values: Values) -> list[str]:
    """The text of a value where it changes, and nothing where it stays."""
    stays = np.append(False, values[1:] == values[:-1])
    return ["" if same else f"{value:.15g}" for same, value in zip(stays.tolist(), values.tolist(), strict=True)]
