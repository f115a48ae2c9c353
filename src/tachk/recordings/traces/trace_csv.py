"""Traces in files of comma-separated values; the rows are read by the core."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, field, replace
from fractions import Fraction
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from tachk import _core
from tachk._core import CsvFaultKind
from tachk.base.diagnostics.diagnostic import Diagnostic, InputError, UsageError
from tachk.base.job import check_job
from tachk.base.span import Source, Span
from tachk.recordings.traces.arrivals import arriving
from tachk.recordings.traces.compressed import is_compressed, open_bytes, torn
from tachk.recordings.traces.csv_beginning import ByteStream, CsvBeginning, read_beginning
from tachk.recordings.traces.csv_faults import FINEST, fault_message, is_half_value
from tachk.recordings.traces.decimal_times import MOST_DECIMALS, USUAL_DECIMALS, fewest_decimals
from tachk.recordings.traces.logs.labels import Labels
from tachk.recordings.traces.trace import (
    SHORTENING_NOTE,
    Ticks,
    Trace,
    Values,
    cut_off_warning,
    later_beginning,
    rounding_note,
)
from tachk.recordings.traces.trace_header import TraceHeader

PIECE = 1 << 20
"""Bytes that are read at a time."""


_LINE_BREAKS = (b"\n", b"\r")


@dataclass(frozen=True, slots=True, eq=False)
class Rows:
    """Some rows of a recording.

    Attributes:
        times: as the clock of the recording shows them, in units of ``10 ** -decimals``.
        columns: numbers or truth values; of columns of texts the texts.
        notes, warnings: as of a `Trace`, as far as they are known.
    """

    times: Ticks
    columns: dict[str, Any]
    decimals: int
    notes: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()


class _ArrivalColumns(NamedTuple):
    """The columns of arrivals with their parts, all parts, and the parts whose values do not matter."""

    arrivals: dict[str, tuple[str, ...]]
    parts: frozenset[str]
    unread: frozenset[str]


class _Read(NamedTuple):
    """A reader that has read all rows.

    Attributes:
        torn: why a compressed file ended before its end.
        open_ended: the last line has no line break.
    """

    reader: _core.CsvReader
    torn: str | None
    open_ended: bool


@dataclass(frozen=True, slots=True, eq=False)
class CsvRecording:
    """A file or stream whose header has been read.

    Attributes:
        opened: gives the stream, standing behind the header; of a pipe it can be used once.
        line: the number of the first line behind the header.
        size: bytes of the whole, where that is known.
        dates: the times are dates.
        texts: the columns whose cells are texts.
        decimals: times are rounded to so many; None: only those that were binary numbers are rounded.
        point: what stands before the decimals of numbers, a comma or a point.
        worded: the columns whose first cells are no numbers.
    """

    name: str
    opened: Callable[[], ByteStream] = field(repr=False)
    header: TraceHeader
    separator: str
    line: int
    size: int | None = None
    dates: bool = False
    texts: frozenset[str] = frozenset()
    decimals: int | None = None
    point: str = "."
    worded: frozenset[str] = frozenset()

    @property
    def unit(self) -> str:
        return self.header.unit

    @property
    def columns(self) -> tuple[str, ...]:
        return self.header.columns

    def read(self, columns: Collection[str] | None = None) -> Trace:
        """The whole trace: from the first row in which every column has a value to the last one."""
        places, arrival_columns = self._places(columns)
        reader, torn, open_ended = self._whole(places, arrival_columns)
        flags = self._flags(reader, places, arrival_columns)
        times, cells, labels = reader.take()
        if len(times) == 0:
            raise UsageError(f"{self.name} has no rows", "the verdict needs at least the state at the beginning")
        first, last = int(times[0]), int(times[-1])
        scale = 10 ** reader.decimals()
        np.subtract(times, first, out=times)
        texts = Labels()
        held: dict[str, Values] = {
            name: texts.recoded(values, _decoded(words), name) if name in self.texts else values
            for name, values, words in zip(places, cells, labels, strict=True)
            if name not in arrival_columns.unread
        }
        held.update(flags)
        trace = Trace(self.name, times, held, last - first, scale, self.unit, Fraction(first, scale), dated=self.dates)
        notes = self._notes(reader, places, open_ended)
        return texts.on(replace(trace, notes=notes, warnings=self._warnings(reader, torn)))

    def _places(self, columns: Collection[str] | None) -> tuple[dict[str, int], _ArrivalColumns]:
        """The cells that are read, and those whose presence is recorded."""
        arrivals = arriving(columns or (), self.columns)
        wanted = None if columns is None else [name for name in columns if name not in arrivals]
        valued = self.header.numbers(wanted, self.name)
        parts = {part for parts in arrivals.values() for part in parts}
        places = self.header.numbers({*valued, *parts}, self.name)
        return places, _ArrivalColumns(arrivals, frozenset(parts), frozenset(parts - valued.keys()))

    def _flags(
        self, reader: _core.CsvReader, places: dict[str, int], arrival_columns: _ArrivalColumns
    ) -> dict[str, Values]:
        """The columns of arrivals: in which rows one of their parts has a value."""
        if not arrival_columns.arrivals:
            return {}
        flags = dict(
            zip((name for name in places if name in arrival_columns.parts), reader.take_arrivals(), strict=True)
        )
        return {
            name: np.bitwise_or.reduce([flags[part] for part in parts])
            for name, parts in arrival_columns.arrivals.items()
        }

    def _whole(self, places: dict[str, int], arrival_columns: _ArrivalColumns) -> _Read:
        """All rows."""
        read = self._shortened(places, arrival_columns, shortening=True)
        if read.reader.shortened() and read.reader.unprinted():
            # Some times cannot have been printed from doubles, so none was.
            read = self._shortened(places, arrival_columns, shortening=False)
        self._refuse(read.reader)
        return read

    def _shortened(self, places: dict[str, int], arrival_columns: _ArrivalColumns, shortening: bool) -> _Read:
        """All rows, up to a fault.

        Args:
            shortening: times as doubles are printed are read as their shortest decimal numbers.
        """
        if self.decimals is not None:
            return self._rows(
                self._reader(places, arrival_columns, self.decimals, self.decimals, shortening=shortening)
            )

        def count(usual: int, binary: bool = False) -> _Read | None:
            read = self._rows(self._reader(places, arrival_columns, 0, MOST_DECIMALS, usual, binary, shortening))
            fault = read.reader.fault()
            merged = fault is not None and fault[0] is CsvFaultKind.TIME_MERGED
            if not binary and read.reader.rounded() and read.reader.decimals() > usual:
                return count(usual, True)  # it did not show at once that the times were binary numbers
            return None if merged and usual < MOST_DECIMALS else read

        read = fewest_decimals(count)
        assert read is not None
        return read

    def _rows(self, reader: _core.CsvReader) -> _Read:
        with closing(self.opened()) as stream:
            done = 0
            open_ended = False
            while piece := stream.read1(PIECE):
                check_job()
                if not reader.feed(piece):
                    break
                if done == 0 and self.size is not None and self.size > len(piece):
                    reader.reserve(int(1.05 * self.size * reader.rows() / len(piece)) + 1)
                done += len(piece)
                open_ended = not piece.endswith(_LINE_BREAKS)
            why = torn(stream)
        reader.finish(whole=why is None)
        return _Read(reader, why, open_ended and why is None)

    def blocks(self, columns: Collection[str] | None, decimals: int) -> Iterator[Rows]:
        """The rows as they come, never more in memory than one piece of the stream.

        Args:
            decimals: of the times; a row with a finer time is refused, for what was handed out cannot be recounted.
        """
        places, arrival_columns = self._places(columns)
        reader = self._reader(places, arrival_columns, decimals, decimals)
        open_ended = False
        with closing(self.opened()) as stream:
            while piece := stream.read1(PIECE):
                check_job()
                going_on = reader.feed(piece)
                open_ended = not piece.endswith(_LINE_BREAKS)
                if reader.rows():
                    yield self._taken(reader, places, arrival_columns)
                if not going_on:
                    break
            why = torn(stream)
        reader.finish(whole=why is None)
        if reader.rows() or self._warnings(reader, why):
            yield self._taken(reader, places, arrival_columns, why, open_ended and why is None)
        self._refuse(reader, f"row by row, the number of decimals is fixed beforehand, here --decimals {decimals}")

    def _reader(
        self,
        places: dict[str, int],
        arrival_columns: _ArrivalColumns,
        decimals: int,
        most_decimals: int,
        usual: int = USUAL_DECIMALS,
        binary: bool = False,
        shortening: bool = True,
    ) -> _core.CsvReader:
        return _core.CsvReader(
            separator=self.separator,
            point=self.point,
            cells=len(self.header.names),
            time=self.header.time,
            columns=list(places.values()),
            texts=[place for name, place in places.items() if name in self.texts],
            arrivals=[place for name, place in places.items() if name in arrival_columns.parts],
            unread=[place for name, place in places.items() if name in arrival_columns.unread],
            dates=self.dates,
            first_line=self.line,
            decimals=decimals,
            most_decimals=most_decimals,
            usual_decimals=usual,
            binary=binary,
            rounding=self.decimals is not None,
            shortening=shortening and not self.dates,
        )

    def _taken(
        self,
        reader: _core.CsvReader,
        places: dict[str, int],
        arrival_columns: _ArrivalColumns,
        torn: str | None = None,
        open_ended: bool = False,
    ) -> Rows:
        flags = self._flags(reader, places, arrival_columns)
        times, columns, labels = reader.take()
        held: dict[str, Any] = {**dict(zip(places, columns, strict=True)), **flags}
        for name, words in zip(places, labels, strict=True):
            if name in self.texts and name not in arrival_columns.unread:
                held[name] = np.array(_decoded(words), dtype=object)[held[name].astype(np.int64)]
        notes = self._notes(reader, places, open_ended)
        return Rows(times, held, reader.decimals(), notes, self._warnings(reader, torn))

    def _notes(self, reader: _core.CsvReader, places: dict[str, int], open_ended: bool) -> tuple[str, ...]:
        notes = []
        if reader.rounded():
            decimals = max(reader.decimals(), USUAL_DECIMALS) if self.decimals is None else self.decimals
            notes.append(rounding_note(decimals))
        elif reader.shortened():
            notes.append(SHORTENING_NOTE)
        if reader.left_out():
            notes.append(later_beginning(reader.left_out()))
        last = len(self.header.names) - 1
        if open_ended and reader.fault() is None and last in (self.header.time, *places.values()):
            name = self.header.names[last]
            notes.append(f"the last line has no line break: if the file is cut off, its {name} may be half written")
        return tuple(notes)

    def _warnings(self, reader: _core.CsvReader, torn: str | None) -> tuple[str, ...]:
        if torn is not None:
            return (cut_off_warning(self.name, f"what follows its last whole line is left out ({torn})"),)
        fault = reader.fault() if self._is_cut_off(reader) else None
        if fault is None:
            return ()
        return (cut_off_warning(self.name, f"line {fault[1]}, which is half written, is left out"),)

    def _is_cut_off(self, reader: _core.CsvReader) -> bool:
        """True if nothing is wrong but that the last line is half written."""
        fault = reader.fault()
        if fault is None or not reader.is_cut_off() or not reader.any_row():
            return False
        kind, _, offset, length, cell, text = fault
        cells = text.count(self.separator.encode()) + 1
        last = cell + 1 == len(self.header.names) and is_half_value(text[offset : offset + length])
        return cells < len(self.header.names) or kind is CsvFaultKind.OPEN_QUOTE or last

    def _refuse(self, reader: _core.CsvReader, finest: str = FINEST) -> None:
        """Raises InputError for what the reader stopped at, but for a last line that is half written.

        Args:
            finest: how finely times can be counted.
        """
        fault = reader.fault()
        if fault is None or self._is_cut_off(reader):
            return
        kind, line, offset, length, cell, text = fault
        if kind is CsvFaultKind.MISSING_VALUE:
            raise UsageError(
                f"{self.name}: column {self.header.names[cell]!r} never has a value",
                "the trace begins with the first row in which every column that a formula reads has one",
            )
        raise self._error(kind, line, offset, length, cell, text, finest)

    def _error(
        self, kind: CsvFaultKind, line: int, offset: int, length: int, cell: int, text: bytes, finest: str
    ) -> InputError:
        start = len(text[:offset].decode("utf-8", "replace"))
        value = text[offset : offset + length].decode("utf-8", "replace")
        source = Source(self.name, text.decode("utf-8", "replace"), first_line=line)
        span = Span(source, start, min(start + max(len(value), 1), max(len(source.text), start)))
        code, message, help_ = fault_message(
            kind.name,
            value,
            self.header.names[cell],
            cell == self.header.time,
            (cell + 1, len(self.header.names)),
            finest,
        )
        return InputError([Diagnostic(code, message, span, help_)])


def open_csv(path: str | Path, time: str | None = None, unit: str | None = None) -> CsvRecording:
    """Opens a file and reads its header. Raises InputError and UsageError."""
    file = Path(path)
    size = None
    try:
        with open_bytes(file) as stream:
            begin = read_beginning(stream, str(path), time, unit, waiting=False)
            if not is_compressed(file):
                size = file.stat().st_size
    except FileNotFoundError:
        raise UsageError(f"there is no file {path}") from None
    except OSError as error:
        raise UsageError(f"{path} cannot be read: {error.strerror or error}") from None
    return _recording(str(path), lambda: _behind_header(file, begin.line), begin, size)


def _behind_header(path: Path, line: int) -> ByteStream:
    stream = open_bytes(path)
    for _ in range(line - 1):
        stream.readline()
    return stream


def open_csv_stream(stream: ByteStream, name: str, time: str | None = None, unit: str | None = None) -> CsvRecording:
    """Reads the header of a stream, which can be read once. Raises InputError and UsageError."""
    begin = read_beginning(stream, name, time, unit, waiting=True)
    return _recording(name, lambda: PushedBack(stream, begin.read), begin, None)


def _recording(name: str, opened: Callable[[], ByteStream], begin: CsvBeginning, size: int | None) -> CsvRecording:
    header, line = begin.header, begin.line
    recording = CsvRecording(name, opened, header, begin.separator, line, size, begin.dates, point=begin.point)
    return replace(recording, worded=begin.worded)


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


def _decoded(words: Sequence[bytes]) -> tuple[str, ...]:
    return tuple(word.decode("utf-8", "replace") for word in words)
