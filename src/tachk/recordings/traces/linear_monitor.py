"""Recorded traces under the monitor of the C++ core that measures with lines: numbers that move from row to row, and
robustness in time, which is linear between changes although values are held.

As in `core_monitor`, values are those at the first instant of a finished trace.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tachk import _core
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.job import check_job
from tachk.recordings.traces.core_monitor import SLICE, RobustnessResult, bounds, columns_read, truth_of
from tachk.recordings.traces.monitor_program import MonitorProgram
from tachk.recordings.traces.node_signal import NodeSignal, Truth
from tachk.recordings.traces.trace import Trace

Measure = _core.Measure
"""The measure of robustness. SPACE: by how much values could change; numbers move linearly from one row to the
next. AHEAD: by how many ticks all changes of atoms may come earlier before the truth of the formula changes: at each
instant an atom counts as many ticks as it will go on to have the truth that it has, negative if it is false (Donze,
Maler 2010). BEHIND: the same looking back; what was before the trace is not counted. For both of them columns keep
their values between rows."""

MOST_PARTS = 1_000_000
"""The largest number of parts of a tick, for the instants at which lines cross."""

LAST_TICK_OF_LINES = 1 << 47
"""The durations of a formula that is evaluated on lines add up to less than this number of ticks."""

_LAST_TICK = 1 << 59


@dataclass(frozen=True, slots=True)
class LinearViolation:
    """The earliest stretch in which something that must always hold certainly does not, on lines.

    Attributes:
        node: as of `Violation`.
        start, end: ticks since the trace begins, rounded to parts of a tick.
    """

    node: int
    start: float
    end: float


@dataclass(frozen=True, slots=True)
class LinearTruthResult:
    """As `TruthResult`."""

    verdict: Truth
    lasting: Truth
    violation: LinearViolation | None


@dataclass(frozen=True, slots=True, eq=False)
class LinearSignal:
    """A signal that is linear between its break points, where it may jump. Times are ticks since the trace begins.

    Attributes:
        starts: the break points, ascending, the first one 0.
        at: the values there.
        after: the limits there from the right.
        before: the limits from the left at the next break points; behind the last one the signal is constant.
    """

    starts: NDArray[np.float64]
    at: NDArray[np.float64]
    after: NDArray[np.float64]
    before: NDArray[np.float64]


def reach_of(program: MonitorProgram) -> int:
    """The sum of the durations of a formula in ticks."""
    return sum(max(node.lower, node.upper) for node in program.nodes)


def parts_of_tick(programs: Iterable[MonitorProgram], trace: Trace) -> int:
    """The number of parts of a tick for the instants at which lines cross: a power of ten, at most a million.

    Raises UsageError if ticks cannot be divided, because the trace is too long for that, or bounds reach
    `LAST_TICK_OF_LINES`.
    """
    reach = trace.end + 1 + 2 * max(map(reach_of, programs), default=0)
    parts = 1
    while parts < MOST_PARTS and reach * parts * 1000 < _LAST_TICK:
        parts *= 10
    if parts == 1:
        raise UsageError(
            f"{trace.name} is too long for lines between its rows, with {trace.ticks_per_unit} ticks per unit of time",
            "times and bounds with fewer decimals, or a shorter trace, can be evaluated",
        )
    return parts


def truth_on_lines(program: MonitorProgram, trace: Trace, parts: int = MOST_PARTS) -> LinearTruthResult:
    """The truth of the formula where numbers move linearly from one row to the next; truth values do not move.

    After the last row they keep their values. Instants at which lines cross are rounded to one of so many parts of a
    tick, or of fewer if the trace is too long for them (`parts_of_tick`). Raises ValueError for what is not linear:
    ``%``, products and quotients of columns (`tachk.recordings.monitors.line_compiler` finds it before).
    """
    core = _ready(program, trace, Measure.SPACE, parts)
    low, high, found, lasting = core.truth()
    parts = 2 * core.refinement()
    violation = None if found is None else LinearViolation(found[0], found[1] / parts, found[2] / parts)
    return LinearTruthResult(truth_of(low, high), Truth(lasting), violation)


def truth_signals_on_lines(
    program: MonitorProgram, trace: Trace, nodes: Sequence[int], parts: int
) -> tuple[NodeSignal, ...]:
    """The truth of nodes over the whole trace, in cells of parts of a tick. Raises ValueError for too many parts."""
    core = _ready(program, trace, Measure.SPACE, parts)
    if core.refinement() != parts:
        raise ValueError("the trace is too long for so many parts of a tick")
    cells = 2 * parts * trace.end + 1
    signals = []
    for node in nodes:
        starts, low, high = core.truth_signal(node)
        signals.append(NodeSignal(starts, np.where(low == high, low, np.uint8(Truth.UNDETERMINED)), cells))
    return tuple(signals)


def robustness(program: MonitorProgram, trace: Trace, measure: Measure) -> RobustnessResult:
    """The robustness: how far the formula is from changing its truth.

    It is computed node by node: between two of them the interpreter sees Ctrl-C.
    """
    core = _ready(program, trace, measure)
    root = len(program.nodes) - 1
    for node in range(root):
        for side in (False, True):
            check_job()
            core.compute(node, side)
    low, high = (float(core.robustness(root, side)[1][0]) for side in (False, True))
    return bounds(low, high) if measure is Measure.SPACE else bounds(_in_half_ticks(low), _in_half_ticks(high))


def _in_half_ticks(bound: float) -> float:
    """Without what was rounded on the way: lines of slope 1 and -1 through whole ticks cross at halves of a tick."""
    return bound if math.isinf(bound) else round(2 * bound) / 2


def robustness_signal(
    program: MonitorProgram, trace: Trace, node: int, measure: Measure
) -> tuple[LinearSignal, LinearSignal]:
    """The bounds of the robustness of a node."""
    core = _ready(program, trace, measure)
    return LinearSignal(*core.robustness(node, False)), LinearSignal(*core.robustness(node, True))


def _ready(program: MonitorProgram, trace: Trace, measure: Measure, parts: int = MOST_PARTS) -> _core.LinearMonitor:
    core = _core.LinearMonitor(program, measure=measure)
    columns = columns_read(program, trace)
    for begin in range(0, trace.rows, SLICE):
        check_job()
        end = begin + SLICE
        core.push(trace.times[begin:end], [column[begin:end] for column in columns])
    core.finish(trace.end, parts)
    return core
