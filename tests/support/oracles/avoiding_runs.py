"""How the oracles look for runs that never meet a goal: build the whole graph of the states without it, then judge.

A run that avoids the goal for ever ends somewhere in this finite graph, or stays in one of its circles. Circles are
found by taking away, as long as there are any, the nodes from which nothing is left to go to.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Generic, TypeVar

from tachk.engine.options import Limits
from tachk.engine.outcome import AvoidingRun, LivenessOutcome, LivenessStatus, RunEnd, Statistics
from tachk.model.run import RunTimeFault, Transition

Node = TypeVar("Node")

Condition = Callable[[Node, Transition | None, Node], bool]
"""Whether a step from one node to another is one of those looked for."""


class LimitError(Exception):
    """A limit ended the construction; the message is the reason for outcomes."""


@dataclass(slots=True)
class Budget:
    """What a construction may still use."""

    limits: Limits
    started: float = field(default_factory=time.monotonic)
    nodes: int = 0

    def spend(self) -> None:
        """Pays for one node. Raises LimitError."""
        self.nodes += 1
        if self.limits.states is not None and self.nodes > self.limits.states:
            raise LimitError("state limit")
        if self.limits.seconds is not None and time.monotonic() - self.started > self.limits.seconds:
            raise LimitError("time limit")


@dataclass(slots=True)
class Graph(Generic[Node]):
    """Attributes:
    came: how each node was reached first: from where, and by which transition (None: time passed); a root from itself.
    steps: what follows each node.
    """

    came: dict[Node, tuple[Node, Transition | None]]
    steps: dict[Node, list[tuple[Transition | None, Node]]]

    def way(self, node: Node) -> tuple[Node, tuple[Transition, ...]]:
        """The root from which a node was reached, and the transitions from there."""
        taken: list[Transition] = []
        while True:
            before, transition = self.came[node]
            if transition is not None:
                taken.append(transition)
            if before == node:
                return node, tuple(reversed(taken))
            node = before

    def circle_of(self, conditions: Sequence[Condition[Node]]) -> list[tuple[Transition | None, Node]]:
        """Steps that lead round a circle and meet each of the conditions, the last one to where the first one starts;
        empty if there is none."""
        for component in _components(self.steps):
            inner = {node: [step for step in self.steps[node] if step[1] in component] for node in component}
            meeting = [
                [(node, step) for node, steps in inner.items() for step in steps if condition(node, *step)]
                for condition in conditions
            ]
            if all(meeting):
                start = node = meeting[0][0][0]
                walked: list[tuple[Transition | None, Node]] = []
                for found in meeting:
                    before, step = found[0]
                    walked += [*_walk(inner, node, before), step]
                    node = step[1]
                return [*walked, *_walk(inner, node, start)]
        return []

    def circle(self) -> list[tuple[Transition | None, Node]]:
        """Steps that lead round a circle, the last one to where the first one starts; empty if there is none."""
        left = _with_endless_ways(self.steps)
        if not left:
            return []
        visited: dict[Node, int] = {}
        walked: list[tuple[Transition | None, Node]] = []
        node = next(iter(left))
        while node not in visited:
            visited[node] = len(walked)
            walked.append(next(step for step in self.steps[node] if step[1] in left))
            node = walked[-1][1]
        return walked[visited[node] :]


def build(
    roots: Iterable[Node],
    follow: Callable[[Node], Iterable[tuple[Transition | None, Node]]],
    budget: Budget,
    stop: Callable[[Node], bool] = lambda node: False,
) -> Graph[Node]:
    """Everything that follows from the roots, breadth first, or as far as a node to stop at, which is then the last to
    arrive. Raises LimitError."""
    graph: Graph[Node] = Graph({}, {})
    waiting: deque[Node] = deque()

    def arrive(node: Node, before: Node, transition: Transition | None) -> bool:
        if node in graph.came:
            return False
        budget.spend()
        graph.came[node] = before, transition
        waiting.append(node)
        return stop(node)

    for root in roots:
        if arrive(root, root, None):
            return graph
    while waiting:
        node = waiting.popleft()
        following = graph.steps[node] = list(follow(node))
        for transition, after in following:
            if arrive(after, node, transition):
                return graph
    return graph


def avoiding_run(
    starts: Mapping[Node, tuple[Transition, ...]],
    follow: Callable[[Node], Iterable[tuple[Transition | None, Node]]],
    ending: Callable[[Node], RunEnd | None],
    budget: Budget,
    conditions: Sequence[Condition[Node]] = (),
) -> AvoidingRun | None:
    """A run from one of the starts, each given with the way to it, that goes on for ever or comes to an ending.

    Args:
        follow: the steps from a node that do not meet the goal. A circle of them in which no transition fires has to
            let time diverge.
        ending: how a run can end in a node without meeting the goal.
        conditions: what a run has to meet again and again that goes on for ever.

    Raises LimitError.
    """
    graph = build(starts, follow, budget, lambda node: ending(node) is not None)
    last = next(reversed(graph.came), None)
    found = None if last is None else ending(last)
    if last is not None and found is not None:
        root, way = graph.way(last)
        return AvoidingRun(found, (*starts[root], *way), len(starts[root]))
    circle = graph.circle_of(conditions) if conditions else graph.circle()
    if not circle:
        return None
    root, way = graph.way(circle[-1][1])
    loop = tuple(transition for transition, _ in circle if transition is not None)
    return AvoidingRun(RunEnd.LOOP if loop else RunEnd.IDLE, (*starts[root], *way), len(starts[root]), loop)


def _walk(
    steps: Mapping[Node, list[tuple[Transition | None, Node]]], start: Node, end: Node
) -> list[tuple[Transition | None, Node]]:
    """The fewest steps from one node to another that can be reached."""
    came: dict[Node, tuple[Node, tuple[Transition | None, Node]]] = {}
    waiting, seen = deque([start]), {start}
    while end not in seen:
        node = waiting.popleft()
        for step in steps[node]:
            if step[1] not in seen:
                seen.add(step[1])
                came[step[1]] = node, step
                waiting.append(step[1])
    walked = []
    while end != start:
        end, step = came[end]
        walked.append(step)
    return walked[::-1]


def _components(steps: Mapping[Node, list[tuple[Transition | None, Node]]]) -> Iterator[set[Node]]:
    """The strongly connected components, by S. R. Kosaraju's two searches."""
    before: dict[Node, list[Node]] = {node: [] for node in steps}
    for node, following in steps.items():
        for _, after in following:
            before[after].append(node)
    finished: list[Node] = []
    seen: set[Node] = set()
    for root in steps:
        if root in seen:
            continue
        seen.add(root)
        path = [(root, iter(steps[root]))]
        while path:
            node, rest = path[-1]
            fresh = next((after for _, after in rest if after not in seen), None)
            if fresh is None:
                finished.append(node)
                path.pop()
            else:
                seen.add(fresh)
                path.append((fresh, iter(steps[fresh])))
    placed: set[Node] = set()
    for root in reversed(finished):
        if root in placed:
            continue
        placed.add(root)
        component, waiting = {root}, [root]
        while waiting:
            for node in before[waiting.pop()]:
                if node not in placed:
                    placed.add(node)
                    component.add(node)
                    waiting.append(node)
        yield component


def _with_endless_ways(steps: Mapping[Node, list[tuple[Transition | None, Node]]]) -> dict[Node, int]:
    """The nodes from which one can walk for ever, in the order of arrival."""
    ahead = {node: len(following) for node, following in steps.items()}
    before: dict[Node, list[Node]] = {node: [] for node in steps}
    for node, following in steps.items():
        for _, after in following:
            before[after].append(node)
    ended = [node for node, count in ahead.items() if count == 0]
    while ended:
        gone = ended.pop()
        del ahead[gone]
        for node in before[gone]:
            ahead[node] -= 1
            if ahead[node] == 0:
                ended.append(node)
    return ahead


def outcome_of(
    run: AvoidingRun | None, statistics: Statistics, reason: str, fault: RunTimeFault | None
) -> LivenessOutcome:
    status = LivenessStatus.FOUND if run is not None else LivenessStatus.UNDECIDED if reason else LivenessStatus.NONE
    return LivenessOutcome(status, statistics, run, reason, fault)
