"""`tachk sweep`: check a model for many values of its constants."""

from __future__ import annotations

from typing import Any

import click

from tachk.cli import options
from tachk.cli import simulation_options as drawing


@click.command(name="sweep")
@click.argument("model", metavar="MODEL", type=click.Path(), help="A model file.")
@click.argument("queries", metavar="[QUERY]...", nargs=-1, required=False, help="Queries.")
@click.option(
    "over",
    "-D",
    "--define",
    "--over",
    metavar="NAME=VALUES,...",
    multiple=True,
    help="Set a global constant of the model to each of these values: 3, 1..5, 10,50,100 or 0..60:5.",
)
@click.option(
    "properties",
    "--property",
    metavar="NAME",
    multiple=True,
    help="A property of the model; `all` for every one, which is the default.",
)
@click.option(
    "store",
    "--store",
    metavar="FILE",
    type=options.type_of_file,
    help="Keep finished cells in this SQLite file. A sweep that was stopped goes on where it was.",
)
@click.option(
    "processes",
    "-j",
    "--processes",
    metavar="N",
    type=options.Count(min=1),
    help="Compute so many cells at a time; without it as many as the machine has cores.",
)
@click.option("dask", "--dask", metavar="ADDRESS", help="Compute on the Dask cluster with this scheduler.")
@options.report("text", "csv", "json")
@click.option(
    "picture",
    "--heat-map",
    metavar="FILE",
    type=options.type_of_file,
    help="Draw a map of the values into this .svg, .png or .pdf file.",
)
@click.option(
    "show",
    "--show",
    metavar="COLUMN",
    default="answer",
    show_default=True,
    help="What the map shows: answer, or a column of numbers such as states_stored, run_end, estimate.",
)
@click.option(
    "seconds_each",
    "--cell-seconds",
    metavar="SECONDS",
    type=options.Seconds(min=0),
    help="Stop the check of a cell after this time; its answers are unknown then.",
)
@click.option(
    "formulas",
    "--monitor",
    metavar="FORMULA",
    help="Judge random runs of each cell by this formula, or by those of a file: how probable it is that a run "
    "satisfies them. Properties are checked then only where they are named.",
)
@click.option(
    "until",
    "--until",
    metavar="TIME",
    default="100",
    show_default=True,
    help="With --monitor: how long the runs are; such as 100 or 2 h.",
)
@click.option(
    "part",
    "--part",
    metavar="K/N",
    default="1/1",
    help="Compute every N-th cell, from the K-th one on: one of N jobs, each with a --store of its own.",
)
@click.option(
    "merged",
    "--merge",
    metavar="FILE",
    multiple=True,
    type=options.type_of_file,
    help="Take over the cells of this file of the same sweep, such as a part has made.",
)
@drawing.confidence(0.8, "Of the intervals of statistical queries.")
@drawing.half_width("Statistical queries draw runs until the interval of a probability is at most 2 E wide.")
@drawing.runs("Statistical queries draw N runs, --monitor judges N (else 100).")
@drawing.seed("Of the runs of statistical queries.")
@drawing.splitting
@options.max_states("; its answers are unknown then")
@options.max_memory
@click.option("non_zeno", "--non-zeno", is_flag=True, help="Count only runs in which time diverges.")
@options.max_seconds("Stop after this time. Cells that are not finished then are missing; --store lets them follow.")
def command(**given: Any) -> None:
    """Check a model for every combination of values of its constants.

    \b
    tachk sweep fischer.ta -D N=2..4 -D WRITE=1..5 --property mutual_exclusion
    tachk sweep model.ta -D LOSSES=0..5 -D SLICE=10,50,100 --store sweep.sqlite -o table.parquet

    With -o and a name that ends in .csv or .parquet, tachk writes the table there and prints the report.
    Exit status: 0 every answer is known, 20 some are unknown or cells are not finished, 2 bad input.
    """
    from tachk.cli.actions.sweep import SweepArguments, run_sweep
    from tachk.cli.reporting import Reporting

    seconds = given.pop("seconds")
    arguments, reporting = options.distributed(given, SweepArguments, Reporting)
    options.finish(lambda: run_sweep(arguments, reporting, seconds))
