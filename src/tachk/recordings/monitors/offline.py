"""Judging a whole recorded trace."""

from __future__ import annotations

import math
import os
from collections.abc import Collection, Iterable, Mapping, Sequence
from fractions import Fraction
from functools import lru_cache

import numpy as np

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError, UsageError
from tachk.base.records import replace
from tachk.recordings.monitors.column_kinds import read_columns
from tachk.recordings.monitors.compiler import compile as compile_formula
from tachk.recordings.monitors.compiler import ticks_needed
from tachk.recordings.monitors.conditions import condition_findings
from tachk.recordings.monitors.formulas import (
    NamedFormula,
    beside_columns,
    defined,
    hidden_formulas,
    in_trace_units,
    read_formulas,
)
from tachk.recordings.monitors.line_compiler import line_findings
from tachk.recordings.monitors.locations import located
from tachk.recordings.monitors.record import MonitorRecord, MonitorVerdict, TimeRobustness
from tachk.recordings.monitors.row_names import TIME, row_columns, with_row_columns
from tachk.recordings.monitors.texts import Texts, unmet_texts
from tachk.recordings.monitors.trace_semantics import TraceSemantics, semantics_of
from tachk.recordings.monitors.value_names import names_of_values, with_named_values
from tachk.recordings.traces.certainty import is_certainly_false
from tachk.recordings.traces.conventions import EvaluationOptions, Interpolation, TraceEnding
from tachk.recordings.traces.core_monitor import RobustnessResult
from tachk.recordings.traces.linear_monitor import LAST_TICK_OF_LINES, Measure, reach_of, robustness
from tachk.recordings.traces.monitor_program import MonitorProgram
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.trace import Trace, TraceSource
from tachk.recordings.traces.trace_arrays import TableRecording
from tachk.recordings.traces.verdict_explanation import never_triggered
from tachk.syntax.formula import Formula


def evaluate_formulas(
    formulas: Sequence[NamedFormula],
    recording: TraceSource,
    evaluation: EvaluationOptions = EvaluationOptions(),
    source: str = "",
) -> MonitorRecord:
    """The record of some formulas on a recording.

    Raises:
        InputError: a formula has no meaning on the trace.
        UsageError: robustness in time is wanted of lines, or the trace is too long for lines.
    """
    if evaluation.time_robustness and evaluation.interpolation is Interpolation.LINEAR:
        raise UsageError(
            "robustness in time is defined only if values stay constant between rows",
            "leave out the linear interpolation, or the robustness in time",
        )
    resolved = resolved_on(formulas, recording)
    record = _evaluated_at_once(resolved, recording, evaluation, source)
    if all(verdict.measured is Truth.TRUE for verdict in record.verdicts):
        return record
    return replace(record, trace=replace(record.trace, value_names=names_of_values(formulas, recording)))


def resolved_on(formulas: Sequence[NamedFormula], recording: TraceSource) -> list[NamedFormula]:
    """The formulas with the names of values and locations that a recording has."""
    return [located(named, recording.columns) for named in with_named_values(formulas, recording)]


def _evaluated_at_once(
    formulas: Sequence[NamedFormula], recording: TraceSource, evaluation: EvaluationOptions, source: str
) -> MonitorRecord:
    if isinstance(recording, TableRecording) and evaluation.interpolation is Interpolation.CONSTANT and formulas:
        # Rows are looked over while the first formula is evaluated. To read them before would take half as long.
        try:
            return _evaluated(formulas, recording.supposed(), evaluation, source)
        except (InputError, UsageError):
            pass  # the rows are out of order, or the trace has an error: below every row is checked first
    return _evaluated(formulas, recording, evaluation, source)


def _evaluated(
    formulas: Sequence[NamedFormula], recording: TraceSource, evaluation: EvaluationOptions, source: str
) -> MonitorRecord:
    trace, programs = prepare(formulas, recording, evaluation.interpolation)
    semantics = semantics_of(trace, programs)
    verdicts = tuple(
        verdict_on(named, program, trace, evaluation, semantics)
        for named, program in zip(formulas, programs, strict=True)
    )
    return MonitorRecord(semantics.shown(trace), source, verdicts, evaluation.ending)


