"""The program: its commands, each loaded when it is called.

Imports nothing heavy: `tachk --version` must not wait for z3. The module of a command in `tachk.cli.commands` holds its
options, its help and what it does; it loads what that needs once its arguments are right. The commands of one protocol
stand in a folder of its name.
"""

from __future__ import annotations

import os
import sys
from importlib import import_module
from typing import TYPE_CHECKING, NoReturn

import click
from click.exceptions import NoSuchCommand

import tachk
from tachk.cli import commands
from tachk.cli.clicked import end_with
from tachk.cli.console_script import COMPLETION_VARIABLE
from tachk.cli.former_names import FORMER_NAMES

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

SECTIONS = {
    "Write and run models": {
        "check": "Report every mistake in models.",
        "fmt": "Rewrite models in canonical form.",
        "draw": "Draw the templates of a model.",
        "convert": "Write a model in another format: for UPPAAL, FMI, ...",
        "diff": "Show how the behaviour of two models differs.",
        "models": "List the models that come with tachk, or copy one.",
        "simulate": "Simulate random runs of a model.",
        "step": "Walk through a model, step by step.",
        "replay": "Execute a recorded run on a model, and check formulas on it.",
    },
    "Ask questions": {
        "verify": "Check the properties of models, or the given queries.",
        "time": "Find the least and the largest time between two events.",
        "estimate": "Answer statistical queries: probabilities from random runs.",
        "sweep": "Check a model for many values of its constants.",
        "synthesize": "Find the values of constants for which a property holds.",
        "certify": "Check proofs that `verify --certificate` has written.",
        "requirements": "Find requirements that contradict each other.",
    },
    "Check logs of the real system": {
        "monitor": "Check properties on a recorded trace, or while it is recorded.",
        "conform": "Check whether recorded events are a run of a model.",
        "test": "Test a running system by a model.",
        "tests": "Make a test suite of a model: runs that take all its edges.",
        "plot": "Draw a trace and the violations of properties on it.",
        "chart": "Draw a sequence chart of a capture or of a run.",
        "xrce": "Decode, measure, relay and answer packets of DDS-XRCE.",
    },
    "Explain results": {
        "explain": "Explain a message, a formula or a sentence.",
        "report": "Write an HTML page with verdicts, runs and pictures.",
        "mcp": "Offer tachk's tools to an agent (Model Context Protocol).",
    },
}
"""The commands by their sections of the help, each with its first line, so that the help need not import them."""

FOLDERS = {
    "xrce": {
        "decode": "Print the submessages of a capture, a line each.",
        "measure": "Measure the parameters of a system in captures of it.",
        "proxy": "Relay packets, and lose, delay or duplicate some of them.",
        "bridge": "Run a model in place of a client or an Agent, over UDP.",
    },
}
"""The commands about one protocol, which stand under its name."""

HIDDEN = ("verifyta", "completion", "serve")
"""Commands that the help does not list: for scripts that call another program, for shells, and for calls of editors."""

_OTHERS = "More commands"
"""The section of commands that stand in the folder but not in a section."""


def _modules() -> set[str]:
    """The names of the modules of commands; `pkgutil` would take a millisecond of each start for it."""
    names = {name.removesuffix(".py") for folder in commands.__path__ for name in os.listdir(folder)}
    return {name for name in names if not name.startswith("_")}


TOP_LEVEL = (
    *(name for section in SECTIONS.values() for name in section),
    *HIDDEN,
    *sorted(_modules().difference(*SECTIONS.values(), HIDDEN)),
)
"""The names behind `tachk`, in the order of the help: those of the sections, then all others of the folder."""

COMMANDS = (
    *(name for name in TOP_LEVEL if name not in FOLDERS),
    *(f"{folder} {name}" for folder, names in FOLDERS.items() for name in names),
)
"""All commands, as one types them."""


