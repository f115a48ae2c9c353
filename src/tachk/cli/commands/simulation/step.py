"""The options of `tachk step`."""

from __future__ import annotations

from typing import Any

import click

from tachk.cli import options
from tachk.cli.commands.simulation import drawing


@click.command(name="step", short_help="Walk through a model, step by step.")
@click.argument("model", metavar="MODEL", type=click.Path(), help="A model file.")
@options.definitions
@click.option(
    "load",
    "--load",
    metavar="FILE",
    type=options.type_of_file,
    help="Begin with a run that step or simulate has written, or with a report of tachk verify.",
)
@drawing.property_of_report
@drawing.seed("The same seed gives the same random steps.")
@options.max_seconds()
def command(seconds: float | None, **given: Any) -> None:
    """Walk through a model: it lists what can happen and when, and you choose; help says how.

    Commands may also come from a pipe or a file. Then the first one that cannot be obeyed ends the program.

    Exit status: 0, or 2 for bad input.
    """
    from tachk.cli.actions.simulation.step import Stepping, run_step

    (asked,) = options.distributed(given, Stepping)
    options.finish(lambda: run_step(asked), seconds)
