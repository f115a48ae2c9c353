"""The options of `tachk draw`."""

from __future__ import annotations

from pathlib import Path

import click

from tachk.cli import options


@click.command(name="draw")
@click.argument("model", metavar="MODEL", type=click.Path(), help="A model file.")
@click.option(
    "output",
    "-o",
    "--output",
    metavar="DIR|FILE.svg",
    type=options.type_of_file,
    default=Path(),
    show_default=True,
    help="A folder, or one file for all templates.",
)
@click.option("--template", metavar="NAME", help="Draw this template only.")
def command(model: str, output: Path, template: str | None) -> None:
    """Draw the templates of a model as SVG, with the picture that a UPPAAL file has or an automatic one."""
    from tachk.cli.draw import run_draw

    options.finish(lambda: run_draw(model, output, template))
