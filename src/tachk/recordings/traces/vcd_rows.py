"""The changes in a value change dump as rows: at which instants something changed, and what the values are from then
on."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from math import isnan
from pathlib import Path
from typing import Final

from vcd.common import VarType
from vcd.reader import Location, RealChange, ScalarChange, StringChange, Token, TokenKind, VCDParseError, VectorChange

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError, UsageError
from tachk.base.job import check_job
from tachk.base.span import Source, Span
from tachk.recordings.traces.compressed import open_bytes
from tachk.recordings.traces.vcd_stream import VcdStream

VcdValue = float | str
_Change = ScalarChange | VectorChange | RealChange | StringChange

_BITS: Final = {"0": 0.0, "1": 1.0, "L": 0.0, "H": 1.0, "l": 0.0, "h": 1.0}
_LARGEST_EXACT: Final = 2**53
_LAST_TICK: Final = 2**62
_CHECKPOINTS: Final = (TokenKind.DUMPVARS, TokenKind.DUMPALL, TokenKind.DUMPON, TokenKind.DUMPOFF)
"""Blocks that hold the values of variables, whether they have changed or not (IEEE 1800-2017, 21.7.2.1)."""

_ESCAPED: Final = re.compile(r"\\x([0-9a-f]{2})")
"""A character of a text that would end it."""

_NO_VALUE: Final = (
    "x and z are not values; the trace begins when every variable that a formula reads has one, "
    "and then they stay known"
)


@dataclass(frozen=True, slots=True)
class VcdVariable:
    """Attributes:
    code: by which changes name it; several variables may share one.
    size: in bits.
    """

    name: str
    code: str
    size: int
    kind: VarType


@dataclass(slots=True)
class VcdRows:
    """Follows the changes of some variables.

    Attributes:
        wanted: the variables whose values are kept.
        magnitude: ticks between two numbers of the time.
        arrivals: of each column of arrivals the codes of the variables that arrive in it. A variable arrives where a
            change gives it a value, be it the one before. A checkpoint gives none, for it is not a change.
        times: of the rows, as the dump numbers them.
        values: of each row, of all variables that are wanted.
        arrived: the columns of arrivals in which something arrives, of each row.
    """

    name: str
    wanted: Sequence[VcdVariable]
    magnitude: int
    arrivals: Mapping[str, frozenset[str]] = field(default_factory=dict)
    times: list[int] = field(default_factory=list)
    values: list[tuple[VcdValue, ...]] = field(default_factory=list)
    arrived: list[frozenset[str]] = field(default_factory=list)
    _places: dict[str, list[int]] = field(default_factory=dict)
    _topics: dict[str, frozenset[str]] = field(default_factory=dict)
    _now: list[VcdValue | None] = field(default_factory=list)
    _unknown: dict[int, Location] = field(default_factory=dict)
    _arriving: frozenset[str] = frozenset()
    _changed: bool = True
    _whole: int = 0

    def follow(self, tokens: Iterable[Token], stream: VcdStream) -> None:
        """Reads all changes of a stream. Raises InputError with the place of what is wrong, UsageError for no times."""
        self._begin()
        now: int | None = None
        at = Location(1, 1)
        checkpoint = False
        for token in tokens:
            check_job()
            if token.kind is TokenKind.CHANGE_TIME:
                time, place = token.time_change, token.span.start
                if now is not None and time < now and stream.open_line == place.line:
                    stream.half_written = True
                    break
                if now is not None and time < now:
                    raise fault_at(self.name, f"the time {time} lies before {now}", place)
                if time * self.magnitude > _LAST_TICK:
                    raise fault_at(self.name, f"the time {time} is too large", place)
                if now is not None and time > now:
                    self._leave(now, at)
                now, at = time, place
            elif isinstance(token.data, (ScalarChange, VectorChange, RealChange, StringChange)):
                self._change(token.data, token.span.start, checkpoint)
            elif token.kind in _CHECKPOINTS:
                checkpoint = True
            elif token.kind is TokenKind.END:
                checkpoint = False
        if now is None:
            raise UsageError(f"{self.name} has no times", "its changes should stand behind lines such as #0")
        if stream.open_instant and self.times:
            self._end(self._whole)
        elif self._changed or not self.times or self.times[-1] != now:
            self._settle(now, at, last=True)  # also without a change: the dump ends here

    def _begin(self) -> None:
        self._now = [None] * len(self.wanted)
        for place, variable in enumerate(self.wanted):
            self._places.setdefault(variable.code, []).append(place)
        for code in frozenset[str]().union(*self.arrivals.values()):
            self._topics[code] = frozenset(name for name, codes in self.arrivals.items() if code in codes)

    def _change(self, change: _Change, where: Location, checkpoint: bool) -> None:
        code = change.id_code
        for place in self._places.get(code, ()):
            self._changed = True
            value = self._checked(change, self.wanted[place], where)
            if value is None:
                self._unknown[place] = where
            else:
                self._unknown.pop(place, None)
                self._now[place] = value
        if not checkpoint and code in self._topics and _is_value(change):
            self._changed = True
            self._arriving |= self._topics[code]

    def _checked(self, change: _Change, variable: VcdVariable, place: Location) -> VcdValue | None:
        """The value that a change gives a variable; None for what is neither a number nor a text."""
        if (bits := _bits(change)) > variable.size:
            message = f"a value of {bits} bits for {variable.name!r}, which has {variable.size}"
            raise fault_at(self.name, message, place)
        value = _value(change, variable)
        if isinstance(change, (ScalarChange, VectorChange)) and isinstance(value, (int, float)):
            if abs(value) > _LARGEST_EXACT:
                raise fault_at(self.name, f"{variable.name!r} is too large to be exact", place)
        return value

    def _leave(self, now: int, at: Location) -> None:
        """The instant `now` is over."""
        if self._changed:
            self._settle(now, at, last=False)
        self._changed, self._arriving, self._whole = False, frozenset(), now

    def _end(self, now: int) -> None:
        """The last row of a dump that is cut off within the instant behind this one, of which some changes are missing:
        what it says of that instant is left out."""
        if self.times[-1] != now:
            self.times.append(now)
            self.values.append(self.values[-1])
            self.arrived.append(frozenset())

    def _settle(self, now: int, at: Location, last: bool) -> None:
        """A row for the instant `now`, which the dump names at a place. Before a reset much is unknown: the trace
        begins when it is not."""
        if not self.times and not last and (self._unknown or None in self._now):
            return
        for place, where in self._unknown.items():
            raise fault_at(self.name, f"{self.wanted[place].name!r} has no known value here", where, _NO_VALUE)
        for place, value in enumerate(self._now):
            if value is None:
                raise fault_at(self.name, f"{self.wanted[place].name!r} never has a value", at, _NO_VALUE)
        self.times.append(now)
        self.values.append(tuple(value for value in self._now if value is not None))
        self.arrived.append(self._arriving)


def _is_value(change: _Change) -> bool:
    """True if a change gives a number or a text, and not `x` or `z`."""
    match change:
        case RealChange(value=value):
            return not isnan(value)
        case ScalarChange(value=value):
            return value in _BITS
        case VectorChange(value=value):
            return isinstance(value, int)
        case _:
            return True


def _value(change: _Change, variable: VcdVariable) -> VcdValue | None:
    """The number or text that a change says; None for what is neither."""
    match change:
        case RealChange(value=value):
            return None if isnan(value) else value
        case StringChange(value=text):
            return _ESCAPED.sub(lambda match: chr(int(match[1], 16)), text)
        case ScalarChange(value=value):
            return _BITS.get(value)
        case VectorChange(value=int() as value):
            negative = variable.kind is VarType.integer and value >> (variable.size - 1) & 1
            return value - (1 << variable.size) if negative else value
        case _:
            return None


def _bits(change: _Change) -> int:
    if isinstance(change, StringChange):
        return 0
    return change.value.bit_length() if isinstance(change, VectorChange) and isinstance(change.value, int) else 1


def unreadable(name: str, error: VCDParseError) -> InputError:
    """E0917 for what pyvcd cannot read."""
    message = str(error).split(": ", 1)[-1]
    if not message.startswith("confused"):
        return fault_at(name, message, error.loc)
    message = "here begins neither a declaration (`$var`), a time (`#10`) nor a value (`1!`)"
    help = "tachk reads value change dumps that are texts; `fst2vcd FILE.fst -o FILE.vcd` makes one of an FST file"
    return fault_at(name, message, error.loc, help)


def fault_at(name: str, message: str, place: Location, help: str | None = None) -> InputError:
    """E0917 at a place of the file; only its line is read again."""
    text = ""
    with open_bytes(Path(name)) as stream:
        for number, line in enumerate(stream, 1):
            if number == place.line:
                text = line.decode("utf-8", "replace").rstrip("\r\n")
                break
    source = Source(name, text, first_line=place.line)
    start = min(max(place.column - 1, 0), len(text))
    return InputError([Diagnostic("E0917", message, Span(source, start, min(start + 1, len(text))), help)])
