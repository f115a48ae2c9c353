"""Recorded traces under the monitors of the C++ core: truth, robustness, whole signals of subformulas.

Values are those at the first instant of the trace, which has to be finished. What lies after its end is not known:
truth may be undetermined, and robustness is bounded by what continuations of the trace make of it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tachk import _core
from tachk.diagnostics.diagnostic import UsageError
from tachk.runtime.monitor_program import MonitorProgram
from tachk.runtime.node_signal import NodeSignal, Truth
from tachk.runtime.trace import FloatTimes, Ticks, Trace, Values, changed_trace
from tachk.time_limit import check_time

_SLICE = 1 << 18
"""Rows between two looks at whether Ctrl-C was pressed."""

_FIRST_SLICE = 1 << 10

MOST_PARTS = 1_000_000
"""Of a tick, in which the instants are told at which lines cross."""

LAST_TICK_OF_LINES = 1 << 47
"""The durations of a formula that is judged on lines add up to less than this number of ticks."""

_LAST_TICK = 1 << 59

_SPACE, _AHEAD, _BEHIND = 0, 1, 2
"""What `LinearMonitor` of the core measures."""


@dataclass(frozen=True, slots=True)
class Violation:
    """The earliest stretch in which something that must always hold certainly does not.

    Attributes:
        node: what must always hold: the operand of an outermost G, or else the formula itself.
        first, last: cells.
    """

    node: int
    first: int
    last: int


@dataclass(frozen=True, slots=True)
class TruthResult:
    """Attributes:
    lasting: the verdict if all values stay for ever as they are at the end of the trace. Operators without upper bound
        still speak, at instants of the trace, about the trace only.
    """

    verdict: Truth
    lasting: Truth
    violation: Violation | None


@dataclass(frozen=True, slots=True)
class RobustnessResult:
    """Every continuation of the trace has a robustness from ``low`` to ``high``; equal if the trace decides it."""

    low: float
    high: float


@dataclass(frozen=True, slots=True, eq=False)
class RobustnessSignal:
    """The robustness of one subformula over the whole trace.

    Attributes:
        starts: the first cell of each piece, ascending, the first one 0.
        low, high: the bounds on each piece.
        cells: how many cells there are; the last piece ends before this one.
    """

    starts: NDArray[np.int64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    cells: int


class TruthMonitor:
    """A formula on a trace that comes in portions. The result does not depend on the portions."""

    def __init__(self, program: MonitorProgram) -> None:
        self._core = _core.OfflineTruth(program, verdict=True, probes=[], signals=[])

    def push(self, times: Ticks, columns: Sequence[Values]) -> None:
        """Takes the next rows: ticks, and the columns of the program in their order."""
        _push(self._core, times, columns)

    def finish(self, end: int) -> TruthResult:
        """The trace is over; it includes the tick ``end``."""
        self._core.finish(end)
        return _truth_result(self._core)


class RobustnessMonitor:
    """The same for robustness."""

    def __init__(self, program: MonitorProgram) -> None:
        self._core = _core.OfflineRobustness(program, verdict=True, probes=[], signals=[])

    def push(self, times: Ticks, columns: Sequence[Values]) -> None:
        """Takes the next rows: ticks, and the columns of the program in their order."""
        _push(self._core, times, columns)

    def finish(self, end: int) -> RobustnessResult:
        """The trace is over; it includes the tick ``end``."""
        self._core.finish(end)
        return _robustness_result(*self._core.verdict())


def monitor_truth(program: MonitorProgram, trace: Trace) -> TruthResult:
    """Whether the formula is true on a trace, and where it is violated first."""
    core = _core.OfflineTruth(program, verdict=True, probes=[], signals=[])
    _run(core, program, trace)
    return _truth_result(core)


def monitor_robustness(program: MonitorProgram, trace: Trace) -> RobustnessResult:
    """How far the formula is from changing its truth on a trace."""
    core = _core.OfflineRobustness(program, verdict=True, probes=[], signals=[])
    _run(core, program, trace)
    return _robustness_result(*core.verdict())


def truth_at(program: MonitorProgram, trace: Trace, places: Sequence[tuple[int, int]]) -> tuple[Truth, ...]:
    """The truth of nodes in cells, given as pairs."""
    core = _core.OfflineTruth(program, verdict=False, probes=list(places), signals=[])
    _run(core, program, trace)
    return tuple(_truth(*core.probe(number)) for number in range(len(places)))


def truth_signals(program: MonitorProgram, trace: Trace, nodes: Sequence[int]) -> tuple[NodeSignal, ...]:
    """The truth of nodes over the whole trace."""
    core = _core.OfflineTruth(program, verdict=False, probes=[], signals=list(nodes))
    _run(core, program, trace)
    signals = []
    for number in range(len(nodes)):
        starts, low, high = core.signal(number)
        signals.append(NodeSignal(starts, np.where(low == high, low, np.uint8(Truth.UNDETERMINED)), _cells(trace)))
    return tuple(signals)


def robustness_signals(program: MonitorProgram, trace: Trace, nodes: Sequence[int]) -> tuple[RobustnessSignal, ...]:
    """The robustness of nodes over the whole trace."""
    core = _core.OfflineRobustness(program, verdict=False, probes=[], signals=list(nodes))
    _run(core, program, trace)
    return tuple(RobustnessSignal(*core.signal(number), _cells(trace)) for number in range(len(nodes)))


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
    """What the durations of a formula add up to, in ticks."""
    return sum(max(node.lower, node.upper) for node in program.nodes)


def parts_of_tick(programs: Iterable[MonitorProgram], trace: Trace) -> int:
    """In how many parts of a tick the instants at which lines cross can be told: a power of ten, at most a million.

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
            "times and bounds with fewer decimals, or a shorter trace, can be judged",
        )
    return parts


