"""A region for people: grids of letters, inequalities, corners with their evidence."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

from tachk.report.region.words import assignment, effort, evidence, inequalities, knowledge, summary
from tachk.verify.synthesis.region import Region, RegionCell
from tachk.verify.verdict import Answer

_LETTERS = {Answer.HOLDS: "#", Answer.FAILS: ".", Answer.UNKNOWN: "?"}
_MOST_GRIDS = 12
_MOST_CORNERS = 12


def region_text(region: Region, time_unit: str, every_corner: bool = False) -> str:
    """What `tachk synthesize` prints."""
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
    yield f"{summary(region)}."
    yield from _description(region)
    yield from _unknown(region)
    corners = region.corners
    if corners:
        yield ""
        yield "Corners of the border:"
        shown = corners if every_corner else corners[:_MOST_CORNERS]
        values = [assignment(region, cell) for cell in shown]
        width = max(map(len, values))
        for cell, text in zip(shown, values, strict=True):
            yield f"  {text:<{width}}  {cell.answer.value}: {evidence(region, cell, time_unit)}"
        if len(shown) < len(corners):
            yield f"  and {len(corners) - len(shown)} more: --all-corners"
    yield ""
    yield f"{effort(region)}"


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
