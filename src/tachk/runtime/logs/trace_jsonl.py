"""Traces as JSON lines: one object a line, with a time and the values that change then.

A value that an object does not name, or that is null, stays. Objects within objects are named with dots (``pose.x``),
elements of arrays with their number (``range[0]``).
"""

from __future__ import annotations

import json
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from tachk.diagnostics.diagnostic import Diagnostic, InputError, UsageError
from tachk.diagnostics.span import Source, Span
from tachk.runtime.logs.dates import is_date, seconds_of
from tachk.runtime.logs.sparse import SparseRecording, sparse
from tachk.runtime.trace_csv import ByteStream, Rows
from tachk.runtime.trace_header import TIME_NAMES, agreed_unit, known_unit
from tachk.time_limit import check_time


class _Number(str):
    """A decimal number as it is written; times are exact."""

    __slots__ = ()


@dataclass(frozen=True, slots=True)
class _Event:
    time: Fraction
    unit: str
    values: Mapping[str, Any]


def open_jsonl(path: Path, time: str | None, unit: str | None) -> SparseRecording:
    """Reads a file. Raises InputError and UsageError."""
    try:
        with path.open("rb") as stream:
            events = list(_events(stream, str(path), time))
    except FileNotFoundError:
        raise UsageError(f"there is no file {path}") from None
    except OSError as error:
        raise UsageError(f"{path} cannot be read: {error.strerror or error}") from None
    if not events:
        raise UsageError(f"{path} has no rows", "the verdict needs at least the state at the beginning")
    known = agreed_unit(events[0].unit, unit, str(path))
    return sparse(str(path), known, [(each.time, each.values) for each in events], dated=all(e.unit for e in events))


@dataclass(frozen=True, slots=True, eq=False)
class JsonStream:
    """JSON lines as they come. The columns are those that somebody asks for: what will come is not known."""

    name: str
    stream: ByteStream = field(repr=False)
    time: str | None
    given_unit: str | None
    first: bytes = b""

    @property
    def unit(self) -> str:
        if self.given_unit is not None:
            return known_unit(self.given_unit)
        event = next(_events([self.first], self.name, self.time), None)
        return "" if event is None else event.unit

    @property
    def columns(self) -> tuple[str, ...]:
        """Those of the first line; later ones may have others."""
        return tuple(column for event in _events([self.first], self.name, self.time) for column in event.values)

    @property
    def dates(self) -> bool:
        """The times are dates."""
        return any(event.unit for event in _events([self.first], self.name, self.time))

    def blocks(self, columns: Collection[str] | None, decimals: int) -> Iterator[Rows]:
        """Rows from the first one on at which every column has a value, a few lines at a time."""
        wanted = tuple(columns or ())
        held: dict[str, Any] = dict.fromkeys(wanted)
        last: Fraction | None = None
        for event in _events(self._lines(), self.name, self.time):
            held.update({name: value for name, value in event.values.items() if name in held and value is not None})
            ticks = event.time * 10**decimals
            if ticks.denominator != 1:
                raise UsageError(
                    f"{self.name}: the time {float(event.time)} has too many digits to be counted exactly",
                    f"row by row, the number of decimals is fixed beforehand, here --decimals {decimals}",
                )
            if None in held.values():
                continue
            last = event.time
            yield Rows(np.array([int(ticks)], np.int64), {name: _column(held[name]) for name in wanted}, decimals)
        if last is None:
            missing = ", ".join(name for name, value in held.items() if value is None)
            raise UsageError(f"{self.name} has no rows", f"no line gives {missing} a value" if missing else None)

    def _lines(self) -> Iterator[bytes]:
        if self.first:
            yield self.first
        while line := self.stream.readline():
            yield line


def _column(value: Any) -> Any:
    if isinstance(value, str):
        return np.array([value], dtype=object)
    return np.array([value], np.uint8 if isinstance(value, bool) else np.float64)


def _events(lines: Iterable[bytes], name: str, time: str | None) -> Iterator[_Event]:
    before: Fraction | None = None
    key: str | None = time
    for number, line in enumerate(lines, 1):
        check_time()
        if not line.strip():
            continue
        text = line.decode("utf-8", "replace").rstrip("\r\n")
        place = Span(Source(name, text, first_line=number), 0, len(text))
        given = _object(text, place)
        if key is None:
            key = next((each for want in TIME_NAMES for each in given if each.lower() == want), None)
        if key is None or key not in given:
            wanted = f"no {key!r}" if key else f"none of {', '.join(TIME_NAMES)}"
            raise _wrong(place, f"this line has {wanted}", "say which value is the time with --time NAME")
        instant, unit = _time(given.pop(key), place)
        if before is not None and instant < before:
            raise _wrong(place, "this time lies before that of the line above", "sort the lines by time", "E0913")
        before = instant
        yield _Event(instant, unit, {column: _value(value, column, place) for column, value in given.items()})


def _object(text: str, place: Span) -> dict[str, Any]:
    try:
        read = json.loads(text, parse_float=_Number, parse_constant=lambda word: _constant(word))
    except ValueError as error:
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


def _value(value: Any, column: str, place: Span) -> Any:
    if isinstance(value, _Number):
        return float(value)
    if isinstance(value, float):
        raise _wrong(place, f"the value of column {column!r} is not finite", "write null where the value stays")
    return value


def _time(value: Any, place: Span) -> tuple[Fraction, str]:
    """A time, with its unit where it tells one: dates are counted in seconds since 1970."""
    if isinstance(value, bool):
        raise _wrong(place, "the time is not a number", None)
    if isinstance(value, (int, _Number)):
        return Fraction(str(value)), ""
    if isinstance(value, str):
        try:
            return seconds_of(value), "s" if is_date(value) else ""
        except ValueError:
            pass
    raise _wrong(place, f"the time {value!r} is neither a number nor a date", "such as 2026-03-01T12:00:00.25Z")


def _wrong(place: Span, message: str, help: str | None, code: str = "E0911") -> InputError:
    return InputError([Diagnostic(code, message, place, help)])
