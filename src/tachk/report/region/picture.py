"""A region as a picture: a square for each cell, one map for each combination of the parameters after the second.

The answers differ in shape, not only in colour: filled, hatched, dotted. Cells that were decided themselves have a
mark; what is without is implied by them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product
from textwrap import wrap
from typing import Any

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PatchCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.report.answer_marks import evenly_labelled, legend_of, mark_of
from tachk.report.region.words import effort, inequalities, summary
from tachk.verify.synthesis.parameters import VariedConstant
from tachk.verify.synthesis.region import CellEvidence, Region, RegionCell
from tachk.verify.verdict import Answer

_MOST_MAPS = 12
_BORDER = "#22223b"
STYLE = {"hatch.linewidth": 0.5}
_LINE = 0.19


def draw_region(region: Region) -> Figure:
    """The picture as a matplotlib figure."""
    further = region.parameters[2:]
    maps = list(product(*(parameter.values for parameter in further)))
    if len(maps) > _MOST_MAPS:
        raise UsageError(
            f"a picture of {len(maps)} maps would show nothing",
            f"give {' or '.join(p.name for p in further)} fewer values; --format csv has all cells",
        )
    columns = min(len(maps), 3)
    rows = math.ceil(len(maps) / columns)
    size = 5.2 if columns == 1 else 3.1
    tall = size if len(region.parameters) > 1 else 0.5
    width = max(columns * size + 1.0, 6.4)
    heading = _heading(region, round(width * 13))
    top, bottom = _LINE * len(heading) + 0.35, 0.95
    gap = 0.75
    height = rows * tall + (rows - 1) * gap + top + bottom
    figure = Figure(figsize=(width, height))
    FigureCanvasAgg(figure)
    corners = {cell.values for cell in region.corners}
    for number, fixed in enumerate(maps):
        row, column = divmod(number, columns)
        left = 0.75 + column * ((width - 0.9) / columns)
        base = height - top - (row + 1) * tall - row * gap
        own = (width - 0.9) / columns - 0.45
        axes = figure.add_axes((left / width, base / height, own / width, tall / height))
        _draw_map(axes, region, fixed, corners)
        if further:
            axes.set_title(", ".join(f"{p.name} = {v}" for p, v in zip(further, fixed, strict=True)), fontsize=9)
    for number, line in enumerate(heading):
        weight = "bold" if number == 0 else "normal"
        figure.text(0.12 / width, 1 - (0.1 + _LINE * number) / height, line, va="top", weight=weight)
    _legend(figure, region)
    return figure


def _heading(region: Region, columns: int) -> list[str]:
    title = f"{region.query.name}: {region.query.title}" if region.query.title else region.query.name
    constants = ", ".join(f"{name} = {value}" for name, value in region.constants)
    words = inequalities(region)
    lines = [*wrap(title, columns)[:2], *wrap(summary(region) + (f": {words}" if words else ""), columns)]
    return [*lines, *wrap(f"{region.model}; {constants}" if constants else region.model, columns)[:2], effort(region)]


def _draw_map(axes: Axes, region: Region, fixed: Sequence[int], corners: set[tuple[int, ...]]) -> None:
    across, *rest = region.parameters[:2]
    up = rest[0] if rest else None
    cells = [cell for cell in region.cells if cell.values[2:] == tuple(fixed)]
    for answer in Answer:
        squares = [_square(region, cell) for cell in cells if cell.answer is answer]
        axes.add_collection(PatchCollection(squares, **mark_of(answer), linewidth=0.25))
    places = {cell.values: _place(region, cell) for cell in cells}
    decided = [
        c.values for c in cells if c.evidence in (CellEvidence.SEARCH, CellEvidence.RUN, CellEvidence.CERTIFICATE)
    ]
    dot = max(1.0, min(4.5, 170 / max(region.shape[:2])))
    axes.plot(*_points(places[v] for v in decided), ".", color=_BORDER, markersize=dot, linestyle="")
    marked = [values for values in decided if values in corners]
    axes.plot(
        *_points(places[v] for v in marked),
        "o",
        markerfacecolor="none",
        markeredgecolor=_BORDER,
        markersize=dot * 1.8,
        markeredgewidth=0.8,
        linestyle="",
    )
    _border(axes, region, cells)
    _scale(axes, across, up)


def _points(places: Any) -> tuple[list[int], list[int]]:
    found = list(places)
    return [x for x, _ in found], [y for _, y in found]


def _place(region: Region, cell: RegionCell) -> tuple[int, int]:
    """The numbers of the values of a cell across and up."""
    numbers = [p.values.index(value) for p, value in zip(region.parameters[:2], cell.values, strict=False)]
    return numbers[0], numbers[1] if len(numbers) > 1 else 0


def _square(region: Region, cell: RegionCell) -> Rectangle:
    x, y = _place(region, cell)
    return Rectangle((x - 0.5, y - 0.5), 1, 1)


def _border(axes: Axes, region: Region, cells: Sequence[RegionCell]) -> None:
    """A line between the wanted answer and the others."""
    wanted = {_place(region, cell) for cell in cells if cell.answer is region.wanted}
    every = {_place(region, cell) for cell in cells}
    for x, y in wanted:
        if (x + 1, y) in every - wanted:
            axes.plot([x + 0.5, x + 0.5], [y - 0.5, y + 0.5], color=_BORDER, linewidth=1.6)
        if (x - 1, y) in every - wanted:
            axes.plot([x - 0.5, x - 0.5], [y - 0.5, y + 0.5], color=_BORDER, linewidth=1.6)
        if (x, y + 1) in every - wanted:
            axes.plot([x - 0.5, x + 0.5], [y + 0.5, y + 0.5], color=_BORDER, linewidth=1.6)
        if (x, y - 1) in every - wanted:
            axes.plot([x - 0.5, x + 0.5], [y - 0.5, y - 0.5], color=_BORDER, linewidth=1.6)


def _scale(axes: Axes, across: VariedConstant, up: VariedConstant | None) -> None:
    axes.set_xlim(-0.5, len(across.values) - 0.5)
    axes.set_xlabel(across.name)
    numbers = evenly_labelled(len(across.values))
    axes.set_xticks(numbers, [str(across.values[number]) for number in numbers])
    if up is None:
        axes.set_ylim(-0.5, 0.5)
        axes.set_yticks([])
        return
    axes.set_ylim(-0.5, len(up.values) - 0.5)
    axes.set_ylabel(up.name)
    numbers = evenly_labelled(len(up.values))
    axes.set_yticks(numbers, [str(up.values[number]) for number in numbers])


def _legend(figure: Figure, region: Region) -> None:
    present = {cell.answer for cell in region.cells}
    handles = legend_of(answer for answer in Answer if answer in present)
    handles.append(Line2D([], [], marker=".", color=_BORDER, linestyle="", label="decided itself"))
    handles.append(
        Line2D([], [], marker="o", markerfacecolor="none", color=_BORDER, linestyle="", label="corner, with evidence")
    )
    figure.legend(handles=handles, loc="lower center", ncols=len(handles), frameon=False, fontsize=8)
