"""The action of `tachk step`."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

from tachk.base.job import check_job
from tachk.base.seeds import DEFAULT_SEED
from tachk.cli.exit_status import ExitStatus
from tachk.cli.guard import complain, print_diagnostics
from tachk.cli.simulated_model import model_of_run
from tachk.cli.stepper import NotUnderstoodError, QuitError, Stepper
from tachk.meaning.run_view import RunNames
from tachk.simulation.stepping.files import read_submitted
from tachk.simulation.stepping.refusals import refusal_diagnostic
from tachk.simulation.stepping.session import Session

_PROMPT = "> "


@dataclass(frozen=True, slots=True)
class StepArguments:
    """Arguments of `tachk step`."""

    model: str
    definitions: tuple[str, ...] = ()
    load: Path | None = None
    prop: str | None = None
    seed: int = DEFAULT_SEED


def run_step(arguments: StepArguments) -> ExitStatus:
    """Answers each line until there are no more."""
    check_job()
    submitted = None if arguments.load is None else read_submitted(arguments.load, arguments.prop)
    about = model_of_run(arguments.model, arguments.definitions, submitted)
    session = Session.begin(RunNames(about.model.network))
    if submitted is not None:
        session, refusal = session.loaded(submitted)
        if refusal is not None:
            print_diagnostics([refusal_diagnostic(refusal)])
    return _converse(Stepper(session, arguments.model, about.constants, arguments.seed), sys.stdin.isatty())


def _converse(stepper: Stepper, with_terminal: bool) -> ExitStatus:
    """In a terminal a wrong line is reported and passed over; from a program it ends the command with status 2."""
    for line in (*stepper.greeting(), *(["help says what can be typed"] if with_terminal else [])):
        print(line)
    for typed in _lines(with_terminal):
        try:
            for line in stepper.answer(typed):
                print(line)
        except QuitError:
            return ExitStatus.AS_EXPECTED
        except NotUnderstoodError as error:
            if not with_terminal:
                sys.stdout.flush()
                complain(str(error))
                return ExitStatus.BAD_INPUT
            print(error)
        check_job()
    return ExitStatus.AS_EXPECTED


def _lines(with_terminal: bool) -> Iterator[str]:
    """The lines that are typed. Where no terminal shows them, they are printed."""
    if with_terminal:
        with suppress(ImportError):
            import_module("readline")  # with it `input` has a history
    while True:
        try:
            typed = input(_PROMPT)
        except EOFError:
            print()
            return
        if not with_terminal:
            print(typed)
        yield typed
