"""Pictures as PNG. The letters are those of the font that matplotlib brings, so they are the same everywhere."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path

from tachk.base.optional_packages import optional_packages, require
from tachk.report.drawing.themes import always_light

_FONTS = ("DejaVuSans.ttf", "DejaVuSans-Bold.ttf", "DejaVuSans-Oblique.ttf")
_ZOOM = 2
"""Pixels for each unit of a picture: sharp on today's screens and on paper."""


def to_png(svg: str) -> bytes:
    """A picture as the content of a PNG file, on white. Raises MissingPackageError where a package is missing."""
    with optional_packages():
        import resvg_py

    return bytes(
        resvg_py.svg_to_bytes(
            svg_string=always_light(svg),
            background="white",
            zoom=_ZOOM,
            font_files=[str(path) for path in _fonts()],
            sans_serif_family="DejaVu Sans",
            skip_system_fonts=True,
        )
    )


def _fonts() -> list[Path]:
    """The files of the font, found without loading the package. Raises MissingPackageError where there is none."""
    require("matplotlib")
    spec = find_spec("matplotlib")
    folders = spec.submodule_search_locations if spec is not None else None
    return [Path(folder) / "mpl-data" / "fonts" / "ttf" / name for folder in folders or () for name in _FONTS]
