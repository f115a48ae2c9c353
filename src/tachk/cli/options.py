"""Options that several commands share. Imports nothing heavy."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from enum import StrEnum
from math import isfinite
from pathlib import Path
from typing import Any, TypeVar

import click

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.cli import plain_options
from tachk.cli.exit_status import ExitStatus
from tachk.cli.guard import run_command
from tachk.cli.plain_options import Kind, PlainOption

type_of_file = click.Path(path_type=Path)
"""A file to read. The command checks if it exists, as only the command knows if it must."""


class WrittenFile(click.Path):
    """A file that a command writes: none that it reads, and each option another one."""


written_file = WrittenFile(path_type=Path)

Decorated = Callable[..., Any]

_E = TypeVar("_E", bound=StrEnum)


class Choice(click.Choice[_E]):
    """The members of an enum, written as their values."""

    def __init__(self, members: Iterable[_E]) -> None:
        super().__init__(members)

    def normalize_choice(self, choice: object, ctx: click.Context | None) -> str:
        return str(choice)


class SectionedCommand(click.Command):
    """A command whose help shows a few options first, and the others under headings.

    Args:
        sections: the parameters under each heading.
    """

    def __init__(self, *args: Any, sections: Mapping[str, Iterable[str]], **others: Any) -> None:
        super().__init__(*args, **others)
        self.sections = sections

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        records = {
            each.name: record
            for each in self.get_params(ctx)
            if not isinstance(each, click.Argument) and (record := each.get_help_record(ctx)) is not None
        }
        placed = {name for names in self.sections.values() for name in names}
        first = [name for name in records if name not in placed]
        for heading, names in {"Options": first, **self.sections}.items():
            with formatter.section(heading):
                formatter.write_dl([records[name] for name in names])


def finish(action: Callable[[], ExitStatus], seconds: float | None = None) -> None:
    """Runs a command and ends the program with its status; an error becomes a message.

    Args:
        seconds: the limit on the time of the command as a whole, see `max_seconds`.
    """

    context = click.get_current_context()

    def checked() -> ExitStatus:
        _check_written_files(context)
        return action()

    context.exit(run_command(checked, seconds))


def _check_written_files(context: click.Context) -> None:
    """Raises UsageError for a file that the command would write and also reads, or would write twice."""
    read, written = list[str](), list[tuple[str, str]]()
    for parameter in context.command.params:
        value = context.params.get(parameter.name or "")
        values = value if isinstance(value, tuple) else (value,)
        paths = [os.fspath(each) for each in values if isinstance(each, str | os.PathLike)]
        if isinstance(parameter.type, WrittenFile):
            written += ((parameter.opts[0], path) for path in paths)
        elif isinstance(parameter, click.Argument) or isinstance(parameter.type, click.Path):
            read += paths
    files = {os.path.realpath(path) for path in read if os.path.isfile(path)}
    for option, path in written:
        target = os.path.realpath(path)
        if target in files:
            raise UsageError(
                f"{option} {path}: the command would overwrite a file that it reads, or write a file twice",
                "give another name",
            )
        if os.path.isfile(path) or not os.path.exists(path):  # neither a folder nor a device nor a pipe
            files.add(target)


class FiniteNumber(click.types.FloatParamType):
    """A finite number that is given."""

    name = "number"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        number = float(super().convert(value, param, ctx))
        if not isfinite(number):
            self.fail(f"{value!r} is not a finite number.", param, ctx)
        return number


class NumberInRange(click.FloatRange, FiniteNumber):
    """A finite number within a range. A range alone lets ``nan`` pass, with which no comparison is true."""

    name = "number"


class Seconds(NumberInRange):
    """A time that is given."""

    name = "number of seconds"


class Count(click.IntRange):
    """A whole number that is given."""

    name = "whole number"


def max_seconds(help: str = "Stop after this time, with exit status 20.") -> Callable[[Decorated], Decorated]:
    """``--max-seconds``: the limit on time of whatever reads models or traces."""
    return click.option("seconds", "--max-seconds", metavar="SECONDS", type=Seconds(min=0), help=help)


faults = click.option(
    "faults",
    "--fault",
    metavar="FAULT=PLAN",
    multiple=True,
    help="How often a fault of the model happens: lost=0.01, or to which messages: lost=send[0][1]:3,5..7, or as soon "
    "as it can: 'falls asleep=now'. Can be given several times.",
)
"""The faults of a model to inject; `simulation.fault_injection` reads them."""


def max_states(more: str = "") -> Callable[[Decorated], Decorated]:
    """``--max-states``: the limit on the states of each search; ``more`` says what that means for an answer."""
    help = f"Stop a search after storing N states{more}."
    return click.option("states", "--max-states", metavar="N", type=Count(min=1), help=help)


def max_memory(function: Decorated) -> Decorated:
    """``--max-memory``: the limit on the memory of each search, such as ``2G``."""
    help = "Stop a search that takes more memory than this, such as 2G."
    return click.option("max_memory", "--max-memory", metavar="SIZE", help=help)(function)


def plain(option: PlainOption, help: str) -> Callable[[Decorated], Decorated]:
    """An option that `tachk verify` also reads without click."""
    attributes: dict[str, Any] = {"multiple": option.several, "help": help}
    match option.kind:
        case Kind.FLAG:
            attributes |= {"is_flag": True}
        case Kind.FILE:
            attributes |= {"metavar": option.metavar, "type": type_of_file}
        case Kind.TEXT:
            attributes |= {"metavar": option.metavar}
    return click.option(option.parameter, *option.names, **attributes)


definitions = plain(plain_options.DEFINITIONS, "Set a global constant of the model to another value.")


def query_files(help: str) -> Callable[[Decorated], Decorated]:
    return plain(plain_options.QUERY_FILES, help)


def agent_ports(help: str) -> Callable[[Decorated], Decorated]:
    """``--port``: the ports of Agents in a capture of packets."""
    return click.option("ports", "--port", metavar="PORT", type=Count(1, 65535), multiple=True, help=help)


def lateness(help: str) -> Callable[[Decorated], Decorated]:
    """The option `--late`, for inputs and outputs together or apart."""
    help += " For each apart: --late input=1ms --late output=20ms."
    return click.option("--late", metavar="DURATION", multiple=True, help=help)


def report(*forms: str) -> Callable[[Decorated], Decorated]:
    """``--format``, ``--output`` and ``--quiet`` of a command that reports in one of these forms, the first
    by default: its `Reporting`."""

    def add(function: Decorated) -> Decorated:
        function = plain(plain_options.QUIET, "Print no report; only set the exit status.")(function)
        function = click.option(
            "output", "-o", "--output", metavar="FILE", type=written_file, help="Write the report to a file."
        )(function)
        return click.option(
            plain_options.FORM.parameter,
            *plain_options.FORM.names,
            type=click.Choice(forms),
            default=forms[0],
            show_default=True,
            help="Form of the report.",
        )(function)

    return add
