"""Traces in value change dumps (IEEE 1800-2017, 21.7), as simulators and logic analysers write them; read by pyvcd."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from vcd.reader import Location, Token, TokenKind, VCDParseError, tokenize

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.recordings.traces.arrivals import arriving
from tachk.recordings.traces.logs.labels import Labels
from tachk.recordings.traces.trace import Trace, Values, cut_off_warning
from tachk.recordings.traces.trace_arrays import held_values, trace_of, whole_times
from tachk.recordings.traces.trace_header import known_unit, no_such_column
from tachk.recordings.traces.vcd_rows import VcdRows, VcdVariable, fault_at, unreadable
from tachk.recordings.traces.vcd_stream import VcdStream
from tachk.recordings.traces.vcd_units import stated_scale

_TICKS_PER_UNIT = {"s": ("s", 1), "ms": ("ms", 1), "us": ("us", 1), "ns": ("ns", 1), "ps": ("ns", 10**3)}
_FEMTOSECONDS = ("ns", 10**6)
_MODEL = "model."


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
        known = {variable.name.removeprefix(_MODEL): variable for variable in self.variables}
        names = tuple(known) if columns is None else tuple(columns)
        known |= {variable.name: variable for variable in self.variables}
        arrivals = arriving(names, self.columns)
        wanted: list[VcdVariable] = []
        for name in names:
            if name in arrivals:
                continue
            if name not in known:
                raise no_such_column(name, self.columns, self.name)
            wanted.append(replace(known[name], name=name))
        stated = {name: frozenset(known[part].code for part in parts) for name, parts in arrivals.items()}
        rows = VcdRows(self.name, wanted, self.magnitude, stated)
        try:
            with VcdStream(self.name, {variable.code for variable in self.variables}) as stream:
                rows.follow(_tokens(stream), stream)
        except VCDParseError as error:
            raise unreadable(self.name, error) from None
        texts = Labels()
        held: dict[str, Values] = {}
        for place, variable in enumerate(wanted):
            values = [row[place] for row in rows.values]
            if any(isinstance(value, str) for value in values):
                held[variable.name] = texts.codes(values, variable.name, self.name)
            else:
                held[variable.name] = held_values(np.array(values, dtype=np.float64), variable.name, self.name)
        for name in stated:
            held[name] = np.array([name in arrived for arrived in rows.arrived], dtype=np.uint8)
        times = np.array(rows.times, dtype=np.int64) * self.magnitude
        trace = trace_of(self.name, whole_times(times, self.ticks_per_unit, self.name), self.unit, held)
        notes, warnings = _stated(self.name, stream)
        return texts.on(replace(trace, notes=(*trace.notes, *notes), warnings=(*trace.warnings, *warnings)))


def _stated(name: str, stream: VcdStream) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The notes and warnings about the end of a file that has been read, as of a `Trace`."""
    if stream.torn is not None:
        return (), (cut_off_warning(name, f"what follows is left out ({stream.torn})"),)
    if stream.half_written:
        return (), (cut_off_warning(name, f"the end of line {stream.open_line}, which is half written, is left out"),)
    if stream.open_time:
        return ("the last line has no line break: if the file is cut off, its time may be half written",), ()
    return (), ()


def open_vcd(path: str | Path, time: str | None = None, unit: str | None = None) -> VcdRecording:
    """Reads the declarations of a file.

    Args:
        unit: in which times are reported and bounds without unit are meant; None: that of the timescale.

    Raises:
        InputError: E0917.
        UsageError: the file cannot be read, two variables have one name, or a time column is named.
    """
    if time is not None:
        raise UsageError("a value change dump has no time column to choose")
    name = str(path)
    try:
        with VcdStream(name) as stream:
            variables, (shown, ticks), magnitude = _declarations(_tokens(stream), name)
    except FileNotFoundError:
        raise UsageError(f"there is no file {path}") from None
    except OSError as error:
        raise UsageError(f"{path} cannot be read: {error.strerror or error}") from None
    except VCDParseError as error:
        raise unreadable(name, error) from None
    if unit is not None and known_unit(unit) != (shown or known_unit(unit)):
        raise UsageError(f"{name} counts its time in {shown}, not in {unit}", "its $timescale says so")
    return VcdRecording(name, variables, shown or known_unit(unit or ""), ticks, magnitude)


def _declarations(tokens: Iterator[Token], name: str) -> tuple[tuple[VcdVariable, ...], tuple[str, int], int]:
    """The variables, the unit of time with its ticks, and the ticks between two numbers of the time."""
    scopes: list[str] = []
    variables: dict[str, VcdVariable] = {}
    comments: list[str] = []
    scale, magnitude = ("ns", 1), 1
    for token in tokens:
        match token.kind:
            case TokenKind.COMMENT:
                comments.append(token.comment)
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
                return tuple(variables.values()), stated_scale(comments, scale), magnitude
            case _:
                pass
    raise fault_at(name, "the declarations do not end with $enddefinitions", Location(1, 1))


def _variable(token: Token, scopes: list[str]) -> VcdVariable:
    declared = token.var
    index = f"[{declared.bit_index}]" if isinstance(declared.bit_index, int) else ""
    name = ".".join((*(scope for scope in scopes if scope), declared.reference + index))
    return VcdVariable(name, declared.id_code, declared.size, declared.type_)
