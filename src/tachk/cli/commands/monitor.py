"""The options of `tachk monitor`."""

from __future__ import annotations

from typing import Any

import click

from tachk.cli import options, trace_options
from tachk.cli.reporting import ReportForm
from tachk.runtime.conventions import Ending


@click.command(name="monitor", short_help="Judge a recorded trace by properties.")
@trace_options.formula
@trace_options.trace("; - reads CSV rows as they come")
@trace_options.columns
@click.option(
    "ending",
    "--end",
    type=options.Choice(Ending),
    default=Ending.UNDETERMINED.value,
    show_default=True,
    help="What is pending at the end counts as: undetermined, satisfied (weak), violated.",
)
@click.option(
    "--robustness/--no-robustness",
    default=True,
    show_default=True,
    help="Compute how far verdicts are from changing.",
)
@click.option(
    "--time-robustness",
    is_flag=True,
    help="Compute by how much time each column may surely be shifted, too.",
)
@click.option("--online", is_flag=True, help="Judge row by row, with bounded memory.")
@click.option("--follow", is_flag=True, help="Wait for further rows at the end of the file.")
@click.option(
    "--decimals",
    metavar="N",
    type=click.IntRange(0, 15),
    help="Row by row: the decimals of times and bounds; by default as many as make nanoseconds, at most 9.",
)
@options.max_seconds()
@options.report(ReportForm.TEXT, ReportForm.JSON, ReportForm.JUNIT)
def command(seconds: float | None, **given: Any) -> None:
    """Judge a recorded trace by formulas, sentences or the properties of a model.

    Exit status: 0 all are true, 10 some are false, 20 nothing worse than undetermined or out of time, 2 bad input.
    """
    from tachk.cli.actions.judged import Judged
    from tachk.cli.actions.monitor import run_monitor
    from tachk.cli.actions.row_by_row import RowByRow
    from tachk.cli.reporting import Reporting
    from tachk.monitoring.offline import Judging

    arguments = options.distributed(given, Judged, Judging, RowByRow, Reporting)
    options.finish(lambda: run_monitor(*arguments), seconds)
