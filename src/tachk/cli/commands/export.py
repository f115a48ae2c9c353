"""The options of `tachk export`."""

from __future__ import annotations

from typing import Any

import click

from tachk.cli import options
from tachk.formats.catalogue import ExportFormat


@click.command(name="export", short_help="Write a model for UPPAAL, TChecker, Munta or Graphviz.")
@click.argument("model", metavar="MODEL", type=click.Path(), help="A model file.")
@click.option("output", "-o", "--output", metavar="FILE", type=options.type_of_file, help="The file to write.")
@click.option(
    "--format",
    type=options.Choice(ExportFormat),
    help="The format; by default the one that the ending of FILE stands for.",
)
@options.definitions
@click.option("--explain", is_flag=True, help="Print what is written differently than in the model, and where.")
@click.option("--keep-names", is_flag=True, help="Keep names that some version of UPPAAL refuses.")
@click.option(
    "--observers/--no-observers",
    default=True,
    show_default=True,
    help="Write temporal properties as observer automata, or as comments.",
)
@options.max_seconds()
def command(seconds: float | None, **given: Any) -> None:
    """Write a model for UPPAAL, TChecker, Munta, Graphviz or other programs, and its queries in a file beside it."""
    from tachk.cli.actions.export import run_export

    options.finish(lambda: run_export(**given), seconds)
