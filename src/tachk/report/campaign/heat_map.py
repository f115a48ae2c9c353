"""A campaign as heat maps: one for each property and each combination of the constants after the second.

Answers differ in shape, not only in colour; of numbers each cell says its own where there is room.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product

from matplotlib import colormaps
from matplotlib.axes import Axes as Plane
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.model.grid import Grid, ParameterAxis
from tachk.report.answer_marks import evenly_labelled, legend_of, mark_of
from tachk.verify.campaign.job import COLUMNS, ESTIMATED, Row
from tachk.verify.verdict import Answer

STYLE = {"hatch.linewidth": 0.5}
_NUMBERS = tuple(name for name, kind in COLUMNS.items() if kind != "TEXT")
_MOST_MAPS = 24
_COLUMNS = 3
_MAP = 2.6
_GAP = 0.95
_HEAD, _FOOT = 0.7, -0.1
_MOST_LABELLED = 12
_WIDE_RANGE = 100
"""From this proportion of the largest to the least on, the scale is logarithmic."""


@dataclass(frozen=True, slots=True)
class _Map:
    title: str
    rows: Mapping[tuple[int, int], Row]


def draw_maps(model: str, grid: Grid, rows: Sequence[Row], show: str) -> Figure:
    """The maps of all properties.

    Args:
        rows: of finished cells.
        show: ``answer``, or a column of numbers.

    Raises UsageError for another column, and for more maps than a picture can show.
    """
    if show not in ("answer", *_NUMBERS):
        raise UsageError(f"there is no column {show!r} to draw", f"one of answer, {', '.join(_NUMBERS)}")
    across, up, maps = _maps(grid, rows)
    if len(maps) > _MOST_MAPS:
        raise UsageError(
            f"a picture of {len(maps)} maps would show nothing", "name one --property, or give constants fewer values"
        )
    columns = min(len(maps), _COLUMNS)
    lines = math.ceil(len(maps) / columns)
    tall = _MAP if len(up.values) > 1 else 0.4
    width, height = columns * (_MAP + _GAP) + 0.2, lines * (tall + _GAP) + _HEAD + _FOOT
    figure = Figure(figsize=(max(width, 5.0), height))
    FigureCanvasAgg(figure)
    figure.text(0.1 / figure.get_figwidth(), 1 - 0.12 / height, f"{model}: {show}", va="top", weight="bold")
    colours = _Colours(show, rows)
    for number, each in enumerate(maps):
        line, column = divmod(number, columns)
        left = _GAP * 0.75 + column * (_MAP + _GAP)
        base = height - _HEAD - (line + 1) * tall - line * _GAP
        plane = figure.add_axes(
            (left / figure.get_figwidth(), base / height, _MAP / figure.get_figwidth(), tall / height)
        )
        _draw(plane, each, across, up, colours)
    colours.explain(figure)
    return figure


def _maps(grid: Grid, rows: Sequence[Row]) -> tuple[ParameterAxis, ParameterAxis, list[_Map]]:
    """The horizontal and the vertical axis, and the maps."""
    varied = sorted(grid.varied or grid.axes[:1], key=lambda axis: -len(axis.values))
    across = varied[0] if varied else ParameterAxis("", ("",))
    up = varied[1] if len(varied) > 1 else ParameterAxis("", ("",))
    further = varied[2:]
    maps = []
    settings = product(*([(axis.name, value) for value in axis.values] for axis in further))
    for name, fixed in product(dict.fromkeys(str(row["property"]) for row in rows), settings):
        own = [r for r in rows if r["property"] == name and all(r[n] == v for n, v in fixed)]
        title = ", ".join([name, *(f"{constant} = {value}" for constant, value in fixed)])
        maps.append(_Map(title, {(_number(across, row), _number(up, row)): row for row in own}))
    return across, up, maps


def _number(axis: ParameterAxis, row: Row) -> int:
    """The number of the row's value along an axis; 0 along an axis for no parameter."""
    return [*axis.values].index(row[axis.name]) if axis.name else 0  # type: ignore[arg-type]


