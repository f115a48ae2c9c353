"""The zone graph of a network, node by node: for looking at, not for speed.

Nodes are symbolic states: a discrete state with the zone of clock values after any delay that is possible there,
widened by the largest constants so that there are finitely many. Other than the engines, nodes are not left out where
another one covers them: what can follow what stays visible, cycles too.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass

from tachk.meaning import symbolic
from tachk.meaning.clock_constants import clock_constants
from tachk.meaning.dbm import Zone
from tachk.meaning.discrete import prepare
from tachk.meaning.extrapolation import widen
from tachk.model.fault import EvaluationFault
from tachk.model.network import Network
from tachk.model.run import DiscreteState, Transition


@dataclass(frozen=True, slots=True)
class ZoneGraph:
    """Attributes:
    nodes: in the order in which breadth-first search meets them; the first ones are initial.
    initial: how many of them.
    edges: node, transition, node.
    reason: why the graph is not the whole one: ``"state limit"``, ``"run-time error"``; empty if it is.
    exact: False where clocks stop: then there are nodes that no run reaches.
    """

    nodes: tuple[tuple[DiscreteState, Zone], ...]
    initial: int
    edges: tuple[tuple[int, Transition, int], ...]
    reason: str = ""
    exact: bool = True


def zone_graph(network: Network, limit: int) -> ZoneGraph:
    """Explores breadth first.

    Args:
        limit: of the number of nodes; those at the limit are there, without what follows them.

    Raises ValueError if the initial state violates an invariant.
    """
    model = prepare(network)
    constants = clock_constants(network, ())
    start, zones = symbolic.initial_situation(model)
    if not zones:
        raise ValueError("the initial state violates an invariant")
    situations = {start.discrete: start}
    numbers: dict[tuple[DiscreteState, Zone], int] = {}
    edges: dict[tuple[int, Transition, int], None] = {}
    waiting: deque[tuple[DiscreteState, Zone]] = deque()
    reason, exact = "", True

    def add(discrete: DiscreteState, found: Iterable[Zone]) -> list[int]:
        nonlocal reason
        met = []
        for zone in (wide for each in found for wide in widen(constants, each)):
            node = discrete, zone
            if node not in numbers:
                if len(numbers) >= limit:
                    reason = reason or "state limit"
                    continue
                numbers[node] = len(numbers)
                waiting.append(node)
            met.append(numbers[node])
        return met

    initial = len(add(start.discrete, zones))
    while waiting:
        node = waiting.popleft()
        here = situations[node[0]]
        exact = exact and not here.stopped
        if any(symbolic.intersections([node[1]], possible_fault.domain) for possible_fault in here.faults):
            reason = "run-time error"
        for move in here.moves:
            fired = symbolic.fire(here, [node[1]], move)
            if not fired:
                continue
            target = move.target
            if target is None:
                reason = "run-time error"
                continue
            if target not in situations:
                try:
                    situations[target] = symbolic.situation(model, target)
                except EvaluationFault:
                    reason = "run-time error"
                    continue
            for number in add(target, symbolic.elapse(situations[target], fired)):
                edges[numbers[node], move.transition, number] = None
    return ZoneGraph(tuple(numbers), initial, tuple(edges), reason, exact)
