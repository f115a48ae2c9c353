"""Pictures of answers to statistical queries: when goals are reached, what values go through, how means are spread.

Of a probability: how many runs reach the goal when, and the share that has reached it up to a time, with what was
estimated at its right end. Of a mean: how often each value is the largest or least of a run.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import assert_never

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.report.figure_files import write_figure
from tachk.report.statistics.text import interval_text
from tachk.simulation.statistics.estimate import Decided, DrawnRuns, Estimate, Estimated, Mean, Split
from tachk.simulation.statistics.sampling import SampledRuns

_WIDTH, _ROW = 9.0, 2.5
_TOP, _BETWEEN, _BOTTOM = 0.45, 0.95, 0.6
_LINES = ("#22577a", "#a4161a", "#5a9367", "#b07d2b", "#6a4c93", "#555555")
_STYLES = ("-", "--", ":", "-.")
_FILL, _INK = "#9db9c9", "#22577a"
_LONGEST = 92
_MOST_LINES = 40
_MOST_ANSWERS = 12
_STYLE = {"axes.spines.top": False, "axes.spines.right": False, "font.size": 8}


def plot_estimates(found: Sequence[Estimate], time_unit: str, path: str | Path) -> None:
    """Writes a picture with a row for each answer.

    Raises UsageError for an unknown format, and for more answers than a picture can show.
    """
    if not 0 < len(found) <= _MOST_ANSWERS:
        raise UsageError(f"a picture shows 1 to {_MOST_ANSWERS} answers, not {len(found)}", "ask fewer queries")
    write_figure(path, lambda: draw_estimates(found, time_unit), _STYLE)


def draw_estimates(found: Sequence[Estimate], time_unit: str) -> Figure:
    height = _TOP + len(found) * _ROW + (len(found) - 1) * _BETWEEN + _BOTTOM
    figure = Figure(figsize=(_WIDTH, height))
    FigureCanvasAgg(figure)
    for number, each in enumerate(found):
        top = height - _TOP - number * (_ROW + _BETWEEN)
        text = " ".join(each.query.text.split())
        title = text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."
        figure.text(0.06, (top + 0.22) / height, f"{each.query.name}: {title}", weight="bold", va="bottom")
        whole = (0.08, (top - _ROW) / height, 0.89, _ROW / height)
        halves = tuple((left, whole[1], 0.405, whole[3]) for left in (0.08, 0.565))
        time = f"time ({time_unit.removeprefix('1 ')})" if time_unit else "time"
        match each:
            case Estimated():
                axes = figure.add_axes(halves[0]), figure.add_axes(halves[1])
                _moments(axes, each.sample, each, time)
            case Decided():
                axes = figure.add_axes(halves[0]), figure.add_axes(halves[1])
                for sample, colour in zip(each.samples, _LINES, strict=False):
                    _reached(axes[1], sample, colour, time)
                _histogram(axes[0], each.samples[0].all_times, time, "runs")
            case Mean():
                _values(figure.add_axes(whole), each)
            case Split():
                axis = figure.add_axes(whole)
                _histogram(axis, each.rare.probabilities, "estimate", "replications")
                axis.axvspan(each.low, each.high, color=_LINES[1], alpha=0.12, linewidth=0)
                axis.set_title(
                    f"{each.rare.mean:.3g}, {interval_text(each.low, each.high)}", color=_LINES[1], loc="right"
                )
            case DrawnRuns():
                _trajectories(figure.add_axes(whole), each, time)
            case never:
                assert_never(never)
    return figure


def _moments(axes: tuple[Axes, Axes], sample: SampledRuns, found: Estimated, time: str) -> None:
    _histogram(axes[0], sample.all_times, time, "runs that violate it" if found.always else "runs that reach it")
    _reached(axes[1], sample, _INK, time)
    low, high = (1 - found.high, 1 - found.low) if found.always else (found.low, found.high)
    end = axes[1].get_xlim()[1]
    axes[1].errorbar([end], [(low + high) / 2], [(high - low) / 2], color=_LINES[1], capsize=4, clip_on=False)
    axes[1].annotate(
        interval_text(low, high), (end, high), (-4, 3), textcoords="offset points", ha="right", color=_LINES[1]
    )


def _histogram(axes: Axes, values: NDArray[np.float64], label: str, what: str) -> None:
    axes.set_xlabel(label)
    axes.set_ylabel(what)
    if not len(values):
        axes.text(0.5, 0.5, "none", transform=axes.transAxes, ha="center")
        axes.set_yticks([])
        return
    distinct = np.unique(values)
    if len(distinct) <= 25:
        counts = [int((values == value).sum()) for value in distinct]
        width = 0.8 * float(np.diff(distinct).min()) if len(distinct) > 1 else 0.8
        axes.bar(distinct, counts, width, color=_FILL, edgecolor=_INK)
    else:
        axes.hist(values, bins=min(40, max(8, round(len(values) ** 0.5))), color=_FILL, edgecolor=_INK, linewidth=0.6)
    axes.yaxis.set_major_locator(MaxNLocator(integer=True))


def _reached(axes: Axes, sample: SampledRuns, colour: str, time: str) -> None:
    times = np.sort(sample.all_times)
    shares = np.arange(len(times) + 1) / sample.runs
    end = float(times[-1]) * 1.05 if len(times) and times[-1] > 0 else 1.0
    axes.step(np.concatenate(([0.0], times, [end])), np.append(shares, shares[-1]), where="post", color=colour)
    axes.set_xlim(0, max(end, axes.get_xlim()[1] if axes.has_data() and axes.get_xlim()[1] > end else end))
    axes.set_ylim(0, 1)
    axes.set_xlabel(time)
    axes.set_ylabel("share of all runs, so far")


def _values(axes: Axes, found: Mean) -> None:
    values = found.sample.all_values
    _histogram(axes, values[~np.isnan(values)], "value", "runs")
    axes.axvline(found.mean, color=_LINES[1], linewidth=1)
    low, high = found.asymptotic
    if found.low is not None and found.high is not None:
        axes.axvspan(found.low, found.high, color=_LINES[1], alpha=0.12, linewidth=0)
        low, high = found.low, found.high
    axes.set_title(f"mean {found.mean:.5g}, {interval_text(low, high)}", fontsize=8, color=_LINES[1], loc="right")


def _trajectories(axes: Axes, found: DrawnRuns, time: str) -> None:
    names: dict[str, int] = {}
    for run in found.runs[:_MOST_LINES]:
        for line in run.lines:
            number = names.setdefault(line.name, len(names))
            axes.plot(
                line.times,
                line.values,
                color=_LINES[number % len(_LINES)],
                linestyle=_STYLES[number % len(_STYLES)],
                linewidth=1,
                alpha=1.0 if len(found.runs) == 1 else 0.55,
                label=line.name if run is found.runs[0] else None,
            )
    axes.set_xlabel(time)
    axes.set_xlim(left=0)
    axes.legend(loc="lower right", bbox_to_anchor=(1, 1), ncols=4, frameon=False)
