"""Pictures of evaluated traces: signals on top, below them the values of subformulas, and where a formula is violated.

True, false and undetermined differ in shape, not only in colour: filled, hatched, dotted.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.textpath import TextPath
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.recordings.monitors.record import MonitorRecord, MonitorVerdict, clock_text, time_text
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.trace import Trace
from tachk.report.figure_files import svg_of, write_figure
from tachk.report.monitor.plot_rows import (
    FormulaRows,
    NamedValues,
    PlotRange,
    SignalBand,
    bands_of,
    formula_rows,
    line,
    named_values,
    steps,
    thresholds,
)
from tachk.report.monitor.robustness_plot import draw_robustness
from tachk.report.monitor.text import answer_text, robustness_text

_WIDTH = 9.0
_ROW = 0.24
_GRAPH = 0.85
_LABEL = 8
_LEFT, _RIGHT = 0.31, 0.985
_TOP, _BOTTOM = 0.55, 0.72
_TITLE, _GAP = 0.4, 0.16
_TICKS, _LABEL_GAP = 0.35, 0.17
_LONGEST_TITLE = 74
_MOST_NAMES = 6
"""Values with names beside one another in letters of the usual size."""
_LARGEST = 1e300
"""Beyond that margins and ticks are not numbers any more."""

_FACE = {Truth.TRUE: "#5a9367", Truth.FALSE: "#ffffff", Truth.UNDETERMINED: "#f1f1f1"}
_INK = {Truth.TRUE: "#3d6b48", Truth.FALSE: "#a4161a", Truth.UNDETERMINED: "#777777"}
_HATCH = {Truth.TRUE: "", Truth.FALSE: "//////", Truth.UNDETERMINED: ".."}
_SIGNAL = "#22577a"
_SHORTEST_LABEL, _LONGEST_LABEL = 8, 200
"""Characters: so many fit always, no more than so many fit ever."""

_STYLE = {"hatch.linewidth": 0.7, "axes.spines.top": False, "axes.spines.right": False}


def plot_record(
    record: MonitorRecord, path: str | Path, span: PlotRange | None = None, robustness: bool = False
) -> None:
    """Writes the picture of a record whose verdicts have their explainers.

    Args:
        path: its ending says the format.
        span: the part that is drawn; None: the whole trace.
        robustness: draw it over time, too.

    Raises UsageError for an unknown format.
    """
    write_figure(path, lambda: draw_record(record, span, robustness), _STYLE)


@dataclass(frozen=True, slots=True)
class Plot:
    """A picture that has not been written; a notebook shows it."""

    record: MonitorRecord = field(repr=False)
    span: PlotRange
    robustness: bool = False

    @property
    def svg(self) -> str:
        """The text of a file."""
        return svg_of(lambda: draw_record(self.record, self.span, self.robustness), _STYLE)

    def _repr_svg_(self) -> str:
        return self.svg


def draw_record(record: MonitorRecord, span: PlotRange | None = None, robustness: bool = False) -> Figure:
    """The picture as a matplotlib figure."""
    trace = record.trace
    span = span or PlotRange(0, max(trace.end, 1))
    groups = [(verdict, formula_rows(verdict)) for verdict in record.verdicts]
    flags = [name for name, values in trace.columns.items() if values.dtype.kind == "u"]
    numbers = [name for name in trace.columns if name not in flags]
    heights = [_GRAPH] * len(numbers)
    if flags:
        heights.append(_ROW * len(flags) + 0.1)
    signals = len(numbers) + bool(flags)
    gaps = [0.0, *[_GAP] * (signals - 1)] if signals else []
    for _, rows in groups:
        heights += [_ROW * len(rows.nodes) + 0.1, *[_GRAPH] * robustness]
        gaps += [_TITLE, *[_GAP] * robustness]
    height = sum(heights) + sum(gaps) + _TOP + _BOTTOM
    figure = Figure(figsize=(_WIDTH, height))
    FigureCanvasAgg(figure)
    axes = _axes(figure, heights, gaps, height)
    tables = axes[signals :: 1 + robustness]
    for name, axis in zip(numbers, axes, strict=False):
        _draw_numbers(axis, trace, name, span, [v for v, _ in groups])
    if flags:
        _draw_flags(axes[len(numbers)], trace, flags, span)
    for (verdict, rows), axis in zip(groups, tables, strict=True):
        _draw_formula(axis, trace, verdict, rows, span)
        _mark_violations(axis, verdict, span)
    if robustness:
        for (verdict, _), axis in zip(groups, axes[signals + 1 :: 2], strict=True):
            draw_robustness(axis, record, verdict, span)
    for axis in axes:
        axis.set_xlim(span.begin, span.end)
    _draw_time(axes, trace, span)
    figure.text(0.008, 1 - 0.1 / height, _short(trace.name, 60), va="top", fontsize=9)
    if len(groups) == 1:
        for axis in axes:
            _mark(axis, groups[0][0], span, axis is axes[0], trace)
    else:
        for (verdict, _), axis in zip(groups, tables, strict=True):
            _mark(axis, verdict, span, False, trace)
    _legend(figure, height)
    return figure


def _axes(figure: Figure, heights: Sequence[float], gaps: Sequence[float], height: float) -> list[Axes]:
    """One axis for each height, from the top down, with these gaps above them."""
    axes: list[Axes] = []
    top = height - _TOP
    for size, gap in zip(heights, gaps, strict=True):
        top -= gap
        bottom = top - size
        axis = figure.add_axes((_LEFT, bottom / height, _RIGHT - _LEFT, size / height))
        axes.append(axis)
        top = bottom
    return axes


def _draw_numbers(axis: Axes, trace: Trace, name: str, span: PlotRange, verdicts: Sequence[MonitorVerdict]) -> None:
    moves = trace.moves(name)
    times, values = (line if moves else steps)(trace, name, span.begin, span.end)
    named = named_values(trace, name, values)
    if named is not None:
        _draw_named(axis, name, times, named)
        return
    levels = thresholds(verdicts, name)
    finite = values[np.isfinite(values)]
    if max((*map(abs, levels), np.abs(finite).max(initial=0))) > _LARGEST:
        raise UsageError(
            f"`{name}` cannot be drawn: there are numbers beyond {_LARGEST:g}",
            "draw a part of the trace, with --from and --to, or divide the numbers",
        )
    values = _within_picture(values, [*levels, *([finite.min(), finite.max()] if len(finite) else [])])
    (curve,) = axis.plot(times, values, drawstyle="default" if moves else "steps-post", color=_SIGNAL, linewidth=1.2)
    curve.set_gid(f"signal-{name}")
    for level in levels:
        axis.axhline(level, color="#555555", linewidth=0.8, linestyle=(0, (1, 2)))
    axis.set_ylabel(_label(name, _TICKS), rotation=0, ha="right", va="center", fontsize=_LABEL)
    axis.margins(y=0.12)
    axis.locator_params(axis="y", nbins=3)


def _draw_named(axis: Axes, name: str, times: NDArray[np.float64], named: NamedValues) -> None:
    """A step line whose levels are values that have names, such as locations."""
    (curve,) = axis.plot(times, named.levels, drawstyle="steps-post", color=_SIGNAL, linewidth=1.2)
    curve.set_gid(f"signal-{name}")
    size = _LABEL if len(named.names) <= _MOST_NAMES else _LABEL * _MOST_NAMES / len(named.names)
    taken = 0.1 + max(_width(text, size) for text in named.names) / 72
    axis.set_yticks(range(len(named.names)), named.names, fontsize=size)
    axis.set_ylabel(_label(name, taken), rotation=0, ha="right", va="center", fontsize=_LABEL)
    axis.margins(y=0.12)


def _within_picture(values: NDArray[np.float64], finite: Sequence[float]) -> NDArray[np.float64]:
    """Values with infinite ones a little beyond the finite numbers that are drawn."""
    low, high = (min(finite), max(finite)) if finite else (0.0, 0.0)
    beyond = 0.2 * (high - low) or 1.0
    return np.clip(values, low - beyond, high + beyond)


def _draw_flags(axis: Axes, trace: Trace, names: Sequence[str], span: PlotRange) -> None:
    """One line for each truth value: high and filled where it is true."""
    for row, name in enumerate(names):
        times, values = steps(trace, name, span.begin, span.end)
        base = len(names) - 1 - row
        levels = base + 0.12 + 0.7 * values
        axis.fill_between(times, base + 0.12, levels, step="post", color=_SIGNAL, alpha=0.35, linewidth=0)
        (curve,) = axis.plot(times, levels, drawstyle="steps-post", color=_SIGNAL, linewidth=1.0)
        curve.set_gid(f"signal-{name}")
    _rows(axis, [_label(name) for name in names])


def _draw_formula(axis: Axes, trace: Trace, verdict: MonitorVerdict, rows: FormulaRows, span: PlotRange) -> None:
    axis.set_gid(f"formula-{verdict.name}")
    pixel = (span.end - span.begin) / (_WIDTH * (_RIGHT - _LEFT) * 150)
    for row, node in enumerate(rows.nodes):
        base = len(rows.nodes) - 1 - row
        for truth in Truth:
            bands = bands_of(rows.signals[row], truth, span.begin, span.end, pixel)
            name = f"band-{verdict.name}-{node}-{truth.word}"
            _draw_bands(axis, [band for band in bands if not band.widened], base, truth, name, 1)
            _draw_bands(axis, [band for band in bands if band.widened], base, truth, f"{name}-instants", 2)
    _rows(axis, [_label(text) for text in rows.texts])
    axis.get_yticklabels()[0].set_color(_title_ink(verdict))
    title = f"{verdict.name}: {answer_text(verdict)}"
    if any(math.isfinite(bound) for bound in verdict.robustness or ()):
        title += f", robustness {robustness_text(verdict.robustness)}"
    axis.set_title(title, loc="left", fontsize=9, fontweight="bold", color=_title_ink(verdict), pad=4)
    text = verdict.sentence or verdict.title
    axis.set_title(_short(text, max(_LONGEST_TITLE - len(title), 0)), loc="right", fontsize=_LABEL, pad=4)


def _title_ink(verdict: MonitorVerdict) -> str:
    return "#222222" if verdict.truth is Truth.UNDETERMINED else _INK[verdict.truth]


def _draw_bands(axis: Axes, bands: Sequence[SignalBand], base: int, truth: Truth, gid: str, level: int) -> None:
    if not bands:
        return
    low, high = base + 0.14, base + 0.86
    shapes = [[(b.begin, low), (b.begin, high), (b.end, high), (b.end, low)] for b in bands]
    collection = PolyCollection(
        shapes,
        facecolors=_FACE[truth],
        edgecolors=_INK[truth],
        linewidths=0.6 * level,
        hatch=_HATCH[truth],
        zorder=level,
    )
    collection.set_gid(gid)
    axis.add_collection(collection)


def _rows(axis: Axes, labels: Sequence[str]) -> None:
    axis.set_ylim(0, len(labels))
    axis.set_yticks([len(labels) - 0.5 - row for row in range(len(labels))], labels, fontsize=_LABEL)
    axis.tick_params(axis="y", length=0)
    axis.spines["left"].set_visible(False)


def _draw_time(axes: Sequence[Axes], trace: Trace, span: PlotRange) -> None:
    """Ticks at round numbers of the recording's clock, with labels below the last axis."""
    origin, scale = float(trace.origin), trace.ticks_per_unit
    begin, end = origin + span.begin / scale, origin + span.end / scale
    marks = [m for m in MaxNLocator(nbins=9, steps=[1, 2, 2.5, 5, 10]).tick_values(begin, end) if begin <= m <= end]
    for axis in axes:
        axis.set_xticks([(mark - origin) * scale for mark in marks], [f"{mark:.10g}" for mark in marks])
        axis.tick_params(labelbottom=axis is axes[-1], labelsize=_LABEL)
    axes[-1].set_xlabel(f"time [{trace.unit}]" if trace.unit else "time", fontsize=_LABEL)


