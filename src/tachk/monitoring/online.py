"""Judging a trace while it is recorded, event by event."""

from __future__ import annotations

import math
import os
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from typing import cast

import numpy as np

from tachk.diagnostics.diagnostic import Diagnostic, InputError, UsageError
from tachk.monitoring.formulas import NamedFormula, in_trace_units
from tachk.monitoring.offline import Measures, counted, ending_of, formulas_of, selected, verdict_on
from tachk.monitoring.reading import HeldValues
from tachk.properties.monitoring import compile as compile_formula
from tachk.properties.monitoring import ticks_needed
from tachk.report.monitor_record import Ending, MonitorRecord, MonitorVerdict
from tachk.report.online_record import OnlineRecord, OnlineVerdict
from tachk.runtime.explanation import horizon, memory
from tachk.runtime.node_signal import Truth
from tachk.runtime.online_monitor import OnlineMonitor
from tachk.runtime.trace import LARGEST_TICK, Ticks, Trace, Values
from tachk.runtime.trace_arrays import held_values
from tachk.runtime.trace_header import known_unit
from tachk.syntax.formula import Formula
from tachk.time_units import usual_decimals

Time = int | float | Fraction | Decimal

MOST_KEPT = 1 << 16
"""Rows that are kept to explain a violation, where the bounds of the formulas would ask for more."""


@dataclass(slots=True)
class _Watched:
    named: NamedFormula
    core: OnlineMonitor
    places: tuple[int, ...]
    story: MonitorRecord | None = None
    decided: bool = False


