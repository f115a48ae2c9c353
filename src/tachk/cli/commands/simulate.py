"""`tachk simulate`: draw random runs of a model."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.seeds import DEFAULT_SEED
from tachk.base.whole_files import write_whole
from tachk.cli import options
from tachk.cli import simulation_options as drawing
from tachk.cli.destination import destination
from tachk.cli.distribution import distributed
from tachk.cli.exit_status import ExitStatus, worst
from tachk.cli.guard import complain, print_diagnostics
from tachk.engine.simulation.policy import SCRIPT, Policy

if TYPE_CHECKING:
    from tachk.api.model import Model
    from tachk.engine.simulation.simulator import Simulated
    from tachk.simulation.runs import Runs
    from tachk.simulation.tally import Tally, WriteRun


def holds_steps(output: Path | None) -> bool:
    """True if a file is one of steps, for which the actions of runs have to be recorded."""
    from tachk.simulation.stepping.run_file import SUFFIX

    return output is not None and output.suffix.lower() == SUFFIX


@contextmanager
def run_files(output: Path, model: Model, chosen: Collection[str], runs: int) -> Iterator[WriteRun]:
    """Gives the function that writes each run.

    Args:
        chosen: the constants that were given another value.
        runs: how many runs there are.

    Raises UsageError for an unknown ending, and for one file of several runs where it can hold one.
    """
    from tachk.meaning.run_view import RunNames
    from tachk.simulation.runs import steps_of
    from tachk.simulation.stepping.run_file import SUFFIX, steps_text
    from tachk.simulation.tables import PARQUET, RUN, parquet_of_runs, run_writer

    if output.suffix.lower() in PARQUET and RUN not in output.name:
        with parquet_of_runs(output) as write_rows:
            yield write_rows
        return
    if not holds_steps(output):
        with run_writer(output) as write:
            yield lambda run, drawn: write(run.number, drawn.trace(run))
        return
    if RUN not in output.name and runs > 1:
        help = f"write {output.stem}-{RUN}{SUFFIX} for a file for each run"
        raise UsageError(f"{output}: a file of steps holds one run", help)
    names = RunNames(model.network)
    constants = {name: value for name, value in model.constants.items() if name in chosen}

    def write_steps(run: Simulated, drawn: Runs) -> None:
        heading = [f"run {run.number} of {model.path}, which {run.ending.what_happened}"]
        text = steps_text(names, steps_of(run), heading, constants)
        write_whole(output.with_name(output.name.replace(RUN, str(run.number))), text)

    yield write_steps


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
    help="The length of the runs: a number of time units of the model, or a duration such as 3 min.",
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
    "first", "--first", metavar="N", type=options.Count(0, 2**62), default=0, help="Index of the first run (default 0)."
)
@drawing.threads("runs")
@drawing.most_steps("steps", "End a run after N transitions.")
@options.faults
@drawing.record
@click.option(
    "formulas",
    "--monitor",
    metavar="FORMULA",
    help="Check a formula, a sentence, or a file of them or a model on each run; write the runs that violate one.",
)
@click.option(
    "all_runs", "--all-runs", is_flag=True, help="With --monitor: write all runs, not only those that violate."
)
@drawing.confidence(0.5, "Confidence level of the interval for the probability that a run violates a formula.")
@options.definitions
@click.option(
    "output",
    "-o",
    "--output",
    metavar="FILE",
    type=options.written_file,
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
    """Simulate random runs of a model: each process draws how long it waits, and the first one acts.

    Exit status: 0 the runs were drawn and violate no formula, 10 some do or end with a run-time error, 20 some formula
    is undetermined and none is false, 2 bad input, 3 something that is not simulated.
    """

    (arguments,) = distributed(given, SimulateArguments)
    options.finish(lambda: run_simulate(arguments), seconds)


@dataclass(frozen=True, slots=True)
class SimulateArguments:
    """Arguments of `tachk simulate`."""

    model: str
    runs: int = 1
    until: str = "100"
    seed: int = DEFAULT_SEED
    policy: str = Policy.STOCHASTIC.value
    first: int = 0
    threads: int = 1
    steps: int | None = None
    faults: tuple[str, ...] = ()
    record: tuple[str, ...] = ()
    formulas: str | None = None
    definitions: tuple[str, ...] = ()
    output: Path | None = None
    form: str = "text"
    script: Path | None = None
    all_runs: bool = False
    confidence: float = 0.95

    @property
    def summary(self) -> Path | None:
        """The file of the summary, where the output is that and not runs; else None, for standard output."""
        is_summary = self.form == "json" and self.output is not None and self.output.suffix.lower() == ".json"
        return self.output if is_summary else None

    @property
    def runs_file(self) -> Path | None:
        """The file for the runs; None: they are not written."""
        return None if self.summary else self.output


def run_simulate(arguments: SimulateArguments) -> ExitStatus:
    """Draws runs, judges and writes them, and prints a summary."""
    from tachk.cli.arguments import parse_definitions
    from tachk.cli.simulated_model import simulated_model
    from tachk.cli.trace_arguments import exit_status
    from tachk.engine.outcome import INTERRUPTED
    from tachk.engine.simulation.simulator import RecordedChanges, SimulationEnding, SimulationOptions
    from tachk.simulation.fault_injection import read_plan, with_faults
    from tachk.simulation.formulas import columns_with, formulas_for
    from tachk.simulation.runs import Runs
    from tachk.simulation.tally import Tally, drawn_runs, take_run, take_until_stopped
    from tachk.simulation.times import parsed_time_bound

    if (arguments.policy == SCRIPT) is (arguments.script is None):
        problem = (
            "--policy script needs a file" if arguments.script is None else f"{arguments.script}: one model at a time"
        )
        raise UsageError(problem, "tachk simulate MODEL --policy script FILE.run takes its steps")
    if arguments.script is not None:
        return _run_scripted(arguments, arguments.script)
    definitions = parse_definitions(arguments.definitions)
    model = simulated_model(arguments.model, **definitions)
    print_diagnostics((*model.refusals, *model.warnings))
    network = model.network
    formulas = formulas_for(arguments.formulas, network, definitions)
    until = parsed_time_bound(arguments.until, network.time_unit)
    columns = columns_with(network, arguments.record, formulas)
    wanted = with_faults(network, read_plan(arguments.faults))
    runs = Runs(wanted.network, columns, [*wanted.done.values(), *wanted.missed.values()])
    drawing = SimulationOptions(
        arguments.seed, until.ticks, Policy(arguments.policy), arguments.steps, arguments.threads, until.ticks_per_unit
    )
    observed = arguments.runs_file is not None or bool(formulas or wanted.done or wanted.missed)
    tally = Tally()
    file = arguments.runs_file
    opened = nullcontext() if file is None else run_files(file, model, definitions, arguments.runs)
    with _reported_when_stopped(file, tally), opened as write:
        numbers = range(arguments.first, arguments.first + arguments.runs)
        recorded = RecordedChanges(holds_steps(file), observed)
        drawn = drawn_runs(runs, formulas, drawing, numbers, recorded, all_rows=arguments.all_runs)
        take_until_stopped(drawn, partial(take_run, runs, wanted, tally, write, arguments.all_runs), tally)
        if write is not None and tally.stopped and not tally.written:
            raise _NothingWritten
    _print(arguments, tally, {formula.name: formula.text for formula in formulas})
    faults = ExitStatus.NOT_AS_EXPECTED if tally.endings[SimulationEnding.FAULT] else ExitStatus.AS_EXPECTED
    truths = {truth for counts in tally.truths.values() for truth in counts}
    stopped = {"": ExitStatus.AS_EXPECTED, INTERRUPTED: ExitStatus.INTERRUPTED}.get(tally.stopped, ExitStatus.UNKNOWN)
    return worst([faults, exit_status(truths), stopped])


def _run_scripted(arguments: SimulateArguments, script: Path) -> ExitStatus:
    from tachk.cli.scripted import ScriptArguments, run_script

    if arguments.runs != 1:
        raise UsageError(f"{script}: a script makes one run", "leave --runs out")
    return run_script(
        ScriptArguments(
            arguments.model,
            script,
            arguments.definitions,
            arguments.record,
            arguments.formulas,
            arguments.output,
            arguments.form,
        )
    )


class _NothingWritten(Exception):
    """A limit or the user has ended the command before a run was written, so that a file of before stays."""


@contextmanager
def _reported_when_stopped(file: Path | None, tally: Tally) -> Iterator[None]:
    """A part after which the runs are reported also where they are in no file."""
    try:
        yield
    except (_NothingWritten, KeyboardInterrupt):
        if not tally.stopped:
            raise
        complain(f"{file}: not written: {tally.stopped}")


def _print(arguments: SimulateArguments, tally: Tally, formulas: Mapping[str, str]) -> None:
    """``formulas``: their texts by their names."""
    from tachk.report.statistics.drawn_runs import SimulationHeading, tally_lines, tally_to_json

    heading = SimulationHeading(
        arguments.model,
        arguments.runs,
        arguments.first,
        arguments.until,
        arguments.seed,
        arguments.policy,
        arguments.confidence,
    )
    if arguments.form == "json":
        with destination(arguments.summary) as out:
            print(json.dumps(tally_to_json(heading, tally, formulas), indent=2), file=out)
        return
    for line in tally_lines(heading, tally):
        print(line)
