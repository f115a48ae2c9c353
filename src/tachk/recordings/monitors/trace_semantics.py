"""The two semantics of a trace: values are held between rows, or numbers move in straight lines."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

from tachk.recordings.traces.conventions import Interpolation
from tachk.recordings.traces.core_monitor import (
    RobustnessResult,
    monitor_robustness,
    monitor_truth,
    truth_signals,
)
from tachk.recordings.traces.linear_monitor import (
    Measure,
    parts_of_tick,
    robustness,
    truth_on_lines,
    truth_signals_on_lines,
)
from tachk.recordings.traces.monitor_program import UNBOUNDED, AtomRelation, MonitorProgram
from tachk.recordings.traces.node_signal import NodeSignal, Truth
from tachk.recordings.traces.online_monitor import OnlineMonitor
from tachk.recordings.traces.trace import Trace
from tachk.recordings.traces.verdict_explanation import Explainer

_ROWS_AT_ONCE = 4096


@dataclass(frozen=True, slots=True)
class EvaluatedTruth:
    """Attributes:
    measured: what the trace says.
    lasting: what it would say if all values stayed for ever as they are at the end.
    """

    measured: Truth
    lasting: Truth


class TraceSemantics(Protocol):
    """The semantics of a trace between its rows. Programs and traces count the same ticks."""

    def shown(self, trace: Trace) -> Trace:
        """The trace as reports count it, so that every instant in them is a whole number of half ticks."""
        ...

    def truth(self, program: MonitorProgram, trace: Trace) -> EvaluatedTruth: ...

    def measured(self, program: MonitorProgram, trace: Trace) -> tuple[EvaluatedTruth, RobustnessResult]:
        """The truth and the robustness."""
        ...

    def explainer(self, program: MonitorProgram, trace: Trace) -> Explainer:
        """In the ticks of what is shown."""
        ...


@dataclass(frozen=True, slots=True)
class _NodeSignals:
    """The signals of nodes over a trace; an object rather than a function, so that reports can be pickled.

    Attributes:
        parts: of a tick, where values lie on lines.
    """

    program: MonitorProgram
    trace: Trace
    parts: int | None = None

    def __call__(self, nodes: Sequence[int]) -> Sequence[NodeSignal]:
        if self.parts is None:
            return truth_signals(self.program, self.trace, nodes)
        return truth_signals_on_lines(self.program, self.trace, nodes, self.parts)


@dataclass(frozen=True, slots=True)
class _Certainty:
    """The first tick at which a violation is certain."""

    program: MonitorProgram
    trace: Trace

    def __call__(self, tick: int) -> int:
        return first_certain(self.program, self.trace, tick)


@dataclass(frozen=True, slots=True)
class HeldValues:
    """Every value is held until the next row."""

    def shown(self, trace: Trace) -> Trace:
        return trace

    def truth(self, program: MonitorProgram, trace: Trace) -> EvaluatedTruth:
        found = monitor_truth(program, trace)
        return EvaluatedTruth(found.verdict, found.lasting)

    def measured(self, program: MonitorProgram, trace: Trace) -> tuple[EvaluatedTruth, RobustnessResult]:
        """A robustness that is not 0 has the sign of the truth under the same rules, so it is computed first."""
        if follows_from_truth(program):
            truth = self.truth(program, trace)
            return truth, infinite_robustness(truth.measured)
        robustness = monitor_robustness(program, trace)
        if robustness.low > 0:
            return EvaluatedTruth(Truth.TRUE, Truth.TRUE), robustness
        if robustness.high < 0:
            return EvaluatedTruth(Truth.FALSE, Truth.FALSE), robustness
        return self.truth(program, trace), robustness

    def explainer(self, program: MonitorProgram, trace: Trace) -> Explainer:
        return Explainer(program, _NodeSignals(program, trace), _Certainty(program, trace), 2 * trace.end + 1)


@dataclass(frozen=True, slots=True)
class Lines:
    """Numbers move in straight lines from row to row.

    Attributes:
        parts: the parts of a tick, for the instants at which lines cross.
    """

    parts: int

    def shown(self, trace: Trace) -> Trace:
        return trace.refined(trace.ticks_per_unit * self.parts)

    def shown_program(self, program: MonitorProgram) -> MonitorProgram:
        """The program in the ticks of what is shown."""
        nodes = tuple(
            replace(
                node,
                lower=node.lower * self.parts,
                upper=UNBOUNDED if node.upper == UNBOUNDED else node.upper * self.parts,
            )
            for node in program.nodes
        )
        return replace(program, nodes=nodes, ticks_per_unit=program.ticks_per_unit * self.parts)

    def truth(self, program: MonitorProgram, trace: Trace) -> EvaluatedTruth:
        found = truth_on_lines(program, trace, self.parts)
        return EvaluatedTruth(found.verdict, found.lasting)

    def measured(self, program: MonitorProgram, trace: Trace) -> tuple[EvaluatedTruth, RobustnessResult]:
        truth = self.truth(program, trace)
        if follows_from_truth(program):
            return truth, infinite_robustness(truth.measured)
        return truth, robustness(program, trace, Measure.SPACE)

    def explainer(self, program: MonitorProgram, trace: Trace) -> Explainer:
        # Certainty of a violation would need the values of prefixes, whose last lines are not known.
        return Explainer(
            self.shown_program(program), _NodeSignals(program, trace, self.parts), None, 2 * trace.end * self.parts + 1
        )


def semantics_of(trace: Trace, programs: Iterable[MonitorProgram]) -> TraceSemantics:
    """The semantics that a trace asks for. Raises UsageError if it is too long for lines."""
    if trace.interpolation is Interpolation.LINEAR:
        return Lines(parts_of_tick(programs, trace))
    return HeldValues()


def follows_from_truth(program: MonitorProgram) -> bool:
    """True if the robustness is infinite, because the formula compares no numbers."""
    return all(atom.relation is AtomRelation.TRUTH for atom in program.atoms)


def infinite_robustness(truth: Truth) -> RobustnessResult:
    """The robustness of a formula that compares no numbers."""
    low = math.inf if truth is Truth.TRUE else -math.inf
    return RobustnessResult(low, -math.inf if truth is Truth.FALSE else math.inf)


def first_certain(program: MonitorProgram, trace: Trace, tick: int) -> int:
    """The first tick from ``tick`` on, or else the first row, at which no continuation could make the formula true."""
    columns = [trace.columns[name] for name in program.columns]
    monitor = OnlineMonitor(program, robustness=False)
    row = int(trace.times.searchsorted(tick, side="right"))
    monitor.push(trace.times[:row], [column[:row] for column in columns])
    if monitor.advance(tick + 1) is Truth.FALSE:
        return tick
    while row < trace.rows and monitor.verdict is Truth.UNDETERMINED:
        last = min(row + _ROWS_AT_ONCE, trace.rows)
        monitor.push(trace.times[row:last], [column[row:last] for column in columns])
        row = last
    at = monitor.decided_at
    return trace.end if at is None else at
