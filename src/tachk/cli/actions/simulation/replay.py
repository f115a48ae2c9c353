"""`tachk replay`."""

from __future__ import annotations

import sys
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

from tachk import api
from tachk.cli.actions.judged import exit_status
from tachk.cli.actions.simulation.formulas import formulas_for
from tachk.cli.arguments import parse_definitions
from tachk.cli.exit_status import ExitStatus, worst
from tachk.cli.guard import print_diagnostics
from tachk.cli.terminal import console
from tachk.diagnostics.diagnostic import Diagnostic
from tachk.diagnostics.span import NOWHERE
from tachk.monitoring.offline import Judging, judge
from tachk.report.quantity import decimal, duration
from tachk.report.run.telling import Telling
from tachk.report.run.trace_text import print_trace
from tachk.report.run.trace_view import Names, view_trace
from tachk.runtime.trace_files import open_trace
from tachk.semantics.timed_trace import TimedTrace
from tachk.simulation.columns import columns_for
from tachk.simulation.tables import run_writer
from tachk.stepping.claims import Claim
from tachk.stepping.files import constants_of, read_claims
from tachk.stepping.replaying import Refusal, replay_claims
from tachk.stepping.run_file import SUFFIX, run_text
from tachk.stepping.signals import Recorded, signals_of


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
    given = parse_definitions(asked.definitions)
    model = api.load(asked.model, **given)
    of_run = constants_of(claimed, model.constants, given)
    if of_run:
        model = api.load(asked.model, **of_run, **given)
    print_diagnostics((*model.refusals, *model.warnings))
    network = model.network
    names = Names(network)
    replayed = replay_claims(names, claimed)
    trace = replayed.trace
    if not asked.quiet:
        telling = Telling(asked.clocks, asked.every_step)
        print_trace(view_trace(network, trace), console(sys.stdout), network.time_unit, telling)
    for name, value in of_run.items():
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
    if asked.output is not None or asked.formulas is not None:
        statuses.append(_signals(asked, names, trace, {**of_run, **given}.keys()))
    return worst(statuses)


def _signals(asked: Replaying, names: Names, trace: TimedTrace, chosen: Collection[str]) -> ExitStatus:
    """Judges the signals of the run and writes them."""
    constants = {name: value for name, value in names.network.constants if name in chosen}
    if asked.output is not None and asked.output.suffix == SUFFIX:
        asked.output.write_text(run_text(names, trace, [f"a run of {asked.model}"], constants), encoding="utf-8")
    formulas = formulas_for(asked.formulas, {name: str(value) for name, value in constants.items()})
    needed = (name for formula in formulas for name in formula.columns - formula.constant_names)
    columns = columns_for(names.network, asked.record, needed)
    if asked.output is not None and asked.output.suffix != SUFFIX:
        write_signals(asked.output, signals_of(names, columns, trace, str(asked.file), decimal_times=True))
    if not formulas:
        return ExitStatus.AS_EXPECTED
    recorded = signals_of(names, columns, trace, str(asked.file))
    verdicts = judge(formulas, open_trace(recorded.trace), Judging(robustness=False)).verdicts
    for verdict in verdicts:
        print(f"{verdict.name}: {verdict.truth}")
    return exit_status({verdict.truth for verdict in verdicts})


def write_signals(output: Path, recorded: Recorded) -> None:
    """Writes the signals of one run, and says so if the file cannot hold its times."""
    if not recorded.exact:
        print(f"{output}: times are rounded down to 1e-9 time units", file=sys.stderr)
    with run_writer(output) as write:
        write(0, recorded.trace)


def refusal_diagnostic(refusal: Refusal) -> Diagnostic:
    """A refused step at its line of the file, or at the place of the model that refuses it."""
    labels = refusal.reason.labels
    words = "the initial state" if refusal.claim is None else f"step {refusal.step} ({_words(refusal.claim)})"
    message = f"{words} cannot be taken: {refusal.reason.message}"
    span = None if refusal.claim is None else refusal.claim.span
    if span is None and labels:
        message += f": {labels[0].text}" if labels[0].text != "here" else ""
        span, labels = labels[0].span, labels[1:]
    return Diagnostic("E0921", message, NOWHERE if span is None else span, labels=labels)


def _words(claim: Claim) -> str:
    when = f"{'after' if claim.relative else 'at'} {decimal(claim.time)}"
    moves = ", ".join(f"{move.process}: {move.source} → {move.target}" for move in claim.moves)
    return f"{moves or 'time passes'} {when}"
