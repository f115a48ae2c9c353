"""`tachk plot`: draw a trace and the violations of properties on it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tachk.base.optional_packages import require
from tachk.cli import options, trace_options
from tachk.cli.distribution import distributed
from tachk.cli.exit_status import ExitStatus

if TYPE_CHECKING:
    from tachk.cli.trace_arguments import TraceArguments
    from tachk.recordings.traces.conventions import EvaluationOptions


@click.command(name="plot")
@trace_options.formula
@trace_options.trace()
@click.option(
    "output",
    "-o",
    "--output",
    metavar="FILE",
    type=options.written_file,
    default=Path("plot.svg"),
    show_default=True,
    help="An .svg, .png or .pdf file.",
)
@trace_options.columns
@click.option("begin", "--from", metavar="TIME", type=options.FiniteNumber(), help="Draw from this time.")
@click.option("end", "--to", metavar="TIME", type=options.FiniteNumber(), help="Draw up to this time.")
@click.option("--robustness", is_flag=True, help="Draw the robustness of each formula over time, too.")
@options.max_seconds()
def command(
    output: Path, begin: float | None, end: float | None, robustness: bool, seconds: float | None, **given: Any
) -> None:
    """Draw a trace, the values of formulas and of their parts on it, and where they are violated."""
    from tachk.cli.trace_arguments import TraceArguments
    from tachk.recordings.traces.conventions import EvaluationOptions

    arguments, evaluation = distributed(given, TraceArguments, EvaluationOptions)
    options.finish(lambda: run_plot(arguments, evaluation, PlotArguments(output, begin, end, robustness)), seconds)


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
    """Draws a trace with the values of formulas on it. The verdict has no influence on the exit status."""
    from tachk.api.monitoring import MonitorReport
    from tachk.cli.trace_arguments import print_warnings
    from tachk.recordings.monitors.offline import evaluate_formulas

    require("matplotlib")
    record = evaluate_formulas(arguments.formulas(), arguments.recording(), evaluation, arguments.formula)
    print_warnings(record.trace.warnings)
    MonitorReport(record).plot(drawn.output, drawn.begin, drawn.end, drawn.robustness)
    print(f"written: {drawn.output}")
    return ExitStatus.AS_EXPECTED
