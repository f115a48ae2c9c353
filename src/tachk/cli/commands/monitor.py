"""`tachk monitor`: check properties on a recorded trace."""

from __future__ import annotations

from typing import Any

import click

from tachk.cli import options, trace_options
from tachk.recordings.traces.conventions import TraceEnding
from tachk.report.monitor.formats import MONITOR_FORMATS


@click.command(name="monitor")
@trace_options.formula
@trace_options.trace("; - reads CSV or JSON lines from standard input as they come, or VCD")
@trace_options.columns
@click.option(
    "ending",
    "--end",
    type=options.Choice(TraceEnding),
    default=TraceEnding.UNDETERMINED.value,
    show_default=True,
    help="What an obligation that is open at the end counts as: undetermined, satisfied (weak) or violated (strong).",
)
@click.option(
    "--robustness/--no-robustness",
    default=True,
    show_default=True,
    help="Also compute how far values are from changing a verdict.",
)
@click.option(
    "--time-robustness",
    is_flag=True,
    help="Also compute how far each column can at least be shifted in time without changing a verdict.",
)
@click.option("--all-violations", is_flag=True, help="Report all violations, not only the first of each formula.")
@click.option(
    "--signals",
    metavar="FILE",
    type=options.type_of_file,
    help="Write the truth and the robustness of each formula over time, as comma-separated values.",
)
@click.option("--online", is_flag=True, help="Read the trace row by row, with bounded memory.")
@click.option("--follow", is_flag=True, help="At the end of the file, wait for further rows.")
@click.option("--live", is_flag=True, help="TRACE is a capture of packets that is being made: - or a file.")
@click.option("--fail-fast", is_flag=True, help="Read row by row, and stop at the first verdict that is false.")
@options.max_seconds()
@options.report(*MONITOR_FORMATS)
def command(seconds: float | None, **given: Any) -> None:
    """Check formulas, sentences or the properties of a model on a recorded trace.

    Exit status: 0 all are true, 10 some are false, 20 some are undetermined or time ran out and none is false,
    2 bad input.
    """
    from tachk.cli.actions.monitor import run_monitor
    from tachk.cli.reporting import Reporting, ViolationReporting
    from tachk.cli.row_by_row import RowByRow
    from tachk.cli.trace_arguments import TraceArguments
    from tachk.recordings.monitors.offline import EvaluationOptions

    arguments = options.distributed(given, TraceArguments, EvaluationOptions, RowByRow, ViolationReporting, Reporting)
    options.finish(lambda: run_monitor(*arguments), seconds)
