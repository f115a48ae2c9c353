"""The values of formulas at every instant of a trace: truth and robustness, as arrays and as CSV."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import reduce
from typing import Any, TextIO

import numpy as np
from numpy.typing import NDArray

from tachk.recordings.monitors.record import MonitorRecord, MonitorVerdict
from tachk.recordings.traces.conventions import Interpolation
from tachk.recordings.traces.core_monitor import robustness_signals
from tachk.recordings.traces.monitor_program import MonitorProgram, NodeKind
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.trace import Trace
from tachk.report.monitor.json import exact


@dataclass(frozen=True, slots=True, eq=False)
class FormulaSignal:
    """The values of a formula over time, in pieces. A piece goes on until the next one, the last one until the end.

    Attributes:
        formula: of ``G f`` it is f, which says more than ``G f`` does.
        times: at which the pieces begin, in units of the trace.
        after: whether a piece begins just after its time, so that the instant itself belongs to the piece before.
        truth: values of `tachk.Truth`.
        low, high: bounds of the robustness, equal where the trace decides it; None where numbers lie on lines.
        cells: in which the pieces begin (docs/logic.md), for exact times.
    """

    formula: str
    times: NDArray[np.float64]
    after: NDArray[np.bool_]
    truth: NDArray[np.uint8]
    low: NDArray[np.float64] | None
    high: NDArray[np.float64] | None
    cells: NDArray[np.int64] = field(repr=False)

    def to_dict(self) -> dict[str, NDArray[Any]]:
        """The columns of a data frame: ``pandas.DataFrame(signal.to_dict())``."""
        columns: dict[str, NDArray[Any]] = {"time": self.times, "after": self.after, "truth": self.truth}
        if self.low is not None and self.high is not None:
            columns |= {"low": self.low, "high": self.high}
        return columns

    def on(self, cells: NDArray[np.int64]) -> FormulaSignal:
        """The same in pieces that begin in these cells, among which are all in which its own begin."""
        place = np.searchsorted(self.cells, cells, side="right") - 1
        low, high = (None if bound is None else bound[place] for bound in (self.low, self.high))
        unused = np.zeros(0)
        return FormulaSignal(self.formula, unused, cells % 2 == 1, self.truth[place], low, high, cells)


def signal_of(record: MonitorRecord, verdict: MonitorVerdict) -> FormulaSignal:
    """The values of the formula of a verdict over time; of ``G f`` those of f."""
    trace, program = record.trace, verdict.program
    node = operand_of_always(program)
    truth = verdict.explainer.signal(node)
    if trace.interpolation is Interpolation.LINEAR:
        return _signal(trace, program.nodes[node].text, truth.starts, truth.values, None, None)
    (margin,) = robustness_signals(program, trace, [node])
    cells = np.union1d(truth.starts, margin.starts)
    values = truth.values[np.searchsorted(truth.starts, cells, side="right") - 1]
    place = np.searchsorted(margin.starts, cells, side="right") - 1
    low, high = margin.low[place] + 0.0, margin.high[place] + 0.0
    return _signal(trace, program.nodes[node].text, cells, values, low, high)


def _signal(
    trace: Trace,
    formula: str,
    cells: NDArray[np.int64],
    truth: NDArray[np.uint8],
    low: NDArray[np.float64] | None,
    high: NDArray[np.float64] | None,
) -> FormulaSignal:
    """Neighbouring pieces of the same value become one."""
    changed = np.ones(len(cells), dtype=bool)
    changed[1:] = truth[1:] != truth[:-1]
    for bound in (low, high):
        if bound is not None:
            changed[1:] |= bound[1:] != bound[:-1]
    cells = cells[changed]
    times = float(trace.origin) + (cells // 2) / trace.ticks_per_unit
    low, high = (None if bound is None else bound[changed] for bound in (low, high))
    return FormulaSignal(formula, times, cells % 2 == 1, truth[changed], low, high, cells)


def operand_of_always(program: MonitorProgram) -> int:
    """The node f of ``G f``, or of ``G G f``; else that of the whole."""
    node = len(program.nodes) - 1
    while program.nodes[node].kind is NodeKind.ALWAYS:
        node = program.nodes[node].operands[0]
    return node


def write_signals(record: MonitorRecord, out: TextIO) -> None:
    """All formulas of a record in one table: a row where the truth or the robustness of one of them changes."""
    signals = [signal_of(record, verdict) for verdict in record.verdicts]
    cells = reduce(np.union1d, [signal.cells for signal in signals])
    unit = f" [{record.trace.unit}]" if record.trace.unit else ""
    names = [f"time{unit}", "after"]
    columns: list[Sequence[object]] = []
    for verdict, signal in zip(record.verdicts, signals, strict=True):
        there = signal.on(cells)
        names.append(verdict.name)
        columns.append([Truth(value).word for value in there.truth.tolist()])
        if there.low is not None and there.high is not None:
            names += [f"{verdict.name}.low", f"{verdict.name}.high"]
            columns += [there.low.tolist(), there.high.tolist()]
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(names)
    trace = record.trace
    for row, cell in enumerate(cells.tolist()):
        after = "true" if cell % 2 else "false"
        writer.writerow([exact(trace, cell - cell % 2), after, *(column[row] for column in columns)])
