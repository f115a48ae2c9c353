"""The options of `tachk monitor`."""

from __future__ import annotations

from typing import Any

import click

from tachk.cli import options


@click.command(name="monitor", short_help="Judge a recorded trace by properties.")
@options.formula
@click.argument("trace", type=click.Path(), help="A CSV, Parquet or VCD file; - reads CSV rows as they come.")
@options.columns
@click.option(
    "--end",
    type=click.Choice(["undetermined", "weak", "strong"]),
    default="undetermined",
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
@options.report("text", "json", "junit")
def command(**given: Any) -> None:
    """Judge a recorded trace by formulas, sentences or the properties of a model.

    Exit status: 0 all are true, 10 some are false, 20 nothing worse than undetermined, 2 bad input.
    """
    from tachk.cli.actions.monitor import run_monitor
    from tachk.cli.actions.monitor_request import MonitorRequest

    request = MonitorRequest(**given)
    options.finish(lambda: run_monitor(request))