def monitor_linear_truth(program: MonitorProgram, trace: Trace, parts: int = MOST_PARTS) -> LinearTruthResult:
    """The truth of the formula where numbers move linearly from one row to the next; truth values do not move.

    After the last row they keep their values. Instants at which lines cross are rounded to one of so many parts of a
    tick, or of fewer if the trace is too long for them (`parts_of_tick`). Raises ValueError for what is not linear:
    ``%``, products and quotients of columns (`tachk.monitoring.line_compiler` finds it before).
    """
    core = _linear(program, trace, _SPACE, parts)
    low, high, found, lasting = core.truth()
    parts = 2 * core.refinement()
    violation = None if found is None else LinearViolation(found[0], found[1] / parts, found[2] / parts)
    return LinearTruthResult(_truth(low, high), Truth(lasting), violation)


def monitor_linear_robustness(program: MonitorProgram, trace: Trace) -> RobustnessResult:
    """The robustness of the formula where numbers move linearly from one row to the next."""
    return _first_value(_linear(program, trace, _SPACE), program)


def linear_truth_signal(program: MonitorProgram, trace: Trace, node: int, parts: int) -> NodeSignal:
    """The truth of a node over the whole trace, in cells of parts of a tick. Raises ValueError for too many parts."""
    core = _linear(program, trace, _SPACE, parts)
    if core.refinement() != parts:
        raise ValueError("the trace is too long for so many parts of a tick")
    starts, low, high = core.truth_signal(node)
    cells = 2 * parts * trace.end + 1
    return NodeSignal(starts, np.where(low == high, low, np.uint8(Truth.UNDETERMINED)), cells)


def linear_robustness_signal(program: MonitorProgram, trace: Trace, node: int) -> tuple[LinearSignal, LinearSignal]:
    """The bounds of the robustness of a node, where numbers move linearly from one row to the next."""
    core = _linear(program, trace, _SPACE)
    return LinearSignal(*core.robustness(node, False)), LinearSignal(*core.robustness(node, True))


def time_robustness_ahead(program: MonitorProgram, trace: Trace) -> RobustnessResult:
    """By how many ticks all changes of atoms may come earlier before the truth of the formula changes: at each instant
    an atom counts as many ticks as it will go on to have the truth that it has, negative if it is false (Donze, Maler
    2010). Columns keep their values between rows."""
    return _in_half_ticks(_first_value(_linear(program, trace, _AHEAD), program))


def time_robustness_behind(program: MonitorProgram, trace: Trace) -> RobustnessResult:
    """The same looking back: by how many ticks all changes may come later. What was before the trace is not counted."""
    return _in_half_ticks(_first_value(_linear(program, trace, _BEHIND), program))


def _in_half_ticks(value: RobustnessResult) -> RobustnessResult:
    """Without what was rounded on the way: lines of slope 1 and -1 through whole ticks cross at halves of a tick."""
    low, high = (bound if math.isinf(bound) else round(2 * bound) / 2 for bound in (value.low, value.high))
    return _robustness_result(low, high)


