"""`tachk check`: report every mistake in models."""

from __future__ import annotations

from typing import Any

import click

from tachk.cli import options
from tachk.formats.uppaal.versions import UppaalVersion
from tachk.report.check_report import CHECK_FORMATS


@click.command(name="check")
@click.argument("models", metavar="MODEL...", nargs=-1, required=True, type=click.Path(), help="Model files.")
@options.definitions
@click.option(
    "version",
    "--for",
    type=options.Choice(UppaalVersion),
    help="Also report what this version of UPPAAL would refuse or treat differently.",
)
@click.option(
    "form",
    "--format",
    type=click.Choice(("text", *CHECK_FORMATS)),
    default="text",
    show_default=True,
    help="Form of the report: text for people, json for programs, sarif for code scanning, github for annotations.",
)
@click.option("output", "-o", "--output", metavar="FILE", type=options.type_of_file, help="Write the report to a file.")
@click.option(
    "deep",
    "--deep",
    is_flag=True,
    help="Explore the states of each model, and warn of what no run reaches, time-locks, Zeno loops, unused names.",
)
@options.max_seconds("Stop reading or exploring a model after this time, with exit status 20.")
@click.option("strict_xta", "--strict-xta", is_flag=True, help="Refuse what tachk adds to the language of UPPAAL.")
def command(**given: Any) -> None:
    """Read models and report every mistake and warning, without checking a property."""
    from tachk.cli.actions.check import run_check

    options.finish(lambda: run_check(**given))
