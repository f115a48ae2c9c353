"""Judging a whole recorded trace."""

from __future__ import annotations

import math
import os
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError, UsageError
from tachk.base.diagnostics.suggestion import unknown_key
from tachk.recordings.monitors.compiler import compile as compile_formula
from tachk.recordings.monitors.compiler import ticks_needed
from tachk.recordings.monitors.conditions import condition_findings
from tachk.recordings.monitors.formulas import (
    NamedFormula,
    check_order,
    defined,
    in_trace_units,
    names_file,
    read_formulas,
)
from tachk.recordings.monitors.line_compiler import line_findings
from tachk.recordings.monitors.locations import located, with_named_values
from tachk.recordings.monitors.reading import Reading, reading_of
from tachk.recordings.monitors.record import MonitorRecord, MonitorVerdict, TimeRobustness, cell_time
from tachk.recordings.monitors.row_names import TIME, row_columns, with_row_columns
from tachk.recordings.monitors.texts import Texts, text_columns, unmet_texts
from tachk.recordings.traces.certainty import is_certainly_false
from tachk.recordings.traces.conventions import Ending, Interpolation
from tachk.recordings.traces.core_monitor import RobustnessResult
from tachk.recordings.traces.linear_monitor import LAST_TICK_OF_LINES, Measure, reach_of, robustness
from tachk.recordings.traces.logs.joined import with_decimals, with_texts
from tachk.recordings.traces.monitor_program import MonitorProgram
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.trace import Recording, Trace
from tachk.recordings.traces.trace_arrays import TableRecording
from tachk.recordings.traces.trace_files import open_trace
from tachk.recordings.traces.verdict_explanation import never_triggered
from tachk.report.monitor.text import print_monitor
from tachk.report.plain_console import plain_console
from tachk.syntax.formula import Formula

if TYPE_CHECKING:
    from tachk.report.json_report import Json
    from tachk.report.monitor.formula_signals import FormulaSignal
    from tachk.report.monitor.signal_plot import Plot


@dataclass(frozen=True, slots=True)
class Judging:
    """How formulas are judged, and what is computed beside their truth.

    Attributes:
        ending: what counts where the trace ends too early to tell.
        interpolation: what numbers do between rows.
        robustness: by how much values could change before the verdict does.
        time_robustness: by how much time signals could be shifted.
    """

    ending: Ending = Ending.UNDETERMINED
    interpolation: Interpolation = Interpolation.CONSTANT
    robustness: bool = True
    time_robustness: bool = False


def monitor(
    formula: str | os.PathLike[str] | Sequence[str],
    trace: Any,
    *,
    time: str | None = None,
    unit: str | None = None,
    ports: Sequence[int] = (),
    end: str = "undetermined",
    robustness: bool = True,
    time_robustness: bool = False,
    interpolation: str = "constant",
    constants: Mapping[str, str | float | Fraction] | None = None,
    select: Collection[str] = (),
    decimals: int | None = None,
    run: int | None = None,
) -> MonitorReport:
    """Judges a recorded trace by one formula or several.

    Args:
        formula: a formula (``"G (p -> F[0, 5 s] q)"``), a sentence, several of them, the path of a file of formulas
            (``.stl``), or of a model, whose formulas and sentences are taken.
        trace: the path of a file in one of the formats of `tachk.recordings.traces.trace_files`, such as CSV; a data
            frame, or a mapping from names to arrays.
        time: the name of the time column, where it is not ``time``, ``t`` or ``timestamp``.
        unit: of the times, such as ``"ms"``, where the trace does not say it.
        ports: of a capture of packets, those of Agents; none: 8888.
        end: what counts where the trace ends too early to tell: ``"undetermined"``, ``"weak"`` (as satisfied) or
            ``"strong"`` (as violated).
        robustness: compute how far each verdict is from changing.
        time_robustness: compute by how much time signals could be shifted before the verdict changes.
        interpolation: between rows ``"constant"`` values are held, ``"linear"`` numbers move in straight lines.
        constants: values for names in bounds and conditions, such as ``{"T": 2.5}`` for ``F[0, T] p``; of a model,
            other values of its constants.
        select: the names of the formulas that are judged; none: all.
        decimals: times are rounded to so many; None: they are exact, unless they are floating-point numbers of more
            than fifteen digits.
        run: the number of the run that is meant in a file of several, such as `tachk simulate --runs` writes.

    Raises:
        InputError: a formula or the trace is wrong; carries every finding.
        UsageError: a file cannot be read, or an argument has no meaning.
    """
    ending = ending_of(end)
    check_order(formula, trace)
    formulas = selected(formulas_of(formula, constants), select)
    judging = Judging(ending, interpolation_of(interpolation), robustness, time_robustness)
    recording = with_decimals(open_trace(trace, time, unit, ports, run), decimals)
    source = os.fspath(formula) if isinstance(formula, (str, os.PathLike)) and names_file(formula) else ""
    return MonitorReport(judge(formulas, recording, judging, source))


