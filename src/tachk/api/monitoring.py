"""Judging recorded traces, for scripts: `tachk.monitor`, and what it answers."""

from __future__ import annotations

import os
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

from tachk.base.arguments import checked_arguments
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.diagnostics.suggestion import unknown_key
from tachk.base.frames import data_frame
from tachk.base.optional_packages import optional_packages
from tachk.recordings.monitors.formulas import (
    NamedFormula,
    check_order,
    model_formulas,
    names_file,
)
from tachk.recordings.monitors.offline import ending_of, evaluate_formulas, formulas_of, interpolation_of, selected
from tachk.recordings.monitors.record import MonitorRecord, MonitorVerdict, cell_time
from tachk.recordings.traces.conventions import EvaluationOptions
from tachk.recordings.traces.logs.joined import with_decimals
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.trace_files import open_trace
from tachk.report.monitor.text import print_monitor
from tachk.report.plain_console import plain_console

if TYPE_CHECKING:
    from tachk.api.model import Model
    from tachk.report.json_report import Json
    from tachk.report.monitor.formula_signals import FormulaSignal
    from tachk.report.monitor.signal_plot import Plot


@checked_arguments
def monitor(
    formula: str | os.PathLike[str] | Sequence[str] | Sequence[NamedFormula] | Model,
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
            (``.stl``), or a model or its path, whose formulas and sentences are taken.
        trace: the path of a file in one of the formats of `tachk.recordings.traces.trace_files`, such as CSV; a data
            frame, or a mapping from names to arrays.
        time: the name of the time column, where it is not ``time``, ``t`` or ``timestamp``.
        unit: of the times, such as ``"ms"``, where the trace does not say it.
        ports: of a capture of packets, those of Agents; none: 8888.
        end: what counts where the trace ends too early to decide: ``"undetermined"``, ``"weak"`` (as satisfied) or
            ``"strong"`` (as violated).
        robustness: compute how far each verdict is from changing.
        time_robustness: compute by how much time signals could be shifted before the verdict changes.
        interpolation: between rows ``"constant"`` values are held, ``"linear"`` numbers move in straight lines.
        constants: values for names in bounds and conditions, such as ``{"T": 2.5}`` for ``F[0, T] p``; of a model,
            other values of its constants.
        select: the names of the formulas that are evaluated; none: all.
        decimals: times are rounded to so many; None: they are exact, unless they are floating-point numbers of more
            than fifteen digits.
        run: the number of the run that is meant in a file of several, such as `tachk simulate --runs` writes.

    Raises:
        InputError: a formula or the trace is wrong; carries every finding.
        UsageError: a file cannot be read, or an argument has no meaning.
    """
    ending = ending_of(end)
    check_order(formula, trace)
    formulas = selected(_formulas(formula, constants), select)
    evaluation = EvaluationOptions(ending, interpolation_of(interpolation), robustness, time_robustness)
    recording = with_decimals(open_trace(trace, time, unit, ports, run), decimals)
    source = os.fspath(formula) if isinstance(formula, (str, os.PathLike)) and names_file(formula) else ""
    return MonitorReport(evaluate_formulas(formulas, recording, evaluation, source))


def _formulas(
    given: str | os.PathLike[str] | Sequence[str] | Sequence[NamedFormula] | Model,
    constants: Mapping[str, str | float | Fraction] | None,
) -> tuple[NamedFormula, ...]:
    """Those of a model have its constants as it was loaded."""
    if isinstance(given, str | os.PathLike | Sequence):
        return formulas_of(given, constants)
    loaded = given.loaded
    values = {name: value.span.text for name, value in loaded.overrides.items()}
    values |= {name: str(value) for name, value in (constants or {}).items()}
    return model_formulas(loaded.document.span.source, values)


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

    def __bool__(self) -> bool:
        raise TypeError("verdicts have three values: compare `report.truth` with Truth.TRUE, FALSE or UNDETERMINED")

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

    def to_frame(self) -> Any:
        """`to_rows` as a `pandas.DataFrame`. Raises UsageError where pandas is not installed."""
        return data_frame(self.to_rows())

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

    @checked_arguments
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
        with optional_packages():
            from tachk.report.monitor.plot_rows import PlotRange
            from tachk.report.monitor.signal_plot import Plot, plot_record

        trace = self.record.trace
        origin, scale = float(trace.origin), trace.ticks_per_unit
        left = 0.0 if begin is None else max((begin - origin) * scale, 0.0)
        right = float(max(trace.end, 1)) if end is None else (end - origin) * scale
        if not left < right:
            raise UsageError("the trace has nothing between these times")
        span = PlotRange(left, right)
        if path is not None:
            plot_record(self.record, Path(path), span, robustness)
        return Plot(self.record, span, robustness)

    def to_text(self, all_violations: bool = False) -> str:
        """The output of `tachk monitor`, with ``--all-violations`` or without."""
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
