"""`tachk verifyta`: check with the options and output of UPPAAL's verifyta."""

from __future__ import annotations

from typing import NoReturn

import click

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.cli import options
from tachk.cli.clicked import end_with
from tachk.cli.exit_status import ExitStatus

_SPOKEN_VERSION = "4.1.26"
"""The release whose output is followed; wrappers read it and derive the names of trace files from it."""


class _Untouched(click.Command):
    """A command that gets its arguments as they were typed."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        ctx.params["arguments"] = tuple(args)
        return []


@click.command(name="verifyta", cls=_Untouched)
def command(arguments: tuple[str, ...]) -> None:
    """Check models with the options and the output of UPPAAL's verifyta, for scripts that call verifyta."""
    program = click.get_current_context().command_path
    options.finish(lambda: _answer(arguments, program))


def _answer(arguments: tuple[str, ...], program: str) -> ExitStatus:
    from tachk.cli.verifyta_options import help_text, parse_arguments

    given = parse_arguments(arguments)
    if given.wants_help:
        print(help_text(program), end="")
    elif given.wants_version:
        print(f"tachk {tachk.__version__}, with the command line of UPPAAL {_SPOKEN_VERSION} (verifyta)")
    elif not given.model:
        raise UsageError("no model is given", f"{program} [OPTION]... MODEL [QUERIES]; the options are listed by -h")
    else:
        from tachk.cli.verifyta_answers import run_verifyta

        return run_verifyta(given)
    return ExitStatus.AS_EXPECTED


def run() -> NoReturn:
    """The console script `tachk-verifyta`."""
    end_with(command, "tachk-verifyta")
