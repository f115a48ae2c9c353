"""Recorded traces under the monitors of the C++ core: truth, robustness, whole signals of subformulas.

Values are those at the first instant of the trace, which has to be finished. What lies after its end is not known:
truth may be undetermined, and robustness is bounded by what continuations of the trace make of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tachk import _core
from tachk.diagnostics.diagnostic import UsageError
from tachk.runtime.node_signal import NodeSignal, Truth
from tachk.runtime.trace import Ticks, Trace, Values
from tachk.semantics.monitor_program import MonitorProgram

_SLICE = 1 << 18
"""Rows between two looks at whether Ctrl-C was pressed."""


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
    verdict: Truth
    violation: Violation | None


@dataclass(frozen=True, slots=True)
class RobustnessResult:
    """Every continuation of the trace has a robustness from ``low`` to ``high``; they are equal if the trace decides it."""

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
        return RobustnessResult(*self._core.verdict())


def monitor_truth(program: MonitorProgram, trace: Trace) -> TruthResult:
    """Whether the formula is true on a trace, and where it is violated first."""
    core = _core.OfflineTruth(program, verdict=True, probes=[], signals=[])
    _run(core, program, trace)
    return _truth_result(core)


def monitor_robustness(program: MonitorProgram, trace: Trace) -> RobustnessResult:
    """How far the formula is from changing its truth on a trace."""
    core = _core.OfflineRobustness(program, verdict=True, probes=[], signals=[])
    _run(core, program, trace)
    return RobustnessResult(*core.verdict())


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


def _run(core: _core.OfflineTruth | _core.OfflineRobustness, program: MonitorProgram, trace: Trace) -> None:
    if trace.ticks_per_unit != program.ticks_per_unit:
        raise ValueError("the formula and the trace count different ticks")
    missing = [name for name in program.columns if name not in trace.columns]
    if missing:
        raise UsageError(f"{trace.name} has no column {missing[0]}")
    _push(core, trace.times, [trace.columns[name] for name in program.columns])
    core.finish(trace.end)


def _push(core: _core.OfflineTruth | _core.OfflineRobustness, times: Ticks, columns: Sequence[Values]) -> None:
    """In slices: between two of them the interpreter sees Ctrl-C."""
    for begin in range(0, len(times), _SLICE):
        if core.settled():
            return
        end = begin + _SLICE
        core.push(times[begin:end], [column[begin:end] for column in columns])


def _truth_result(core: _core.OfflineTruth) -> TruthResult:
    found = core.violation()
    return TruthResult(_truth(*core.verdict()), None if found is None else Violation(*found))


def _truth(low: int, high: int) -> Truth:
    return Truth(low) if low == high else Truth.UNDETERMINED


def _cells(trace: Trace) -> int:
    return 2 * (trace.end - int(trace.times[0])) + 1
