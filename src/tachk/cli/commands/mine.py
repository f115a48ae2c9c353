"""`tachk mine`: find the tightest parameter that traces satisfy."""

from __future__ import annotations

from typing import Any

import click

from tachk.cli import options, trace_options
from tachk.cli.reporting import Reporting
from tachk.recordings.traces.conventions import TraceEnding


@click.command(name="mine")
@trace_options.formula
@click.argument("traces", metavar="TRACE...", type=click.Path(), nargs=-1, required=True, help="Recorded traces.")
@click.option(
    "over",
    "--over",
    metavar="NAME=LOW..HIGH",
    required=True,
    multiple=True,
    help="The name in the formula whose value is looked for, and the values that it may have.",
)
@click.option("step", "--step", metavar="NUMBER", help="Try multiples of this number only.")
@options.definitions
@click.option("name", "--property", metavar="NAME", help="The formula of the file.")
@click.option("--unit", metavar="UNIT", help="The unit of the times, if a trace does not say it: ms, s, ...")
@click.option("--time", metavar="NAME", help="The time column, if its name is not time, t or timestamp.")
@click.option(
    "ending",
    "--end",
    type=options.Choice(TraceEnding),
    default=TraceEnding.UNDETERMINED.value,
    show_default=True,
    help="With strong, an obligation open at the end of a trace counts as violated, else as satisfied.",
)
@options.max_seconds()
@options.report("text", "json")
def command(seconds: float | None, **given: Any) -> None:
    """Find the tightest value of a name in a formula with which recorded traces satisfy it.

    Exit status: 0 there is one, 10 no value of the range satisfies it, 2 bad input.
    """
    from tachk.cli.actions.mine import MineArguments, run_mine

    arguments, reporting = options.distributed(given, MineArguments, Reporting)
    options.finish(lambda: run_mine(arguments, reporting), seconds)
