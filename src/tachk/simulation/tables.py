"""Runs as files: one table of all of them (CSV, JSON lines, Parquet), or a file for each (also VCD)."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

import numpy as np
from numpy.typing import NDArray

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.job import unhurried
from tachk.base.optional_packages import optional_packages
from tachk.base.time_units import NANOSECONDS
from tachk.base.whole_files import whole_file, whole_text
from tachk.recordings.traces.trace import LARGEST_TICK, Trace
from tachk.recordings.traces.vcd_units import time_comment
from tachk.simulation.runs import RunRows

if TYPE_CHECKING:
    from tachk.engine.simulation.simulator import Simulated
    from tachk.simulation.runs import Runs

PARQUET = (".parquet", ".pq")
"""The endings of Parquet's files."""

RUN = "{run}"
"""Stands for the number of the run in the name of a file for each run."""

_VCD_TIMES = {
    "ns": ("1 fs", 1, 1000),
    "us": ("1 fs", 1, 1),
    "ms": ("1 ps", 1, 1),
    "s": ("1 ns", 1, 1),
    "min": ("1 ns", 60, 1),
    "h": ("1 ns", 3600, 1),
    "d": ("1 ns", 24 * 3600, 1),
}
"""For each unit the unit of a dump, and how many of these are 1e-9 units: a fraction. No unit: seconds."""

_VCD_SCALES = [f"{number} {unit}" for unit in ("fs", "ps", "ns", "us", "ms", "s") for number in (1, 10, 100)]

_ROW_GROUP = 100_000
"""Rows of Parquet that are written together: so many are held until then."""

_ROWS_AT_ONCE = 4096
"""Rows of a text that are Python's objects together: each takes many times the memory that a trace takes for it."""

Writer = Callable[[int, Trace], None]
Row = tuple[str, list[Any]]


@contextmanager
def run_writer(path: Path) -> Iterator[Writer]:
    """The writer of runs, given with their numbers. Raises UsageError for an unknown ending of the file."""
    kinds = {".csv": _csv, ".jsonl": _json_lines, **dict.fromkeys(PARQUET, _parquet), ".vcd": _vcd}
    opened = kinds.get(path.suffix.lower())
    if opened is None:
        raise UsageError(f"{path}: runs are written as {', '.join(kinds)}", "give the file one of these endings")
    if RUN not in path.name:
        with opened(path) as write:
            yield write
        return

    def write_own(number: int, trace: Trace) -> None:
        with opened(path.with_name(path.name.replace(RUN, str(number)))) as write:
            write(number, trace)

    yield write_own


@contextmanager
def _whole_run(out: TextIO) -> Iterator[None]:
    """Takes the beginning of a run back if its rows are not written to their end; not from a device or a pipe."""
    begins = out.tell() if out.seekable() else None
    try:
        yield
    except BaseException:
        if begins is not None:
            with suppress(OSError):
                out.seek(begins)
                out.truncate()
        raise


@contextmanager
def _csv(path: Path) -> Iterator[Writer]:
    with whole_text(path, newline="") as out:
        begun = False

        def write(number: int, trace: Trace) -> None:
            nonlocal begun
            with _whole_run(out):
                if not begun:
                    out.write(",".join(["run", _time_name(trace.unit), *map(_quoted, trace.columns)]) + "\n")
                for time, values in _rows(trace):
                    out.write(f"{number},{time},{','.join(map(_cell, values))}\n")
            begun = True

        yield write


@contextmanager
def _json_lines(path: Path) -> Iterator[Writer]:
    with whole_text(path) as out:

        def write(number: int, trace: Trace) -> None:
            head = f'{{"run": {number}, "{_time_name(trace.unit)}": '
            with _whole_run(out):
                for time, values in _rows(trace):
                    row = json.dumps(dict(zip(trace.columns, values, strict=True)))
                    out.write(f"{head}{time}{', ' + row[1:] if len(row) > 2 else '}'}\n")

        yield write


