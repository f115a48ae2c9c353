"""`tachk time`: measure the time between two events, over all runs."""

from __future__ import annotations

from pathlib import Path

import click

from tachk.cli import options
from tachk.engine.options import Limits


@click.command(name="time")
@click.argument("model", metavar="MODEL", type=click.Path(), help="A model file.")
@click.option(
    "start",
    "--from",
    metavar="EVENT",
    help="Where time begins: a condition that becomes true, a channel (c!, c?) or a signal. Without it: the start of "
    "the run.",
)
@click.option("end", "--to", metavar="EVENT", required=True, help="Where it ends: the next such event after that.")
@click.option(
    "last",
    "--last/--first",
    help="If the first event comes again before the second, measure from the last one; else from the first.",
)
@click.option("best", "--best", is_flag=True, help="Only the least time.")
@click.option(
    "worst", "--worst", is_flag=True, help="Only the largest time, and whether the second event may not come."
)
@click.option(
    "settled",
    "--settled",
    is_flag=True,
    help="Look at conditions only where no process is in a committed location, as temporal properties do.",
)
@click.option(
    "over",
    "--over",
    metavar="NAME=A..B",
    multiple=True,
    help="A table over the values of constants: LOSSES=0..3,HBA=5 (several are separated by commas).",
)
@click.option("traces", "--traces", is_flag=True, help="Also show a run for each time.")
@options.definitions
@click.option(
    "form",
    "--format",
    type=click.Choice(("text", "csv", "json")),
    default="text",
    show_default=True,
    help="Form of the report.",
)
@click.option("output", "-o", "--output", metavar="FILE", type=options.type_of_file, help="Write the report to a file.")
@options.max_states()
@options.max_seconds()
def command(
    model: str,
    start: str | None,
    end: str,
    last: bool,
    best: bool,
    worst: bool,
    settled: bool,
    over: tuple[str, ...],
    traces: bool,
    definitions: tuple[str, ...],
    form: str,
    output: Path | None,
    states: int | None,
    seconds: float | None,
) -> None:
    """Measure the least and the largest time between two events, over all runs of a model."""
    from tachk.cli.actions.time import TimeArguments, run_time

    arguments = TimeArguments(model, start, end, last, best, worst, settled, over, definitions)
    options.finish(lambda: run_time(arguments, Limits(states=states, seconds=seconds), form, output, traces), seconds)
