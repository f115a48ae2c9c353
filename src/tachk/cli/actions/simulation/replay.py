"""`tachk replay`."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

from tachk.cli.actions.judged import exit_status
from tachk.cli.actions.simulation.models import model_of_run
from tachk.cli.actions.simulation.run_signals import judged_run, write_run
from tachk.cli.exit_status import ExitStatus, worst
from tachk.cli.guard import print_diagnostics
from tachk.cli.terminal import console
from tachk.meaning.run_view import RunNames, view_trace
from tachk.model.quantity import duration
from tachk.report.run.telling import Telling
from tachk.report.run.trace_text import print_trace
from tachk.simulation.formulas import formulas_for
from tachk.simulation.stepping.files import read_claims
from tachk.simulation.stepping.refusals import refusal_diagnostic
from tachk.simulation.stepping.replaying import replay_claims


@dataclass(frozen=True, slots=True)
class Replaying:
    """What is asked, as it was typed."""

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


def run_replay(asked: Replaying) -> ExitStatus:
    """Executes the run, prints and writes it as far as it is one."""
    claimed = read_claims(asked.file, asked.prop)
    about = model_of_run(asked.model, asked.definitions, claimed)
    network = about.model.network
    names = RunNames(network)
    replayed = replay_claims(names, claimed)
    trace = replayed.trace
    if not asked.quiet:
        telling = Telling(asked.clocks, asked.every_step)
        print_trace(view_trace(network, trace), console(sys.stdout), network.time_unit, telling)
    for name, value in about.of_run.items():
        print(f"with {name} = {value}, as the run says")
    steps = f"{len(claimed.claims)} step{'s' if len(claimed.claims) != 1 else ''}"
    when = duration(trace.states[-1].time, network.time_unit)
    if replayed.refusal is None:
        print(f"{asked.file}: a run of {asked.model}: {steps}, to {when}")
    else:
        where = f"step {replayed.refusal.step} of {steps} cannot be taken from {when} on"
        print(f"{asked.file}: no run of {asked.model}: {where}")
        print_diagnostics([refusal_diagnostic(replayed.refusal)])
    statuses = [ExitStatus.AS_EXPECTED if replayed.refusal is None else ExitStatus.NOT_AS_EXPECTED]
    formulas = formulas_for(asked.formulas, network, about.constants)
    if asked.output is not None:
        write_run(asked.output, names, trace, asked.record, formulas, asked.model, about.constants)
    truths = judged_run(names, trace, formulas, str(asked.file))
    for name, truth in truths.items():
        print(f"{name}: {truth}")
    return worst([*statuses, exit_status(set(truths.values()))])