def judge(
    formulas: Sequence[NamedFormula],
    recording: Recording,
    judging: Judging = Judging(),
    source: str = "",
) -> MonitorRecord:
    """The record of some formulas on a recording.

    Raises:
        InputError: a formula has no meaning on the trace.
        UsageError: robustness in time is wanted of lines, or the trace is too long for lines.
    """
    if judging.time_robustness and judging.interpolation is Interpolation.LINEAR:
        raise UsageError(
            "robustness in time is defined only if values stay constant between rows",
            "leave out the linear interpolation, or the robustness in time",
        )
    formulas = [located(named, recording.columns) for named in with_named_values(formulas, recording)]
    if isinstance(recording, TableRecording) and judging.interpolation is Interpolation.CONSTANT and formulas:
        # Rows are looked over while the first formula is judged. To read them before would take half as long as that.
        try:
            return _judged(formulas, recording.supposed(), judging, source)
        except (InputError, UsageError):
            pass  # something is not as supposed, or wrong, which is told below
    return _judged(formulas, recording, judging, source)


def _judged(formulas: Sequence[NamedFormula], recording: Recording, judging: Judging, source: str) -> MonitorRecord:
    trace, programs = prepare(formulas, recording, judging.interpolation)
    reading = reading_of(trace, programs)
    verdicts = tuple(
        verdict_on(named, program, trace, judging, reading) for named, program in zip(formulas, programs, strict=True)
    )
    return MonitorRecord(reading.shown(trace), source, verdicts, judging.ending)


def prepare(
    formulas: Sequence[NamedFormula], recording: Recording, interpolation: Interpolation = Interpolation.CONSTANT
) -> tuple[Trace, tuple[MonitorProgram, ...]]:
    """The trace, counted finely enough for all bounds, and a program for each formula. Raises InputError."""
    formulas = [named.within(recording.columns) for named in formulas]
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
    texts = frozenset(name for formula, _ in resolved for name in text_columns(formula))
    read = with_texts(recording, texts & wanted).read(wanted - {TIME} if TIME in of_rows else wanted)
    trace = with_row_columns(read, of_rows).refined(math.lcm(*(ticks for _, ticks in resolved)))
    trace = replace(trace, interpolation=interpolation)
    booleans = frozenset(name for name, values in trace.columns.items() if values.dtype.kind == "u")
    formulas_in_units = [formula for formula, _ in resolved]
    labels = Texts(trace.texts, trace.labels)
    unmet = tuple(dict.fromkeys(each for formula in formulas_in_units for each in unmet_texts(formula, trace)))
    trace = replace(trace, warnings=(*trace.warnings, *unmet)) if unmet else trace
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
    """Raises InputError and UsageError for what has no meaning on lines."""
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


