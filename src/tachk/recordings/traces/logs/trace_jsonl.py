"""Traces as JSON lines: one object a line, with a time and the values that change then.

A value that an object does not name, or that is null, stays. Objects within objects are named with dots (``pose.x``),
elements of arrays with their number (``range[0]``).
"""

from __future__ import annotations

import codecs
import json
import re
import sys
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field, replace
from fractions import Fraction
from itertools import pairwise
from math import isinf
from pathlib import Path
from typing import Any, Final

import numpy as np

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError, UsageError
from tachk.base.job import check_job
from tachk.base.span import Source, Span
from tachk.model.quantity import shortened
from tachk.recordings.traces.arrivals import belongs, topic_of
from tachk.recordings.traces.compressed import open_bytes, torn
from tachk.recordings.traces.csv_beginning import ByteStream
from tachk.recordings.traces.decimal_times import USUAL_DECIMALS, is_binary, rounded, separated, shortest
from tachk.recordings.traces.location_names import location_names, locations_in
from tachk.recordings.traces.logs.dates import is_date, seconds_of
from tachk.recordings.traces.logs.json_table import JsonTable, merged_times, read_table
from tachk.recordings.traces.logs.sparse import sparse
from tachk.recordings.traces.trace import SHORTENING_NOTE, Trace, cut_off_warning, rounding_note
from tachk.recordings.traces.trace_csv import Rows
from tachk.recordings.traces.trace_header import TIME_NAMES, agreed_unit, known_unit, name_and_unit

LARGEST_NUMBER: Final = int(sys.float_info.max)
LARGEST_TIME: Final = 2**62
"""In ticks."""


_UNIT: Final = re.compile(r"(?<=[^\s.])[ \t]+(\[[^\[\]()]*\]|\([^\[\]()]*\))(?=$|[.\[])")
"""A unit behind the name of a value, of an object or of a list in a flat name, see `trace_header.name_and_unit`."""


class _Number(str):
    """A decimal number as it is written; times are exact."""

    __slots__ = ()


@dataclass(frozen=True, slots=True)
class _Event:
    """Attributes:
    unit: of the time, where the line says it.
    dated: the time is a date.
    binary: the time was a binary number, by the digits that it is written with.
    shortest: see `decimal_times.shortest`; and whether that was a binary number.
    """

    time: Fraction
    unit: str
    dated: bool
    binary: bool
    shortest: tuple[Fraction, bool] | None
    values: Mapping[str, Any]


@dataclass(frozen=True, slots=True, eq=False)
class JsonRecording:
    """Lines that have been read.

    Attributes:
        warnings: as of a `Trace`.
        decimals: times are rounded to so many; None: only those that were binary numbers are rounded.
    """

    name: str
    unit: str
    events: Sequence[_Event] = field(repr=False)
    warnings: tuple[str, ...] = ()
    decimals: int | None = None

    @property
    def columns(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(column for event in self.events for column in event.values))

    def read(self, columns: Collection[str] | None = None) -> Trace:
        written = [event.time for event in self.events]
        short = [event.shortest for event in self.events if event.shortest is not None]
        if len(short) < len(written):  # some cannot have been printed from floating-point numbers, so none was
            short = [(event.time, event.binary) for event in self.events]
        times = [time for time, _ in short]
        notes = (SHORTENING_NOTE,) if times != written else ()
        if self.decimals is not None:
            exact, times = times, [rounded(time, self.decimals) for time in times]
            if times != exact:
                notes = (rounding_note(self.decimals),)
            if any(a == b and c != d for (a, b), (c, d) in zip(pairwise(times), pairwise(exact), strict=True)):
                raise self._merged(exact)
        else:
            counted = separated(times, [binary for _, binary in short])
            if counted is None:
                raise self._merged(times)
            times, decimals = counted
            notes = notes if decimals is None else (rounding_note(decimals),)
        events = [(time, event.values) for time, event in zip(times, self.events, strict=True)]
        trace = sparse(self.name, self.unit, events, dated=all(event.dated for event in self.events)).read(columns)
        return replace(trace, notes=notes, warnings=self.warnings)

    def _merged(self, times: Sequence[Fraction]) -> UsageError:
        closest = min((after - before for before, after in pairwise(times) if after > before), default=Fraction(0))
        return merged_times(self.name, closest)


