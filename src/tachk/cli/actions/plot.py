"""The action of `tachk plot`."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from tachk.api.monitoring import MonitorReport
from tachk.cli.exit_status import ExitStatus
from tachk.cli.trace_arguments import TraceArguments, print_warnings
from tachk.recordings.monitors.offline import EvaluationOptions, judge


@dataclass(frozen=True, slots=True)
class PlotArguments:
    """Attributes:
    output: the file of the picture.
    begin, end: the part that is drawn, in units of the trace; None: all of it.
    robustness: draw it over time.
    """

    output: Path
    begin: float | None = None
    end: float | None = None
    robustness: bool = False


def run_plot(arguments: TraceArguments, evaluation: EvaluationOptions, drawn: PlotArguments) -> ExitStatus:
    """Draws a trace with what formulas are worth on it. The verdict has no influence on the exit status."""
    record = judge(arguments.formulas(), arguments.recording(), evaluation, arguments.formula)
    print_warnings(record.trace.warnings)
    MonitorReport(record).plot(drawn.output, drawn.begin, drawn.end, drawn.robustness)
    print(f"written: {drawn.output}")
    return ExitStatus.AS_EXPECTED
