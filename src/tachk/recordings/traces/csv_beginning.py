"""The first lines of comma-separated values: columns, separators of cells, form of numbers."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError, UsageError
from tachk.base.span import Source, Span
from tachk.recordings.traces.logs.dates import is_date
from tachk.recordings.traces.trace_header import TraceHeader, agreed_unit, read_header

SEPARATORS = ",;\t"
"""The separators of cells: the one that the header has most of, unless a line above it names one."""

_LONGEST_HEADER = 1 << 24
_SAMPLE = 1 << 16
"""Bytes behind the header that show how numbers are written."""

_DECLARED_SEPARATOR = re.compile(r"\"?sep=(?P<separator>[,;\t]|\\t)\"?[,;\t]*", re.IGNORECASE)
"""A line above the header by which spreadsheets declare the separator; some quote it, or write it into the first cell
of a row."""

_WITH_COMMA = re.compile(r"[-+]?\d+,\d+(e[-+]?\d+)?", re.IGNORECASE)
_WITH_POINT = re.compile(r"[-+]?\d*\.\d+(e[-+]?\d+)?", re.IGNORECASE)
_THOUSANDS = re.compile(r"[-+]?[1-9]\d{0,2}(,\d{3})+")

_ENDS_OF_LINES = "end lines with a line feed, and put names with other control characters between double quotes"


_SAMPLE_LINES = 100
"""Lines that show which columns hold numbers."""

_BINARY = {
    b"\x1f\x8b": "compressed by gzip",
    b"\x28\xb5\x2f\xfd": "compressed by Zstandard",
    b"PAR1": "a Parquet file",
    b"\x89MCAP": "an MCAP file",
    b"\x89HDF": "an HDF5 file",
    b"MDF ": "an MDF file",
    b"SQLite": "a database of SQLite",
    **dict.fromkeys((b"\xd4\xc3\xb2\xa1", b"\xa1\xb2\xc3\xd4", b"\x0a\x0d\x0d\x0a"), "a capture of packets"),
    **dict.fromkeys((b"\x4d\x3c\xb2\xa1", b"\xa1\xb2\x3c\x4d"), "a capture of packets"),
}
"""The kind of a file by the bytes at its beginning."""

_MISSING = ("", "nan", "na", "null")


class ByteStream(Protocol):
    """The interface of a file or pipe that is read; `io.BufferedReader` has it."""

    def readline(self, size: int = -1, /) -> bytes: ...
    def read1(self, size: int = -1, /) -> bytes:
        """The bytes that are there already; waits for some if there are none; empty at the end."""
        ...

    def close(self) -> None: ...


@dataclass(frozen=True, slots=True)
class CsvBeginning:
    """Attributes:
    line: the number of the first line behind the header.
    read: what was read behind the header.
    point: what stands before the decimals of numbers, a comma or a point.
    dates: the times are dates.
    worded: the columns whose first cell with a value is not a number.
    """

    header: TraceHeader
    separator: str
    line: int
    read: bytes
    point: str
    dates: bool
    worded: frozenset[str]


def read_beginning(stream: ByteStream, name: str, time: str | None, unit: str | None, waiting: bool) -> CsvBeginning:
    """Reads the header, and some rows.

    Args:
        waiting: the stream may wait for more, so one row has to be enough.

    Raises InputError and UsageError.
    """
    header, separator, line = _header(stream, name, time, unit)
    begin = _first_row(stream)
    row = begin.rstrip(b"\r\n").rpartition(b"\n")[2].decode("utf-8", "replace").replace("\0", "")
    cells = _cells(row, separator)
    dates = header.time < len(cells) and is_date(cells[header.time])
    if dates:
        header = replace(header, unit=agreed_unit("s", header.unit or unit, name))
    sample = begin if waiting else begin + stream.read1(_SAMPLE)
    point = _point(sample, separator)
    return CsvBeginning(header, separator, line, sample, point, dates, _worded(sample, header, separator, point))


def declared_separator(line: str) -> str | None:
    """The separator of cells that the first line of a file declares for spreadsheets; None: it is another line."""
    declared = _DECLARED_SEPARATOR.fullmatch(line.strip(" "))
    return None if declared is None else declared["separator"].replace("\\t", "\t")


def _first_row(stream: ByteStream) -> bytes:
    """The lines up to the first row, included."""
    lines = b""
    while line := stream.readline(_LONGEST_HEADER):
        lines += line
        if line.strip() and not line.lstrip().startswith(b"#"):
            break
    return lines


def _cells(row: str, separator: str) -> Sequence[str]:
    try:
        return next(csv.reader([row], delimiter=separator, skipinitialspace=True), [])
    except csv.Error:  # the reader of the row reports it
        return ()


def _point(sample: bytes, separator: str) -> str:
    """A comma where it cannot be anything else: it separates no cells, some number can be read with a decimal comma
    only, and none has a decimal point."""
    if separator == "," or b"," not in sample:
        return "."
    lines = sample.decode("utf-8", "replace").splitlines()
    cells = [cell.strip().strip('"') for line in lines if not line.startswith("#") for cell in line.split(separator)]
    commas = [cell for cell in cells if _WITH_COMMA.fullmatch(cell)]
    if all(_THOUSANDS.fullmatch(cell) for cell in commas) or any(_WITH_POINT.fullmatch(cell) for cell in cells):
        return "."
    return ","


def _worded(sample: bytes, header: TraceHeader, separator: str, point: str) -> frozenset[str]:
    left = dict(enumerate(header.names))
    words = set()
    for line in sample.decode("utf-8", "replace").splitlines()[:_SAMPLE_LINES]:
        for place, cell in enumerate(() if line.startswith("#") else _cells(line.replace("\0", ""), separator)):
            text = cell.strip().lower()
            if place in left and text not in _MISSING:
                name = left.pop(place)
                if text not in ("true", "false") and not _is_number(text.replace(point, ".")):
                    words.add(name)
        if not left:
            break
    return frozenset(words)


def _header(stream: ByteStream, name: str, time: str | None, unit: str | None) -> tuple[TraceHeader, str, int]:
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
            raise _no_text(name, line) from None
        if number == 1 and (declared := declared_separator(text)) is not None:
            continue
        if text.strip() and not text.lstrip().startswith("#"):
            break
    if text.lstrip("\ufeff ").startswith(("{", "[{")):
        raise UsageError(
            f"{name} has JSON where the names of columns should be",
            "JSON lines have one object a line, and their files end with .jsonl",
        )
    if "\0" in text:
        raise UsageError(f"{name} is not a text file", "text in UTF-8, VCD and Parquet files can be read")
    separator = declared if declared is not None else max(SEPARATORS, key=text.count)
    try:
        cells = next(csv.reader([text], delimiter=separator))
    except csv.Error:
        raise UsageError(f"the names of the columns of {name} cannot be read", _ENDS_OF_LINES) from None
    if all(_is_number(cell) for cell in cells):
        span = Span(Source(name, text, first_line=number), 0, len(text))
        help = "the first line should name them: time,speed,alarm"
        raise InputError([Diagnostic("E0916", "the columns have no names", span, help)])
    return read_header(cells, time, unit, name), separator, number + 1


def _no_text(name: str, line: bytes) -> UsageError:
    """The error for a file that begins with bytes that are no text."""
    kind = next((kind for begin, kind in _BINARY.items() if line.startswith(begin)), None)
    if kind is None:
        return UsageError(f"{name} is not text in UTF-8", "save it with the encoding UTF-8")
    help_ = "give the file itself, with the ending of its format: CSV, JSON lines and VCD are read from standard input"
    return UsageError(f"{name} is {kind}, not text", help_)


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True
