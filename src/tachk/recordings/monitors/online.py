"""Judging a trace while it is recorded, event by event."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from functools import partial
from numbers import Rational, Real
from typing import Any

import numpy as np

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError, UsageError
from tachk.base.diagnostics.suggestion import unknown_key
from tachk.base.time_units import usual_decimals
from tachk.recordings.monitors.compiler import compile as compile_formula
from tachk.recordings.monitors.compiler import ticks_needed
from tachk.recordings.monitors.conditions import no_condition
from tachk.recordings.monitors.formulas import NamedFormula, in_trace_units
from tachk.recordings.monitors.offline import counted, ending_of, formulas_of, selected, verdict_on
from tachk.recordings.monitors.online_record import OnlineRecord, OnlineVerdict, OnlineViolation
from tachk.recordings.monitors.record import MonitorRecord, MonitorVerdict
from tachk.recordings.monitors.row_names import TIME, RowNames
from tachk.recordings.monitors.texts import TextNumbers, Texts, text_columns, texts_of
from tachk.recordings.monitors.trace_semantics import HeldValues
from tachk.recordings.traces.arrivals import topic_of
from tachk.recordings.traces.conventions import EvaluationOptions
from tachk.recordings.traces.location_names import location_names, locations_in, locations_in_columns
from tachk.recordings.traces.logs.cell_texts import plain_cell
from tachk.recordings.traces.monitor_group import RowFault, open_group
from tachk.recordings.traces.monitor_program import MonitorProgram
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.trace import Ticks, Trace, Values
from tachk.recordings.traces.trace_arrays import cells_of, held_values
from tachk.recordings.traces.trace_header import known_unit
from tachk.recordings.traces.violation_watch import ViolationWatch
from tachk.syntax.formula import Formula

Time = int | float | Fraction | Decimal


@dataclass(slots=True)
class _WatchedFormula:
    """Attributes:
    stretch: the first cell of the violation and the one behind it, as they were known when the formula was decided.
    """

    named: NamedFormula
    program: MonitorProgram
    text: str
    story: MonitorRecord | None = None
    interval: tuple[int, int] | None = None
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

    dated: bool = False
    """Times are seconds since 1970, and reports show them as dates."""

    notes: tuple[str, ...] = ()
    """Remarks of the reader of the trace for reports, such as that times are rounded."""

    def __init__(
        self,
        formula: str | os.PathLike[str] | Sequence[str] | Sequence[NamedFormula],
        *,
        unit: str = "",
        decimals: int | None = None,
        end: str = "undetermined",
        robustness: bool = False,
        all_violations: bool = False,
        constants: Mapping[str, str | float | Fraction] | None = None,
        select: Sequence[str] = (),
        packets: Callable[[Ticks], Ticks] | None = None,
    ) -> None:
        """Args:
            formula: as for `tachk.monitor`.
            unit: of the times that will be given, such as ``"ms"``.
            decimals: times are counted in units of ``10 ** -decimals``; floating-point times are rounded to them. By
                default as many as make nanoseconds, at most 9.
            end: what counts where the trace ends too early to decide: ``"undetermined"``, ``"weak"``, ``"strong"``.
            robustness: keep bounds of the robustness too.
            all_violations: go on after the first violation of a formula, see `take_violations`.
            constants: as for `tachk.monitor`.
            select: the names of the formulas that are watched; none: all.
            packets: of a capture, from times in units of ``10 ** -decimals`` to numbers of packets, 0 for none.

        Raises:
            InputError: a formula is wrong.
            UsageError: a file cannot be read, or an argument has no meaning.
        """
        self._ending = ending_of(end)
        self._unit = known_unit(unit)
        self._robust, self._packets = robustness, packets
        formulas = selected(formulas_of(formula, constants), select)
        whole = [named.within(()) for named in formulas]
        self._named = frozenset(name for named in formulas for name in named.named_formulas)
        self.columns = _columns(whole)
        self._of_rows = RowNames(tuple(name for name in self.columns if name == TIME or topic_of(name) is not None))
        self._locations = location_names(self.columns)
        resolved = _resolved(whole, self.columns, self._unit)
        self._texts = TextNumbers(resolved)
        self.decimals = usual_decimals(self._unit) if decimals is None else decimals
        if not 0 <= self.decimals <= 18:
            raise UsageError(f"decimals={decimals}: expected 0 to 18")
        self._scale = math.lcm(10**self.decimals, *(ticks_needed(formula) for formula in resolved))
        programs = [compile_formula(tree, self.columns, self._scale, texts=self._texts.known) for tree in resolved]
        self._watched = [_WatchedFormula(*each, each[0].text) for each in zip(formulas, programs, strict=True)]
        try:
            self._group = open_group(
                programs,
                self.columns,
                robustness=robustness,
                decimals=self.decimals,
                parts=self._scale // 10**self.decimals,
                exact=partial(_exact_tick, self._scale),
            )
            self._watch = None if not all_violations else self._violation_watch(programs)
        except ValueError:
            raise UsageError(f"times cannot be counted in units of 1/{self._scale}", "allow fewer decimals") from None
        self._update, self._push = self._group.update, self._group.push
        self._factors: dict[int, int] = {}

    # ---- rows ----

    def update(self, time: Time, values: Mapping[str, float | str] | None = None, **more: float | str) -> Truth:
        """Some columns have these values from this time on; the others keep theirs.

        None and NaN mean that a value stays; columns that no formula reads may be there. `P.loc` is true where `P` has
        the text ``"loc"``, unless the first row gives `P.loc` a value itself.

        Returns the verdict on all formulas together, see `truth`. Raises UsageError, with column and row, for a column
        without a value, for what is not a number, for a time before the one given last, and for a time that differs
        from that of the row before by too little to be counted. The monitor has then changed nothing.
        """
        if self._named:
            self._check_names({**(values or {}), **more})
        locations, after = self._locations, self._of_rows
        if locations:
            values, more = {**(values or {}), **more}, {}
            found = locations_in(locations, values)
            values.update(found)
            locations = locations if self._group.begun() else {name: locations[name] for name in found}
        if after.names:
            values, after = after.row(time, {**(values or {}), **more})
            more = {}
        if self._texts.columns:
            values, more = self._texts.in_row({**(values or {}), **more}, self.rows), {}
        truth = self._update(time, values, more)
        if truth is None and self._group.fault()[0] == RowFault.NOT_A_VALUE:
            values, more = {name: plain_cell(value) for name, value in {**(values or {}), **more}.items()}, {}
            truth = self._update(time, values, more)
        if truth is None:
            self._refuse(
                time, lambda name: more.get(name) if values is None else dict(values).get(name, more.get(name))
            )
            truth = self._note_verdicts()
        if self._watch is not None:
            self._watch.update(time, values, more)
        self._locations, self._of_rows = locations, after
        return truth

    def push(self, times: Ticks, columns: Mapping[str, Any], decimals: int) -> Truth:
        """Many rows at once, their times in units of ``10 ** -decimals``. Every column is given.

        Returns and raises the same as `update`.
        """
        factor = self._factors.get(decimals) or self._factor(decimals)
        if self._named:
            self._check_names(columns)
        locations, after = self._locations, self._of_rows
        if locations:
            found = locations_in_columns(locations, columns)
            columns = {**columns, **found}
            begun = self._group.begun() or len(times) == 0
            locations = locations if begun else {name: locations[name] for name in found}
        if after.names:
            columns, after = after.rows(self._whole_numbers(times), columns, decimals)
        if self._texts.columns:
            columns = self._texts.in_rows(columns, f"in what was pushed behind row {self.rows}")
        truth = self._push(times, columns, factor)
        if truth is None and self._group.fault()[0] in (RowFault.NOT_A_VALUE, RowFault.NOT_A_TIME):
            times, columns = self._whole_numbers(times), self._held(columns, len(times))
            truth = self._push(times, columns, factor)
        if truth is None:
            row = self._group.fault()[2]
            self._refuse(
                Fraction(int(times[row]), 10**decimals) if len(times) else 0,
                lambda name: np.asarray(columns[name])[row],
                row,
            )
            truth = self._note_verdicts()
        if self._watch is not None:
            self._watch.push(times, columns, factor)
        self._locations, self._of_rows = locations, after
        return truth

    def advance(self, time: Time) -> Truth:
        """Nothing has changed before this time; something may still change at it. Raises UsageError."""
        self._check_begun()
        truth = self._group.advance(time)
        if truth is None:
            self._refuse(time)
            truth = self._note_verdicts()
        if self._watch is not None:
            self._watch.advance(time)
        return truth

    def finish(self, time: Time | None = None) -> tuple[OnlineVerdict, ...]:
        """The trace is over; it includes this time, or else ends with the last one given. Returns the verdicts."""
        self._check_begun()
        if self._group.finish(time) is None:
            self._refuse(time)
            self._note_verdicts()
        if self._watch is not None:
            self._watch.finish(time)
        return self.verdicts

    # ---- verdicts ----

    @property
    def truth(self) -> Truth:
        """FALSE if one formula is false, else UNDETERMINED if one is undetermined, else TRUE."""
        return self._group.verdict()

    @property
    def decided(self) -> bool:
        """True if nothing that follows can change a verdict."""
        return self._group.open() == 0

    @property
    def robustness(self) -> tuple[tuple[float, float], ...]:
        """Bounds of the robustness of every continuation, for each formula in order. Raises UsageError without
        ``robustness=True``."""
        if not self._robust:
            raise UsageError("this monitor keeps no robustness", "open it with robustness=True")
        return tuple([self._group.robustness(number) for number in range(len(self._watched))])

    def take_violations(self) -> tuple[OnlineViolation, ...]:
        """The news since the last call: each violation when it begins and, once more, when it has ended.

        Those of one part of a formula come in the order of time: a violation is reported when all before it is decided.
        At the end of the trace all that `tachk.monitor` finds have been reported. Raises UsageError without
        ``all_violations=True``.
        """
        if self._watch is None:
            raise UsageError("this monitor reports the first violation only", "open it with all_violations=True")
        return tuple(
            OnlineViolation(
                self._watched[change.formula].named.name,
                change.part,
                self._clock(Fraction(change.first, 2)),
                None if change.end is None else self._clock(change.end // 2),
            )
            for change in self._watch.take()
        )

    @property
    def verdicts(self) -> tuple[OnlineVerdict, ...]:
        """One for each formula, in order."""
        return tuple(self._verdict(number) for number in range(len(self._watched)))

    def __getitem__(self, name: str) -> OnlineVerdict:
        for number, watched in enumerate(self._watched):
            if watched.named.name == name:
                return self._verdict(number)
        raise unknown_key(name, (watched.named.name for watched in self._watched))

    @property
    def watches_violations(self) -> bool:
        """True if all violations are reported."""
        return self._watch is not None

    @property
    def text_columns(self) -> frozenset[str]:
        """The columns that hold texts, because a formula compares them with one."""
        return self._texts.columns

    @property
    def unit(self) -> str:
        """The unit of the times of rows, such as ``ms``; empty where nobody said it."""
        return self._unit

    @property
    def rows(self) -> int:
        """The number of rows so far."""
        return self._group.rows()

    def record(self, name: str = "-", violations: Sequence[OnlineViolation] | None = None) -> OnlineRecord:
        """Everything that is known now, for reports.

        Args:
            name: of the trace.
            violations: those that have been taken and have ended; None: they are not known.
        """
        group = self._group
        begin, end = self._clock(0), self._clock(group.now())
        known = None if violations is None else tuple(violations)
        shown = self._unit, self._ending, self.verdicts, known, self.dated, self.notes
        return OnlineRecord(name, group.rows(), begin, end, *shown)

    @property
    def bytes_used(self) -> int:
        """Memory held by the monitors, without the rows that are kept for explanations."""
        return self._group.bytes()

    # ---- inside ----

    def _factor(self, decimals: int) -> int:
        if not 0 <= decimals <= self.decimals:
            raise UsageError(
                f"times in units of 1e-{decimals} are finer than those of the monitor, 1e-{self.decimals}",
                f"open it with decimals={decimals}",
            )
        self._factors[decimals] = self._scale // 10**decimals
        return self._factors[decimals]

    def _check_names(self, given: Collection[str]) -> None:
        """Raises UsageError for a column that has the name of a formula which another one names."""
        for name in self._named.intersection(given):
            raise UsageError(f"`{name}` is a column and a formula of the file", "rename the formula")

    def _whole_numbers(self, times: Any) -> Ticks:
        array = np.asarray(times)
        if array.ndim != 1 or array.dtype.kind not in "iu":
            raise UsageError("the times of many rows are a one-dimensional array of whole numbers")
        return np.ascontiguousarray(array, dtype=np.int64)

    def _held(self, columns: Mapping[str, Any], count: int) -> dict[str, Values]:
        """Arrays without missing values. Raises UsageError for a column that is none of numbers, and so long."""
        name = f"in what was pushed behind row {self.rows}"
        held = {}
        for number, column in enumerate(self.columns):
            if column not in columns:
                raise UsageError(f"{name}: there is no column {column!r}", "many rows at once give every column")
            values = held_values(_plain_cells(columns[column]), column, name, self._group.held(number))
            if len(values) != count:
                raise UsageError(f"{name}: column {column!r} has {len(values)} values for {count} times")
            held[column] = values
        return held

    def _check_begun(self) -> None:
        if not self._group.begun():
            raise UsageError("the trace has no rows", "the verdict needs at least the state at the beginning")

    def _refuse(self, time: Time | None, given: Callable[[str], object] = lambda name: None, row: int = 0) -> None:
        """Raises UsageError if the last call met a fault.

        Args:
            time: that it was given.
            given: what it was given for a column.
            row: that is at fault, among those of the call.
        """
        kind, number, _ = self._group.fault()
        fault = RowFault(kind)
        if fault is RowFault.NONE:
            return
        place = f"row {self.rows + row}, at {time}"
        match fault:
            case RowFault.FINISHED:
                raise UsageError("the trace is over", "begin a new monitor")
            case RowFault.BACKWARDS:
                raise UsageError(f"{place}: the time {time} lies before the one given last")
            case RowFault.TOO_FAR:
                raise UsageError(
                    f"{place}: the time {time} is too far from the beginning to be counted in units of 1/{self._scale}",
                    f"allow fewer decimals, say {self.decimals - 3}" if self.decimals >= 3 else "begin a new monitor",
                )
            case RowFault.MERGED:
                raise UsageError(
                    f"{place}: the time {time} differs from that of the row before, but in units of "
                    f"1/{self._scale} both are the same",
                    "allow more decimals, or round the times where they should be equal",
                )
            case RowFault.NOT_A_TIME:
                raise UsageError(f"{place}: the time {time} is not a number that can be counted")
            case RowFault.NO_TRUTH | RowFault.NOT_A_VALUE | RowFault.MISSING:
                pass
        column = self.columns[number]
        match fault:
            case RowFault.NO_TRUTH:
                raise no_condition(place, column, given(column))
            case RowFault.NOT_A_VALUE:
                raise UsageError(
                    f"{place}: the value {given(column)!r} of column {column!r} is not a number",
                    "values are numbers or booleans",
                )
            case RowFault.MISSING:
                raise UsageError(
                    f"{place}: column {column!r} has no value yet", "the first event gives every column a value"
                )

    def _note_verdicts(self) -> Truth:
        """Notes the decisions of the last call, while the rows that explain it are there still."""
        for number, watched in enumerate(self._watched):
            truth = Truth(self._group.verdict_of(number))
            if watched.decided or truth is Truth.UNDETERMINED:
                continue
            watched.decided = True
            watched.interval = self._group.violation(number)
            if truth is Truth.FALSE:
                watched.story = self._story(watched)
        return self._group.verdict()

    def _verdict(self, number: int) -> OnlineVerdict:
        watched, group = self._watched[number], self._group
        named = watched.named
        measured = Truth(group.verdict_of(number))
        at = group.decided_at(number)
        interval = watched.interval
        return OnlineVerdict(
            named.name,
            named.title,
            watched.text,
            named.sentence,
            measured,
            counted(measured, self._ending) if group.finished(number) else measured,
            None if at is None else self._clock(at),
            None if interval is None else (self._clock(interval[0] // 2), self._clock(interval[1] // 2)),
            group.robustness(number) if self._robust else None,
            watched.story,
        )

    def _violation_watch(self, programs: Sequence[MonitorProgram]) -> ViolationWatch:
        return ViolationWatch(
            programs,
            self.columns,
            decimals=self.decimals,
            parts=self._scale // 10**self.decimals,
            exact=partial(_exact_tick, self._scale),
        )

    def _clock(self, tick: int | Fraction) -> Fraction:
        return Fraction(self._group.origin() + tick) / self._scale

    def _story(self, watched: _WatchedFormula) -> MonitorRecord | None:
        """The violation on the rows that are kept, if it is found there as the first one."""
        ticks, values_of_rows, whole = self._group.retained_rows()
        columns = {
            name: values if name in self._texts.columns else held_values(values, name, "the trace")
            for name, values in zip(self.columns, values_of_rows, strict=True)
        }
        first = int(ticks[0])
        end = max(self._group.now(), int(ticks[-1])) - first
        packets = None if self._packets is None else self._packets(ticks // (self._scale // 10**self.decimals))
        clock = self._clock(first)
        trace = Trace(
            "", ticks - first, columns, end, self._scale, self._unit, clock, packets=packets, dated=self.dated
        )
        trace = self._texts.on(trace)
        verdict: MonitorVerdict = verdict_on(
            watched.named, watched.program, trace, EvaluationOptions(robustness=False), HeldValues()
        )
        found = verdict.finding
        if verdict.measured is not Truth.FALSE or found is None:
            return None
        if not whole and (watched.interval is None or found.cell + 2 * first != watched.interval[0]):
            return None
        return MonitorRecord(trace, "", (verdict,))


def _plain_cells(values: Any) -> Any:
    """The cells of a column with numbers in place of texts that say some."""
    array = cells_of(values)
    if array.dtype.kind not in "OUT":
        return values
    plain = np.empty(len(array), dtype=object)
    plain[:] = [plain_cell(value) for value in array.tolist()]
    return plain


def _exact_tick(scale: int, time: Any) -> int:
    """A time that is neither int nor float, in ticks. Raises UsageError."""
    try:
        exact = Fraction(str(time) if isinstance(time, Real) and not isinstance(time, Rational) else time)
    except (TypeError, ValueError, OverflowError):
        raise UsageError(
            f"the time {time!r} is not a number",
            "times are numbers in the unit of the monitor, such as time.timestamp() in seconds",
        ) from None
    ticks = exact * scale
    if ticks.denominator != 1:
        raise UsageError(f"the time {time} is finer than 1/{scale}", "allow more decimals")
    return int(ticks)


def _columns(formulas: Sequence[NamedFormula]) -> tuple[str, ...]:
    """The columns that the formulas read."""
    names = (each for named in formulas for each in sorted(named.columns) if each not in named.constant_names)
    return tuple(dict.fromkeys(names))


def _resolved(formulas: Sequence[NamedFormula], columns: Sequence[str], unit: str) -> list[Formula]:
    """The formulas in units of the trace. Raises InputError with all that is wrong."""
    found: list[Diagnostic] = []
    resolved = []
    for named in formulas:
        try:
            formula = in_trace_units(named, columns, unit)
            texts = Texts(text_columns(formula), texts_of(formula))
            compile_formula(formula, columns, ticks_needed(formula), texts=texts)
            resolved.append(formula)
        except InputError as error:
            found += error.diagnostics
    if found:
        raise InputError(found)
    return resolved
