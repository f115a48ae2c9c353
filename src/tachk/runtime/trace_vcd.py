"""Traces in value change dumps (IEEE 1800-2017, 21.7), as simulators and logic analysers write them; read by pyvcd."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from io import FileIO
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from vcd.common import VarType
from vcd.reader import Location, RealChange, ScalarChange, Token, TokenKind, VCDParseError, VectorChange, tokenize

from tachk.diagnostics.diagnostic import Diagnostic, InputError, UsageError
from tachk.diagnostics.span import Source, Span
from tachk.runtime.trace import Trace, Values
from tachk.runtime.trace_arrays import trace_of, whole_times
from tachk.runtime.trace_header import known_unit, no_such_column
from tachk.time_limit import check_time

if TYPE_CHECKING:
    from _typeshed import WriteableBuffer

_TICKS_PER_UNIT = {"s": ("s", 1), "ms": ("ms", 1), "us": ("us", 1), "ns": ("ns", 1), "ps": ("ns", 10**3)}
_FEMTOSECONDS = ("ns", 10**6)
_LARGEST_EXACT = 2**53
_LAST_TICK = 2**62


_BEYOND_ASCII = bytes(byte if byte < 128 else ord("?") for byte in range(256))


class _Plain(FileIO):
    """A file in which each byte beyond ASCII reads as a question mark. The standard knows ASCII only, yet localised
    dates and names of people stand in comments, in whatever encoding."""

    def readinto(self, buffer: WriteableBuffer, /) -> int:
        count = super().readinto(buffer)
        seen = memoryview(buffer)[:count]
        seen[:] = bytes(seen).translate(_BEYOND_ASCII)
        return count


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
        return tuple(variable.name for variable in self.variables)

    def read(self, columns: Collection[str] | None = None) -> Trace:
        wanted = [v for v in self.variables if columns is None or v.name in columns]
        for name in columns or ():
            if name not in self.columns:
                raise no_such_column(name, self.columns, self.name)
        try:
            with _Plain(self.name) as stream:
                times, rows = self._changes(wanted, tokenize(stream))
        except VCDParseError as error:
            raise _error(self.name, str(error).split(": ", 1)[-1], error.loc) from None
        held = {variable.name: _values(variable, [row[i] for row in rows]) for i, variable in enumerate(wanted)}
        ticks = whole_times(np.array(times, dtype=np.int64) * self.magnitude, self.ticks_per_unit, self.name)
        return trace_of(self.name, ticks, self.unit, held)

    def _changes(self, wanted: list[VcdVariable], tokens: Iterator[Token]) -> tuple[list[int], list[tuple[float, ...]]]:
        """The instants at which something wanted changed, and all wanted values from then on."""
        places: dict[str, list[int]] = {}
        for place, variable in enumerate(wanted):
            places.setdefault(variable.code, []).append(place)
        values: list[float | None] = [None] * len(wanted)
        unknown: dict[int, Location] = {}
        times: list[int] = []
        rows: list[tuple[float, ...]] = []
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

        for token in tokens:
            check_time()
            if token.kind is TokenKind.CHANGE_TIME:
                time = token.time_change
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
            if not isinstance(data, (ScalarChange, VectorChange, RealChange)):
                continue
            for place in places.get(data.id_code, ()):
                changed = True
                if (bits := _bits(data)) > wanted[place].size:
                    message = f"a value of {bits} bits for {wanted[place].name!r}, which has {wanted[place].size}"
                    raise _error(self.name, message, token.span.start)
                value = _value(data, wanted[place])
                if value is None:
                    unknown[place] = token.span.start
                elif abs(value) > _LARGEST_EXACT and not isinstance(data, RealChange):
                    raise _error(self.name, f"{wanted[place].name!r} is too large to be exact", token.span.start)
                else:
                    unknown.pop(place, None)
                    values[place] = value
        if now is None:
            raise UsageError(f"{self.name} has no times", "its changes should stand behind lines such as #0")
        if changed or not times or times[-1] != now:
            last = True
            settle()  # also without a change: the dump ends here
        return times, rows


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
        with _Plain(name) as stream:
            variables, (shown, ticks), magnitude = _declarations(tokenize(stream), name)
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


_NO_VALUE = (
    "x and z are not values; the trace begins when every variable that a formula reads has one, "
    "and then they stay known"
)


def _variable(token: Token, scopes: list[str]) -> VcdVariable:
    declared = token.var
    index = f"[{declared.bit_index}]" if isinstance(declared.bit_index, int) else ""
    name = ".".join((*(scope for scope in scopes if scope), declared.reference + index))
    return VcdVariable(name, declared.id_code, declared.size, declared.type_)


def _value(change: ScalarChange | VectorChange | RealChange, variable: VcdVariable) -> float | None:
    """The number that a change says; None for what is not a number."""
    match change:
        case RealChange(value=value):
            return value if np.isfinite(value) else None
        case ScalarChange(value=value):
            return {"0": 0.0, "1": 1.0, "L": 0.0, "H": 1.0, "l": 0.0, "h": 1.0}.get(value)
        case VectorChange(value=int() as value):
            negative = variable.kind is VarType.integer and value >> (variable.size - 1) & 1
            return value - (1 << variable.size) if negative else value
        case _:
            return None


def _bits(change: ScalarChange | VectorChange | RealChange) -> int:
    return change.value.bit_length() if isinstance(change, VectorChange) and isinstance(change.value, int) else 1


def _values(variable: VcdVariable, values: list[float]) -> Values:
    if variable.size == 1 and set(values) <= {0.0, 1.0}:
        return np.array(values, dtype=np.uint8)
    return np.array(values, dtype=np.float64)


def _error(name: str, message: str, place: Location, help: str | None = None) -> InputError:
    """E0917 at a place of the file; only its line is read again."""
    text = ""
    with Path(name).open("rb") as stream:
        for number, line in enumerate(stream, 1):
            if number == place.line:
                text = line.decode("utf-8", "replace").rstrip("\r\n")
                break
    source = Source(name, text, first_line=place.line)
    start = min(max(place.column - 1, 0), len(text))
    return InputError([Diagnostic("E0917", message, Span(source, start, min(start + 1, len(text))), help)])
