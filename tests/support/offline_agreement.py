"""The offline monitors of the core against the oracle."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from random import Random

import numpy as np

from tachk.recordings.traces.core_monitor import (
    RobustnessMonitor,
    RobustnessResult,
    TruthMonitor,
    monitor_robustness,
    monitor_truth,
    robustness_signals,
    truth_signals,
)
from tests.support.exact_monitor import ExactSignal, satisfaction
from tests.support.formulas import MonitoringCase
from tests.support.monitor_input import MonitorInput, first_violation, guarded, monitor_input, portions, truth_of


def offline_problems(case: MonitoringCase, refinement: int = 1, seed: int = 0) -> tuple[str, ...]:
    """Where the offline monitors and the oracle differ: in the verdict, in the robustness, at any instant of the trace,
    or when the trace comes in portions drawn with the seed."""
    given = monitor_input(case, refinement)
    exact = satisfaction(case.formula, case.trace)
    return (*_verdict_problems(given, exact, seed), *_signal_problems(given, exact), *_violation_problems(case, given))


def _verdict_problems(given: MonitorInput, exact: ExactSignal, seed: int) -> Iterator[str]:
    start = exact.value(Fraction(0))
    truths, margins = TruthMonitor(given.program), RobustnessMonitor(given.program)
    for times, columns in portions(given, Random(seed)):
        truths.push(times, columns)
        margins.push(times, columns)
    verdicts = {
        "truth": monitor_truth(given.program, given.trace).verdict,
        "truth of portions": truths.finish(given.trace.end).verdict,
    }
    for name, verdict in verdicts.items():
        if verdict is not truth_of(start):
            yield f"{name}: {verdict.word}, not {truth_of(start).word}"
    ranges = {
        "robustness": monitor_robustness(given.program, given.trace),
        "robustness of portions": margins.finish(given.trace.end),
    }
    for name, found in ranges.items():
        if found != RobustnessResult(float(start.low), float(start.high)):
            yield f"{name}: [{found.low}, {found.high}], not [{float(start.low)}, {float(start.high)}]"


def _signal_problems(given: MonitorInput, exact: ExactSignal) -> Iterator[str]:
    root = len(given.program.nodes) - 1
    (truth,) = truth_signals(given.program, given.trace, [root])
    (margin,) = robustness_signals(given.program, given.trace, [root])
    for cell in range(2 * given.trace.end + 1):
        value = exact.value(given.instant(cell))
        piece = int(np.searchsorted(margin.starts, cell, side="right")) - 1
        found = truth.at(cell), float(margin.low[piece]), float(margin.high[piece])
        if found != (truth_of(value), float(value.low), float(value.high)):
            yield f"cell {cell} of {given.trace.ticks_per_unit} ticks a unit: {found}, not {value}"
            return


def _violation_problems(case: MonitoringCase, given: MonitorInput) -> Iterator[str]:
    if guarded(case.formula) is not None:
        found, expected = monitor_truth(given.program, given.trace).violation, first_violation(case, given)
        if (None if found is None else (found.first, found.last)) != expected:
            yield f"violation: {found}, not in cells {expected}"
