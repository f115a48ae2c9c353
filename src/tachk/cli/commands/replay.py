"""`tachk replay`: execute a run on a model, and check it."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

from tachk.cli import options
from tachk.cli import simulation_options as drawing
from tachk.cli.distribution import distributed
from tachk.cli.exit_status import ExitStatus, worst
from tachk.cli.guard import print_diagnostics
from tachk.cli.terminal import console
from tachk.report.run.display import RunDisplay


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
    help="Check a formula, a sentence, or a file of them or a model on the run.",
)
@drawing.record
@click.option(
    "output",
    "-o",
    "--output",
    metavar="FILE",
    type=options.written_file,
    help="Write the signals of the run: .csv, .jsonl, .parquet, .vcd; the run itself: .run; or a scenario: .ta.",
)
@options.max_seconds()
def command(seconds: float | None, **given: Any) -> None:
    """Replay a run on a model, step by step, and check that the model allows it.

    Exit status: 0 it is a run of the model, 10 it is not, or it violates a formula, 20 a formula is undetermined, 2 bad
    input.
    """

    (arguments,) = distributed(given, ReplayArguments)
    options.finish(lambda: run_replay(arguments), seconds)


@dataclass(frozen=True, slots=True)
class ReplayArguments:
    """Arguments of `tachk replay`."""

    model: str
    file: Path
    prop: str | None = None
    definitions: tuple[str, ...] = ()
    clocks: bool = False
    every_step: bool = False
    quiet: bool = False
    formulas: str | None = None
    record: tuple[str, ...] = ()
    output: Path | None = None


def run_replay(arguments: ReplayArguments) -> ExitStatus:
    """Executes the run, and prints and writes the steps that the model allows."""
    from tachk.cli.run_signals import evaluated_run, write_run
    from tachk.cli.simulated_model import model_of_run
    from tachk.cli.trace_arguments import exit_status
    from tachk.meaning.run_view import RunNames, view_trace
    from tachk.model.quantity import duration
    from tachk.report.run.trace_text import print_trace
    from tachk.simulation.columns import chosen_columns
    from tachk.simulation.formulas import formulas_for
    from tachk.simulation.stepping.files import read_submitted
    from tachk.simulation.stepping.rejections import rejection_diagnostic
    from tachk.simulation.stepping.replaying import replay_submitted

    submitted = read_submitted(arguments.file, arguments.prop)
    about = model_of_run(arguments.model, arguments.definitions, submitted)
    network = about.model.network
    chosen_columns(network, arguments.record)
    names = RunNames(network)
    replayed = replay_submitted(names, submitted)
    trace = replayed.trace
    if not arguments.quiet:
        display = RunDisplay(arguments.clocks, arguments.every_step)
        print_trace(view_trace(network, trace), console(sys.stdout), network.time_unit, display)
    for name, value in about.of_run.items():
        print(f"with {name} = {value}, as the run says")
    steps = f"{len(submitted.steps)} step{'s' if len(submitted.steps) != 1 else ''}"
    when = duration(trace.states[-1].time, network.time_unit)
    if replayed.refusal is None:
        print(f"{arguments.file}: a run of {arguments.model}: {steps}, to {when}")
    else:
        where = f"step {replayed.refusal.step} of {steps} cannot be taken from {when} on"
        print(f"{arguments.file}: no run of {arguments.model}: {where}")
        print_diagnostics([rejection_diagnostic(replayed.refusal)])
    statuses = [ExitStatus.AS_EXPECTED if replayed.refusal is None else ExitStatus.NOT_AS_EXPECTED]
    formulas = formulas_for(arguments.formulas, network, about.constants)
    if arguments.output is not None:
        write_run(arguments.output, names, trace, arguments.record, formulas, arguments.model, about.constants)
    truths = evaluated_run(names, trace, formulas, str(arguments.file))
    for name, truth in truths.items():
        print(f"{name}: {truth}")
    return worst([*statuses, exit_status(set(truths.values()))])