class Monitor:
    """Formulas on one growing trace.

        monitor = tachk.Monitor("G (request -> F[0, 5 s] answer)", unit="s")
        for time, values in events:
            if monitor.update(time, values) is tachk.Truth.FALSE: ...
        monitor.finish(end)

    The first instant that is given is the beginning of the trace. Values hold until they are given anew; of several
    ones for one instant the last one counts. Memory is bounded if all intervals of the formulas are, but for an
    outermost G or F.
    """

    def __init__(
        self,
        formula: str | os.PathLike[str] | Sequence[str] | Sequence[NamedFormula],
        *,
        unit: str = "",
        decimals: int | None = None,
        end: str = "undetermined",
        robustness: bool = False,
        select: Sequence[str] = (),
    ) -> None:
        """Args:
            formula: as for `tachk.monitor`.
            unit: of the times that will be given, such as ``"ms"``.
            decimals: times are counted in units of ``10 ** -decimals``; floating-point times are rounded to them. By
                default as many as make nanoseconds, at most 9.
            end: what counts where the trace ends too early to tell: ``"undetermined"``, ``"weak"``, ``"strong"``.
            robustness: keep bounds of the robustness too.
            select: the names of the formulas that are watched; none: all.

        Raises:
            InputError: a formula is wrong.
            UsageError: a file cannot be read, or an argument has no meaning.
        """
        self._ending = ending_of(end)
        self._unit = known_unit(unit)
        self._robust = robustness
        formulas = selected(formulas_of(formula), select)
        names = dict.fromkeys(
            column for named in formulas for column in sorted(named.columns) if column not in (named.constants or {})
        )
        self.columns: tuple[str, ...] = tuple(names)
        resolved = _resolved(formulas, self.columns, self._unit)
        self.decimals = usual_decimals(self._unit) if decimals is None else decimals
        self._scale = math.lcm(10**self.decimals, *(ticks_needed(formula) for formula in resolved))
        self._watched: list[_Watched] = []
        for named, tree in zip(formulas, resolved, strict=True):
            program = compile_formula(tree, self.columns, self._scale)
            places = tuple(self.columns.index(column) for column in program.columns)
            self._watched.append(_Watched(named, OnlineMonitor(program, robustness=robustness), places))
        self._values: list[float | None] = [None] * len(self.columns)
        self._kept: deque[tuple[Ticks, tuple[Values, ...]]] = deque()
        self._kept_rows = 0
        self._whole = True
        reaches = [horizon(w.core.program) + memory(w.core.program) for w in self._watched]
        self._reach = max(reaches)
        self._open = len(self._watched)
        self._now: int | None = None
        self._first: int | None = None
        self.rows = 0

    # ---- what comes in ----

    def update(self, time: Time, values: Mapping[str, float] | None = None, **more: float) -> Truth:
        """Some columns have these values from this time on; the others keep theirs.

        None and NaN mean that a value stays; columns that no formula reads may be there.

        Returns the verdict on all formulas together, see `truth`. Raises UsageError for a column without a value, for
        what is no number, and for a time before the one given last.
        """
        tick = self.tick(time)
        row: list[float] = []
        for name, value in zip(self.columns, self._values, strict=True):
            new = more.get(name, value) if values is None else values.get(name, more.get(name, value))
            row.append(_number(name, new, value))
        self._check(tick, time)
        self._values = [*row]
        self.rows += 1
        self._keep(np.array([tick]), tuple(np.array([value], dtype=np.float64) for value in row))
        for watched in self._watched:
            if not watched.decided:
                self._look(watched, watched.core.update(tick, [row[place] for place in watched.places]))
        return self.truth

    def push(self, times: Ticks, columns: Mapping[str, Values], decimals: int) -> Truth:
        """Many rows at once, their times in units of ``10 ** -decimals``. Every column is given."""
        if len(times) == 0:
            return self.truth
        factor = self._scale // 10**decimals
        for time in (int(times[0]), int(times[-1])):
            self._check(time * factor, Fraction(time, 10**decimals))
        ticks = times * factor
        held = tuple(held_values(columns[name], name, "the trace") for name in self.columns)
        self._values = [float(values[-1]) for values in held]
        self.rows += len(times)
        self._now = int(ticks[-1])
        self._keep(ticks, held)
        for watched in self._watched:
            if not watched.decided:
                self._look(watched, watched.core.push(ticks, [held[place] for place in watched.places]))
        return self.truth

    def advance(self, time: Time) -> Truth:
        """Nothing has changed before this time; something may still change at it."""
        tick = self.tick(time)
        self._check(tick, time)
        for watched in self._watched:
            if not watched.decided:
                self._look(watched, watched.core.advance(tick))
        return self.truth

    def finish(self, time: Time | None = None) -> tuple[OnlineVerdict, ...]:
        """The trace is over; it includes this time, or else ends with the last one given. Returns the verdicts."""
        if time is not None:
            self._check(self.tick(time), time)
        if self._now is None:
            raise UsageError("the trace has no rows", "the verdict needs at least the state at the beginning")
        for watched in self._watched:
            if not watched.decided:
                self._look(watched, watched.core.finish(self._now))
        return self.verdicts

    def tick(self, time: Time) -> int:
        """A time as the monitor counts it; a float is rounded.

        Raises UsageError for one that is finer, and for what is no time.
        """
        if isinstance(time, float):
            if not math.isfinite(time):
                raise UsageError(f"the time {time} is no number")
            return round(time * self._scale)
        if isinstance(time, int):
            return time * self._scale
        exact = Fraction(time) * self._scale
        if exact.denominator != 1:
            raise UsageError(f"the time {time} is finer than 1/{self._scale}", "allow more decimals")
        return int(exact)

    # ---- what is known ----

    @property
    def truth(self) -> Truth:
        """FALSE if one formula is false, else UNDETERMINED if one is undetermined, else TRUE."""
        truths = [watched.core.verdict for watched in self._watched]
        return next(t for t in (Truth.FALSE, Truth.UNDETERMINED, Truth.TRUE) if t in truths)

    @property
    def decided(self) -> bool:
        """Whether nothing that follows can change a verdict."""
        return self._open == 0

    @property
    def verdicts(self) -> tuple[OnlineVerdict, ...]:
        """One for each formula, in order."""
        return tuple(self._verdict(watched) for watched in self._watched)

    def __getitem__(self, name: str) -> OnlineVerdict:
        for watched in self._watched:
            if watched.named.name == name:
                return self._verdict(watched)
        raise KeyError(name)

    @property
    def unit(self) -> str:
        return self._unit

    def record(self, name: str = "-") -> OnlineRecord:
        """Everything that is known now, for reports.

        Args:
            name: of the trace.
        """
        begin, end = Fraction(self._first or 0, self._scale), Fraction(self._now or 0, self._scale)
        return OnlineRecord(name, self.rows, begin, end, self._unit, self._ending, self.verdicts)

    @property
    def bytes_used(self) -> int:
        """Memory held by the monitors, without the rows that are kept for explanations."""
        return sum(watched.core.bytes_used for watched in self._watched)

    # ---- inside ----

    def _check(self, tick: int, time: Time) -> None:
        if self._now is not None and tick < self._now:
            raise UsageError(f"the time {time} lies before the one given last")
        far = abs(tick) > LARGEST_TICK if self._first is None else tick - self._first >= LARGEST_TICK
        if far:
            raise UsageError(
                f"the time {time} is too far from the beginning to be counted in units of 1/{self._scale}",
                f"allow fewer decimals, say {max(self.decimals - 3, 0)}",
            )
        self._now = tick
        if self._first is None:
            self._first = tick

    def _look(self, watched: _Watched, verdict: Truth) -> None:
        if verdict is Truth.UNDETERMINED:
            return
        watched.decided = True
        self._open -= 1
        if verdict is Truth.FALSE:
            watched.story = self._story(watched)
        if self._open == 0:
            self._kept.clear()

    def _verdict(self, watched: _Watched) -> OnlineVerdict:
        core, named = watched.core, watched.named
        measured = core.verdict
        stretch = core.violation
        at = core.decided_at
        return OnlineVerdict(
            named.name,
            named.title,
            named.text,
            named.sentence,
            measured,
            counted(measured, self._ending) if core.finished else measured,
            None if at is None else Fraction(at, self._scale),
            None if stretch is None else (self._clock(stretch.first), self._clock(stretch.last + 1)),
            core.robustness if self._robust else None,
            watched.story,
        )

    def _clock(self, cell: int) -> Fraction:
        return Fraction((self._first or 0) + cell // 2, self._scale)

    def _keep(self, ticks: Ticks, columns: tuple[Values, ...]) -> None:
        """What may be needed to explain a violation that these rows or later ones bring up."""
        if self._open == 0:
            return
        oldest = (int(self._kept[-1][0][-1]) if self._kept else int(ticks[0])) - self._reach - 1
        self._kept.append((ticks, columns))
        self._kept_rows += len(ticks)
        while len(self._kept) > 1 and (int(self._kept[1][0][0]) <= oldest or self._kept_rows > MOST_KEPT):
            self._kept_rows -= len(self._kept.popleft()[0])
            self._whole = False

    def _story(self, watched: _Watched) -> MonitorRecord | None:
        """The violation on the rows that are kept, if it is found there as the first one."""
        ticks = np.concatenate([block[0] for block in self._kept])
        columns = {}
        for place, name in enumerate(self.columns):
            values = np.concatenate([block[1][place] for block in self._kept]).astype(np.float64)
            columns[name] = held_values(values, name, "the trace")
        first = int(ticks[0])
        end = max(self._now or 0, int(ticks[-1])) - first
        trace = Trace("", ticks - first, columns, end, self._scale, self._unit, Fraction(first, self._scale))
        verdict: MonitorVerdict = verdict_on(
            watched.named, watched.core.program, trace, Ending.UNDETERMINED, Measures(robustness=False), HeldValues()
        )
        stretch = watched.core.violation
        found = verdict.finding
        if verdict.measured is not Truth.FALSE or found is None:
            return None
        shift = 2 * (first - (self._first or 0))
        if not self._whole and (stretch is None or found.cell + shift != stretch.first):
            return None
        return MonitorRecord(trace, "", (verdict,))


def _resolved(formulas: Sequence[NamedFormula], columns: Sequence[str], unit: str) -> list[Formula]:
    """The formulas in units of the trace. Raises InputError with all that is wrong."""
    found: list[Diagnostic] = []
    resolved = []
    for named in formulas:
        try:
            formula = in_trace_units(named, columns, unit)
            compile_formula(formula, columns, ticks_needed(formula))
            resolved.append(formula)
        except InputError as error:
            found += error.diagnostics
    if found:
        raise InputError(found)
    return resolved


def _number(name: str, new: object, held: float | None) -> float:
    """The value of a column after an event: the new one, or the one held where the event gives none."""
    try:
        number = math.nan if new is None else float(cast("float", new))
    except (TypeError, ValueError):
        raise UsageError(
            f"the value {new!r} of column {name!r} is no number", "values are numbers or booleans"
        ) from None
    if math.isfinite(number):
        return number
    if math.isinf(number):
        raise UsageError(f"the value {new!r} of column {name!r} is not finite")
    if held is None:
        raise UsageError(f"column {name!r} has no value yet", "the first event gives every column a value")
    return held
