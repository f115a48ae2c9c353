"""The robustness of a formula over time, as a part of a picture."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from tachk.recordings.monitors.record import MonitorRecord, MonitorVerdict
from tachk.report.monitor.formula_signals import signal_of
from tachk.report.monitor.plot_rows import PlotRange

_INK = "#22577a"
_LABEL = 8
_LARGEST = 1e300


def draw_robustness(axis: Axes, record: MonitorRecord, verdict: MonitorVerdict, span: PlotRange) -> None:
    """A line where the trace decides it, a band between its bounds where not. What is infinite has no line."""
    signal = signal_of(record, verdict)
    axis.set_gid(f"robustness-{verdict.name}")
    axis.set_ylabel("robustness", rotation=0, ha="right", va="center", fontsize=_LABEL)
    axis.axhline(0, color="#555555", linewidth=0.8, linestyle=(0, (1, 2)))
    if signal.low is None or signal.high is None:
        axis.text(0.5, 0.5, "not defined at each instant of lines", transform=axis.transAxes, ha="center", fontsize=8)
        return
    places = np.append((signal.cells + 1) // 2, record.trace.end).astype(np.float64)
    low, high = (np.append(bound, bound[-1]) for bound in (signal.low, signal.high))
    finite = [bound[np.isfinite(bound) & (abs(bound) < _LARGEST)] for bound in (low, high)]
    known = np.concatenate(finite)
    if not len(known):
        axis.set_yticks([])
        axis.text(
            0.5, 0.5, "infinite: no number is compared", transform=axis.transAxes, ha="center", va="bottom", fontsize=8
        )
        return
    bottom, top = float(known.min()), float(known.max())
    margin = 0.12 * (top - bottom) or 1.0
    axis.set_ylim(min(bottom, 0) - margin, max(top, 0) + margin)
    shown = [np.clip(bound, bottom - 2 * margin, top + 2 * margin) for bound in (low, high)]
    axis.fill_between(places, shown[0], shown[1], step="post", color=_INK, alpha=0.2, linewidth=0)
    for bound, clipped in zip((low, high), shown, strict=True):
        line = np.where(np.isfinite(bound), clipped, np.nan)
        axis.plot(places, line, drawstyle="steps-post", color=_INK, linewidth=1.0)
    axis.locator_params(axis="y", nbins=3)