def prepare(
    formulas: Sequence[NamedFormula], recording: TraceSource, interpolation: Interpolation = Interpolation.CONSTANT
) -> tuple[Trace, tuple[MonitorProgram, ...]]:
    """The trace, counted finely enough for all bounds, and a program for each formula. Raises InputError."""
    hidden = hidden_formulas(formulas, recording.columns)
    formulas = [named.within(()) for named in beside_columns(formulas, recording.columns)]
    of_rows = row_columns(formulas, recording.columns)
    known = tuple(dict.fromkeys((*recording.columns, *of_rows)))
    wanted = {name for named in formulas for name in named.columns}.intersection(known)
    resolved = []
    found: list[Diagnostic] = []
    for named in formulas:
        try:
            resolved.append(_resolved(named, known, recording.unit))
        except InputError as error:
            found += error.diagnostics
    if found:
        raise InputError(found)
    formulas_in_units = [formula for formula, _ in resolved]
    read = read_columns(recording, formulas_in_units, wanted - {TIME} if TIME in of_rows else wanted)
    trace = with_row_columns(read, of_rows).refined(math.lcm(*(ticks for _, ticks in resolved)))
    trace = replace(trace, interpolation=interpolation)
    booleans = frozenset(name for name, values in trace.columns.items() if values.dtype.kind == "u")
    labels = Texts(trace.texts, trace.labels)
    unmet = tuple(dict.fromkeys(each for formula in formulas_in_units for each in unmet_texts(formula, trace)))
    trace = replace(trace, warnings=(*trace.warnings, *hidden, *unmet)) if hidden or unmet else trace
    programs = tuple(_program(formula, known, trace.ticks_per_unit, booleans, labels) for formula in formulas_in_units)
    unfit = [
        finding
        for formula, program in zip(formulas_in_units, programs, strict=True)
        for finding in condition_findings(formula, program, trace)
    ]
    if unfit:
        raise InputError(unfit)
    if interpolation is Interpolation.LINEAR:
        _check_lines(formulas_in_units, programs, trace)
    return trace, programs


def _resolved(named: NamedFormula, columns: tuple[str, ...], unit: str) -> tuple[Formula, int]:
    """The formula in units of a trace with these columns, and the ticks of a unit that it needs. Raises InputError."""
    if named.constants is None and named.given is None and named.durations is None:
        return _plainly_resolved(named, columns, unit)
    return _newly_resolved(named, columns, unit)


def _newly_resolved(named: NamedFormula, columns: tuple[str, ...], unit: str) -> tuple[Formula, int]:
    formula = in_trace_units(named, columns, unit)
    ticks = ticks_needed(formula)
    _program(formula, columns, ticks, None)
    return formula, ticks


# One formula often judges many traces.
_plainly_resolved = lru_cache(maxsize=256)(_newly_resolved)


@lru_cache(maxsize=256)
def _program(
    formula: Formula, columns: tuple[str, ...], ticks: int, booleans: frozenset[str] | None, texts: Texts | None = None
) -> MonitorProgram:
    return compile_formula(formula, columns, ticks, booleans=booleans, texts=texts)


def _check_lines(formulas: Sequence[Formula], programs: Sequence[MonitorProgram], trace: Trace) -> None:
    """Raises InputError and UsageError for formulas without meaning on lines."""
    moving = [column for column in trace.columns if trace.moves(column)]
    for column in moving:
        if not np.isfinite(trace.columns[column]).all():
            message = f"{trace.name}: column {column!r} has an infinite value, to which no straight line leads"
            raise UsageError(message, "leave out the linear interpolation")
    found: list[Diagnostic] = []
    for formula, program in zip(formulas, programs, strict=True):
        found += line_findings(formula, moving)
        if reach_of(program) >= LAST_TICK_OF_LINES:
            ticks = f"2**47 ticks, {trace.ticks_per_unit} to a time unit"
            message = f"the durations of this formula add up to more than {ticks}, the most where values lie on lines"
            found.append(Diagnostic("E0903", message, formula.span))
    if found:
        raise InputError(found)