def ending_of(name: str) -> Ending:
    """The ending of this name. Raises UsageError."""
    try:
        return Ending(name)
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
    judging: Judging,
    reading: Reading,
) -> MonitorVerdict:
    """The verdict of one program on a whole trace. Its explanation is made when it is asked for."""
    robustness = None
    if judging.robustness:
        truth, robustness = reading.measured(program, trace)
    else:
        truth = reading.truth(program, trace)
    measured = truth.measured
    if measured is Truth.FALSE and not is_certainly_false(program, trace):
        measured = Truth.UNDETERMINED
        robustness = None if robustness is None else replace(robustness, high=math.inf)
    explainer = reading.explainer(program, trace)
    presumably = truth.lasting if measured is Truth.UNDETERMINED else None
    triggers = never_triggered(program) if measured is Truth.TRUE else ()
    return MonitorVerdict(
        named.name,
        named.title,
        named.text,
        named.sentence,
        measured,
        counted(measured, judging.ending),
        presumably,
        None if robustness is None else (robustness.low, robustness.high),
        bool(triggers) and all(reading.truth(never, trace).measured is Truth.TRUE for never in triggers),
        explainer.program,
        explainer,
        _time_robustness(program, trace) if judging.time_robustness else None,
    )


def counted(measured: Truth, ending: Ending) -> Truth:
    """What counts where the end of the trace has been given a meaning."""
    if measured is not Truth.UNDETERMINED or ending is Ending.UNDETERMINED:
        return measured
    return Truth.TRUE if ending is Ending.WEAK else Truth.FALSE


def _time_robustness(program: MonitorProgram, trace: Trace) -> TimeRobustness:
    def in_units(ticks: RobustnessResult) -> tuple[float, float]:
        return ticks.low / trace.ticks_per_unit, ticks.high / trace.ticks_per_unit

    return TimeRobustness(
        in_units(robustness(program, trace, Measure.AHEAD)), in_units(robustness(program, trace, Measure.BEHIND))
    )


