"""Cases as monitors take them: times in ticks, columns as arrays.

A case is counted in ticks as coarse as its numbers allow, or finer: no answer may depend on it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import lcm
from random import Random

import numpy as np

from tachk.base.span import NOWHERE
from tachk.recordings.monitors import compiler as monitoring
from tachk.recordings.traces.monitor_program import MonitorProgram
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.trace import Ticks, Trace, Values
from tachk.syntax import formula as syntax
from tests.support.exact_monitor import satisfaction
from tests.support.exact_trace import ExactTrace, Value
from tests.support.formulas import MonitoringCase

_EVER = syntax.all_time(NOWHERE)


@dataclass(frozen=True, slots=True, eq=False)
class MonitorInput:
    program: MonitorProgram
    trace: Trace

    def instant(self, cell: int) -> Fraction:
        """An instant of a cell, in units of time."""
        return Fraction(cell, 2 * self.trace.ticks_per_unit)


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


def portions(given: MonitorInput, random: Random) -> Iterator[tuple[Ticks, list[Values]]]:
    """The rows of the trace cut anywhere, also between rows for one instant, with empty portions among them."""
    rows = given.trace.rows
    cuts = sorted(random.randint(0, rows) for _ in range(random.randint(0, 4)))
    columns = [given.trace.columns[name] for name in given.program.columns]
    for first, last in pairwise((0, *cuts, rows)):
        yield given.trace.times[first:last], [column[first:last] for column in columns]


def truth_of(value: Value) -> Truth:
    return Truth.UNDETERMINED if value.truth is None else Truth(value.truth)


def guarded(formula: syntax.Formula) -> syntax.Formula | None:
    """What a formula demands of every instant: f of ``G f``."""
    return formula.operand if isinstance(formula, syntax.Always) and formula.interval == _EVER else None


def always(formula: syntax.Formula) -> syntax.Formula:
    return syntax.Always(NOWHERE, _EVER, formula)


def first_violation(case: MonitoringCase, given: MonitorInput) -> tuple[int, int] | None:
    """The first and the last cell of the first stretch in which a formula ``G f`` is certainly without f."""
    demand = guarded(case.formula)
    if demand is None:
        raise ValueError("the formula demands nothing of every instant")
    exact = satisfaction(demand, case.trace)
    cells = 2 * given.trace.end + 1
    false = [exact.value(given.instant(cell)).truth is False for cell in range(cells)]
    if True not in false:
        return None
    first = false.index(True)
    return first, (false.index(False, first) if False in false[first:] else cells) - 1