def selected(formulas: Sequence[NamedFormula], names: Collection[str]) -> tuple[NamedFormula, ...]:
    """The formulas of these names, all where there are none. Raises UsageError for a name that is not there."""
    known = [named.name for named in formulas]
    for name in names:
        if name not in known:
            raise UsageError(f"there is no formula {name!r}", f"there are: {', '.join(known)}")
    return tuple(named for named in formulas if not names or named.name in names)


def ending_of(name: str) -> TraceEnding:
    """The ending of this name. Raises UsageError."""
    try:
        return TraceEnding(name)
    except ValueError:
        raise UsageError(f"end={name!r}: expected undetermined, weak or strong") from None


def interpolation_of(name: str) -> Interpolation:
    """The interpolation of this name. Raises UsageError."""
    try:
        return Interpolation(name)
    except ValueError:
        raise UsageError(f"interpolation={name!r}: expected constant or linear") from None


def formulas_of(
    given: str | os.PathLike[str] | Sequence[str] | Sequence[NamedFormula],
    constants: Mapping[str, str | float | Fraction] | None = None,
) -> tuple[NamedFormula, ...]:
    """The formulas of a text, a file, or several texts; these are named ``p1``, ``p2``, ... in order.

    Args:
        constants: values of constants of a model or a file, and of names in bounds and conditions.

    Raises:
        InputError: a formula is wrong.
        UsageError: something else is given.
    """
    if isinstance(given, (str, os.PathLike)):
        return read_formulas(given, {name: str(value) for name, value in (constants or {}).items()})
    anything: object = given
    entries: tuple[object, ...] = tuple(anything) if isinstance(anything, Iterable) else (anything,)
    strange = next((entry for entry in entries if not isinstance(entry, (str, NamedFormula))), None)
    if strange is not None:
        raise UsageError(
            f"a formula cannot be a {type(strange).__name__}",
            "give its text, several texts, or the path of a file of formulas or of a model",
        )
    ready = tuple(entry for entry in entries if isinstance(entry, NamedFormula))
    values = {name: Fraction(str(value)) for name, value in (constants or {}).items()}
    if ready:
        return defined(ready, values)
    read = [named for text in entries if isinstance(text, str) for named in read_formulas(text)]
    return defined(tuple(replace(named, name=f"p{number}") for number, named in enumerate(read, 1)), values)


def verdict_on(
    named: NamedFormula,
    program: MonitorProgram,
    trace: Trace,
    evaluation: EvaluationOptions,
    semantics: TraceSemantics,
) -> MonitorVerdict:
    """The verdict of one program on a whole trace. Its explanation is made on demand."""
    robustness = None
    if evaluation.robustness:
        truth, robustness = semantics.measured(program, trace)
    else:
        truth = semantics.truth(program, trace)
    measured = truth.measured
    if measured is Truth.FALSE and not is_certainly_false(program, trace):
        measured = Truth.UNDETERMINED
        robustness = None if robustness is None else replace(robustness, high=math.inf)
    explainer = semantics.explainer(program, trace)
    presumably = truth.lasting if measured is Truth.UNDETERMINED else None
    triggers = never_triggered(program) if measured is Truth.TRUE else ()
    return MonitorVerdict(
        named.name,
        named.title,
        named.text,
        named.sentence,
        measured,
        counted(measured, evaluation.ending),
        presumably,
        None if robustness is None else (robustness.low, robustness.high),
        bool(triggers) and all(semantics.truth(never, trace).measured is Truth.TRUE for never in triggers),
        explainer.program,
        explainer,
        _time_robustness(program, trace) if evaluation.time_robustness else None,
    )


def counted(measured: Truth, ending: TraceEnding) -> Truth:
    """The verdict where the end of the trace has been given a meaning."""
    if measured is not Truth.UNDETERMINED or ending is TraceEnding.UNDETERMINED:
        return measured
    return Truth.TRUE if ending is TraceEnding.WEAK else Truth.FALSE


def _time_robustness(program: MonitorProgram, trace: Trace) -> TimeRobustness:
    def in_units(ticks: RobustnessResult) -> tuple[float, float]:
        return ticks.low / trace.ticks_per_unit, ticks.high / trace.ticks_per_unit

    return TimeRobustness(
        in_units(robustness(program, trace, Measure.AHEAD)), in_units(robustness(program, trace, Measure.BEHIND))
    )
