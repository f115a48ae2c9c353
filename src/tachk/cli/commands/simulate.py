"""`tachk simulate`: draw random runs of a model."""

from __future__ import annotations

from typing import Any

import click

from tachk.cli import options
from tachk.cli import simulation_options as drawing
from tachk.engine.simulation.policy import SCRIPT, Policy


@click.command(name="simulate")
@click.argument("model", metavar="MODEL", type=click.Path(), help="A model file.")
@click.argument(
    "script",
    metavar="[FILE]",
    type=options.type_of_file,
    required=False,
    help="With --policy script: the run, as tachk step writes it.",
)
@drawing.runs("How many runs.", default=1)
@click.option(
    "--until",
    metavar="TIME",
    default="100",
    show_default=True,
    help="How long they are: a number of time units of the model, or a duration such as 3 min.",
)
@drawing.seed("The same seed gives the same runs.")
@click.option(
    "--policy",
    type=click.Choice([*(policy.value for policy in Policy), SCRIPT]),
    default=Policy.STOCHASTIC.value,
    show_default=True,
    help="How long a process waits before it acts; script FILE: one run, all decisions are in the file.",
)
@click.option(
    "first", "--first", metavar="N", type=options.Count(0, 2**62), default=0, help="The number of the first run; 0."
)
@drawing.threads("runs")
@drawing.most_steps("steps", "End a run after N transitions.")
@options.faults
@drawing.record
@click.option(
    "formulas",
    "--monitor",
    metavar="FORMULA",
    help="Judge each run by a formula, a sentence, or a file of them or a model; write the runs that violate one.",
)
@click.option(
    "all_runs", "--all-runs", is_flag=True, help="With --monitor: write all runs, not only those that violate."
)
@drawing.confidence(0.5, "Of the interval for the probability that a run violates a formula.")
@options.definitions
@click.option(
    "output",
    "-o",
    "--output",
    metavar="FILE",
    type=options.type_of_file,
    help="Write the runs: .csv, .jsonl, .parquet, .vcd, or their steps: .run; {run} in its name makes a file for each.",
)
@click.option(
    "form",
    "--format",
    type=click.Choice(("text", "json")),
    default="text",
    show_default=True,
    help="Form of the summary; json with -o FILE.json writes it there.",
)
@options.max_seconds()
def command(seconds: float | None, **given: Any) -> None:
    """Draw random runs of a model: each process draws its waiting time, and the first one acts.

    Exit status: 0 the runs were drawn and violate no formula, 10 some do or end with a run-time error, 20 some formula
    is undetermined and none is false, 2 bad input, 3 something that is not simulated.
    """
    from tachk.cli.actions.simulate import SimulateArguments, run_simulate

    (arguments,) = options.distributed(given, SimulateArguments)
    options.finish(lambda: run_simulate(arguments), seconds)
