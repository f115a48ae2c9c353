"""`tachk simulate`: draw random runs of a model."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.job import StoppedError
from tachk.base.seeds import DEFAULT_SEED
from tachk.base.whole_files import write_whole
from tachk.cli import options
from tachk.cli import simulation_options as drawing
from tachk.cli.destination import destination
from tachk.cli.exit_status import ExitStatus, worst
from tachk.cli.guard import complain, print_diagnostics
from tachk.engine.simulation.policy import SCRIPT, Policy
from tachk.simulation.intervals import clopper_pearson

if TYPE_CHECKING:
    from tachk.api.model import Model
    from tachk.engine.simulation.simulator import Simulated, SimulationEnding
    from tachk.model.network import Network
    from tachk.recordings.monitors.formulas import NamedFormula
    from tachk.recordings.traces.node_signal import Truth
    from tachk.simulation.fault_injection import FaultedNetwork
    from tachk.simulation.runs import Runs

    Write = Callable[[Simulated, Runs], None]


def holds_steps(output: Path | None) -> bool:
    """True if a file is one of steps, for which the actions of runs have to be recorded."""
    from tachk.simulation.stepping.run_file import SUFFIX

    return output is not None and output.suffix.lower() == SUFFIX


@contextmanager
def run_files(output: Path, model: Model, chosen: Collection[str], runs: int) -> Iterator[Write]:
    """Gives the function that writes each run.

    Args:
        chosen: the constants that were given another value.
        runs: how many runs there are.

    Raises UsageError for an unknown ending, and for one file of several runs where it can hold one.
    """
    from tachk.meaning.run_view import RunNames
    from tachk.simulation.runs import steps_of
    from tachk.simulation.stepping.run_file import SUFFIX, steps_text
    from tachk.simulation.tables import RUN, run_writer

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
        heading = [f"run {run.number} of {model.path}, which ends with: {run.ending}"]
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
    help="Check a formula, a sentence, or a file of them or a model on each run; write the runs that violate one.",
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

    (arguments,) = options.distributed(given, SimulateArguments)
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


@dataclass(slots=True)
class _Tally:
    """Counts over the runs that were drawn.

    Attributes:
        endings: how many runs end so.
        examples: the first run of each ending, and when it ends.
        truths: for each formula how many runs have each verdict.
        violating: for each formula the runs on which it is false.
        done, missed: how often each ordered fault happened, and how often the model did not allow it.
        stopped: why not all runs were drawn; empty if they were.
        written: how many runs are in a file.
    """

    transitions: int = 0
    endings: Counter[SimulationEnding] = field(default_factory=Counter)
    examples: dict[SimulationEnding, tuple[int, str]] = field(default_factory=dict)
    faults: list[str] = field(default_factory=list)
    truths: dict[str, Counter[Truth]] = field(default_factory=dict)
    violating: dict[str, list[int]] = field(default_factory=dict)
    done: Counter[str] = field(default_factory=Counter)
    missed: Counter[str] = field(default_factory=Counter)
    stopped: str = ""
    written: int = 0

    @property
    def runs(self) -> int:
        return self.endings.total()

    def add(self, run: Simulated) -> None:
        from tachk.simulation.tables import decimal_time

        # First the example, or Ctrl-C in between leaves an ending that has none.
        self.examples.setdefault(run.ending, (run.number, decimal_time(run.end, run.ticks_per_unit)))
        self.transitions += run.transitions
        self.endings[run.ending] += 1
        if run.fault is not None and not self.faults:
            kind, span = run.fault
            self.faults.append(f"{span}: {kind.name.lower().replace('_', ' ')}")

    def count(self, name: str, number: int, truth: Truth) -> None:
        from tachk.recordings.traces.node_signal import Truth

        self.truths.setdefault(name, Counter())[truth] += 1
        if truth is Truth.FALSE:
            self.violating.setdefault(name, []).append(number)


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
    tally = _Tally()
    file = arguments.runs_file
    opened = nullcontext() if file is None else run_files(file, model, definitions, arguments.runs)
    with _reported_when_stopped(file, tally), opened as write:
        numbers = range(arguments.first, arguments.first + arguments.runs)
        drawn = runs.draw(drawing, numbers, RecordedChanges(holds_steps(file), observed))
        _until_stopped(drawn, partial(_take, runs, formulas, wanted, tally, write, arguments.all_runs), tally)
        if write is not None and tally.stopped and not tally.written:
            raise _NothingWritten
    _print(arguments, tally, network, formulas)
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
def _reported_when_stopped(file: Path | None, tally: _Tally) -> Iterator[None]:
    """A part after which the runs are reported also where they are in no file."""
    try:
        yield
    except (_NothingWritten, KeyboardInterrupt):
        if not tally.stopped:
            raise
        complain(f"{file}: not written: {tally.stopped}")


def _until_stopped(drawn: Iterator[Simulated], take: Callable[[Simulated], None], tally: _Tally) -> None:
    """Takes the runs. Where a limit or the user ends that, the tally says so."""
    from tachk.engine.outcome import INTERRUPTED

    try:
        for run in drawn:
            take(run)
    except StoppedError as error:
        tally.stopped = error.reason
    except KeyboardInterrupt:
        tally.stopped = INTERRUPTED


def _take(
    runs: Runs,
    formulas: tuple[NamedFormula, ...],
    wanted: FaultedNetwork,
    tally: _Tally,
    write: Write | None,
    all_runs: bool,
    run: Simulated,
) -> None:
    """Judges, writes and counts a run; it does not count if a limit or the user ends that.

    Args:
        write: writes a run; None where no file is wanted.
        all_runs: those on which no formula is false are written, too.
    """
    from tachk.recordings.traces.node_signal import Truth

    truths = _truths(runs, run, formulas)
    counts = runs.counts(run)
    if write is not None and len(run.times) and (all_runs or not formulas or Truth.FALSE in truths.values()):
        write(run, runs)
        tally.written += 1
    for name, truth in truths.items():
        tally.count(name, run.number, truth)
    counted = iter(counts)
    tally.done.update(dict(zip(wanted.done, counted, strict=False)))
    tally.missed.update(dict(zip(wanted.missed, counted, strict=False)))
    tally.add(run)


def _truths(runs: Runs, run: Simulated, formulas: tuple[NamedFormula, ...]) -> Mapping[str, Truth]:
    """The verdicts about a run; none where there are no formulas, or the run has no state."""
    if not formulas or not len(run.times):
        return {}
    from tachk.simulation.formulas import truths_on

    return truths_on(runs.trace(run), formulas)


# ---- the summary ----------------------------------------------------------------------------------------------------


def _print(arguments: SimulateArguments, tally: _Tally, network: Network, formulas: Iterable[NamedFormula]) -> None:
    from tachk.engine.simulation.simulator import SimulationEnding
    from tachk.recordings.traces.node_signal import Truth
    from tachk.report.statistics.text import times_text

    if arguments.form == "json":
        with destination(arguments.summary) as out:
            print(json.dumps(_json(arguments, tally, {f.name: f.text for f in formulas}), indent=2), file=out)
        return
    runs = "1 run" if arguments.runs == 1 else f"{arguments.runs} runs"
    if tally.stopped:
        runs = f"{tally.runs} of {runs}"
    print(f"{arguments.model}: {runs} until {arguments.until}, {tally.transitions} transitions, seed {arguments.seed}")
    for ending, count in tally.endings.most_common():
        number, end = tally.examples[ending]
        where = "" if ending is SimulationEnding.HORIZON else f", the first is run {number} at {end}"
        print(f"{count:8} end with: {ending}{where}")
    for written, done in tally.done.items():
        missed = tally.missed[written]
        impossible = f", {times_text(missed)} the model does not allow it" if missed else ""
        print(f"{written}: {times_text(done)}{impossible}")
    for fault in tally.faults:
        print(f"  {fault}")
    for name, counts in tally.truths.items():
        verdicts = ", ".join(f"{truth} on {counts[truth]}" for truth in (Truth.TRUE, Truth.FALSE, Truth.UNDETERMINED))
        violating = tally.violating.get(name, [])
        print(f"{name}: {verdicts}" + (f"; the first violation is in run {violating[0]}" if violating else ""))
        low, high = _violations(counts, arguments.confidence)
        print(f"  probability of a violation: {low:.4g} to {high:.4g}, confidence {arguments.confidence:.6g}")
    if tally.stopped:
        print(f"unknown what the other runs do ({tally.stopped})")


def _violations(counts: Counter[Truth], confidence: float) -> tuple[float, float]:
    """The interval of the probability that a run violates a formula; those that are undetermined may."""
    from tachk.recordings.traces.node_signal import Truth

    return clopper_pearson(counts[Truth.FALSE], counts.total(), confidence, maybe=counts[Truth.UNDETERMINED])


def _json(arguments: SimulateArguments, tally: _Tally, formulas: Mapping[str, str]) -> dict[str, object]:
    """``formulas``: their texts by their names."""
    from tachk.recordings.traces.node_signal import Truth

    return {
        "model": arguments.model,
        "runs": tally.runs,
        **({"not_drawn": arguments.runs - tally.runs, "reason": tally.stopped} if tally.stopped else {}),
        "first": arguments.first,
        "until": arguments.until,
        "seed": arguments.seed,
        "policy": arguments.policy,
        "transitions": tally.transitions,
        "faults": [{"order": order, "done": done, "missed": tally.missed[order]} for order, done in tally.done.items()],
        "endings": {ending.value: count for ending, count in tally.endings.items()},
        "formulas": [
            {
                "name": name,
                "formula": formulas[name],
                "true": counts[Truth.TRUE],
                "false": counts[Truth.FALSE],
                "undetermined": counts[Truth.UNDETERMINED],
                "violating": tally.violating.get(name, []),
                "probability_of_violation": _violations(counts, arguments.confidence),
                "confidence": arguments.confidence,
            }
            for name, counts in tally.truths.items()
        ],
    }