def _mark(axis: Axes, verdict: MonitorVerdict, span: PlotRange, labelled: bool, trace: Trace) -> None:
    """Lines at the instant of the violation (or of what is pending) and at the deadline."""
    finding = verdict.finding
    if finding is None:
        return
    begin = finding.cell / 2
    deadline = None if finding.deadline is None else finding.deadline / 2
    marks: list[tuple[float, str, Any]] = [(begin, "trigger" if finding.trigger is not None else "violated", "-")]
    if verdict.measured is Truth.UNDETERMINED and finding.trigger is None:
        marks = [(begin, "pending from", "-")]
    if deadline is not None and deadline != begin:
        marks.append((deadline, "deadline", (0, (4, 2))))
        axis.axvspan(begin, min(deadline, span.end), color="#ffb703", alpha=0.16, linewidth=0, zorder=0)
    width = span.end - span.begin
    taken: list[tuple[float, float]] = []
    for place, word, style in marks:
        if not span.begin <= place <= span.end:
            continue
        mark = axis.axvline(place, color="#000000", linewidth=1.1, linestyle=style, zorder=5)
        mark.set_gid(f"{word.split()[0]}-{verdict.name}")
        if labelled:
            text = f"{word} {_readable_time(trace, int(place), span)}"
            room = _width(text, _LABEL) / 72 / (_WIDTH * (_RIGHT - _LEFT)) * width * 1.05
            right = (place, place + room)
            crossed = any(place < other < right[1] for other, _, _ in marks) and place - room >= span.begin
            overlaps = any(begin < right[1] and right[0] < end for begin, end in taken)
            leftwards = crossed or overlaps or right[1] > span.end
            begin, end = (place - room, place) if leftwards else right
            level = sum(begin < other_end and other_begin < end for other_begin, other_end in taken)
            taken.append((begin, end))
            axis.annotate(
                text,
                (place, 1.0),
                xycoords=("data", "axes fraction"),
                xytext=(-2 if leftwards else 2, 4 + 10 * level),
                textcoords="offset points",
                ha="right" if leftwards else "left",
                fontsize=_LABEL,
            )


