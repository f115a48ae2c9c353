"""All violations of formulas on a trace that grows, those of each part in the order of time."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from tachk.recordings.traces.monitor_group import open_group
from tachk.recordings.traces.monitor_program import MonitorNode, MonitorProgram, NodeKind
from tachk.recordings.traces.trace import Ticks
from tachk.recordings.traces.violations import DemandedNode, obligations


@dataclass(frozen=True, slots=True)
class ViolationChange:
    """A violation has become known, or has ended.

    Attributes:
        formula: its number.
        part: the text of what has to be true.
        first: the first cell without it.
        end: the cell behind the last one; None: it goes on.
    """

    formula: int
    part: str
    first: int
    end: int | None


@dataclass(frozen=True, slots=True)
class _WatchedConjunct:
    formula: int
    text: str
    demand: DemandedNode


class ViolationWatch:
    """Watches each condition that must always be true by itself, so that it goes on where the verdict is decided.

    A violation is reported when all before it is decided. The rows are those of a `Monitor`, which has checked them.
    Memory is bounded as that of the monitor is, if the violations are taken.
    """

    def __init__(
        self,
        programs: Sequence[MonitorProgram],
        columns: Sequence[str],
        *,
        decimals: int,
        parts: int,
        exact: Callable[[Any], int],
    ) -> None:
        """Args: see `open_group`."""
        found = [
            (_WatchedConjunct(number, program.nodes[demand.node].text, demand), _always(program, demand.node))
            for number, program in enumerate(programs)
            for demand in obligations(program)
        ]
        self._parts = [part for part, _ in found]
        self._reported: list[int | None] = [None] * len(found)
        self._group = open_group(
            [program for _, program in found],
            columns,
            all_violations=True,
            decimals=decimals,
            parts=parts,
            exact=exact,
        )
        self.update = self._group.update
        self.advance = self._group.advance
        self.finish = self._group.finish

    def push(self, times: Ticks, columns: Mapping[str, Any], factor: int) -> None:
        self._group.push(times, columns, factor)

    def take(self) -> Iterator[ViolationChange]:
        """The news since the last call: violations that begin, and those that end."""
        for number, part in enumerate(self._parts):
            for begin, behind in self._group.take_violations(number):
                first = max(begin, part.demand.first)
                end = behind if part.demand.last is None else min(behind, part.demand.last + 1)
                if first < end:
                    yield from self._begins(number, first)
                    yield ViolationChange(part.formula, part.text, first, end)
                self._reported[number] = None
            since = self._group.violated_since(number)
            if since is not None and since >= part.demand.first:
                if part.demand.last is None or since <= part.demand.last:
                    yield from self._begins(number, since)

    def _begins(self, number: int, first: int) -> Iterator[ViolationChange]:
        if self._reported[number] != first:
            self._reported[number] = first
            yield ViolationChange(self._parts[number].formula, self._parts[number].text, first, None)


def _always(program: MonitorProgram, node: int) -> MonitorProgram:
    """The program that a node is true at every instant."""
    nodes = (*program.nodes[: node + 1], MonitorNode(NodeKind.ALWAYS, (node,), text=f"G ({program.nodes[node].text})"))
    return replace(program, nodes=nodes)
