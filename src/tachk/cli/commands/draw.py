"""`tachk draw`: draw the templates of a model."""

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
    metavar="DIR|FILE",
    type=options.type_of_file,
    default=Path(),
    show_default=True,
    help="The folder for one .svg file per template, or one .svg or .png file for all.",
)
@click.option("--template", metavar="NAME", help="Draw this template only.")
@click.option(
    "coverage",
    "--coverage",
    metavar="FILE",
    type=options.type_of_file,
    help="Draw which edges recordings have taken, and how often; tachk conform --coverage --format json writes it.",
)
@options.definitions
@options.max_seconds()
def command(
    model: str,
    output: Path,
    template: str | None,
    coverage: Path | None,
    definitions: tuple[str, ...],
    seconds: float | None,
) -> None:
    """Draw the templates of a model as SVG or PNG.

    If a UPPAAL file has a picture, it is used; otherwise tachk places locations and edges itself. A constant that is
    set with -D is drawn as its value.
    """
    from tachk.cli.actions.draw import run_draw

    options.finish(lambda: run_draw(model, output, template, definitions, coverage), seconds)