@contextmanager
def parquet_of_runs(path: Path) -> Iterator[Callable[[Simulated, Runs], None]]:
    """Writes runs that are drawn into one table. Many are taken together: one by one they take many times as long."""
    with _row_groups(path) as add:
        waiting: list[Simulated] = []
        drawn: Runs | None = None
        rows = 0
        is_torn = False

        def flush() -> None:
            nonlocal rows, is_torn
            if drawn is not None and waiting:
                table = drawn.rows(waiting)
                is_torn = True
                waiting.clear()
                rows = 0
                add(table)
                is_torn = False

        def write(run: Simulated, runs: Runs) -> None:
            nonlocal drawn, rows
            drawn = runs
            if rows >= _ROW_GROUP:
                flush()  # before the run is taken: one that a limit ends here does not count
            waiting.append(run)
            rows += len(run.times)

        yield write
        if is_torn:  # Ctrl-C came while runs were handed on
            raise KeyboardInterrupt
        with unhurried():  # these runs count already
            flush()


@contextmanager
def _parquet(path: Path) -> Iterator[Writer]:
    with _row_groups(path) as add:
        yield lambda number, trace: add(_rows_of(number, trace))


@contextmanager
def _row_groups(path: Path) -> Iterator[Callable[[RunRows], None]]:
    with optional_packages():
        import pyarrow
        from pyarrow import parquet
    with ExitStack() as stack:
        file: Any = None
        waiting: list[Any] = []
        rows, is_damaged = 0, False

        def flush() -> None:
            nonlocal file, rows, is_damaged
            if not waiting:
                return
            if file is None:
                part = stack.enter_context(whole_file(path))
                file = stack.enter_context(parquet.ParquetWriter(part, waiting[0].schema))
            is_damaged = True
            file.write_table(pyarrow.concat_tables(waiting), row_group_size=_ROW_GROUP)
            is_damaged = False
            waiting.clear()
            rows = 0

        def add(more: RunRows) -> None:
            nonlocal rows
            exact = bool(more.unit) and NANOSECONDS[more.unit] % more.ticks_per_unit == 0
            name = "time" if exact else _time_name(more.unit)
            times = _durations(path, more) if exact else more.times / more.ticks_per_unit
            columns: dict[str, Any] = {**more.columns}
            for column, labels in more.labels.items():
                places = pyarrow.array(more.columns[column].astype(np.int32))
                texts = pyarrow.DictionaryArray.from_arrays(places, pyarrow.array(labels, pyarrow.string()))
                columns[column] = texts.dictionary_decode()
            waiting.append(pyarrow.table({"run": more.run, name: times, **columns}))
            rows += len(more.run)
            if rows >= _ROW_GROUP:
                flush()

        yield add
        if is_damaged:  # Ctrl-C came while rows were written
            raise KeyboardInterrupt
        flush()


def _time_name(unit: str) -> str:
    """The name of the column of times, with their unit."""
    return f"time [{unit}]" if unit else "time"


def _durations(path: Path, rows: RunRows) -> NDArray[np.timedelta64]:
    """The times of rows whose ticks are whole nanoseconds."""
    tick = NANOSECONDS[rows.unit] // rows.ticks_per_unit
    if rows.end * tick >= 2**63:
        raise UsageError(f"{path}: Parquet has no durations of more than 292 years", "write .csv or .jsonl")
    return np.asarray(rows.times * tick, dtype="timedelta64[ns]")


class _ExactDouble(float):
    """A number that a dump gives with all its digits: pyvcd writes 16, which are not always enough."""

    def __format__(self, spec: str, /) -> str:
        return repr(float(self))


def _rows_of(number: int, trace: Trace) -> RunRows:
    """The rows of one run; each column has the same type for all runs of a model."""
    columns: dict[str, NDArray[Any]] = {}
    for name, values in trace.columns.items():
        if name in trace.texts or (name not in trace.floating and values.dtype.kind != "u"):
            columns[name] = values.astype(np.int64)
        else:
            columns[name] = values.astype(np.bool_) if values.dtype.kind == "u" else values
    run = np.full(trace.rows, number, dtype=np.int64)
    labels = dict.fromkeys(trace.texts, trace.labels)
    return RunRows(run, trace.times, trace.end, trace.ticks_per_unit, trace.unit, columns, labels)


