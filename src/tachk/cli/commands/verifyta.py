"""`tachk verifyta`, and the program `tachk-verifyta`: their options are UPPAAL's, so click does not read them."""

from __future__ import annotations

import sys
from typing import NoReturn

import click

from tachk.cli import options
from tachk.cli.program import end_program


class _Untouched(click.Command):
    """A command that gets its arguments as they were typed."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        ctx.params["arguments"] = tuple(args)
        return []


@click.command(name="verifyta", cls=_Untouched)
def command(arguments: tuple[str, ...]) -> None:
    """Check models with the options and the output of UPPAAL's verifyta, for scripts written for it."""
    from tachk.cli.verifyta import run_verifyta

    program = click.get_current_context().command_path
    options.finish(lambda: run_verifyta(arguments, program))


def run() -> NoReturn:
    """The console script `tachk-verifyta`."""
    end_program(lambda: command.main(sys.argv[1:], prog_name="tachk-verifyta", standalone_mode=False))
