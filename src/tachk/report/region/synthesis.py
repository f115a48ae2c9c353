"""The answer of `Model.synthesize`: a region that can be written in every form."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tachk.base.frames import data_frame
from tachk.base.notebook import folded, html_table, preformatted
from tachk.base.optional_packages import optional_packages
from tachk.base.whole_files import whole_bytes
from tachk.meaning.judge.certificate import CertificateWriter
from tachk.report.json_report import Json
from tachk.report.region.json import Row, region_to_json, row_of
from tachk.report.region.words import assignment, effort, evidence, inequalities, knowledge, summary
from tachk.verify.synthesis.region import Region, RegionCell
from tachk.verify.verdict import Answer

if TYPE_CHECKING:
    from tachk.report.figure_files import DrawnFigure

_LETTERS = {Answer.HOLDS: "#", Answer.FAILS: ".", Answer.UNKNOWN: "?"}
_MOST_GRIDS = 12
_MOST_CORNERS = 12


def region_text(region: Region, time_unit: str, every_corner: bool = False) -> str:
    """The output of `tachk synthesize`."""
    return "\n".join(_lines(region, time_unit, every_corner)) + "\n"


def _lines(region: Region, time_unit: str, every_corner: bool) -> Iterator[str]:
    title = f": {region.query.title}" if region.query.title else ""
    yield f"{region.model}: {region.query.name}{title}"
    yield ""
    width = max(len(parameter.name) for parameter in region.parameters)
    for name, words in knowledge(region):
        yield f"  {name:<{width}}  {words}"
    yield ""
    yield from _grids(region)
    yield from _result_lines(region)
    corners = _corner_lines(region, time_unit, every_corner)
    if corners:
        yield ""
        yield "Corners of the border:"
        yield from (f"  {line}" for line in corners)
    yield ""
    yield f"{effort(region)}"


def _result_lines(region: Region) -> Iterator[str]:
    yield f"{summary(region)}."
    yield from _description(region)
    yield from _unknown(region)


def _corner_lines(region: Region, time_unit: str, every_corner: bool) -> list[str]:
    """The corners of the border with their evidence, or the first of them."""
    corners = region.corners
    shown = corners if every_corner else corners[:_MOST_CORNERS]
    values = [assignment(region, cell) for cell in shown]
    width = max(map(len, values), default=0)
    lines = [
        f"{text:<{width}}  {cell.answer.value}: {evidence(region, cell, time_unit)}"
        for cell, text in zip(shown, values, strict=True)
    ]
    return [*lines, *([f"and {len(corners) - len(shown)} more: --all-corners"] if len(shown) < len(corners) else [])]


def _counted(number: int, one: str) -> str:
    return f"{number} {one}" if number == 1 else f"{number} {one}s"


def _description(region: Region) -> Iterator[str]:
    words = inequalities(region)
    if words:
        yield ""
        yield f"  {words}"
        yield ""
        decided = len(region.cells) - len(region.unknown)
        yield f"This is consistent with all {decided} decided cells of the box. It says nothing about other values."
    elif region.holding and len(region.holding) + len(region.unknown) < len(region.cells):
        yield "No few linear inequalities with small coefficients describe it."


def _unknown(region: Region) -> Iterator[str]:
    reasons: dict[str, list[RegionCell]] = {}
    for cell in region.unknown:
        reasons.setdefault(cell.reason, []).append(cell)
    for reason, cells in reasons.items():
        more = f" and {len(cells) - 1} more" if len(cells) > 1 else ""
        yield f"Unknown: {assignment(region, cells[0])}{more}: {reason}"


def _grids(region: Region) -> Iterator[str]:
    """A grid for each combination of the values of the parameters after the second."""
    further = region.parameters[2:]
    letters = {cell.values: _LETTERS[cell.answer] for cell in region.cells}
    combinations = list(product(*(parameter.values for parameter in further)))
    for fixed in combinations[:_MOST_GRIDS]:
        if further:
            yield "  " + " ".join(f"{p.name}={value}" for p, value in zip(further, fixed, strict=True))
        yield from _grid(region, letters, fixed)
        yield ""
    if len(combinations) > _MOST_GRIDS:
        yield f"  and {len(combinations) - _MOST_GRIDS} more grids: --format csv"
        yield ""


def _grid(region: Region, letters: dict[tuple[int, ...], str], fixed: tuple[int, ...]) -> Iterator[str]:
    across, *rest = region.parameters[:2]
    rows = rest[0].values if rest else range(1)
    labels = [str(value) for value in rows] if rest else [""]
    width = max(map(len, labels))
    if rest:
        yield f"  {rest[0].name}"
    for row, label in reversed(list(zip(rows, labels, strict=True))):
        own = (row,) if rest else ()
        yield f"  {label:>{width}} " + "".join(letters[(value, *own, *fixed)] for value in across.values)
    yield f"  {'':>{width}} {across}    # holds  . fails  ? unknown"


@dataclass(frozen=True, slots=True)
class Synthesis:
    """For which values of constants a property holds.

    Attributes:
        region: every combination of values with its answer and the evidence for it.
        time_unit: of the model.
    """

    region: Region
    time_unit: str = ""

    @property
    def inequalities(self) -> str:
        """Linear inequalities that agree with all decided cells: ``WRITE <= WAIT``; empty where none were found."""
        return inequalities(self.region)

    @property
    def corners(self) -> tuple[RegionCell, ...]:
        """The cells where the border turns, each with a run or with a search that explored everything."""
        return self.region.corners

    def at(self, **values: int) -> RegionCell:
        """The cell with these values. Raises KeyError if it is none of the region."""
        return self.region.at(**values)

    def answer(self, **values: int) -> Answer:
        """The answer with these values. Raises KeyError if they are not in the region."""
        return self.at(**values).answer

    def to_dict(self) -> dict[str, Json]:
        """The region as docs/schema/synthesize.schema.json describes it."""
        return region_to_json(self.region)

    def to_rows(self) -> list[Row]:
        """One flat dictionary for each cell: what `pandas.DataFrame` takes."""
        return [row_of(self.region, cell) for cell in self.region.cells]

    def to_text(self, every_corner: bool = False) -> str:
        """The output of `tachk synthesize`."""
        return region_text(self.region, self.time_unit, every_corner)

    def certificates(self, folder: str | Path) -> list[Path]:
        """Writes the certificate of each corner that has one into a file of its own and returns their paths.

        The names are those of the values, such as ``WRITE=2,WAIT=2.cert``; `tachk certify` checks each with the same
        values of the constants.
        """
        target = Path(folder)
        target.mkdir(parents=True, exist_ok=True)
        written = []
        for cell in self.corners:
            if cell.certificate is not None:
                path = target / f"{assignment(self.region, cell).replace(' ', ',')}.cert"
                with whole_bytes(path) as stream:
                    CertificateWriter(stream).write(cell.certificate.header, cell.certificate.blocks())
                written.append(path)
        return written

    def to_frame(self) -> Any:
        """`to_rows` as a `pandas.DataFrame`. Raises UsageError where pandas is not installed."""
        return data_frame(self.to_rows())

    def plot(self, path: str | Path | None = None) -> DrawnFigure:
        """Draws the region. A notebook shows the result.

        Args:
            path: a file to write. Raises UsageError if it does not end in .svg, .png or .pdf.
        """
        with optional_packages():
            from tachk.report.figure_files import DrawnFigure
            from tachk.report.region.picture import STYLE, draw_region

        figure = DrawnFigure(lambda: draw_region(self.region), STYLE)
        if path is not None:
            figure.write(path)
        return figure

    def __str__(self) -> str:
        return self.to_text()

    def _repr_html_(self) -> str:
        region = self.region
        rows = [(name, words) for name, words in knowledge(region)]
        text = "".join(f"{line}\n" for line in (*_grids(region), *_result_lines(region)))
        corners = _corner_lines(region, self.time_unit, every_corner=True)
        title = f"{region.model}: {region.query.name}"
        parts = [html_table(["constant", "what is known of it"], rows, title), preformatted(text)]
        if corners:
            parts.append(folded(f"{_counted(len(region.corners), 'corner')} of the border", "\n".join(corners)))
        return "\n".join([*parts, preformatted(effort(region))])

    def __repr__(self) -> str:
        return f"<Synthesis on {self.region.model}: {summary(self.region)}>"