@dataclass(frozen=True, slots=True, eq=False)
class MonitorReport(Sequence[MonitorVerdict]):
    """The verdicts on one trace, in the order of the formulas; ``report["name"]`` finds one by name."""

    record: MonitorRecord

    @overload
    def __getitem__(self, index: int | str) -> MonitorVerdict: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[MonitorVerdict, ...]: ...
    def __getitem__(self, index: int | str | slice) -> MonitorVerdict | tuple[MonitorVerdict, ...]:
        if isinstance(index, str):
            for verdict in self.record.verdicts:
                if verdict.name == index:
                    return verdict
            raise unknown_key(index, (verdict.name for verdict in self.record.verdicts))
        return self.record.verdicts[index]

    def __len__(self) -> int:
        return len(self.record.verdicts)

    @property
    def truth(self) -> Truth:
        """FALSE if one verdict is, else UNDETERMINED if one is, else TRUE."""
        truths = {verdict.truth for verdict in self.record.verdicts}
        return next(t for t in (Truth.FALSE, Truth.UNDETERMINED, Truth.TRUE) if t in truths)

    def to_dict(self, all_violations: bool = False) -> dict[str, Json]:
        """The record as docs/schema/monitor.schema.json describes it, its violations counted or listed."""
        from tachk.report.monitor.json import monitor_to_json

        return monitor_to_json(self.record, all_violations)

    def to_rows(self) -> list[Mapping[str, str | float | bool | None]]:
        """One flat dictionary for each verdict: what `pandas.DataFrame` takes. Instants are in the trace's unit."""
        trace = self.record.trace
        rows: list[Mapping[str, str | float | bool | None]] = []
        for verdict in self.record.verdicts:
            finding = verdict.finding
            low, high = verdict.robustness or (None, None)
            ahead = verdict.time_robustness.ahead if verdict.time_robustness else (None, None)
            behind = verdict.time_robustness.behind if verdict.time_robustness else (None, None)
            deadline = None if finding is None else finding.deadline
            rows.append(
                {
                    "trace": trace.name,
                    "name": verdict.name,
                    "formula": verdict.formula,
                    "verdict": verdict.truth.word,
                    "presumably": None if verdict.presumably is None else verdict.presumably.word,
                    "robustness_low": low,
                    "robustness_high": high,
                    "ahead_low": ahead[0],
                    "ahead_high": ahead[1],
                    "behind_low": behind[0],
                    "behind_high": behind[1],
                    "vacuous": verdict.vacuous,
                    "trigger": None if finding is None or finding.trigger is None else finding.trigger.text,
                    "at": None if finding is None else float(trace.clock(finding.cell // 2)),
                    "deadline": None if deadline is None else float(trace.clock(deadline // 2)),
                    "blamed": None if finding is None else ", ".join(reason.text for reason in finding.blamed),
                }
            )
        return rows

    def violation_rows(self) -> list[Mapping[str, str | float | None]]:
        """One flat dictionary for each violation of each formula, in the order of time: what `pandas.DataFrame` takes.
        Instants are in the trace's unit."""
        trace = self.record.trace
        rows: list[Mapping[str, str | float | None]] = []
        for verdict in self.record.verdicts:
            for finding in verdict.violations if verdict.measured is Truth.FALSE else ():
                triggered, deadline = finding.triggered, finding.deadline
                rows.append(
                    {
                        "trace": trace.name,
                        "name": verdict.name,
                        "violated": finding.formula,
                        "from": float(trace.clock(cell_time(finding.cell))),
                        "until": float(trace.clock((finding.last + 1) // 2)),
                        "triggered_from": None if triggered is None else float(trace.clock(cell_time(triggered[0]))),
                        "deadline": None if deadline is None else float(trace.clock(cell_time(deadline))),
                        "blamed": ", ".join(reason.text for reason in finding.blamed),
                    }
                )
        return rows

    def signal(self, name: str) -> FormulaSignal:
        """The truth and the robustness of a formula at every instant of the trace, as arrays; of ``G f`` those of f."""
        from tachk.report.monitor.formula_signals import signal_of

        return signal_of(self.record, self[name])

    def plot(
        self,
        path: str | os.PathLike[str] | None = None,
        begin: float | None = None,
        end: float | None = None,
        robustness: bool = False,
    ) -> Plot:
        """Draws signals, subformulas and verdicts. A notebook shows the result.

        Args:
            path: a file to write; its ending says the format (svg, png, pdf).
            begin, end: the part that is drawn, in the units of the trace's clock; None: all of it.
            robustness: draw the robustness of each formula over time, too.
        """
        from tachk.report.monitor.plot_rows import Stretch
        from tachk.report.monitor.signal_plot import Plot, plot_record

        trace = self.record.trace
        origin, scale = float(trace.origin), trace.ticks_per_unit
        left = 0.0 if begin is None else max((begin - origin) * scale, 0.0)
        right = float(max(trace.end, 1)) if end is None else (end - origin) * scale
        if not left < right:
            raise UsageError("the trace has nothing between these times")
        span = Stretch(left, right)
        if path is not None:
            plot_record(self.record, Path(path), span, robustness)
        return Plot(self.record, span, robustness)

    def to_text(self, all_violations: bool = False) -> str:
        """What `tachk monitor` prints, with ``--all-violations`` or without."""
        out = StringIO()
        print_monitor(self.record, plain_console(out), all_violations)
        return out.getvalue()

    def __str__(self) -> str:
        return self.to_text()

    def __repr__(self) -> str:
        verdicts = ", ".join(f"{verdict.name}: {verdict.truth.word}" for verdict in self.record.verdicts)
        return f"<MonitorReport on {self.record.trace.name}: {verdicts}>"

    def _repr_html_(self) -> str:
        from tachk.report.monitor.html import monitor_to_html

        return monitor_to_html(self.record)
