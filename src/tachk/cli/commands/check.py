"""The options of `tachk check`."""

from __future__ import annotations

import click

from tachk.cli import options


@click.command(name="check")
@click.argument("models", metavar="MODEL...", nargs=-1, required=True, type=click.Path(), help="Model files.")
@options.definitions
@click.option(
    "version",
    "--for",
    type=click.Choice(["uppaal-4.1", "uppaal-5.0"]),
    help="Report what this version of UPPAAL would refuse or do otherwise.",
)
def command(models: tuple[str, ...], definitions: tuple[str, ...], version: str | None) -> None:
    """Read models and report every mistake and warning, without checking a property."""
    from tachk.cli.check import run_check

    options.finish(lambda: run_check(models, definitions, version))
