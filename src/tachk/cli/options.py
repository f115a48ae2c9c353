"""What the options of several commands have in common. Imports nothing heavy."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from tachk.cli.exit_status import ExitStatus
from tachk.cli.guard import guarded

type_of_file = click.Path(path_type=Path)
"""A file to read or write. Whether it exists is for the command to say, which knows what was meant."""

Decorated = Callable[..., Any]


def finish(action: Callable[[], ExitStatus]) -> None:
    """Runs a command and ends the program with its status; an error becomes a message."""
    click.get_current_context().exit(guarded(action))


def definitions(function: Decorated) -> Decorated:
    return click.option(
        "definitions",
        "-D",
        "--define",
        metavar="NAME=EXPR",
        multiple=True,
        help="Give a global constant of the model another value.",
    )(function)


def query_files(help: str) -> Callable[[Decorated], Decorated]:
    return click.option("query_files", "-q", "--queries", metavar="FILE", multiple=True, type=type_of_file, help=help)


def report(*formats: str) -> Callable[[Decorated], Decorated]:
    """``--format``, ``--output`` and ``--quiet`` of a command that reports in one of these formats."""

    def add(function: Decorated) -> Decorated:
        function = click.option("quiet", "--quiet", is_flag=True, help="Print no report; the exit status tells.")(
            function
        )
        function = click.option(
            "output", "-o", "--output", metavar="FILE", type=type_of_file, help="Write the report to a file."
        )(function)
        return click.option(
            "--format", type=click.Choice(formats), default=formats[0], show_default=True, help="Form of the report."
        )(function)

    return add


def formula(function: Decorated) -> Decorated:
    return click.argument(
        "formula",
        metavar="FORMULA|FILE",
        type=click.Path(),
        help="A formula, a sentence, a file of them (.stl), or a model.",
    )(function)


def columns(function: Decorated) -> Decorated:
    """``--time``, ``--unit``, ``--property`` and ``--interpolation`` of the commands that read a trace."""
    for option in (
        click.option(
            "--interpolation",
            type=click.Choice(["constant", "linear"]),
            default="constant",
            show_default=True,
            help="Between rows numbers are held, or move in straight lines.",
        ),
        click.option("names", "--property", metavar="NAME", multiple=True, help="Take this formula of the file."),
        click.option("--unit", metavar="UNIT", help="Of the times, if the trace does not say it: ms, s, ..."),
        click.option("--time", metavar="NAME", help="The time column, if it is not time, t or timestamp."),
    ):
        function = option(function)
    return function