@contextmanager
def _vcd(path: Path) -> Iterator[Writer]:
    written = False

    def write(number: int, trace: Trace) -> None:
        nonlocal written
        if written:
            raise UsageError(
                f"{path}: a value change dump holds one run", f"write {path.stem}-{RUN}.vcd for a file for each run"
            )
        written = True
        with whole_file(path) as part, part.open("w", encoding="ascii", errors="replace") as out:
            _write_vcd(trace, out)

    yield write


def _write_vcd(trace: Trace, out: TextIO) -> None:
    from vcd import VCDWriter

    scale, tick = _vcd_scale(trace)
    comment = f"{trace.name}\n{time_comment(trace.unit)}"
    with VCDWriter(out, timescale=scale, date="", comment=comment) as dump:
        variables = {}
        columns = dict(_columns(trace))
        for name, values in columns.items():
            scope, _, own = name.rpartition(".")
            kind, size = _vcd_kind(trace, name)
            if kind == "real":
                columns[name] = values = list(map(_ExactDouble, values))
            variables[name] = dump.register_var(scope or "model", own, kind, size=size, init=values[0])
        for row, time in enumerate(trace.times.tolist()):
            for name, variable in variables.items():
                dump.change(variable, int(time * tick), columns[name][row])
        dump.close(int(trace.end * tick))


def _vcd_scale(trace: Trace) -> tuple[str, Fraction]:
    """The unit of a dump, and how many of these are a tick: a coarser one where a run is too long."""
    scale, numerator, denominator = _VCD_TIMES[trace.unit or "s"]
    tick = Fraction(numerator * 10**9, denominator * trace.ticks_per_unit)
    number = _VCD_SCALES.index(scale)
    while trace.end * tick > LARGEST_TICK and number + 1 < len(_VCD_SCALES):
        number, tick = number + 1, tick / 10
    return _VCD_SCALES[number], tick


def _vcd_kind(trace: Trace, name: str) -> tuple[str, int]:
    """The type of the values of a column in a dump, and their number of bits."""
    values = trace.columns[name]
    if name in trace.texts:
        return "string", 32
    if values.dtype.kind == "u":
        return "wire", 1
    whole = bool((values == values.round()).all()) and bool((np.abs(values) < 2**31).all())
    return ("integer", 32) if whole else ("real", 64)


def _columns(trace: Trace, rows: slice = slice(None)) -> Iterator[tuple[str, list[Any]]]:
    """The values of each column as Python has them."""
    for name, column in trace.columns.items():
        values = column[rows]
        if name in trace.texts:
            yield name, [trace.labels[place] for place in values.astype(int).tolist()]
        elif values.dtype.kind == "u":
            yield name, values.astype(bool).tolist()
        else:
            yield name, [int(value) if value == int(value) else value for value in values.tolist()]


def _rows(trace: Trace) -> Iterator[Row]:
    for first in range(0, trace.rows, _ROWS_AT_ONCE):
        rows = slice(first, first + _ROWS_AT_ONCE)
        times = [decimal_time(time, trace.ticks_per_unit) for time in trace.times[rows].tolist()]
        columns: Mapping[str, list[Any]] = dict(_columns(trace, rows))
        values = map(list, zip(*columns.values(), strict=True)) if columns else ([] for _ in times)
        yield from zip(times, values, strict=True)


def decimal_time(ticks: int, per_unit: int) -> str:
    """Exact: ``per_unit`` is a power of ten."""
    whole, rest = divmod(ticks, per_unit)
    return f"{whole}.{str(per_unit + rest)[1:]}".rstrip("0").rstrip(".")


def _cell(value: Any) -> str:
    match value:
        case bool():
            return "1" if value else "0"
        case str():
            return _quoted(value)
        case _:
            return str(value)


def _quoted(text: str) -> str:
    return '"' + text.replace('"', '""') + '"' if any(c in text for c in ',"\n') else text
