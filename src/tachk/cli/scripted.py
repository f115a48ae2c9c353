"""`tachk simulate --policy script FILE`: one run, whose steps stand in a file."""

from __future__ import annotations

import json
import sys
from pathlib import Path

from tachk.base.diagnostics.diagnostic import InputError
from tachk.base.records import dataclass
from tachk.cli.exit_status import ExitStatus
from tachk.cli.run_signals import evaluated_run, write_run
from tachk.cli.simulated_model import model_of_run
from tachk.cli.trace_arguments import exit_status
from tachk.meaning.run_view import RunNames
from tachk.model.quantity import duration
from tachk.simulation.columns import chosen_columns
from tachk.simulation.formulas import formulas_for
from tachk.simulation.stepping.files import read_submitted
from tachk.simulation.stepping.rejections import rejection_diagnostic
from tachk.simulation.stepping.replaying import replay_submitted


@dataclass(frozen=True, slots=True)
class ScriptArguments:
    """Arguments of `tachk simulate --policy script`."""

    model: str
    file: Path
    definitions: tuple[str, ...]
    record: tuple[str, ...]
    formulas: str | None
    output: Path | None
    form: str


def run_script(arguments: ScriptArguments) -> ExitStatus:
    """Takes each step of the file. Raises InputError with the first line that cannot be taken."""
    submitted = read_submitted(arguments.file)
    about = model_of_run(arguments.model, arguments.definitions, submitted)
    chosen_columns(about.model.network, arguments.record)
    names = RunNames(about.model.network)
    replayed = replay_submitted(names, submitted)
    if replayed.refusal is not None:
        raise InputError([rejection_diagnostic(replayed.refusal)])
    formulas = formulas_for(arguments.formulas, about.model.network, about.constants)
    if arguments.output is not None:
        write_run(arguments.output, names, replayed.trace, arguments.record, formulas, arguments.model, about.constants)
    truths = evaluated_run(names, replayed.trace, formulas, str(arguments.file))
    texts = {formula.name: formula.text for formula in formulas}
    end = replayed.trace.states[-1].time
    if arguments.form == "json":
        summary = {
            "model": arguments.model,
            "script": str(arguments.file),
            "until": str(end),
            "transitions": len(replayed.trace.path),
            "formulas": [
                {"name": name, "formula": texts[name], "verdict": str(truth)} for name, truth in truths.items()
            ],
        }
        json.dump(summary, sys.stdout, indent=2)
        print()
    else:
        when = duration(end, names.network.time_unit)
        print(
            f"{arguments.model}: 1 run until {when}, {len(replayed.trace.path)} transitions, as {arguments.file} says"
        )
        for name, truth in truths.items():
            print(f"{name}: {truth}")
    return exit_status(set(truths.values()))
