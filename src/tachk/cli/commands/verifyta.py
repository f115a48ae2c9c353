"""`tachk verifyta`, and the program `tachk-verifyta`: their options are UPPAAL's, so click does not read them."""

from __future__ import annotations

import sys

import click

from tachk.cli import options


class _Untouched(click.Command):
    """A command that gets its arguments as they were typed."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        ctx.params["arguments"] = tuple(args)
        return []


@click.command(name="verifyta", cls=_Untouched)
def command(arguments: tuple[str, ...]) -> None:
    """Check models with the options and the output of UPPAAL's verifyta, for scripts written for it."""
    _run(arguments, "tachk verifyta")


def _run(arguments: tuple[str, ...], program: str) -> None:
    from tachk.cli.verifyta import run_verifyta

    options.finish(lambda: run_verifyta(arguments, program))


def run() -> None:
    """The console script `tachk-verifyta`."""
    with click.Context(command):
        try:
            _run(tuple(sys.argv[1:]), "tachk-verifyta")
        except click.exceptions.Exit as end:
            sys.exit(end.exit_code)
