"""Traces in files of comma-separated values; the rows are read by the core."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, field, replace
from fractions import Fraction
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from tachk import _core
from tachk._core import CsvFaultKind
from tachk.diagnostics.diagnostic import Diagnostic, InputError, UsageError
from tachk.diagnostics.span import Source, Span
from tachk.runtime.logs.dates import is_date
from tachk.runtime.logs.labels import Labels
from tachk.runtime.trace import LARGEST_TICK, Ticks, Trace, Values
from tachk.runtime.trace_header import Header, agreed_unit, read_header
from tachk.time_limit import check_time

PIECE = 1 << 20
"""Bytes that are read at a time."""

_SEPARATORS = ",;\t"
_LONGEST_HEADER = 1 << 24
_DECIMAL_COMMA = re.compile(r"\s*[-+]?\d+,\d+\s*")
_DATE = re.compile(r"\s*\d+[-/.:]\d+[-/.:]\d+")


class ByteStream(Protocol):
    """What is asked of a file or pipe; `io.BufferedReader` has it."""

    def readline(self, size: int = -1, /) -> bytes: ...
    def read1(self, size: int = -1, /) -> bytes:
        """What is there already, or waits for something; empty at the end."""
        ...

    def close(self) -> None: ...


@dataclass(frozen=True, slots=True, eq=False)
class Rows:
    """Some rows of a recording.

    Attributes:
        times: as the clock of the recording shows them, in units of ``10 ** -decimals``.
        columns: numbers or truth values; of columns of texts the texts.
    """

    times: Ticks
    columns: dict[str, Any]
    decimals: int


@dataclass(frozen=True, slots=True, eq=False)
class CsvRecording:
    """A file or stream whose header has been read.

    Attributes:
        opened: gives the stream, standing behind the header; of a pipe it can be used once.
        line: the number of the first line behind the header.
        size: bytes of the whole, where that is known.
        dates: the times are dates.
        texts: the columns whose cells are texts.
    """

    name: str
    opened: Callable[[], ByteStream] = field(repr=False)
    header: Header
    separator: str
    line: int
    size: int | None = None
    dates: bool = False
    texts: frozenset[str] = frozenset()

    @property
    def unit(self) -> str:
        return self.header.unit

    @property
    def columns(self) -> tuple[str, ...]:
        return self.header.columns

    def read(self, columns: Collection[str] | None = None) -> Trace:
        """The whole trace; it begins with its first row and ends with its last one."""
        places = self.header.numbers(columns, self.name)
        reader = self._reader(places, decimals=0, most_decimals=18)
        with closing(self.opened()) as stream:
            read = 0
            while piece := stream.read1(PIECE):
                check_time()
                if not reader.feed(piece):
                    break
                if read == 0 and self.size is not None and self.size > len(piece):
                    reader.reserve(int(1.05 * self.size * reader.rows() / len(piece)) + 1)
                read += len(piece)
        reader.finish()
        self._refuse(reader, "at most 18 digits in all, those behind the point included")
        times, cells, labels = reader.take()
        if len(times) == 0:
            raise UsageError(f"{self.name} has no rows", "the verdict needs at least the state at the beginning")
        first, last = int(times[0]), int(times[-1])
        if last - first > LARGEST_TICK:
            raise UsageError(f"{self.name} is too long to be counted in units of 1e-{reader.decimals()}")
        scale = 10 ** reader.decimals()
        np.subtract(times, first, out=times)
        texts = Labels()
        held: dict[str, Values] = {
            name: texts.recoded(values, _decoded(words), name) if name in self.texts else values
            for name, values, words in zip(places, cells, labels, strict=True)
        }
        return texts.on(
            Trace(self.name, times, held, last - first, scale, self.unit, Fraction(first, scale), dated=self.dates)
        )

    def blocks(self, columns: Collection[str] | None, decimals: int) -> Iterator[Rows]:
        """The rows as they come, never more in memory than one piece of the stream.

        Args:
            decimals: of the times; a row with a finer time is refused, for what was handed out cannot be recounted.
        """
        places = self.header.numbers(columns, self.name)
        reader = self._reader(places, decimals, decimals)
        with closing(self.opened()) as stream:
            while piece := stream.read1(PIECE):
                check_time()
                going_on = reader.feed(piece)
                if reader.rows():
                    yield self._taken(reader, places)
                if not going_on:
                    break
        reader.finish()
        if reader.rows():
            yield self._taken(reader, places)
        self._refuse(reader, f"row by row, the number of decimals is fixed beforehand, here --decimals {decimals}")

    def _reader(self, places: dict[str, int], decimals: int, most_decimals: int) -> _core.CsvReader:
        return _core.CsvReader(
            separator=self.separator,
            cells=len(self.header.names),
            time=self.header.time,
            columns=list(places.values()),
            texts=[place for name, place in places.items() if name in self.texts],
            dates=self.dates,
            first_line=self.line,
            decimals=decimals,
            most_decimals=most_decimals,
        )

    def _taken(self, reader: _core.CsvReader, places: dict[str, int]) -> Rows:
        times, columns, labels = reader.take()
        held: dict[str, Any] = dict(zip(places, columns, strict=True))
        for name, words in zip(places, labels, strict=True):
            if name in self.texts:
                held[name] = np.array(_decoded(words), dtype=object)[held[name].astype(np.int64)]
        return Rows(times, held, reader.decimals())

    def _refuse(self, reader: _core.CsvReader, finest: str) -> None:
        """Raises InputError for what the reader stopped at.

        Args:
            finest: how finely times can be counted.
        """
        fault = reader.fault()
        if fault is not None:
            kind, line, offset, length, cell, text = fault
            raise self._error(kind, line, offset, length, cell, text, finest)

    def _error(
        self, kind: CsvFaultKind, line: int, offset: int, length: int, cell: int, text: bytes, finest: str
    ) -> InputError:
        start = len(text[:offset].decode("utf-8", "replace"))
        value = text[offset : offset + length].decode("utf-8", "replace")
        source = Source(self.name, text.decode("utf-8", "replace"), first_line=line)
        span = Span(source, start, min(start + max(len(value), 1), max(len(source.text), start)))
        code, message, help_ = _told(
            kind, value, self.header.names[cell], cell == self.header.time, (cell + 1, len(self.header.names)), finest
        )
        return InputError([Diagnostic(code, message, span, help_)])


def _told(
    kind: CsvFaultKind, value: str, column: str, is_time: bool, cells: tuple[int, int], finest: str
) -> tuple[str, str, str | None]:
    """The code of a fault, what it is, and how to mend it.

    Args:
        value: of the cell of this column.
        cells: of the row, and of the header.
        finest: what helps against a time that is too fine.
    """
    told: dict[CsvFaultKind, tuple[str, str, str | None]] = {
        CsvFaultKind.NOT_A_NUMBER: (
            "E0911",
            f"{value!r} in column {column!r} is not a number",
            _advice_on_a_cell(value, is_time),
        ),
        CsvFaultKind.NOT_FINITE: (
            "E0911",
            f"the value {value!r} of column {column!r} is not finite",
            "leave the cell empty where the value stays",
        ),
        CsvFaultKind.MIXED_COLUMN: (
            "E0911",
            f"column {column!r} has truth values and the number {value!r}",
            "a column holds either numbers, or true and false (or 1 and 0)",
        ),
        CsvFaultKind.MISSING_VALUE: (
            "E0912",
            f"column {column!r} has no value in the first row",
            "an empty cell means that the value stays, so the first row has to give one",
        ),
        CsvFaultKind.MISSING_TIME: ("E0912", "this row has no time", None),
        CsvFaultKind.DECREASING_TIME: (
            "E0913",
            f"the time {value} lies before that of the row above",
            "sort the rows by time; of several rows with the same time, the last one counts",
        ),
        CsvFaultKind.TOO_FEW_CELLS: ("E0914", f"this row has {cells[0]} cells, the header has {cells[1]}", None),
        CsvFaultKind.TOO_MANY_CELLS: ("E0914", f"this row has more cells than the {cells[1]} of the header", None),
        CsvFaultKind.TIME_TOO_LARGE: (
            "E0915",
            f"the time {value} is too large to be counted as finely as the trace needs",
            "at most 18 digits in all, those behind the point included",
        ),
        CsvFaultKind.TIME_TOO_FINE: ("E0915", f"the time {value} has too many digits to be counted exactly", finest),
        CsvFaultKind.OPEN_QUOTE: ("E0911", "this quotation mark is not closed in its line", None),
        CsvFaultKind.LINE_TOO_LONG: ("E0911", "this line has more than 16 million characters", "is it a text file?"),
    }
    return told[kind]


def _advice_on_a_cell(value: str, is_time: bool) -> str:
    if _DECIMAL_COMMA.fullmatch(value):
        return f"numbers have a decimal point: {value.strip().replace(',', '.')}"
    if is_time and _DATE.match(value):
        return "dates are written as 2026-03-01T12:00:00.25Z, and then all times are dates"
    if is_time:
        return "times are numbers such as 0.25 or 2e3"
    return "cells hold numbers such as -1.5 or 2e3, true or false, or nothing where the value stays"


def open_csv(path: str | Path, time: str | None = None, unit: str | None = None) -> CsvRecording:
    """Opens a file and reads its header. Raises InputError and UsageError."""
    file = Path(path)

    def opened() -> ByteStream:
        stream = file.open("rb")
        stream.seek(offset)
        return stream

    try:
        with file.open("rb") as stream:
            header, separator, line = _header(stream, str(path), time, unit)
            offset = stream.tell()
            size = file.stat().st_size
            header, dates = _with_dates(header, separator, _first_row(stream), unit, str(path))
    except FileNotFoundError:
        raise UsageError(f"there is no file {path}") from None
    except OSError as error:
        raise UsageError(f"{path} cannot be read: {error.strerror or error}") from None
    return CsvRecording(str(path), opened, header, separator, line, size, dates)


def open_csv_stream(stream: ByteStream, name: str, time: str | None = None, unit: str | None = None) -> CsvRecording:
    """Reads the header of a stream, which can be read once. Raises InputError and UsageError."""
    header, separator, line = _header(stream, name, time, unit)
    begin = _first_row(stream)
    header, dates = _with_dates(header, separator, begin, unit, name)
    return CsvRecording(name, lambda: PushedBack(stream, begin), header, separator, line, None, dates)


class PushedBack:
    """A stream some of which has been read already, and is read again."""

    def __init__(self, stream: ByteStream, first: bytes) -> None:
        self._stream = stream
        self._first = first

    def readline(self, size: int = -1, /) -> bytes:
        if not self._first:
            return self._stream.readline(size)
        line, end, self._first = self._first.partition(b"\n")
        return line + end

    def read1(self, size: int = -1, /) -> bytes:
        piece, self._first = self._first, b""
        return piece or self._stream.read1(size)

    def close(self) -> None:
        self._stream.close()


def _first_row(stream: ByteStream) -> bytes:
    """The lines up to the first row, included."""
    lines = b""
    while line := stream.readline(_LONGEST_HEADER):
        lines += line
        if line.strip() and not line.lstrip().startswith(b"#"):
            break
    return lines


def _with_dates(header: Header, separator: str, begin: bytes, unit: str | None, name: str) -> tuple[Header, bool]:
    """The header with the unit of its times, and whether these are dates, which count seconds since 1970.

    Args:
        begin: lines up to the first row, included.
    """
    row = begin.rstrip(b"\r\n").rpartition(b"\n")[2].decode("utf-8", "replace").replace("\0", "")
    cells = next(csv.reader([row], delimiter=separator, skipinitialspace=True), [])
    if header.time >= len(cells) or not is_date(cells[header.time]):
        return header, False
    return replace(header, unit=agreed_unit("s", header.unit or unit, name)), True


def _decoded(words: Sequence[bytes]) -> tuple[str, ...]:
    return tuple(word.decode("utf-8", "replace") for word in words)


_ENDS_OF_LINES = "end lines with a line feed, and put names with other control characters between double quotes"


def _header(stream: ByteStream, name: str, time: str | None, unit: str | None) -> tuple[Header, str, int]:
    """The header, the separator, and the number of the line behind."""
    number = 0
    while True:
        line = stream.readline(_LONGEST_HEADER)
        number += 1
        if not line:
            raise UsageError(f"{name} is empty", "its first line should name the columns: time,speed,alarm")
        try:
            text = line.decode("utf-8-sig" if number == 1 else "utf-8").strip("\r\n")
        except UnicodeDecodeError:
            raise UsageError(f"{name} is not text in UTF-8", "save it with the encoding UTF-8") from None
        if text.strip() and not text.lstrip().startswith("#"):
            break
    if "\0" in text:
        raise UsageError(f"{name} is not a text file", "text in UTF-8, VCD and Parquet files can be read")
    separator = max(_SEPARATORS, key=text.count)
    try:
        cells = next(csv.reader([text], delimiter=separator))
    except csv.Error:
        raise UsageError(f"the names of the columns of {name} cannot be read", _ENDS_OF_LINES) from None
    if all(_is_number(cell) for cell in cells):
        span = Span(Source(name, text, first_line=number), 0, len(text))
        raise InputError(
            [
                Diagnostic(
                    "E0916", "the columns have no names", span, "the first line should name them: time,speed,alarm"
                )
            ]
        )
    return read_header(cells, time, unit, name), separator, number + 1


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True
