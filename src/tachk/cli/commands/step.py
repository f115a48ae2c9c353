"""`tachk step`: walk through a model, step by step."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.job import check_job
from tachk.base.seeds import DEFAULT_SEED
from tachk.cli import options
from tachk.cli import simulation_options as drawing
from tachk.cli.distribution import distributed
from tachk.cli.exit_status import ExitStatus
from tachk.cli.guard import complain, print_diagnostics

if TYPE_CHECKING:
    from tachk.cli.stepper import Stepper


@click.command(name="step")
@click.argument("model", metavar="MODEL", type=click.Path(), help="A model file.")
@options.definitions
@click.option(
    "load",
    "--load",
    metavar="FILE",
    type=options.type_of_file,
    help="Begin with a run that step or simulate has written, or with a report of tachk verify.",
)
@click.option(
    "output",
    "-o",
    "--output",
    metavar="FILE",
    type=options.written_file,
    help="Write the run here when the session ends.",
)
@drawing.property_of_report
@drawing.seed("The same seed gives the same random steps.")
@options.max_seconds()
def command(seconds: float | None, **given: Any) -> None:
    """Walk through a model, step by step: tachk lists what can happen and when, and you choose. Type `help` for the
    commands.

    Commands may also come from a pipe or a file. Then the first wrong one ends the program with status 2.

    Exit status: 0, or 2 for bad input.
    """

    (arguments,) = distributed(given, StepArguments)
    options.finish(lambda: run_step(arguments), seconds)


_PROMPT = "> "


@dataclass(frozen=True, slots=True)
class StepArguments:
    """Arguments of `tachk step`.

    Attributes:
        output: the file for the run at the end of the session.
    """

    model: str
    definitions: tuple[str, ...] = ()
    load: Path | None = None
    output: Path | None = None
    prop: str | None = None
    seed: int = DEFAULT_SEED


def run_step(arguments: StepArguments) -> ExitStatus:
    """Answers each line until there are no more."""
    from tachk.cli.simulated_model import model_of_run
    from tachk.cli.stepper import Stepper
    from tachk.meaning.run_view import RunNames
    from tachk.simulation.stepping.files import read_submitted
    from tachk.simulation.stepping.rejections import rejection_diagnostic
    from tachk.simulation.stepping.session import Session

    check_job()
    if arguments.prop is not None and arguments.load is None:
        raise UsageError("--property chooses among the runs of a report", "--load names the report of tachk verify")
    submitted = None if arguments.load is None else read_submitted(arguments.load, arguments.prop)
    about = model_of_run(arguments.model, arguments.definitions, submitted)
    session = Session.begin(RunNames(about.model.network))
    if submitted is not None:
        session, rejection = session.loaded(submitted)
        if rejection is not None:
            print_diagnostics([rejection_diagnostic(rejection)])
    stepper = Stepper(session, arguments.model, about.constants, arguments.seed)
    status = _converse(stepper, sys.stdin.isatty())
    if arguments.output is not None:
        for line in stepper.save(arguments.output):
            print(line)
    return status


def _converse(stepper: Stepper, with_terminal: bool) -> ExitStatus:
    """In a terminal a wrong line is reported and passed over; from a program it ends the command with status 2."""
    from tachk.cli.stepper import NotUnderstoodError, QuitError

    for line in (*stepper.greeting(), *(["type `help` for the commands"] if with_terminal else [])):
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