def open_jsonl(path: Path, time: str | None, unit: str | None) -> JsonRecording | JsonTable:
    """Reads a file. Raises InputError and UsageError."""
    try:
        table = read_as_table(path, time, unit) if path.is_file() else None  # a pipe can be read once
        return table or read_as_events(path, time, unit)
    except FileNotFoundError:
        raise UsageError(f"there is no file {path}") from None
    except OSError as error:
        raise UsageError(f"{path} cannot be read: {error.strerror or error}") from None


def read_as_table(path: Path, time: str | None, unit: str | None) -> JsonTable | None:
    """The file as columns; None where it has something unusual, or several runs.

    Raises InputError and UsageError about its first line, and OSError.
    """
    beginning = JsonLines(str(path), time)
    with open_bytes(path) as stream:
        first = next(beginning.events(stream), None)
    if first is None:
        return None
    known = agreed_unit(first.unit, unit, str(path))
    with open_bytes(path) as stream:
        table = read_table(stream, str(path), beginning.key, known, first.dated, _bare)
        why = torn(stream)
    if table is None or "run" in table.columns:
        return None
    return JsonTable(table, _torn_warnings(path, why))


def read_as_events(path: Path, time: str | None, unit: str | None) -> JsonRecording:
    """The file line by line, whatever it holds. Raises InputError, UsageError and OSError."""
    lines = JsonLines(str(path), time)
    with open_bytes(path) as stream:
        events = list(lines.events(stream))
        why = torn(stream)
    if not events:
        raise UsageError(f"{path} has no rows", "the verdict needs at least the state at the beginning")
    known = agreed_unit(events[0].unit, unit, str(path))
    return JsonRecording(str(path), known, events, lines.warnings or _torn_warnings(path, why))


def _torn_warnings(path: Path, why: str | None) -> tuple[str, ...]:
    """The warning about a compressed file that is cut off.

    Args:
        why: it ended; None: it did not.
    """
    if why is None:
        return ()
    return (cut_off_warning(str(path), f"what follows its last whole line is left out ({why})"),)


