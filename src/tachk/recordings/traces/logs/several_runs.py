"""Files that hold several runs one after the other, as `tachk simulate --runs` writes them: each is a trace of its own.

A column `run` numbers them. A run begins where that number changes and the time does not go on.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Mapping
from contextlib import closing
from dataclasses import dataclass, replace
from decimal import Decimal, InvalidOperation
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.job import check_job
from tachk.recordings.traces.logs.dates import seconds_of
from tachk.recordings.traces.logs.set_of_runs import SeveralRuns
from tachk.recordings.traces.logs.trace_jsonl import JsonRecording
from tachk.recordings.traces.trace import TraceSource
from tachk.recordings.traces.trace_arrays import TableRecording
from tachk.recordings.traces.trace_csv import CsvRecording
from tachk.recordings.traces.trace_parquet import ParquetRecording

RUN = "run"
"""The column that numbers runs."""

_TAIL = 1 << 16
"""Bytes in which the last line stands."""

Run = tuple[int, int]
"""The first row of a run and the row behind its last one."""


def one_run(recording: TraceSource, run: int | None) -> TraceSource:
    """A recording as `SeveralRuns` if it holds several; with a number one of them. Raises UsageError."""
    if RUN in recording.columns:
        recording = _split(recording)
    if run is None:
        return recording
    if not isinstance(recording, SeveralRuns):
        raise UsageError(f"{recording.name} does not hold several runs", "leave the number of the run out")
    if str(run) not in recording.runs:
        raise UsageError(f"{recording.name} has no run {run}", f"it has {', '.join(list(recording.runs)[:10])}, ...")
    return recording.runs[str(run)]


def _split(recording: TraceSource) -> TraceSource:
    parts: Mapping[str, TraceSource]
    match recording:
        case CsvRecording():
            parts = dict(_csv_runs(recording))
        case JsonRecording():
            rows = [(event.values.get(RUN), event.time) for event in recording.events]
            parts = {
                number: replace(recording, name=_named(recording, number), events=recording.events[first:end])
                for number, (first, end) in _runs(rows).items()
            }
        case ParquetRecording():
            recording = replace(recording, held={})
            parts = {
                number: replace(recording, rows=slice(first, end), called=_named(recording, number))
                for number, (first, end) in _runs(_table_rows(recording.table([RUN]))).items()
            }
        case TableRecording():
            parts = {
                number: replace(
                    recording, name=_named(recording, number), cells=[cells[first:end] for cells in recording.cells]
                )
                for number, (first, end) in _runs(_table_rows(recording)).items()
            }
        case _:
            return recording
    return SeveralRuns(recording.name, parts) if len(parts) > 1 else recording


def _named(recording: TraceSource, number: str) -> str:
    return f"{recording.name}, run {number}"


def _runs(rows: list[tuple[Any, Any]]) -> dict[str, Run]:
    """The runs of a table, as ranges of rows; none where the time goes on although the number changes.

    Args:
        rows: the number of the run and the time of each row.
    """
    places = [row for row, (before, here) in enumerate(pairwise(rows), 1) if before[0] != here[0]]
    try:
        if not rows or any(rows[row][1] > rows[row - 1][1] for row in places):
            return {}
    except (TypeError, InvalidOperation):  # the reader of the times reports the error
        return {}
    edges = [0, *places, len(rows)]
    runs = {str(rows[first][0]): (first, end) for first, end in pairwise(edges)}
    return runs if len(runs) == len(edges) - 1 else {}


def _table_rows(table: TableRecording) -> list[tuple[Any, Any]]:
    place = table.header.names.index(RUN)
    numbers, times = (np.asarray(table.cells[number]).tolist() for number in (place, table.header.time))
    return list(zip(numbers, times, strict=True))


def _csv_runs(recording: CsvRecording) -> Iterator[tuple[str, CsvRecording]]:
    place, clock = recording.header.names.index(RUN), recording.header.time
    if _is_one_run(recording, place):
        return
    lines: list[bytes] = []
    numbers: list[int] = []
    rows: list[tuple[Any, Any]] = []
    with closing(recording.opened()) as stream:
        number = recording.line
        while line := stream.readline():
            check_job()
            cells = [] if line.lstrip().startswith(b"#") else _cells(line, recording.separator)
            if len(cells) > max(place, clock):
                rows.append((cells[place], _time(cells[clock], recording.point)))
                numbers.append(number)
                lines.append(line)
            elif rows and not line.endswith(b"\n"):  # half written: its run reports that
                rows.append(rows[-1])
                numbers.append(number)
                lines.append(line)
            elif line.strip() and not line.lstrip().startswith(b"#"):
                return  # the reader of the file as one trace reports the error
            number += 1
    if any(time is None for _, time in rows):
        return
    for run, (first, end) in _runs(rows).items():
        content = b"".join(lines[first:end])
        name = _named(recording, run)
        yield run, replace(recording, name=name, opened=_BytesOpener(content), line=numbers[first], size=None)


def _is_one_run(recording: CsvRecording, place: int) -> bool:
    """True if the last line of a file is of the same run as the first one: they are counted up."""
    if recording.size is None:
        return False
    with open(recording.name, "rb") as stream:
        stream.seek(max(0, recording.size - _TAIL))
        last = next((line for line in reversed(stream.read().split(b"\n")) if line.strip()), b"")
    with closing(recording.opened()) as begin:
        first = begin.readline()
    numbers = [_cells(line, recording.separator)[place : place + 1] for line in (first, last)]
    return numbers[0] == numbers[1]


@dataclass(frozen=True, slots=True)
class _BytesOpener:
    content: bytes

    def __call__(self) -> io.BytesIO:
        return io.BytesIO(self.content)


def _cells(line: bytes, separator: str) -> list[str]:
    text = line.decode("utf-8", "replace").rstrip("\r\n").replace("\0", "")
    if '"' not in text:
        return [cell.strip() for cell in text.split(separator)]
    try:
        return next(csv.reader([text], delimiter=separator, skipinitialspace=True), [])
    except csv.Error:
        return []


def _time(text: str, point: str) -> Decimal | Fraction | None:
    try:
        return Decimal(text.replace(point, "."))
    except InvalidOperation:
        pass
    try:
        return seconds_of(text)
    except ValueError:
        return None