class _Colours:
    """The colours of values."""

    def __init__(self, show: str, rows: Sequence[Row]) -> None:
        self._show = show
        self._answers = [answer for answer in Answer if any(row["answer"] == answer.value for row in rows)]
        numbers = [] if show == "answer" else [float(row[show] or 0) for row in rows if row[show] is not None]
        least, largest = min(numbers, default=0.0), max(numbers, default=1.0)
        wide = least > 0 and largest / least >= _WIDE_RANGE
        self._norm = LogNorm(least, largest) if wide else Normalize(least, max(largest, least + 1e-9))
        self._map = colormaps["cividis"]

    def square(self, place: tuple[int, int], row: Row) -> Rectangle:
        corner = (place[0] - 0.5, place[1] - 0.5)
        if self._show == "answer" and row["answer"] != ESTIMATED:
            answer = Answer(str(row["answer"]))
            return Rectangle(corner, 1, 1, **mark_of(answer), linewidth=0.4)
        value = None if self._show == "answer" else row[self._show]
        if value is None:
            return Rectangle(corner, 1, 1, facecolor="#ffffff", edgecolor="#bbbbbb", hatch="...", linewidth=0.4)
        return Rectangle(
            corner, 1, 1, facecolor=self._map(self._norm(float(value))), edgecolor="#ffffff", linewidth=0.4
        )

    def label(self, row: Row) -> tuple[str, str]:
        """The text of a cell, and its colour."""
        value = row.get(self._show)
        if self._show == "answer" or value is None:
            return "", "#000000"
        dark = float(self._norm(float(value))) < 0.5
        return short(float(value)), "#ffffff" if dark else "#000000"

    def explain(self, figure: Figure) -> None:
        if self._show != "answer":
            figure.text(0.5, 0.02, _LEGENDS.get(self._show, self._show), ha="center", va="bottom", fontsize=8)
            return
        handles = legend_of(self._answers)
        figure.legend(handles=handles, loc="lower center", ncols=len(handles), frameon=False, fontsize=8)


_LEGENDS = {
    "seconds": "seconds of the search",
    "estimate": "estimated probability or mean; dotted: there is none",
    "low": "lower end of the interval of a probability or mean; dotted: there is none",
    "high": "upper end of the interval of a probability or mean; dotted: there is none",
    "run_end": "end of the run behind the answer, in time units of the model; dotted: there is none",
    "run_steps": "steps of the run behind the answer; dotted: there is none",
    "peak_bytes": "bytes of the search",
}


def short(value: float) -> str:
    """A number of at most five characters, rounded: ``0.12``, ``81.9k``."""
    for factor, unit in ((1e9, "G"), (1e6, "M"), (1e3, "k")):
        if abs(value) >= factor:
            return f"{value / factor:.3g}{unit}"
    return f"{value:.3g}"


def _draw(plane: Plane, map_: _Map, across: ParameterAxis, up: ParameterAxis, colours: _Colours) -> None:
    plane.set_title(map_.title, fontsize=9, loc="left")
    labelled = max(len(across.values), len(up.values)) <= _MOST_LABELLED
    for place, row in map_.rows.items():
        plane.add_patch(colours.square(place, row))
        text, ink = colours.label(row)
        if labelled and text:
            size = min(8.0, 58 / len(across.values))
            plane.text(*place, text, ha="center", va="center", fontsize=size, color=ink)
    plane.set_xlim(-0.5, len(across.values) - 0.5)
    plane.set_ylim(-0.5, len(up.values) - 0.5)
    plane.set_xlabel(across.name, labelpad=1)
    plane.set_ylabel(up.name)
    numbers = evenly_labelled(len(across.values))
    plane.set_xticks(numbers, [str(across.values[n]) for n in numbers], fontsize=8)
    numbers = evenly_labelled(len(up.values)) if up.name else []
    plane.set_yticks(numbers, [str(up.values[n]) for n in numbers], fontsize=8)
