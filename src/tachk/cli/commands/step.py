"""`tachk step`: walk through a model, step by step."""

from __future__ import annotations

from typing import Any

import click

from tachk.cli import options
from tachk.cli import simulation_options as drawing


@click.command(name="step")
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
    from tachk.cli.actions.step import StepArguments, run_step

    (arguments,) = options.distributed(given, StepArguments)
    options.finish(lambda: run_step(arguments), seconds)
