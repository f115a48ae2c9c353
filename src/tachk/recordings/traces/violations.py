"""All violations of a formula on a trace: where what always has to be true is not, and which triggers ask in vain.

For ``G f`` a violation is a longest stretch of instants at which f is false; ``G f && G g`` has those of both, and a
formula that asks for nothing at more than one instant has at most one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import overload

import numpy as np
from numpy.typing import NDArray

from tachk.recordings.traces.monitor_program import MonitorNode, MonitorProgram, NodeKind
from tachk.recordings.traces.node_signal import CellRuns, Truth
from tachk.recordings.traces.verdict_explanation import Explainer, Finding, trigger_of, window_of


@dataclass(frozen=True, slots=True)
class DemandedNode:
    """A node that is neither a conjunction nor a G, with the first and the last cell at which it has to be true.

    Attributes:
        last: None: without end.
    """

    node: int
    first: int
    last: int | None


@dataclass(frozen=True, slots=True)
class TriggerCounts:
    """Stretches in which a trigger is true; of ``rise(p)`` each is an instant.

    Attributes:
        violated: those in which the response is violated at some instant.
        pending: those in which it is not violated, but open at some instant.
    """

    total: int
    violated: int
    pending: int

    def __add__(self, other: TriggerCounts) -> TriggerCounts:
        return TriggerCounts(self.total + other.total, self.violated + other.violated, self.pending + other.pending)


@dataclass(frozen=True, slots=True, eq=False)
class _DemandedCells:
    """Something that has to be true in some cells."""

    node: int
    violated: CellRuns
    triggers: CellRuns | None
    counts: TriggerCounts | None


@dataclass(frozen=True, slots=True, eq=False)
class Violations(Sequence[Finding]):
    """The violations in the order of time. Each is explained on access, but for the moment when it became certain.

    Attributes:
        triggers: None where the formula has no form ``trigger -> response``.
    """

    triggers: TriggerCounts | None
    _explainer: Explainer = field(repr=False)
    _parts: tuple[_DemandedCells, ...] = field(repr=False)
    _order: NDArray[np.int64] = field(repr=False)

    def __len__(self) -> int:
        return len(self._order)

    @property
    def first_cells(self) -> NDArray[np.int64]:
        """The first cells of all of them, in order."""
        return np.concatenate([part.violated.first for part in self._parts])[self._order]

    @property
    def parts(self) -> tuple[str, ...]:
        """The texts of what has to be true, such as ``p -> F[0, 5] q`` in ``G (p -> F[0, 5] q) && G r``."""
        return tuple(self._explainer.program.nodes[part.node].text for part in self._parts)

    @overload
    def __getitem__(self, index: int) -> Finding: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Finding, ...]: ...
    def __getitem__(self, index: int | slice) -> Finding | tuple[Finding, ...]:
        if isinstance(index, slice):
            return tuple(self._finding(int(number)) for number in self._order[index])
        return self._finding(int(self._order[index]))

    def __iter__(self) -> Iterator[Finding]:
        return (self._finding(int(number)) for number in self._order)

    def _finding(self, number: int) -> Finding:
        for part in self._parts:
            if number < len(part.violated):
                interval = int(part.violated.first[number]), int(part.violated.last[number])
                triggered = None if part.triggers is None else part.triggers.around(interval[0])
                return self._explainer.explained(part.node, interval, triggered, Truth.FALSE)
            number -= len(part.violated)
        raise IndexError(number)


def violations_of(explainer: Explainer) -> Violations:
    """Looks for all of them, in time that grows with the trace and with their number only."""
    parts = tuple(_part(explainer, obligation) for obligation in obligations(explainer.program))
    firsts = np.concatenate([part.violated.first for part in parts])
    counts = [part.counts for part in parts if part.counts is not None]
    total = sum(counts, TriggerCounts(0, 0, 0)) if counts else None
    return Violations(total, explainer, parts, np.argsort(firsts, kind="stable"))


def obligations(program: MonitorProgram) -> Iterator[DemandedNode]:
    """The conjuncts of a formula made of conjunctions and G."""
    pending = [DemandedNode(len(program.nodes) - 1, 0, 0)]
    while pending:
        requested = pending.pop()
        current = program.nodes[requested.node]
        if current.kind is NodeKind.AND:
            pending += [replace(requested, node=operand) for operand in reversed(current.operands)]
        elif current.kind is NodeKind.ALWAYS and not _empty(current):
            # The windows of neighbouring cells overlap or touch, so together they have no gap.
            last = None if requested.last is None else window_of(current, requested.last)[1]
            pending.append(DemandedNode(current.operands[0], window_of(current, requested.first)[0], last))
        else:
            yield requested


def _empty(node: MonitorNode) -> bool:
    """True if the window of an operator has no instant, as that of ``G(2, 2)``."""
    return node.lower == node.upper and not (node.lower_closed and node.upper_closed)


def _part(explainer: Explainer, requested: DemandedNode) -> _DemandedCells:
    node, first = requested.node, requested.first
    last = explainer.cells - 1 if requested.last is None else min(requested.last, explainer.cells - 1)
    signal = explainer.signal(node)
    violated = signal.runs(Truth.FALSE, first, last)
    trigger = trigger_of(explainer.program, node)
    if trigger is None:
        return _DemandedCells(node, violated, None, None)
    trigger_signal = explainer.signal(trigger)
    triggers = trigger_signal.runs(Truth.TRUE, first, last)
    in_vain = triggers.meets(violated)
    pending = triggers.meets(signal.runs(Truth.UNDETERMINED, first, last)) & ~in_vain
    counts = TriggerCounts(len(triggers), int(in_vain.sum()), int(pending.sum()))
    return _DemandedCells(node, violated, trigger_signal.runs(Truth.TRUE, 0, trigger_signal.cells - 1), counts)
