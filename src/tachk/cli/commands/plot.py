"""The options of `tachk plot`."""

from __future__ import annotations

from pathlib import Path

import click

from tachk.cli import options


@click.command(name="plot", short_help="Draw a trace, and where properties are violated.")
@options.formula
@click.argument("trace", type=click.Path(), help="A CSV, Parquet or VCD file.")
@click.option(
    "output",
    "-o",
    "--output",
    metavar="FILE",
    type=options.type_of_file,
    required=True,
    help="An .svg, .png or .pdf file.",
)
@options.columns
@click.option("begin", "--from", metavar="TIME", type=float, help="Draw from here.")
@click.option("end", "--to", metavar="TIME", type=float, help="Draw up to here.")
def command(
    formula: str,
    trace: str,
    output: Path,
    time: str | None,
    unit: str | None,
    names: tuple[str, ...],
    begin: float | None,
    end: float | None,
    interpolation: str,
) -> None:
    """Draw a trace with what formulas and their parts are worth on it, and where they are violated."""
    from tachk.cli.actions.plot import run_plot

    options.finish(lambda: run_plot(formula, trace, output, time, unit, names, begin, end, interpolation))
