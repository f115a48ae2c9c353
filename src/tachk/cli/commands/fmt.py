"""`tachk fmt`: rewrite models in canonical form."""

from __future__ import annotations

from pathlib import Path

import click

from tachk.cli import options


@click.command(name="fmt")
@click.argument(
    "files", metavar="FILE...", nargs=-1, required=True, type=options.type_of_file, help="Model files in text form."
)
@click.option("check_only", "--check", is_flag=True, help="Change no file; fail if one is not in canonical form.")
@click.option("to_stdout", "--stdout", is_flag=True, help="Print the result instead of changing the file.")
@options.max_seconds()
def command(files: tuple[Path, ...], check_only: bool, to_stdout: bool, seconds: float | None) -> None:
    """Rewrite models in canonical form."""
    from tachk.cli.actions.fmt import run_fmt

    options.finish(lambda: run_fmt(files, check_only, to_stdout), seconds)