@dataclass(frozen=True, slots=True, eq=False)
class JsonStream:
    """JSON lines as they come. The columns are those that are requested: later ones are not known."""

    name: str
    stream: ByteStream = field(repr=False)
    time: str | None
    given_unit: str | None
    first: bytes = b""
    decimals: int | None = None

    @property
    def unit(self) -> str:
        if self.given_unit is not None:
            return known_unit(self.given_unit)
        event = next(JsonLines(self.name, self.time).events([self.first]), None)
        return "" if event is None else event.unit

    @property
    def columns(self) -> tuple[str, ...]:
        """The columns of the first line; later lines may have others."""
        return tuple(name for event in JsonLines(self.name, self.time).events([self.first]) for name in event.values)

    @property
    def dates(self) -> bool:
        """The times are dates."""
        return any(event.dated for event in JsonLines(self.name, self.time).events([self.first]))

    def blocks(self, columns: Collection[str] | None, decimals: int) -> Iterator[Rows]:
        """Rows from the first one on at which every column has a value, a few lines at a time."""
        topics = {name: topic for name in columns or () if (topic := topic_of(name)) is not None}
        wanted = tuple(name for name in columns or () if name not in topics)
        held: dict[str, Any] = dict.fromkeys(wanted)
        locations = location_names(wanted)
        last: tuple[Fraction, Fraction] | None = None
        lines = JsonLines(self.name, self.time)
        notes: tuple[str, ...] = ()
        binary, printed = False, True
        for event in lines.events(self._lines()):
            held.update({name: value for name, value in event.values.items() if name in held and value is not None})
            held.update(locations_in(locations, event.values))
            printed = printed and event.shortest is not None
            read, long = (event.shortest if printed else None) or (event.time, event.binary)
            binary = binary or long
            time = self._counted(read, decimals, binary)
            if time != read:
                notes = (rounding_note(USUAL_DECIMALS if self.decimals is None else self.decimals),)
            elif read != event.time and not notes:
                notes = (SHORTENING_NOTE,)
            if last is not None and last[0] != read and last[1] >= time:
                raise UsageError(
                    f"{self.name}: rounded, the times {shortened(last[0])} and {shortened(read)} are the same",
                    "give more --decimals, or write times alike that should be equal",
                )
            last = read, time
            if None in held.values():
                continue
            ticks = np.array([int(time * 10**decimals)], np.int64)
            given = [name for name, value in event.values.items() if value is not None]
            flags = {
                name: np.array([any(belongs(column, topic) for column in given)], np.uint8)
                for name, topic in topics.items()
            }
            yield Rows(ticks, {**{name: _column(held[name]) for name in wanted}, **flags}, decimals, notes)
        if last is None or None in held.values():
            missing = ", ".join(name for name, value in held.items() if value is None)
            raise UsageError(f"{self.name} has no rows", f"no line gives {missing} a value" if missing else None)
        if lines.warnings:
            yield Rows(
                np.array([], np.int64), {name: np.array([]) for name in columns or ()}, decimals, notes, lines.warnings
            )

    def _counted(self, read: Fraction, decimals: int, binary: bool) -> Fraction:
        """The time as it is counted, where times are binary numbers or not. Raises UsageError where it cannot be."""
        if self.decimals is not None:
            return rounded(read, decimals)
        time = rounded(read, USUAL_DECIMALS) if binary else read
        ticks = time * 10**decimals
        if ticks.denominator != 1:
            raise UsageError(
                f"{self.name}: the time {shortened(read)} has too many digits to be counted exactly",
                f"row by row, the number of decimals is fixed beforehand, here --decimals {decimals}",
            )
        if abs(ticks) > LARGEST_TIME:
            raise UsageError(
                f"{self.name}: the time {shortened(read)} is too large to be counted in units of 1e-{decimals}",
                "allow fewer --decimals",
            )
        return time

    def _lines(self) -> Iterator[bytes]:
        with closing(self.stream):
            if self.first:
                yield self.first
            while line := self.stream.readline():
                yield line


def _column(value: Any) -> Any:
    if isinstance(value, str):
        return np.array([value], dtype=object)
    return np.array([value], np.uint8 if isinstance(value, bool) else np.float64)


class JsonLines:
    """Reads lines.

    Attributes:
        warnings: as of a `Trace`: that the last line, which has no line break, is half written and left out.
    """

    def __init__(self, name: str, time: str | None) -> None:
        self._name = name
        self._key = time
        self._unit = ""
        self._known = False
        self.warnings: tuple[str, ...] = ()

    @property
    def key(self) -> str:
        """The name of the time, once a line has been read."""
        return self._key or ""

    def events(self, lines: Iterable[bytes]) -> Iterator[_Event]:
        """Raises InputError for the first line that cannot be read."""
        before: Fraction | None = None
        last_run: Any = None
        for number, line in enumerate(lines, 1):
            check_job()
            if number == 1:
                line = line.removeprefix(codecs.BOM_UTF8)
            if not line.strip():
                continue
            text = line.decode("utf-8", "replace").rstrip("\r\n")
            place = Span(Source(self._name, text, first_line=number), 0, len(text))
            try:
                given = _object(text, place)
            except InputError:
                if before is None or line.endswith(b"\n") or not line.lstrip().startswith(b"{"):
                    raise
                what = f"line {number}, which is half written, is left out"
                self.warnings = (cut_off_warning(self._name, what),)
                return
            event = self._event(given, place)
            run = event.values.get("run")
            if run != last_run:  # each run of a simulation begins at 0
                before, last_run = None, run
            if before is not None and event.time < before:
                raise _wrong(place, "this time lies before that of the line above", "sort the lines by time", "E0913")
            before = event.time
            yield event

    def _event(self, given: dict[str, Any], place: Span) -> _Event:
        if not self._known:
            self._choose(given)
        if self._key is None or self._key not in given:
            wanted = f"no {self._key!r}" if self._key else f"none of {', '.join(TIME_NAMES)}"
            raise _wrong(place, f"this line has {wanted}", "say which value is the time with --time NAME")
        written = given.pop(self._key)
        instant, dated = _time(written, place)
        unit = agreed_unit("s" if dated else "", self._unit or None, self._name)
        binary = isinstance(written, str) and not dated and is_binary(written)
        values = {_bare(column): _value(value, column, place) for column, value in given.items()}
        if len(values) < len(given) or _bare(self._key) in values:
            names = Counter(map(_bare, (self._key, *given)))
            twice = next(name for name, count in names.items() if count > 1)
            raise _wrong(place, f"this line has two values {twice!r}", "rename one of them")
        short = shortest(written, instant) if isinstance(written, str) and not dated else (instant, False)
        return _Event(instant, unit, dated, binary, short, values)

    def _choose(self, given: Mapping[str, Any]) -> None:
        """Chooses the value of lines that is the time, and its unit, as in ``time [ms]``."""
        parts = {each: (each, "") for each in given}, {each: name_and_unit(each) for each in given}
        for names in parts:  # a name without a unit comes first
            for want in TIME_NAMES if self._key is None else (self._key,):
                for each, (name, unit) in names.items():
                    if want == (name.lower() if self._key is None else name):
                        self._key, self._unit, self._known = each, known_unit(unit), True
                        return


