"""The program: its commands, each loaded when it is asked for.

Imports nothing heavy: `tachk --version` must not wait for z3. The options of a command are in `tachk.cli.commands`,
what it does is in the module of its name in `tachk.cli.actions`.
"""

from __future__ import annotations

from importlib import import_module
from typing import NoReturn

import click
from click.exceptions import NoSuchCommand

import tachk
from tachk.cli.console_script import end_program

COMMANDS = (
    "verify",
    "synthesize",
    "sweep",
    "report",
    "certify",
    "time",
    "check",
    "fmt",
    "convert",
    "export",
    "diff",
    "draw",
    "decode",
    "measure",
    "chart",
    "simulate",
    "replay",
    "step",
    "estimate",
    "bridge",
    "conform",
    "proxy",
    "monitor",
    "mine",
    "plot",
    "explain",
    "sentences",
    "requirements",
    "models",
    "completion",
    "verifyta",
)
"""In the order of the help."""

_FOLDERS = {
    **dict.fromkeys(("chart", "decode", "measure", "proxy"), "packets"),
    **dict.fromkeys(("synthesize", "sweep"), "many_values"),
    **dict.fromkeys(("simulate", "replay", "step", "estimate", "bridge"), "simulation"),
}
"""Of commands whose modules are in folders of their own."""


COMPLETION_VARIABLE = "_TACHK_COMPLETE"
"""With this in the environment click answers what a shell asks when it completes a line."""


def load_command(name: str) -> click.Command:
    """The command of a name: `tachk.cli.commands.NAME.command`, or in one of the folders."""
    folder = f"{_FOLDERS[name]}." if name in _FOLDERS else ""
    command = import_module(f"tachk.cli.commands.{folder}{name.replace('-', '_')}").command
    assert isinstance(command, click.Command)
    return command


class _Commands(click.Group):
    """Loads a command when it is needed; the help needs all of them."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        return load_command(cmd_name) if cmd_name in COMMANDS else None

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
