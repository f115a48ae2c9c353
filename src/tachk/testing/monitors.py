"""One formula and one trace for all monitors: the exact case turned into what the core takes, and the comparison."""

from __future__ import annotations

from dataclasses import dataclass
from math import lcm

import numpy as np

from tachk.properties import monitoring
from tachk.runtime.trace import Trace, Values
from tachk.semantics.monitor_program import MonitorProgram
from tachk.testing.exact_trace import ExactTrace
from tachk.testing.formulas import MonitoringCase


@dataclass(frozen=True, slots=True, eq=False)
class MonitorInput:
    program: MonitorProgram
    trace: Trace


def monitor_input(case: MonitoringCase, refinement: int = 1) -> MonitorInput:
    """The case in ticks: as coarse as its numbers allow, divided by ``refinement``."""
    booleans = [name for name, values in case.trace.columns.items() if all(isinstance(v, bool) for v in values)]
    denominators = (case.trace.end.denominator, *(time.denominator for time in case.trace.times))
    ticks = lcm(monitoring.ticks_needed(case.formula), *denominators) * refinement
    program = monitoring.compile(case.formula, tuple(case.trace.columns), ticks, booleans=booleans)
    return MonitorInput(program, in_ticks(case.trace, ticks))


def in_ticks(trace: ExactTrace, ticks_per_unit: int) -> Trace:
    """The trace as monitors read it."""
    columns: dict[str, Values] = {}
    for name, values in trace.columns.items():
        if all(isinstance(value, bool) for value in values):
            columns[name] = np.array(values, np.uint8)
        else:
            columns[name] = np.array([float(value) for value in values], np.float64)
    times = np.array([int(time * ticks_per_unit) for time in trace.times], np.int64)
    return Trace("exact", times, columns, int(trace.end * ticks_per_unit), ticks_per_unit)
