"""`tachk draw`: draw the templates of a model."""

from __future__ import annotations

from pathlib import Path

import click

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.whole_files import write_whole
from tachk.cli import options
from tachk.cli.exit_status import ExitStatus
from tachk.report.drawing.png import to_png


@click.command(name="draw")
@click.argument("model", metavar="MODEL", type=click.Path(), help="A model file.")
@click.option(
    "output",
    "-o",
    "--output",
    metavar="DIR|FILE",
    type=options.written_file,
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

    options.finish(lambda: run_draw(model, output, template, definitions, coverage), seconds)


_SUFFIXES = (".svg", ".png")


def run_draw(
    model: str,
    output: Path,
    template: str | None,
    definitions: tuple[str, ...] = (),
    coverage: Path | None = None,
) -> ExitStatus:
    """Writes the pictures of a model: all in one if the output is named ``.svg`` or ``.png``, else one SVG each."""
    from tachk.cli.arguments import parse_definitions
    from tachk.report.conformance.taken_edges import read_taken
    from tachk.report.drawing.svg import together
    from tachk.report.pictures import draw_file, named

    suffix = output.suffix.lower()
    if suffix and suffix not in _SUFFIXES and not output.is_dir():
        raise UsageError(f"{output}: pictures are written as .svg or .png", "without an ending, to a folder")
    taken = None if coverage is None else read_taken(coverage)
    pictures = draw_file(model, parse_definitions(definitions), taken)
    if template is not None:
        pictures = (named(pictures, template),)
    if suffix in _SUFFIXES:
        whole = pictures[0] if len(pictures) == 1 else together(Path(model).stem, pictures)
        files = {output: whole}
    else:
        output.mkdir(parents=True, exist_ok=True)
        files = {output / f"{picture.name}.svg": picture for picture in pictures}
    for path, picture in files.items():
        if path.suffix.lower() == ".png":
            write_whole(path, to_png(picture.svg))
        else:
            write_whole(path, picture.svg)
        print(f"written: {path}")
    return ExitStatus.AS_EXPECTED