def _object(text: str, place: Span) -> dict[str, Any]:
    try:
        read = json.loads(text, parse_float=_Number, parse_constant=lambda word: _constant(word))
    except RecursionError:
        raise _wrong(place, "this line is nested too deeply", None) from None
    except ValueError as error:
        if "digits" in str(error) and len(text) > sys.get_int_max_str_digits() > 0:
            raise _wrong(place, "this line has a number of too many digits", "numbers have up to 308 digits") from None
        raise _wrong(
            place, f"this line is not JSON: {error}", 'each line is an object: {"time": 0.5, "speed": 3}'
        ) from None
    if not isinstance(read, dict):
        raise _wrong(place, "this line is not an object", 'each line is an object: {"time": 0.5, "speed": 3}')
    flat: dict[str, Any] = {}
    _flatten(read, "", flat)
    return flat


def _constant(word: str) -> float | None:
    return None if word == "NaN" else float(word.replace("Infinity", "inf"))


def _flatten(value: Any, name: str, flat: dict[str, Any]) -> None:
    match value:
        case dict():
            for key, inner in value.items():
                _flatten(inner, f"{name}.{key}" if name else str(key), flat)
        case list():
            for number, inner in enumerate(value):
                _flatten(inner, f"{name}[{number}]", flat)
        case _:
            flat[name] = value


def _bare(column: str) -> str:
    """The name without units: ``speeds [m/s][0]`` is ``speeds[0]``."""
    return _UNIT.sub("", column) if " " in column or "\t" in column else column


def _value(value: Any, column: str, place: Span) -> Any:
    if isinstance(value, _Number):
        number = float(value)
        if isinf(number):
            raise _wrong(place, f"the value of column {column!r} is too large", "at most about 1.8e308; or Infinity")
        return number
    if isinstance(value, int) and abs(value) > LARGEST_NUMBER:
        raise _wrong(place, f"the value of column {column!r} is too large", "at most about 1.8e308; or Infinity")
    return value


def _time(value: Any, place: Span) -> tuple[Fraction, bool]:
    """A time, and whether it is a date, of which seconds since 1970 are counted."""
    if isinstance(value, bool):
        raise _wrong(place, "the time is not a number", None)
    if isinstance(value, (int, str)):
        try:
            return seconds_of(str(value)), is_date(str(value))
        except ValueError:
            pass
    raise _wrong(place, f"the time {value!r} is neither a number nor a date", "such as 2026-03-01T12:00:00.25Z")


def _wrong(place: Span, message: str, help: str | None, code: str = "E0911") -> InputError:
    return InputError([Diagnostic(code, message, place, help)])
