"""Traces in value change dumps (IEEE 1800-2017, 21.7), as simulators and logic analysers write them; read by pyvcd."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace
from math import isnan
from pathlib import Path

import numpy as np
from vcd.common import VarType
from vcd.reader import (
    Location,
    RealChange,
    ScalarChange,
    StringChange,
    Token,
    TokenKind,
    VCDParseError,
    VectorChange,
    tokenize,
)

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError, UsageError
from tachk.base.span import Source, Span
from tachk.base.time_limit import check_time
from tachk.recordings.traces.compressed import open_bytes
from tachk.recordings.traces.logs.labels import Labels
from tachk.recordings.traces.trace import Trace, Values, cut_off_warning
from tachk.recordings.traces.trace_arrays import trace_of, whole_times
from tachk.recordings.traces.trace_header import known_unit, no_such_column
from tachk.recordings.traces.vcd_stream import VcdStream

_TICKS_PER_UNIT = {"s": ("s", 1), "ms": ("ms", 1), "us": ("us", 1), "ns": ("ns", 1), "ps": ("ns", 10**3)}
_FEMTOSECONDS = ("ns", 10**6)
_LARGEST_EXACT = 2**53
_MODEL = "model."
_LAST_TICK = 2**62


def _tokens(stream: VcdStream) -> Iterator[Token]:
    """The tokens of a file. Raises VCDParseError for what pyvcd cannot read, whatever it raises about it."""
    place = Location(1, 1)
    tokens = tokenize(stream)
    while True:
        try:
            token = next(tokens)
        except StopIteration:
            return
        except VCDParseError:
            if stream.torn is not None:
                return
            raise
        except ValueError:  # numbers of more digits than Python converts
            raise VCDParseError(place, "a number has too many digits") from None
        place = token.span.end
        yield token


_Value = float | str
_Row = tuple[_Value, ...]
_Change = ScalarChange | VectorChange | RealChange | StringChange


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


@dataclass(frozen=True, slots=True, eq=False)
class VcdRecording:
    """Attributes:
    magnitude: ticks between two numbers of the time, such as 10 for a timescale of ``10 ns``.
    """

    name: str
    variables: tuple[VcdVariable, ...]
    unit: str
    ticks_per_unit: int
    magnitude: int

    @property
    def columns(self) -> tuple[str, ...]:
        """The names of the variables. Those of the scope `model`, into which runs of a model are written, are known
        without it too."""
        names = [variable.name for variable in self.variables]
        return tuple(dict.fromkeys((*(name.removeprefix(_MODEL) for name in names), *names)))

    def read(self, columns: Collection[str] | None = None) -> Trace:
        known = {variable.name: variable for variable in self.variables}
        short = {variable.name.removeprefix(_MODEL): variable for variable in self.variables}
        wanted: list[VcdVariable] = []
        for name in short if columns is None else columns:
            found = known.get(name) or short.get(name)
            if found is None:
                raise no_such_column(name, self.columns, self.name)
            wanted.append(replace(found, name=name))
        try:
            with VcdStream(self.name, {variable.code for variable in self.variables}) as stream:
                instants, rows = self._changes(wanted, stream)
        except VCDParseError as error:
            raise _error(self.name, str(error).split(": ", 1)[-1], error.loc) from None
        texts = Labels()
        held: dict[str, Values] = {}
        for place, variable in enumerate(wanted):
            values = [row[place] for row in rows]
            if any(isinstance(value, str) for value in values):
                held[variable.name] = texts.codes(values, variable.name, self.name)
            else:
                held[variable.name] = _values(variable, [float(value) for value in values])
        times = np.array(instants, dtype=np.int64) * self.magnitude
        trace = trace_of(self.name, whole_times(times, self.ticks_per_unit, self.name), self.unit, held)
        notes, warnings = _told(self.name, stream)
        return texts.on(replace(trace, notes=(*trace.notes, *notes), warnings=(*trace.warnings, *warnings)))

    def _changes(self, wanted: list[VcdVariable], stream: VcdStream) -> tuple[list[int], list[tuple[_Value, ...]]]:
        """The instants at which something wanted changed, and all wanted values from then on."""
        places: dict[str, list[int]] = {}
        for place, variable in enumerate(wanted):
            places.setdefault(variable.code, []).append(place)
        values: list[_Value | None] = [None] * len(wanted)
        unknown: dict[int, Location] = {}
        times: list[int] = []
        rows: list[_Row] = []
        now: int | None = None
        changed = True
        last = False
        at = Location(1, 1)

        def settle() -> None:
            if not times and not last and (unknown or None in values):
                return  # before a reset much is unknown: the trace begins when it is not
            for place, where in unknown.items():
                raise _error(self.name, f"{wanted[place].name!r} has no known value here", where, _NO_VALUE)
            for place, value in enumerate(values):
                if value is None:
                    raise _error(self.name, f"{wanted[place].name!r} never has a value", at, _NO_VALUE)
            times.append(now or 0)
            rows.append(tuple(value for value in values if value is not None))

        for token in _tokens(stream):
            check_time()
            if token.kind is TokenKind.CHANGE_TIME:
                time = token.time_change
                if now is not None and time < now and stream.open_line == token.span.start.line:
                    stream.half_written = True
                    break
                if now is not None and time < now:
                    raise _error(self.name, f"the time {time} lies before {now}", token.span.start)
                if time * self.magnitude > _LAST_TICK:
                    raise _error(self.name, f"the time {time} is too large", token.span.start)
                if now is not None and time > now and changed:
                    settle()
                    changed = False
                now, at = time, token.span.start
                continue
            data = token.data
            if not isinstance(data, (ScalarChange, VectorChange, RealChange, StringChange)):
                continue
            for place in places.get(data.id_code, ()):
                changed = True
                value = self._changed(data, wanted[place], token.span.start)
                if value is None:
                    unknown[place] = token.span.start
                else:
                    unknown.pop(place, None)
                    values[place] = value
        if now is None:
            raise UsageError(f"{self.name} has no times", "its changes should stand behind lines such as #0")
        if changed or not times or times[-1] != now:
            last = True
            settle()  # also without a change: the dump ends here
        return times, rows

    def _changed(self, change: _Change, variable: VcdVariable, place: Location) -> _Value | None:
        """The value that a change gives a variable; None for what is neither a number nor a text."""
        if (bits := _bits(change)) > variable.size:
            message = f"a value of {bits} bits for {variable.name!r}, which has {variable.size}"
            raise _error(self.name, message, place)
        value = _value(change, variable)
        if isinstance(change, (ScalarChange, VectorChange)) and isinstance(value, (int, float)):
            if abs(value) > _LARGEST_EXACT:
                raise _error(self.name, f"{variable.name!r} is too large to be exact", place)
        return value


def _told(name: str, stream: VcdStream) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The notes and warnings about the end of a file that has been read, as of a `Trace`."""
    if stream.torn is not None:
        return (), (cut_off_warning(name, f"what follows is left out ({stream.torn})"),)
    if stream.half_written:
        return (), (cut_off_warning(name, f"the end of line {stream.open_line}, which is half written, is left out"),)
    if stream.open_time:
        return ("the last line has no line break: if the file is cut off, its time may be half written",), ()
    return (), ()


