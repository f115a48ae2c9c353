"""Monitors on traces that are longer than every block and buffer of the core.

The oracle is too slow for them, but the value of a formula with bounded windows at an instant depends only on the trace
around it, so it is asked about pieces of the trace.
"""

from __future__ import annotations

from fractions import Fraction
from random import Random

import numpy as np
import pytest

from tachk.recordings.traces.core_monitor import (
    RobustnessMonitor,
    TruthMonitor,
    monitor_robustness,
    monitor_truth,
    robustness_signals,
    truth_signals,
)
from tachk.recordings.traces.online_monitor import OnlineMonitor
from tachk.recordings.traces.verdict_explanation import horizon, memory
from tachk.syntax.formulas.printer import print_formula
from tests.support.exact_monitor import value_at
from tests.support.exact_trace import ExactTrace
from tests.support.formulas import FormulaShape, MonitoringCase, random_formula, random_trace
from tests.support.monitor_input import MonitorInput, always, monitor_input, portions, truth_of
from tests.support.seeds import seeds

pytestmark = pytest.mark.drawn

ROWS = 9000
BOUNDED = FormulaShape(depth=3, bound=6, unbounded=False, rows=ROWS, gap=2)
UNBOUNDED = FormulaShape(depth=3, bound=6, rows=ROWS, gap=2)


def long_case(seed: int, shape: FormulaShape) -> MonitoringCase:
    random = Random(seed)
    formula = random_formula(random, shape, shape.depth)
    trace = random_trace(random, shape)
    while len(trace.times) < ROWS // 2:
        trace = random_trace(random, shape)
    return MonitoringCase(formula, trace)


def piece(trace: ExactTrace, first: Fraction, last: Fraction) -> tuple[ExactTrace, Fraction]:
    """The rows that matter between two instants as a trace of their own, and the instant at which it begins."""
    times = np.array([float(time) for time in trace.times])
    begin = max(int(np.searchsorted(times, float(first), side="left")) - 1, 0)
    end = int(np.searchsorted(times, float(last), side="right"))
    start = trace.times[begin]
    rows = range(begin, end)
    columns = {name: tuple(values[row] for row in rows) for name, values in trace.columns.items()}
    shifted = tuple(trace.times[row] - start for row in rows)
    return ExactTrace(shifted, columns, max(min(last, trace.end) - start, shifted[-1])), start


@pytest.mark.parametrize("seed", seeds(range(8)))
def test_signals_agree_with_the_definitions_anywhere(seed: int) -> None:
    case = long_case(seed, BOUNDED)
    given, random = monitor_input(case), Random(seed)
    ticks = given.trace.ticks_per_unit
    ahead, behind = (Fraction(reach(given.program), ticks) + 1 for reach in (horizon, memory))
    root = len(given.program.nodes) - 1
    (truth,) = truth_signals(given.program, given.trace, [root])
    (margin,) = robustness_signals(given.program, given.trace, [root])
    for _ in range(8):
        cell = random.randint(0, 2 * given.trace.end)
        instant = given.instant(cell)
        around, start = piece(case.trace, instant - behind, instant + ahead)
        value = value_at(case.formula, around, instant - start)
        number = int(np.searchsorted(margin.starts, cell, side="right")) - 1
        found = truth.at(cell), float(margin.low[number]), float(margin.high[number])
        assert found == (truth_of(value), float(value.low), float(value.high)), (print_formula(case.formula), cell)


def online(given: MonitorInput, seed: int) -> OnlineMonitor:
    monitor = OnlineMonitor(given.program)
    for times, columns in portions(given, Random(seed)):
        monitor.push(times, columns)
    monitor.finish(given.trace.end)
    return monitor


@pytest.mark.parametrize("seed", seeds(range(8)))
def test_portions_do_not_matter_and_online_is_offline(seed: int) -> None:
    case = long_case(100 + seed, UNBOUNDED)
    given = monitor_input(MonitoringCase(always(case.formula), case.trace) if seed % 2 else case)
    truth, margin = monitor_truth(given.program, given.trace), monitor_robustness(given.program, given.trace)
    truths, margins = TruthMonitor(given.program), RobustnessMonitor(given.program)
    for times, columns in portions(given, Random(seed)):
        truths.push(times, columns)
        margins.push(times, columns)
    assert truths.finish(given.trace.end) == truth
    assert margins.finish(given.trace.end) == margin
    first, second = online(given, seed), online(given, seed + 1)
    assert first.verdict is second.verdict is truth.verdict
    assert first.robustness == second.robustness == (margin.low, margin.high)
    assert first.decided_at == second.decided_at
    assert first.violation == second.violation
