"""`tachk draw`."""

from __future__ import annotations

from pathlib import Path

from tachk.cli.exit_status import ExitStatus
from tachk.export.pictures import draw_file, named
from tachk.export.svg import together


def run_draw(model: str, output: Path, template: str | None) -> ExitStatus:
    """Writes the pictures of a model: all in one file if the output is named ``.svg``, else one each."""
    pictures = draw_file(model)
    if template is not None:
        pictures = (named(pictures, template),)
    if output.suffix.lower() == ".svg":
        whole = pictures[0] if len(pictures) == 1 else together(Path(model).stem, pictures)
        files = {output: whole}
    else:
        output.mkdir(parents=True, exist_ok=True)
        files = {output / f"{picture.name}.svg": picture for picture in pictures}
    for path, picture in files.items():
        path.write_text(picture.svg, encoding="utf-8")
        print(f"written: {path}")
    return ExitStatus.AS_EXPECTED
