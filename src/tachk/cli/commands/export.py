"""`tachk export`: write a model for UPPAAL, TChecker, Munta or Graphviz, or as a unit (FMU)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from tachk.cli import options
from tachk.formats.catalogue import EXPORT_FORMATS

_UNIT = "fmu"
"""Not one of the formats of texts: a unit for co-simulation."""


@click.command(name="export")
@click.argument("model", metavar="MODEL", type=click.Path(), help="A model file.")
@click.option("output", "-o", "--output", metavar="FILE", type=options.type_of_file, help="The file to write.")
@click.option(
    "--format",
    type=click.Choice([*EXPORT_FORMATS, _UNIT]),
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
@click.option("--fmi", type=click.Choice(["2", "3"]), help="The version of FMI of a unit; 3 by default.")
@click.option("--processes", metavar="NAMES", help="Of a unit: only these processes or templates, with commas between.")
@options.max_seconds()
def command(
    seconds: float | None, output: Path | None, format: str | None, fmi: str | None, processes: str | None, **given: Any
) -> None:
    """Write a model for UPPAAL, TChecker, Munta, Graphviz or other programs, and its queries in a file beside it.

    With --format fmu it becomes a unit for co-simulation by the standard FMI.
    """
    from tachk.cli.actions.export import run_export, run_export_unit

    if format == _UNIT or (format is None and output is not None and output.suffix.lower() == f".{_UNIT}"):
        options.finish(lambda: run_export_unit(output=output, fmi=fmi or "3", processes=processes, **given), seconds)
        return

    for_unit = tuple(name for name, value in (("--fmi", fmi), ("--processes", processes)) if value is not None)
    options.finish(lambda: run_export(output=output, format=format, for_unit=for_unit, **given), seconds)
