"""The explanation of a false or undetermined formula on a trace: from the verdict down to the responsible atoms."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice

from tachk.recordings.traces.arrivals import topic_of
from tachk.recordings.traces.monitor_program import UNBOUNDED, MonitorNode, MonitorProgram, NodeKind, ValueOperator
from tachk.recordings.traces.node_signal import NodeSignal, Truth
from tachk.recordings.traces.trace import changed_trace

_AT_ONCE = 64
"""Nodes whose values are kept in memory before they are needed."""

_AHEAD = (NodeKind.EVENTUALLY, NodeKind.ALWAYS, NodeKind.UNTIL)


@dataclass(frozen=True, slots=True)
class TruthReason:
    """The fact that a subformula has a value in a cell, and its reasons.

    Attributes:
        node: its number in the program.
        cell: the cell.
        window: the first and the last cell that a temporal operator speaks about there; the last one may lie beyond the
            trace, None: without end.
        parts: the responsible operands, with their cells.
        operands: the texts of all operands.
    """

    node: int
    text: str
    kind: NodeKind
    cell: int
    value: Truth
    window: tuple[int, int | None] | None = None
    parts: tuple[TruthReason, ...] = ()
    operands: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Finding:
    """The first instant at which a formula is violated, or at which its verdict hangs.

    Attributes:
        formula: what has to be true, such as ``p -> q`` in ``G (p -> q)``.
        cell: the instant; for ``G (p -> ...)`` that of the trigger.
        last: the last cell of the stretch in which it is so, the first being ``cell``.
        trigger: why the condition that asks for the response is true, if the formula has that form.
        triggered: the first and the last cell of the stretch around ``cell`` in which the trigger is true.
        response: why the response, or the whole, has its value.
        deadline: the last cell at which the response could have come or been broken; None: without end.
        decided: the cell from which on the verdict is certain; None if it is not, or that is not known.
        blamed: the innermost subformulas to blame, with the cells at which they are.
    """

    formula: str
    cell: int
    last: int
    trigger: TruthReason | None
    triggered: tuple[int, int] | None
    response: TruthReason
    deadline: int | None
    decided: int | None
    blamed: tuple[TruthReason, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Explainer:
    """Attributes:
    compute: the values of nodes of the program over the trace; called once for each node that matters.
    decide: the first tick from the given one on at which a violation is certain; called where the parts of a formula do
        not decide it by themselves, because windows lie within windows. None: it is not reported then.
    cells: of the trace, ``2 * end + 1``.
    """

    program: MonitorProgram
    compute: Callable[[Sequence[int]], Sequence[NodeSignal]] = field(repr=False)
    decide: Callable[[int], int] | None = field(repr=False)
    cells: int
    _known: dict[int, NodeSignal] = field(default_factory=dict, repr=False)
    _found: dict[Truth, Finding | None] = field(default_factory=dict, repr=False)

    def signal(self, node: int) -> NodeSignal:
        """The signal of a node of the program over the trace."""
        self._compute((node,))
        return self._known[node]

    def _compute(self, nodes: Sequence[int]) -> None:
        """Computes the values of nodes. Their operands are mostly looked at next, and the trace need not be read again
        for them."""
        new = [node for node in nodes if node not in self._known]
        operands = {o for node in new for o in self.program.nodes[node].operands if o not in self._known}
        wanted = [*new, *operands.difference(new)]
        if wanted:
            self._known.update(zip(wanted, self.compute(wanted), strict=True))

    def _having(self, nodes: Sequence[int], cell: int, value: Truth) -> Iterator[int]:
        """The nodes that have a value in a cell. The trace is read for ever more of them at once, as it would take long
        for thousands one by one."""
        start, size = 0, 1
        while start < len(nodes):
            group = nodes[start : start + size]
            self._compute(group)
            yield from (node for node in group if self._known[node].at(cell) is value)
            start, size = start + size, min(2 * size, _AT_ONCE)

    def finding(self, value: Truth) -> Finding | None:
        """The first violation of the formula, or the place that leaves it open; None if it is true. Searched once.

        Args:
            value: of the formula.

        Raises UsageError if the formula does not have this value on the trace as it is now.
        """
        if value not in self._found:
            self._found[value] = None if value is Truth.TRUE else self._find(value)
        return self._found[value]

    def _find(self, value: Truth) -> Finding:
        node, cell, end = self._body(len(self.program.nodes) - 1, value)
        if self.signal(node).at(cell) is not value:
            raise changed_trace()
        trigger, _ = self._triggered(node, cell)
        triggered = None if trigger is None else self.signal(trigger).run(cell)
        finding = self.explained(node, (cell, min(self.signal(node).run(cell)[1], end)), triggered, value)
        if value is not Truth.FALSE:
            return finding
        return replace(finding, decided=self._certain(finding.response, finding.trigger))

    def explained(
        self, node: int, interval: tuple[int, int], triggered: tuple[int, int] | None, value: Truth
    ) -> Finding:
        """The reasons why a node is false or undetermined, without the time at which that became certain.

        Args:
            stretch: the first and the last cell in which it is so.
            triggered: those in which the trigger is true, if the node has one.
        """
        cell, last = interval
        trigger, response = self._triggered(node, cell)
        cause = None if trigger is None else self.reason(trigger, cell, Truth.TRUE)
        reason = self.reason(node if response is None else response, cell, value)
        text = self.program.nodes[node].text
        return Finding(text, cell, last, cause, triggered, reason, _deadline(reason), None, tuple(_leaves(reason)))

    def reason(self, node: int, cell: int, value: Truth) -> TruthReason:
        """The reason for the value of a node in a cell. The value must be the one that it has."""
        program_node = self.program.nodes[node]
        parts, window = self._parts(program_node, cell, value)
        operands = tuple(self.program.nodes[operand].text for operand in program_node.operands)
        return TruthReason(node, program_node.text, program_node.kind, cell, value, window, tuple(parts), operands)

    def columns(self, reason: TruthReason) -> tuple[str, ...]:
        """The columns that the atoms within a subformula read, without those that count arrivals: their numbers are of
        the monitor's making."""
        seen: dict[str, None] = {}
        pending = [reason.node]
        while pending:
            node = self.program.nodes[pending.pop()]
            pending.extend(reversed(node.operands))
            if node.atom >= 0:
                atom = self.program.atoms[node.atom]
                for instruction in (*atom.left, *atom.right):
                    if instruction.operator is ValueOperator.COLUMN:
                        column = self.program.columns[int(instruction.operand)]
                        if topic_of(column) is None:
                            seen[column] = None
        return tuple(seen)

    # ---- the shape of the whole ----

    def _body(self, node: int, value: Truth) -> tuple[int, int, int]:
        """Goes from the whole down conjunctions and G to the first part with the value, its cell, and the end of the
        cells in which it counts."""
        cell = end = 0
        while True:
            current = self.program.nodes[node]
            if current.kind is NodeKind.AND:
                part = next(self._having(current.operands, cell, value), None)
                if part is None:
                    return node, cell, end
                node = part
            elif current.kind is NodeKind.ALWAYS:
                first, last = window_of(current, cell)
                found = self.signal(current.operands[0]).first(value, first, self.cells - 1 if last is None else last)
                if found is None:
                    return node, cell, end
                end = self.cells - 1 if (furthest := window_of(current, end)[1]) is None else furthest
                node, cell = current.operands[0], found
            else:
                return node, cell, end

    def _triggered(self, node: int, cell: int) -> tuple[int | None, int | None]:
        """The trigger and the response of ``trigger -> response``, where the trigger is true."""
        trigger = trigger_of(self.program, node)
        if trigger is None or self.signal(trigger).at(cell) is not Truth.TRUE:
            return None, None
        return trigger, self.program.nodes[node].operands[1]

    # ---- one step down ----

    def _parts(
        self, node: MonitorNode, cell: int, value: Truth
    ) -> tuple[list[TruthReason], tuple[int, int | None] | None]:
        operands = node.operands
        match node.kind:
            case NodeKind.NOT:
                return [self.reason(operands[0], cell, value.negated)], None
            case NodeKind.AND | NodeKind.OR:
                decisive = Truth.FALSE if node.kind is NodeKind.AND else Truth.TRUE
                same = self._having(operands, cell, value)
                chosen = islice(same, 1) if value is decisive else same
                return [self.reason(o, cell, value) for o in chosen], None
            case NodeKind.EVENTUALLY | NodeKind.ALWAYS | NodeKind.ONCE | NodeKind.HISTORICALLY:
                return self._window_parts(node, cell, value)
            case NodeKind.UNTIL:
                return self._until_parts(node, cell, value)
            case NodeKind.RISE | NodeKind.FALL:
                wanted = Truth.TRUE if node.kind is NodeKind.RISE else Truth.FALSE
                now = self.signal(operands[0]).at(cell)
                missing = value is Truth.FALSE and now is wanted.negated
                return ([self.reason(operands[0], cell, now)] if missing else []), None
            case _:
                return [], None

    def _window_parts(
        self, node: MonitorNode, cell: int, value: Truth
    ) -> tuple[list[TruthReason], tuple[int, int | None] | None]:
        """The operand where it is decisive: nowhere for an F that is false, at one instant for a G that is."""
        window = window_of(node, cell)
        universal = node.kind in (NodeKind.ALWAYS, NodeKind.HISTORICALLY)
        decisive = Truth.FALSE if universal else Truth.TRUE
        if value is not decisive and value is not Truth.UNDETERMINED:
            return [], window
        signal = self.signal(node.operands[0])
        end = self.cells - 1 if window[1] is None else window[1]
        ahead = node.kind in (NodeKind.ALWAYS, NodeKind.EVENTUALLY)
        found = signal.first(value, window[0], end) if ahead else signal.last(value, window[0], end)
        return ([] if found is None else [self.reason(node.operands[0], found, value)]), window

    def _until_parts(
        self, node: MonitorNode, cell: int, value: Truth
    ) -> tuple[list[TruthReason], tuple[int, int | None] | None]:
        """A false until: the left operand where it fails too early; nothing where the right one never came."""
        window = window_of(node, cell)
        left, right = node.operands
        end = self.cells - 1 if window[1] is None else window[1]
        match value:
            case Truth.TRUE:
                found = self.signal(right).first(Truth.TRUE, window[0], end)
                return ([] if found is None else [self.reason(right, found, Truth.TRUE)]), window
            case Truth.FALSE:
                broken = self.signal(left).first(Truth.FALSE, cell, end)
                return ([] if broken is None else [self.reason(left, broken, Truth.FALSE)]), window
            case _:
                return [], window

    def _certain(self, response: TruthReason, trigger: TruthReason | None) -> int | None:
        """The cell from which on the violation is certain."""
        reasons = [response] if trigger is None else [response, trigger]
        decided = max(self._decided(reason) for reason in reasons)
        last = self.cells - 1
        if decided >= last or not any(self._reaches_beyond(reason) for reason in reasons):
            return min(decided, last)
        return None if self.decide is None else min(2 * self.decide((decided + 1) // 2), last)

    def _decided(self, reason: TruthReason) -> int:
        """From which cell on nothing can change the value, unless it hangs on windows within windows."""
        if reason.parts:
            return max(reason.cell, *(self._decided(part) for part in reason.parts))
        if reason.window is not None and reason.kind in _AHEAD:
            return self.cells - 1 if reason.window[1] is None else reason.window[1]
        return reason.cell

    def _reaches_beyond(self, reason: TruthReason) -> bool:
        """True if operands that the reasons say nothing about look ahead of the window of their operator."""
        if reason.parts and reason.kind is not NodeKind.UNTIL:
            return any(self._reaches_beyond(part) for part in reason.parts)
        pending = list(self.program.nodes[reason.node].operands)
        while pending:
            node = self.program.nodes[pending.pop()]
            if node.kind in _AHEAD:
                return True
            pending += node.operands
        return False


def window_of(node: MonitorNode, cell: int) -> tuple[int, int | None]:
    """The cells that a temporal operator speaks about; see docs/logic.md for open bounds."""
    odd = cell % 2
    low = 2 * node.lower + (0 if odd or node.lower_closed else 1)
    high = None if node.upper == UNBOUNDED else 2 * node.upper - (0 if odd or node.upper_closed else 1)
    if node.kind in (NodeKind.ONCE, NodeKind.HISTORICALLY, NodeKind.SINCE):
        return (0 if high is None else max(cell - high, 0)), cell - low
    return cell + low, None if high is None else cell + high


def trigger_of(program: MonitorProgram, node: int) -> int | None:
    """The trigger, if a node has the form ``trigger -> response``."""
    current = program.nodes[node]
    if current.kind is not NodeKind.OR or len(current.operands) != 2:
        return None
    negated = program.nodes[current.operands[0]]
    return negated.operands[0] if negated.kind is NodeKind.NOT else None


def never_triggered(program: MonitorProgram) -> tuple[MonitorProgram, ...]:
    """For a formula ``G (trigger -> ...)``, or several of them, the formulas ``G !trigger``; if all of them are true,
    the formula is vacuously true."""
    return tuple(_triggers(program, len(program.nodes) - 1))


def _triggers(program: MonitorProgram, node: int) -> Iterator[MonitorProgram]:
    current = program.nodes[node]
    if current.kind is NodeKind.AND:
        for operand in current.operands:
            yield from _triggers(program, operand)
    elif current.kind is NodeKind.ALWAYS:
        if trigger_of(program, current.operands[0]) is not None:
            negated = program.nodes[current.operands[0]].operands[0]
            yield replace(program, nodes=(*program.nodes[: negated + 1], replace(current, operands=(negated,))))


def horizon(program: MonitorProgram) -> int:
    """The largest number of ticks that the bounded operators of a formula look ahead of an instant."""
    ahead: list[int] = []
    for node in program.nodes:
        reach = max((ahead[operand] for operand in node.operands), default=0)
        is_future = node.kind in _AHEAD
        ahead.append(reach + (max(node.upper, node.lower) if is_future else 0))
    return ahead[-1]


def memory(program: MonitorProgram) -> int:
    """The largest number of ticks that the bounded operators of a formula look back from an instant."""
    behind: list[int] = []
    for node in program.nodes:
        reach = max((behind[operand] for operand in node.operands), default=0)
        is_past = node.kind in (NodeKind.ONCE, NodeKind.HISTORICALLY, NodeKind.SINCE)
        behind.append(reach + (max(node.upper, node.lower) if is_past else 0))
    return behind[-1]


def _leaves(reason: TruthReason) -> Iterator[TruthReason]:
    if not reason.parts:
        yield reason
    for part in reason.parts:
        yield from _leaves(part)


def _deadline(reason: TruthReason) -> int | None:
    """The end of the outermost window that looks ahead."""
    if reason.kind in _AHEAD and reason.window is not None:
        return reason.window[1]
    deadlines = [deadline for part in reason.parts if (deadline := _deadline(part)) is not None]
    return max(deadlines, default=None)