def open_vcd(path: str | Path, unit: str | None = None) -> VcdRecording:
    """Reads the declarations of a file.

    Args:
        unit: in which times are reported and bounds without unit are meant; None: that of the timescale.

    Raises:
        InputError: E0917.
        UsageError: the file cannot be read, or two variables have one name.
    """
    name = str(path)
    try:
        with VcdStream(name) as stream:
            variables, (shown, ticks), magnitude = _declarations(_tokens(stream), name)
    except FileNotFoundError:
        raise UsageError(f"there is no file {path}") from None
    except OSError as error:
        raise UsageError(f"{path} cannot be read: {error.strerror or error}") from None
    except VCDParseError as error:
        raise _error(name, str(error).split(": ", 1)[-1], error.loc) from None
    if unit is not None and known_unit(unit) != shown:
        raise UsageError(f"{name} counts its time in {shown}, not in {unit}", "its $timescale says so")
    return VcdRecording(name, variables, shown, ticks, magnitude)


def _declarations(tokens: Iterator[Token], name: str) -> tuple[tuple[VcdVariable, ...], tuple[str, int], int]:
    """The variables, the unit of time with its ticks, and the ticks between two numbers of the time."""
    scopes: list[str] = []
    variables: dict[str, VcdVariable] = {}
    scale, magnitude = ("ns", 1), 1
    for token in tokens:
        match token.kind:
            case TokenKind.SCOPE:
                scopes.append(token.scope.ident)
            case TokenKind.UPSCOPE if scopes:
                scopes.pop()
            case TokenKind.TIMESCALE:
                magnitude = int(token.timescale.magnitude)
                scale = _TICKS_PER_UNIT.get(token.timescale.unit.value, _FEMTOSECONDS)
            case TokenKind.VAR:
                variable = _variable(token, scopes)
                if variables.setdefault(variable.name, variable).code != variable.code:
                    raise UsageError(f"{name} has two variables {variable.name!r}")
            case TokenKind.ENDDEFINITIONS:
                return tuple(variables.values()), scale, magnitude
            case _:
                pass
    raise _error(name, "the declarations do not end with $enddefinitions", Location(1, 1))


_ESCAPED = re.compile(r"\\x([0-9a-f]{2})")
"""A character of a text that would end it."""

_NO_VALUE = (
    "x and z are not values; the trace begins when every variable that a formula reads has one, "
    "and then they stay known"
)


def _variable(token: Token, scopes: list[str]) -> VcdVariable:
    declared = token.var
    index = f"[{declared.bit_index}]" if isinstance(declared.bit_index, int) else ""
    name = ".".join((*(scope for scope in scopes if scope), declared.reference + index))
    return VcdVariable(name, declared.id_code, declared.size, declared.type_)


def _value(change: _Change, variable: VcdVariable) -> _Value | None:
    """The number or text that a change says; None for what is neither."""
    match change:
        case RealChange(value=value):
            return None if isnan(value) else value
        case StringChange(value=text):
            return _ESCAPED.sub(lambda match: chr(int(match[1], 16)), text)
        case ScalarChange(value=value):
            return {"0": 0.0, "1": 1.0, "L": 0.0, "H": 1.0, "l": 0.0, "h": 1.0}.get(value)
        case VectorChange(value=int() as value):
            negative = variable.kind is VarType.integer and value >> (variable.size - 1) & 1
            return value - (1 << variable.size) if negative else value
        case _:
            return None


def _bits(change: _Change) -> int:
    if isinstance(change, StringChange):
        return 0
    return change.value.bit_length() if isinstance(change, VectorChange) and isinstance(change.value, int) else 1


def _values(variable: VcdVariable, values: list[float]) -> Values:
    if variable.size == 1 and set(values) <= {0.0, 1.0}:
        return np.array(values, dtype=np.uint8)
    return np.array(values, dtype=np.float64)


def _error(name: str, message: str, place: Location, help: str | None = None) -> InputError:
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