def load_command(name: str) -> click.Command:
    """The command of a name: `tachk.cli.commands.NAME.command`; `xrce decode` stands in the folder `xrce`."""
    command = import_module(f"{commands.__name__}.{name.replace(' ', '.')}").command
    assert isinstance(command, click.Command)
    return command


class _Group(click.Group):
    """Loads a command when it is needed; the help and the completion of names load none."""

    def sections(self) -> dict[str, dict[str, str]]:
        """The first lines of the commands, by section."""
        raise NotImplementedError

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        raise NotImplementedError

    def list_commands(self, ctx: click.Context) -> list[str]:
        return [name for section in self.sections().values() for name in section]

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        sections = self.sections()
        width = max(len(name) for section in sections.values() for name in section)
        for section, summaries in sections.items():
            with formatter.section(section):
                formatter.write_dl([(name.ljust(width), summary) for name, summary in summaries.items()])

    def shell_complete(self, ctx: click.Context, incomplete: str) -> list[CompletionItem]:
        from click.shell_completion import CompletionItem

        summaries = {name: summary for section in self.sections().values() for name, summary in section.items()}
        names = [CompletionItem(name, help=help) for name, help in summaries.items() if name.startswith(incomplete)]
        return [*names, *click.Command.shell_complete(self, ctx, incomplete)]

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if not args[0].startswith("-") and self.get_command(ctx, args[0]) is None:
            raise NoSuchCommand(args[0], possibilities=self.list_commands(ctx), ctx=ctx)
        return super().resolve_command(ctx, args)


class _Folder(_Group):
    """The commands of a folder: those about one protocol."""

    def sections(self) -> dict[str, dict[str, str]]:
        assert self.name is not None
        return {"Commands": FOLDERS[self.name]}

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        assert self.name is not None
        return load_command(f"{self.name} {cmd_name}") if cmd_name in FOLDERS[self.name] else None


class _MainGroup(_Group):
    """The commands behind `tachk`; those of earlier versions go on working, with a note.

    `help NAME` is `NAME --help`.
    """

    def sections(self) -> dict[str, dict[str, str]]:
        listed = {*HIDDEN, *(name for section in SECTIONS.values() for name in section)}
        others = {name: load_command(name).get_short_help_str(80) for name in TOP_LEVEL if name not in listed}
        return {**SECTIONS, _OTHERS: others} if others else SECTIONS

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name in FOLDERS:
            return _Folder(
                cmd_name,
                help=f"{dict(item for section in SECTIONS.values() for item in section.items())[cmd_name]}",
                context_settings=_CONTEXT,
            )
        return load_command(cmd_name) if cmd_name in TOP_LEVEL else None

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        former = FORMER_NAMES.get(args[0])
        if former is not None:
            print(f"note: `tachk {args[0]}` is now `tachk {former.name}`; the old name will go", file=sys.stderr)
            args = former.arguments(args[1:])
        if args[0] == "help":
            args = [*args[1:], "--help"]
            if len(args) == 1:
                click.echo(ctx.get_help())
                ctx.exit()
        return super().resolve_command(ctx, args)

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        self.format_commands(ctx, formatter)


def _print_version(ctx: click.Context, parameter: click.Parameter, wanted: bool) -> None:
    if wanted:
        print(f"tachk {tachk.__version__}")
        ctx.exit()


_CONTEXT = {"help_option_names": ["-h", "--help"]}


@click.group(
    name="tachk",
    cls=_MainGroup,
    context_settings=_CONTEXT,
    options_metavar="[--version]",
    subcommand_metavar="COMMAND [--help] ...",
)
@click.option(
    "--version", is_flag=True, is_eager=True, expose_value=False, callback=_print_version, help="Print the version."
)
def app() -> None:
    """Check protocols and controllers whose correctness depends on time.

    Exit status: 0 as expected, 10 not as expected, 20 unknown or a limit was hit,
    2 wrong input or options, 3 not supported, 70 a defect of tachk.
    """


def run() -> NoReturn:
    """The program, with whatever arguments."""
    end_with(app, "tachk", COMPLETION_VARIABLE)