def _readable_time(trace: Trace, tick: int, span: PlotRange) -> str:
    """The time on the clock of the recording, to a thousandth of the picture: more digits tell a reader nothing."""
    scale = trace.ticks_per_unit
    shown = max((span.end - span.begin) / scale, 1e-9)
    decimals = max(0, 3 - math.floor(math.log10(shown)))
    if trace.dated:
        return clock_text(trace, tick)
    return time_text(round(trace.clock(tick), decimals), trace.unit, trace.dated)


def _width(text: str, size: float) -> float:
    """The width of a text in points."""
    return float(TextPath((0, 0), text, size=size).get_extents().width) if text else 0.0


def _mark_violations(axis: Axes, verdict: MonitorVerdict, span: PlotRange) -> None:
    """A small triangle above each violation."""
    if verdict.measured is not Truth.FALSE:
        return
    places = verdict.violations.first_cells / 2
    shown = places[(places >= span.begin) & (places <= span.end)]
    height = axis.get_ylim()[1]
    (marks,) = axis.plot(
        shown, [height] * len(shown), "v", color=_INK[Truth.FALSE], markersize=3.5, clip_on=False, zorder=6
    )
    marks.set_gid(f"violations-{verdict.name}")


def _legend(figure: Figure, height: float) -> None:
    patches = [
        Patch(facecolor=_FACE[truth], edgecolor=_INK[truth], hatch=_HATCH[truth], label=truth.word) for truth in Truth
    ]
    figure.legend(
        handles=[patches[1], patches[0], patches[2]],
        loc="lower left",
        bbox_to_anchor=(_LEFT - 0.005, 0.0),
        ncols=3,
        frameon=False,
        fontsize=_LABEL,
        handlelength=2.4,
        handleheight=1.1,
    )


def _label(text: str, taken: float = 0.0) -> str:
    """The text as far as it fits to the left of an axis; of a long one the middle is left out.

    Args:
        taken: how many inches there are not for it.
    """
    room = (_WIDTH * _LEFT - taken - _LABEL_GAP) * 72

    def fits(shown: str) -> bool:
        return _width(shown, _LABEL) <= room

    def shortened(letters: int) -> str:
        return f"{text[: letters // 2]}…{text[len(text) - (letters - letters // 2) :]}"

    if len(text) <= _SHORTEST_LABEL or (len(text) <= _LONGEST_LABEL and fits(text)):
        return text
    # Each length keeps the characters of the one below it and one more.
    lengths = range(_SHORTEST_LABEL + 1, min(len(text), _LONGEST_LABEL))
    letters = bisect_left(lengths, True, key=lambda length: not fits(shortened(length))) + _SHORTEST_LABEL
    return shortened(letters)


def _short(text: str, most: int) -> str:
    return text if len(text) <= most else text[: max(most - 1, 0)] + "…" if most > 8 else ""
