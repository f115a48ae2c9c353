"""The program: its commands, each loaded when it is called.

Imports nothing heavy: `tachk --version` must not wait for z3. The module of a command in `tachk.cli.commands` holds its
options, its help and what it does; it loads what that needs once its arguments are right.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from importlib import import_module
from typing import TYPE_CHECKING, NoReturn

import click
from click.exceptions import NoSuchCommand

import tachk
from tachk.cli import commands
from tachk.cli.console_script import end_program

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

SECTIONS = {
    "Verify": {
        "verify": "Check the properties of models, or the given queries.",
        "synthesize": "Find the values of constants for which a property holds.",
        "sweep": "Check a model for many values of its constants.",
        "time": "Find the least and the largest time between two events.",
        "certify": "Check certificates: proofs of verdicts, without a search.",
        "requirements": "Find requirements that contradict each other.",
        "report": "Write an HTML page with verdicts, runs and pictures.",
        "verifyta": "Check with the options and output of UPPAAL's verifyta.",
    },
    "Simulate": {
        "simulate": "Simulate random runs of a model.",
        "estimate": "Answer statistical queries: probabilities from random runs.",
        "replay": "Execute a recorded run on a model, and check formulas on it.",
        "step": "Walk through a model, step by step.",
    },
    "Logs of a real system": {
        "monitor": "Check properties on a recorded trace, or while it is recorded.",
        "conform": "Check whether recorded events are a run of a model.",
        "mine": "Find the tightest value for which a formula holds on traces.",
        "plot": "Draw a trace and the violations of properties on it.",
    },
    "Packets of DDS-XRCE": {
        "decode": "Print the DDS-XRCE submessages of a capture, a line each.",
        "measure": "Measure the parameters of a DDS-XRCE system in captures of it.",
        "chart": "Draw a sequence chart of a capture or of a run.",
        "proxy": "Relay packets, and lose, delay or duplicate some of them.",
        "bridge": "Run a model in place of a client or an Agent, over UDP.",
    },
    "Models": {
        "check": "Report every mistake in models.",
        "fmt": "Rewrite models in canonical form.",
        "convert": "Write a model in another file format.",
        "export": "Write a model for UPPAAL, TChecker, Munta, Graphviz or FMI.",
        "diff": "Show how the behaviour of two models differs.",
        "draw": "Draw the templates of a model.",
        "models": "List the models that come with tachk, or copy one.",
    },
    "Help": {
        "explain": "Explain a message, a formula or a sentence.",
        "sentences": "List the English sentences that express properties.",
        "completion": "Print a script that lets your shell complete commands.",
    },
}
"""The commands by their sections of the help, each with its first line, so that the help need not import them."""


def _modules_of(folders: Iterable[str]) -> set[str]:
    """The names of the modules in some folders; `pkgutil` would take a millisecond of each start for it."""
    names = {name.removesuffix(".py") for folder in folders for name in os.listdir(folder) if name.endswith(".py")}
    return names - {"__init__"}


_OTHERS = "More commands"
"""The section of commands that stand in the folder but not in a section."""

COMMANDS = (
    *(name for section in SECTIONS.values() for name in section),
    *sorted(_modules_of(commands.__path__).difference(*SECTIONS.values())),
)
"""In the order of the help: those of the sections, then all others of the folder."""

COMPLETION_VARIABLE = "_TACHK_COMPLETE"
"""With this in the environment click answers what a shell asks when it completes a line."""


def load_command(name: str) -> click.Command:
    """The command of a name: `tachk.cli.commands.NAME.command`."""
    command = import_module(f"{commands.__name__}.{name}").command
    assert isinstance(command, click.Command)
    return command


def _summaries() -> dict[str, dict[str, str]]:
    """The first lines of all commands, by section."""
    others = {name: load_command(name).get_short_help_str(80) for name in COMMANDS if not _has_section(name)}
    return {**SECTIONS, _OTHERS: others} if others else SECTIONS


def _has_section(name: str) -> bool:
    return any(name in section for section in SECTIONS.values())


class _Commands(click.Group):
    """Loads a command when it is needed; the help and the completion of names load none."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        return load_command(cmd_name) if cmd_name in COMMANDS else None

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        width = max(map(len, COMMANDS))
        for section, summaries in _summaries().items():
            with formatter.section(section):
                formatter.write_dl([(name.ljust(width), summary) for name, summary in summaries.items()])

    def shell_complete(self, ctx: click.Context, incomplete: str) -> list[CompletionItem]:
        from click.shell_completion import CompletionItem

        summaries = {name: summary for section in _summaries().values() for name, summary in section.items()}
        names = [CompletionItem(name, help=help) for name, help in summaries.items() if name.startswith(incomplete)]
        return [*names, *click.Command.shell_complete(self, ctx, incomplete)]

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if args[0] not in COMMANDS and not args[0].startswith("-"):
            raise NoSuchCommand(args[0], possibilities=COMMANDS, ctx=ctx)
        return super().resolve_command(ctx, args)


def _print_version(ctx: click.Context, parameter: click.Parameter, wanted: bool) -> None:
    if wanted:
        print(f"tachk {tachk.__version__}")
        ctx.exit()


@click.group(name="tachk", cls=_Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.option(
    "--version", is_flag=True, is_eager=True, expose_value=False, callback=_print_version, help="Print the version."
)
def app() -> None:
    """Model checking of networks of timed automata.

    Exit status: 0 everything is as expected, 10 something is not, 20 something is unknown or a limit was hit,
    2 bad input or usage, 3 unsupported feature, 70 a defect of tachk. If several apply, it is the first of
    70, 2, 10, 3, 20, 0.
    """


def run() -> NoReturn:
    """The console script."""
    end_program(lambda: app.main(prog_name="tachk", complete_var=COMPLETION_VARIABLE, standalone_mode=False))
