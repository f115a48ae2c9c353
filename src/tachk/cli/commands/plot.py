"""`tachk plot`: draw a trace and the violations of properties on it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from tachk.cli import options, trace_options


@click.command(name="plot")
@trace_options.formula
@trace_options.trace()
@click.option(
    "output",
    "-o",
    "--output",
    metavar="FILE",
    type=options.type_of_file,
    required=True,
    help="An .svg, .png or .pdf file.",
)
@trace_options.columns
@click.option("begin", "--from", metavar="TIME", type=float, help="Draw from this time.")
@click.option("end", "--to", metavar="TIME", type=float, help="Draw up to this time.")
@click.option("--robustness", is_flag=True, help="Draw the robustness of each formula over time, too.")
@options.max_seconds()
def command(
    output: Path, begin: float | None, end: float | None, robustness: bool, seconds: float | None, **given: Any
) -> None:
    """Draw a trace, the values of formulas and of their parts on it, and where they are violated."""
    from tachk.cli.actions.plot import PlotArguments, run_plot
    from tachk.cli.trace_arguments import TraceArguments
    from tachk.recordings.monitors.offline import EvaluationOptions

    arguments, evaluation = options.distributed(given, TraceArguments, EvaluationOptions)
    options.finish(lambda: run_plot(arguments, evaluation, PlotArguments(output, begin, end, robustness)), seconds)
