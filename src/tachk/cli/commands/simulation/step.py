"""The options of `tachk step`."""

from __future__ import annotations

from typing import Any

import click

from tachk.cli import options


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
@click.option("prop", "--property", metavar="NAME", help="Of a report with several runs: the one about this property.")
@click.option(
    "seed",
    "--seed",
    metavar="S",
    type=options.Count(0, 2**63 - 1),
    default=0,
    help="The same seed gives the same random steps.",
)
@options.max_seconds()
def command(seconds: float | None, **given: Any) -> None:
    """Walk through a model: it lists what can happen and when, and you choose; help says how.

    Commands may also come from a pipe or a file. Then the first one that cannot be obeyed ends the program.

    Exit status: 0, or 2 for bad input.
    """
    from tachk.cli.actions.simulation.step import Stepping, run_step

    (asked,) = options.distributed(given, Stepping)
    options.finish(lambda: run_step(asked), seconds)
