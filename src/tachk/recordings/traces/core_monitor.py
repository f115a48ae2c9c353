"""Recorded traces whose values are held between rows, under the monitors of the C++ core: truth, robustness, signals.

Values are those at the first instant of the trace, which has to be finished. What lies after its end is not known:
truth may be undetermined, and robustness is bounded by what continuations of the trace make of it. Values that move
between rows, and robustness in time, are for `linear_monitor`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tachk import _core
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.job import check_job
from tachk.recordings.traces.monitor_program import MonitorProgram, part_of
from tachk.recordings.traces.node_signal import NodeSignal, Truth
from tachk.recordings.traces.trace import FloatTimes, Ticks, Trace, Values, changed_trace

SLICE = 1 << 18
"""Rows between two looks at whether Ctrl-C was pressed."""

_FIRST_SLICE = 1 << 10


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
        self._core = _core.OfflineTruth(program, verdict=True, signals=[])

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
        self._core = _core.OfflineRobustness(program, verdict=True, signals=[])

    def push(self, times: Ticks, columns: Sequence[Values]) -> None:
        """Takes the next rows: ticks, and the columns of the program in their order."""
        _push(self._core, times, columns)

    def finish(self, end: int) -> RobustnessResult:
        """The trace is over; it includes the tick ``end``."""
        self._core.finish(end)
        return bounds(*self._core.verdict())


def monitor_truth(program: MonitorProgram, trace: Trace) -> TruthResult:
    """The truth of the formula on a trace, and its first violation."""
    core = _core.OfflineTruth(program, verdict=True, signals=[])
    _run(core, program, trace)
    return _truth_result(core)


def monitor_robustness(program: MonitorProgram, trace: Trace) -> RobustnessResult:
    """The robustness of the formula on a trace: how far it is from changing its truth."""
    core = _core.OfflineRobustness(program, verdict=True, signals=[])
    _run(core, program, trace)
    return bounds(*core.verdict())


def truth_signals(program: MonitorProgram, trace: Trace, nodes: Sequence[int]) -> tuple[NodeSignal, ...]:
    """The truth of nodes over the whole trace."""
    part, places = part_of(program, nodes)
    core = _core.OfflineTruth(part, verdict=False, signals=places)
    _run(core, part, trace)
    signals = []
    for number in range(len(nodes)):
        starts, low, high = core.signal(number)
        signals.append(NodeSignal(starts, np.where(low == high, low, np.uint8(Truth.UNDETERMINED)), _cells(trace)))
    return tuple(signals)


def robustness_signals(program: MonitorProgram, trace: Trace, nodes: Sequence[int]) -> tuple[RobustnessSignal, ...]:
    """The robustness of nodes over the whole trace."""
    core = _core.OfflineRobustness(program, verdict=False, signals=list(nodes))
    _run(core, program, trace)
    return tuple(RobustnessSignal(*core.signal(number), _cells(trace)) for number in range(len(nodes)))


def _run(core: _core.OfflineTruth | _core.OfflineRobustness, program: MonitorProgram, trace: Trace) -> None:
    columns = columns_read(program, trace)
    if isinstance(trace.instants, FloatTimes):
        try:
            _push_counted(core, trace.instants, columns, trace)
            core.finish(trace.end)
        except ValueError:
            raise changed_trace() from None
    else:
        _push(core, trace.instants, columns)
        core.finish(trace.end)


def columns_read(program: MonitorProgram, trace: Trace) -> list[Values]:
    """The columns of a program. Raises ValueError for different ticks, UsageError for a column that is not there."""
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
        check_job()
        end = begin + size
        core.push(times[begin:end], [column[begin:end] for column in columns])
        begin, size = end, min(4 * size, SLICE)


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
        begin, size = end, min(4 * size, SLICE)
    times.checked = True


def _truth_result(core: _core.OfflineTruth) -> TruthResult:
    found = core.violation()
    return TruthResult(truth_of(*core.verdict()), Truth(core.lasting()), None if found is None else Violation(*found))


def bounds(low: float, high: float) -> RobustnessResult:
    """A robustness, as people read it."""
    return RobustnessResult(low + 0.0, high + 0.0)  # never -0.0


def truth_of(low: int, high: int) -> Truth:
    """The truth between two bounds."""
    return Truth(low) if low == high else Truth.UNDETERMINED


def _cells(trace: Trace) -> int:
    return 2 * trace.end + 1
