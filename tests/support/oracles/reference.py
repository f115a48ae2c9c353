"""The reference explorer: a breadth-first zone graph in plain Python, slow and obvious, interpreting the Network.

Sound and complete for networks without stopwatches. Zones are widened by ExtraM with the largest constant of each clock
in the whole model, which keeps every valuation region-equivalent to a reached one and so preserves priorities, urgency
and deadlock (Bouyer 2004; Behrmann et al. 2006). Where clocks are compared with each other, a zone is first split along
these comparisons, and each part stays on its side of them (Bengtsson and Yi 2003).
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Iterable, Sequence

from tachk.base.records import dataclass, field
from tachk.engine.options import Limits
from tachk.engine.outcome import GoalOutcome, Outcome, Statistics, Status
from tachk.meaning import dbm, symbolic
from tachk.meaning.clock_constants import ClockConstants, clock_constants
from tachk.meaning.dbm import Federation, Zone
from tachk.meaning.discrete import PreparedNetwork, prepare
from tachk.meaning.extrapolation import widen
from tachk.meaning.symbolic import Move, Situation
from tachk.model.expressions import Expression
from tachk.model.fault import EvaluationFault
from tachk.model.network import Network
from tachk.model.run import DiscreteState, RunTimeFault, Transition


@dataclass(eq=False, slots=True)
class _Node:
    situation: Situation
    zone: Zone
    depth: int
    parent: _Node | None
    transition: Transition | None
    covered: bool = False

    def path(self) -> tuple[Transition, ...]:
        before = () if self.parent is None else self.parent.path()
        return before if self.transition is None else (*before, self.transition)


@dataclass(slots=True)
class _Search:
    model: PreparedNetwork
    goals: Sequence[Expression]
    limits: Limits
    constants: ClockConstants
    passed: dict[DiscreteState, list[_Node]] = field(default_factory=dict)
    situations: dict[DiscreteState, Situation] = field(default_factory=dict)
    waiting: deque[_Node] = field(default_factory=deque)
    found: dict[int, tuple[Transition, ...]] = field(default_factory=dict)
    explored: int = 0
    stored: int = 0
    transitions: int = 0
    exact: bool = True


def explore(network: Network, goals: Sequence[Expression], limits: Limits = Limits()) -> Outcome:
    """Searches until every goal is reached or everything is explored.

    ``limits.states`` also bounds how many states are explored: of a chain of zones each of which covers the one before,
    only one is stored at any time. ``limits.memory_bytes`` is not looked at.

    Raises ValueError if the initial state violates an invariant.
    """
    model = prepare(network)
    search = _Search(model, goals, limits, clock_constants(network, goals))
    started = time.monotonic()
    fault: RunTimeFault | None = None
    node: _Node | None = None
    move: Move | None = None
    reason = ""
    try:
        start, zones = symbolic.initial_situation(model)
        if not zones:
            raise ValueError("the initial state violates an invariant")
        search.situations[start.discrete] = start
        _add(search, start, zones, None, None)
        while search.waiting and len(search.found) < len(goals):
            node = search.waiting.popleft()
            if node.covered:
                continue
            if limits.depth is not None and node.depth >= limits.depth:
                reason = "depth limit"
                continue
            search.explored += 1
            for asked in node.situation.faults:
                if symbolic.intersections([node.zone], asked.domain):
                    raise asked.fault
            for move in node.situation.moves:
                # Updates are evaluated where the guards hold, whatever has priority.
                if move.fault is not None and symbolic.intersections([node.zone], move.domain):
                    raise move.fault
            for move in node.situation.moves:
                _follow(search, node, move)
            move = None
            limit = _limit_hit(search, limits, started)
            if limit:
                reason = limit
                break
    except EvaluationFault as error:
        path = () if node is None else node.path()
        fault = RunTimeFault(error.kind, error.span, path, None if move is None else move.transition)
        reason = "run-time error"
    if len(search.found) == len(goals) and fault is None:
        reason = ""
    open_status = Status.UNDECIDED if reason else Status.UNREACHABLE
    return Outcome(
        tuple(
            GoalOutcome(Status.REACHED, search.found[g]) if g in search.found else GoalOutcome(open_status)
            for g in range(len(goals))
        ),
        Statistics(search.explored, search.stored, search.transitions, time.monotonic() - started),
        reason,
        fault,
        search.exact,
    )


def _limit_hit(search: _Search, limits: Limits, started: float) -> str:
    """Which limit ends the search; empty if none does."""
    if limits.states is not None and max(search.stored, search.explored) > limits.states:
        return "state limit"
    if limits.seconds is not None and time.monotonic() - started > limits.seconds:
        return "time limit"
    return ""


def _follow(search: _Search, node: _Node, move: Move) -> None:
    fired = symbolic.fire(node.situation, [node.zone], move)
    if not fired:
        return
    assert move.target is not None
    there = search.situations.get(move.target)
    if there is None:
        there = symbolic.situation(search.model, move.target)
        search.situations[move.target] = there
    search.transitions += 1
    _add(search, there, symbolic.elapse(there, fired), node, move.transition)


def _add(
    search: _Search, there: Situation, zones: Iterable[Zone], parent: _Node | None, transition: Transition | None
) -> None:
    search.exact = search.exact and not there.stopped
    depth = 0 if parent is None else parent.depth + 1
    for zone in (widened for exact in zones for widened in widen(search.constants, exact)):
        known = search.passed.setdefault(there.discrete, [])
        if any(dbm.includes(other.zone, zone) for other in known):
            continue
        for other in known:
            other.covered = dbm.includes(zone, other.zone)
        kept = [other for other in known if not other.covered]
        search.stored += 1 + len(kept) - len(known)
        node = _Node(there, zone, depth, parent, transition)
        search.passed[there.discrete] = [*kept, node]
        search.waiting.append(node)
        _look(search, node)


def _look(search: _Search, node: _Node) -> None:
    for number, goal in enumerate(search.goals):
        if number not in search.found:
            hits: Federation = symbolic.where(search.model, node.situation, goal)
            if symbolic.intersections([node.zone], hits):
                search.found[number] = node.path()
