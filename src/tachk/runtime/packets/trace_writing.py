"""Traces as files and data frames, in forms in which they can be read again."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tachk.diagnostics.diagnostic import UsageError
from tachk.report.quantity import decimal
from tachk.runtime.trace import Trace, Values

if TYPE_CHECKING:
    import pandas


def write_trace(trace: Trace, path: Path) -> None:
    """Writes a table with a column of times, as CSV or Parquet, by the ending of the file.

    In CSV a cell is empty where the value stays. Raises UsageError for other endings, and without pandas and pyarrow
    for Parquet.
    """
    match path.suffix.lower():
        case ".csv":
            _write_csv(trace, path)
        case ".parquet" | ".pq":
            try:
                trace_frame(trace).reset_index().to_parquet(path)
            except ImportError:
                raise UsageError(
                    "to write Parquet, tachk needs pandas and pyarrow", "pip install pandas pyarrow"
                ) from None
        case _:
            raise UsageError(f"{path}: traces are written as .csv or .parquet")


def trace_frame(trace: Trace) -> pandas.DataFrame:
    """A data frame with one row for each instant; its index is the time since the trace begins.

    Of several rows for one instant only the last one is there, for only that one counts.
    """
    import pandas

    times = trace.times
    last = np.append(np.diff(times) > 0, True)
    unit = trace.unit or "s"
    index = (
        pandas.to_timedelta(times[last] / trace.ticks_per_unit, unit=unit)
        if trace.ticks_per_unit != 10**9
        else (pandas.to_timedelta(times[last], unit="ns"))
    )
    columns = {
        name: values[last].astype(bool) if values.dtype.kind == "u" else values[last]
        for name, values in trace.columns.items()
    }
    return pandas.DataFrame(columns, index=index.rename("time"))


def _write_csv(trace: Trace, path: Path) -> None:
    name = f"time [{trace.unit}]" if trace.unit else "time"
    times = [decimal(trace.clock(tick), 18) for tick in trace.times.tolist()]
    with path.open("w", newline="", encoding="utf-8") as out:
        rows = csv.writer(out, lineterminator="\n")
        rows.writerow([name, *trace.columns])
        rows.writerows(zip(times, *(_cells(values) for values in trace.columns.values()), strict=True))


def _cells(values: Values) -> list[str]:
    """The text of a value where it changes, and nothing where it stays."""
    stays = np.append(False, values[1:] == values[:-1])
    return ["" if same else f"{value:.15g}" for same, value in zip(stays.tolist(), values.tolist(), strict=True)]