def time_robustness_signal(
    program: MonitorProgram, trace: Trace, node: int, *, ahead: bool
) -> tuple[LinearSignal, LinearSignal]:
    """The bounds of the robustness in time of a node, in ticks."""
    core = _linear(program, trace, _AHEAD if ahead else _BEHIND)
    return LinearSignal(*core.robustness(node, False)), LinearSignal(*core.robustness(node, True))


def _linear(program: MonitorProgram, trace: Trace, measure: int, parts: int = MOST_PARTS) -> _core.LinearMonitor:
    core = _core.LinearMonitor(program, measure=measure)
    columns = _columns(program, trace)
    for begin in range(0, trace.rows, _SLICE):
        check_time()
        end = begin + _SLICE
        core.push(trace.times[begin:end], [column[begin:end] for column in columns])
    core.finish(trace.end, parts)
    return core


def _first_value(core: _core.LinearMonitor, program: MonitorProgram) -> RobustnessResult:
    """Node by node: between two of them the interpreter sees Ctrl-C."""
    root = len(program.nodes) - 1
    for node in range(root):
        for high in (False, True):
            check_time()
            core.compute(node, high)
    low, high = (core.robustness(root, side)[1][0] for side in (False, True))
    return _robustness_result(float(low), float(high))


def _run(core: _core.OfflineTruth | _core.OfflineRobustness, program: MonitorProgram, trace: Trace) -> None:
    columns = _columns(program, trace)
    if isinstance(trace.instants, FloatTimes):
        try:
            _push_counted(core, trace.instants, columns, trace)
            core.finish(trace.end)
        except ValueError:
            raise changed_trace() from None
    else:
        _push(core, trace.instants, columns)
        core.finish(trace.end)


def _columns(program: MonitorProgram, trace: Trace) -> list[Values]:
    if trace.ticks_per_unit != program.ticks_per_unit:
        raise ValueError("the formula and the trace count different ticks")
    missing = [name for name in program.columns if name not in trace.columns]
    if missing:
        raise UsageError(f"{trace.name} has no column {missing[0]}")
    return [trace.columns[name] for name in program.columns]


def _push(core: _core.OfflineTruth | _core.OfflineRobustness, times: Ticks, columns: Sequence[Values]) -> None:
    """In slices: between two of them the interpreter sees Ctrl-C. The first ones are short: some formulas are settled
    soon."""
    begin, size = 0, _FIRST_SLICE
    while begin < len(times) and not core.settled():
        check_time()
        end = begin + size
        core.push(times[begin:end], [column[begin:end] for column in columns])
        begin, size = end, min(4 * size, _SLICE)


def _push_counted(
    core: _core.OfflineTruth | _core.OfflineRobustness, times: FloatTimes, columns: Sequence[Values], trace: Trace
) -> None:
    """The same of times that are counted on the way. The first monitor of a trace looks at all rows, also at those that
    do not matter to it. Raises UsageError if something is not as it was supposed to be."""
    numbers = times.numbers
    finite: list[NDArray[np.float64]] = []
    if not times.checked:
        finite = [np.asarray(values, np.float64) for values in trace.columns.values() if values.dtype.kind == "f"]
    begin, size = 0, _FIRST_SLICE
    while begin < len(numbers) and not (times.checked and core.settled()):
        end = begin + size
        if not core.push_counted(
            numbers[begin:end],
            numbers[max(begin - 1, 0)],
            times.decimals,
            times.first,
            times.factor,
            [column[begin:end] for column in columns],
            [values[begin:end] for values in finite],
            not times.checked,
        ):
            raise changed_trace()
        begin, size = end, min(4 * size, _SLICE)
    times.checked = True


def _truth_result(core: _core.OfflineTruth) -> TruthResult:
    found = core.violation()
    return TruthResult(_truth(*core.verdict()), Truth(core.lasting()), None if found is None else Violation(*found))


def _robustness_result(low: float, high: float) -> RobustnessResult:
    return RobustnessResult(low + 0.0, high + 0.0)  # never -0.0


def _truth(low: int, high: int) -> Truth:
    return Truth(low) if low == high else Truth.UNDETERMINED


def _cells(trace: Trace) -> int:
    return 2 * trace.end + 1
