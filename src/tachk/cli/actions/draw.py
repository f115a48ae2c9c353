"""The action of `tachk draw`."""

from __future__ import annotations

from pathlib import Path

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.whole_files import write_whole
from tachk.cli.arguments import parse_definitions
from tachk.cli.exit_status import ExitStatus
from tachk.report.conformance.taken_edges import read_taken
from tachk.report.drawing.png import to_png
from tachk.report.drawing.svg import together
from tachk.report.pictures import draw_file, named

_SUFFIXES = (".svg", ".png")


def run_draw(
    model: str,
    output: Path,
    template: str | None,
    definitions: tuple[str, ...] = (),
    coverage: Path | None = None,
) -> ExitStatus:
    """Writes the pictures of a model: all in one if the output is named ``.svg`` or ``.png``, else one SVG each."""
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
