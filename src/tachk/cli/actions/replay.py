"""The action of `tachk replay`."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

from tachk.cli.exit_status import ExitStatus, worst
from tachk.cli.guard import print_diagnostics
from tachk.cli.run_signals import judged_run, write_run
from tachk.cli.simulated_model import model_of_run
from tachk.cli.terminal import console
from tachk.cli.trace_arguments import exit_status
from tachk.meaning.run_view import RunNames, view_trace
from tachk.model.quantity import duration
from tachk.report.run.display import RunDisplay
from tachk.report.run.trace_text import print_trace
from tachk.simulation.formulas import formulas_for
from tachk.simulation.stepping.files import read_submitted
from tachk.simulation.stepping.refusals import refusal_diagnostic
from tachk.simulation.stepping.replaying import replay_submitted


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
    submitted = read_submitted(arguments.file, arguments.prop)
    about = model_of_run(arguments.model, arguments.definitions, submitted)
    network = about.model.network
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
        print_diagnostics([refusal_diagnostic(replayed.refusal)])
    statuses = [ExitStatus.AS_EXPECTED if replayed.refusal is None else ExitStatus.NOT_AS_EXPECTED]
    formulas = formulas_for(arguments.formulas, network, about.constants)
    if arguments.output is not None:
        write_run(arguments.output, names, trace, arguments.record, formulas, arguments.model, about.constants)
    truths = judged_run(names, trace, formulas, str(arguments.file))
    for name, truth in truths.items():
        print(f"{name}: {truth}")
    return worst([*statuses, exit_status(set(truths.values()))])
