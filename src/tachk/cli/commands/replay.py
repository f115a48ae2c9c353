"""`tachk replay`: execute a run on a model, and judge it."""

from __future__ import annotations

from typing import Any

import click

from tachk.cli import options
from tachk.cli import simulation_options as drawing


@click.command(name="replay")
@click.argument("model", metavar="MODEL", type=click.Path(), help="A model file.")
@click.argument(
    "file",
    metavar="RUN",
    type=options.type_of_file,
    help="A run that tachk step or tachk simulate wrote (.run), or a report of tachk verify --format json.",
)
@drawing.property_of_report
@options.definitions
@click.option("clocks", "--clocks", is_flag=True, help="Print the value of every clock after each step.")
@click.option(
    "every_step", "--every-step", is_flag=True, help="Print each step of repeated rounds, and what is hidden."
)
@click.option("quiet", "-q", "--quiet", is_flag=True, help="Print the outcome only.")
@click.option(
    "formulas",
    "--monitor",
    metavar="FORMULA",
    help="Judge the run by a formula, a sentence, or a file of them or a model.",
)
@drawing.record
@click.option(
    "output",
    "-o",
    "--output",
    metavar="FILE",
    type=options.type_of_file,
    help="Write the signals of the run: .csv, .jsonl, .parquet, .vcd; or the run itself: .run.",
)
@options.max_seconds()
def command(seconds: float | None, **given: Any) -> None:
    """Execute a run step by step on a model, by the semantics that judges counterexamples.

    Exit status: 0 it is a run of the model, 10 it is none, or violates a formula, 20 a formula is undetermined, 2 bad
    input.
    """
    from tachk.cli.actions.replay import ReplayArguments, run_replay

    (arguments,) = options.distributed(given, ReplayArguments)
    options.finish(lambda: run_replay(arguments), seconds)
