"""Options that the commands that read a trace share. Imports nothing heavy."""

from __future__ import annotations

from collections.abc import Callable

import click

from tachk.cli import options
from tachk.cli.options import Choice, Count, Decorated
from tachk.recordings.traces.conventions import Interpolation
from tachk.recordings.traces.trace_files import FORMATS


def formula(function: Decorated) -> Decorated:
    return click.argument(
        "formula",
        metavar="FORMULA|FILE",
        type=click.Path(),
        help="A formula, a sentence, a file of them (.stl), or a model.",
    )(function)


def trace(more: str = "") -> Callable[[Decorated], Decorated]:
    names = [known.name for known in FORMATS]
    help = f"A {', '.join(names[:-1])} or {names[-1]} file{more}."
    others = "Further files, joined by time: each value is held until its column changes."

    def add(function: Decorated) -> Decorated:
        function = click.argument("others", metavar="[TRACE]...", type=click.Path(), nargs=-1, help=others)(function)
        return click.argument("trace", type=click.Path(), help=help)(function)

    return add


definitions = click.option(
    "definitions",
    "-D",
    "--define",
    metavar="NAME=NUMBER",
    multiple=True,
    help="Give a name in the formulas a value, or a constant of the model another one.",
)
"""``-D`` of the commands that read formulas."""


def columns(function: Decorated) -> Decorated:
    """The options of all commands that read a trace."""
    for option in (
        click.option(
            "--interpolation",
            type=Choice(Interpolation),
            default=Interpolation.CONSTANT.value,
            show_default=True,
            help="Between rows, numbers stay constant or change along straight lines.",
        ),
        definitions,
        click.option("names", "--property", metavar="NAME", multiple=True, help="Check only this formula of the file."),
        click.option("--unit", metavar="UNIT", help="The unit of the times, if the trace does not say it: ms, s, ..."),
        click.option(
            "--decimals",
            metavar="N",
            type=Count(0, 15),
            help="Round times to this many decimals. Without it they are exact, and binary numbers such as "
            "0.30000000000000004 are rounded to nine; row by row times and bounds have nine at most.",
        ),
        click.option(
            "--run",
            metavar="N",
            type=Count(0),
            help="Of a file of several runs, which simulate writes, this one only.",
        ),
        click.option("--time", metavar="NAME", help="The time column, if its name is not time, t or timestamp."),
        options.agent_ports(
            "Of a capture of packets: a port of an Agent or of a relay; without it 8888, and each port to which a "
            "session is created. Can be given several times."
        ),
    ):
        function = option(function)
    return function
