"""Writing matplotlib figures: the same bytes for the same figure."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from io import StringIO
from pathlib import Path
from typing import Any

from matplotlib import rc_context
from matplotlib.figure import Figure

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.whole_files import whole_file

FORMATS = (".svg", ".png", ".pdf")

_STYLE: dict[Any, Any] = {
    "font.size": 9,
    "font.family": "DejaVu Sans",
    "svg.hashsalt": "tachk",
    "svg.fonttype": "none",
}
_METADATA: Any = {"Date": None, "Creator": "tachk"}


@dataclass(frozen=True, slots=True)
class DrawnFigure:
    """A picture; a notebook shows it.

    Attributes:
        draw: makes it.
        style: matplotlib's parameters beside those of all pictures.
    """

    draw: Callable[[], Figure] = field(repr=False)
    style: Mapping[Any, Any] = field(repr=False)

    @property
    def svg(self) -> str:
        """The text of a file."""
        return svg_of(self.draw, self.style)

    def write(self, path: str | Path) -> None:
        """Writes a file whose ending says the format. Raises UsageError for an unknown one."""
        write_figure(path, self.draw, self.style)

    def _repr_svg_(self) -> str:
        return self.svg


def write_figure(path: str | Path, draw: Callable[[], Figure], style: Mapping[Any, Any]) -> None:
    """Draws a figure into a file whose ending says the format.

    Args:
        style: matplotlib's parameters beside those of all pictures.

    Raises UsageError for an unknown format.
    """
    target = Path(path)
    if target.suffix.lower() not in FORMATS:
        raise UsageError(f"{path}: pictures are written as {', '.join(FORMATS)}", "the ending of the name decides")
    with rc_context({**_STYLE, **style}):
        figure, form = draw(), target.suffix.lower().removeprefix(".")
        with whole_file(target) as part:
            figure.savefig(part, format=form, dpi=150, metadata=_METADATA if form == "svg" else None)


def svg_of(draw: Callable[[], Figure], style: Mapping[Any, Any]) -> str:
    """The text that `write_figure` writes into a file that ends in ``.svg``."""
    out = StringIO()
    with rc_context({**_STYLE, **style}):
        draw().savefig(out, format="svg", metadata=_METADATA)
    return out.getvalue()
