"""Comma-separated values with columns of texts, or with dates as times: whole files, read cell by cell."""

from __future__ import annotations

import csv
import io
from collections.abc import Collection
from contextlib import closing
from dataclasses import dataclass
from typing import Any

import numpy as np

from tachk.diagnostics.diagnostic import Diagnostic, InputError
from tachk.diagnostics.span import Source, Span
from tachk.runtime.logs.dates import seconds_of
from tachk.runtime.trace import Trace
from tachk.runtime.trace_arrays import TableRecording
from tachk.runtime.trace_csv import PIECE, CsvRecording
from tachk.runtime.trace_header import Header
from tachk.time_limit import check_time

_MISSING = ("", "nan", "-nan", "na", "null")
_WORDS = {"true": True, "false": False}


@dataclass(frozen=True, slots=True, eq=False)
class TextCsv:
    """Attributes:
    texts: the columns whose cells are texts.
    """

    recording: CsvRecording
    texts: frozenset[str]

    @property
    def name(self) -> str:
        return self.recording.name

    @property
    def unit(self) -> str:
        return self.recording.unit

    @property
    def columns(self) -> tuple[str, ...]:
        return self.recording.columns

    def read(self, columns: Collection[str] | None = None) -> Trace:
        """The whole trace. Raises InputError for a cell that is no number where one is expected."""
        header = self.recording.header
        places = header.numbers(columns, self.name)
        times: list[Any] = []
        cells: dict[str, list[Any]] = {name: [] for name in places}
        for line, row in self._rows():
            if len(row) != len(header.names):
                raise self._wrong(
                    "E0914", f"this row has {len(row)} cells, the header has {len(header.names)}", line, row
                )
            try:
                times.append(seconds_of(row[header.time]))
            except ValueError:
                raise self._wrong("E0911", f"the time {row[header.time]!r} is no number", line, row) from None
            for name, place in places.items():
                cells[name].append(self._cell(name, row[place].strip(), line, row))
        instants = np.empty(len(times), dtype=object)
        instants[:] = times
        names = ("time", *places)
        return TableRecording(self.name, Header(names, 0, self.unit), (instants, *cells.values())).read(list(places))

    def _rows(self) -> Any:
        with closing(self.recording.opened()) as stream:
            text = b""
            while piece := stream.read1(PIECE):
                check_time()
                text += piece
        lines = text.decode("utf-8", "replace").splitlines()
        for number, line in enumerate(lines, self.recording.line):
            if line.strip() and not line.lstrip().startswith("#"):
                yield (
                    number,
                    next(csv.reader(io.StringIO(line), delimiter=self.recording.separator, skipinitialspace=True)),
                )

    def _cell(self, column: str, cell: str, line: int, row: list[str]) -> Any:
        if column in self.texts:
            return cell or None
        if cell.lower() in _MISSING:
            return None
        if cell.lower() in _WORDS:
            return _WORDS[cell.lower()]
        try:
            return float(cell)
        except ValueError:
            raise self._wrong("E0911", f"{cell!r} in column {column!r} is not a number", line, row) from None

    def _wrong(self, code: str, message: str, line: int, row: list[str]) -> InputError:
        text = self.recording.separator.join(row)
        return InputError([Diagnostic(code, message, Span(Source(self.name, text, first_line=line), 0, len(text)))])
