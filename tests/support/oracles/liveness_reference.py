"""The reference for obligations: zones in plain Python, told apart by equality alone.

Sound and complete for networks without stopwatches. Zones are widened as in `tests.support.oracles.reference`, which
adds only
valuations of regions that were there: with the constants of goal and trigger counted, a zone without the goal stays
without it, and what can happen, now or later, stays the same (Bouyer 2004).

Time diverges in a run with infinitely many transitions if infinitely many of them are *beats*: taken at least one time
unit after the last one. A clock beside those of the network measures that; it is not a part of the network.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from tachk.base.operators import BinaryOperator
from tachk.engine.options import Limits
from tachk.engine.outcome import LivenessOutcome, Obligation, RunEnd, Statistics
from tachk.meaning import dbm, symbolic
from tachk.meaning.avoidance import elapse_before, ends_in_deadlock, idles_for_ever
from tachk.meaning.clock_constants import ClockConstants, clock_constants
from tachk.meaning.dbm import Federation, Zone
from tachk.meaning.discrete import PreparedNetwork, prepare
from tachk.meaning.extrapolation import widen
from tachk.meaning.symbolic import Situation
from tachk.model.expressions import BOOL, Binary, Constant, Expression, Reference, Variable, VariableKind
from tachk.model.fault import EvaluationFault
from tachk.model.network import Network
from tachk.model.run import DiscreteState, RunTimeFault, Transition
from tachk.model.types import ClockType
from tests.support.oracles.avoiding_runs import Budget, Graph, LimitError, avoiding_run, build, outcome_of

Node = tuple[DiscreteState, Zone, bool]
"""``beat``: the transition to it was taken when the last one of that kind was at least one time unit ago."""


def check_by_zones(network: Network, obligation: Obligation, limits: Limits = Limits()) -> LivenessOutcome:
    """Exact. Raises ValueError for networks with stopwatches, and if the initial state violates an invariant."""
    if any(location.rates for process in network.processes for location in process.locations):
        raise ValueError("the past of a zone is not a zone where clocks stop")
    predicates = [e for e in (obligation.goal, obligation.trigger) if e is not None]
    since = None
    if obligation.diverges:
        network, clock = _with_clock(network)
        predicates.append(Binary(BinaryOperator.GREATER_EQUAL, Reference(clock), Constant(1), BOOL))
        since = prepare(network).dimension - 1
    graph = _Zones(prepare(network), obligation.goal, clock_constants(network, predicates), since)
    budget = Budget(limits)
    found, reason, fault = None, "", None
    try:
        starts = _starts(graph, obligation.trigger, budget)
        conditions = [_beats] if obligation.diverges else []
        found = avoiding_run(starts, graph.follow_avoiding, graph.end, budget, conditions)
    except LimitError as limit:
        reason = str(limit)
    except EvaluationFault as error:
        fault, reason = RunTimeFault(error.kind, error.span, (), None), "run-time error"
    statistics = Statistics(budget.nodes, budget.nodes, 0, time.monotonic() - budget.started)
    return outcome_of(found, statistics, reason, fault)


def _beats(_before: Node, transition: Transition | None, after: Node) -> bool:
    return transition is not None and after[2]


def _with_clock(network: Network) -> tuple[Network, Variable]:
    clock = Variable("time since the last beat", ClockType(), VariableKind.LOCAL, (0,))
    *others, last = network.processes
    last = replace(last, variables=(*last.variables, clock))
    return replace(network, processes=(*others, last)), clock


def _starts(graph: _Zones, trigger: Expression | None, budget: Budget) -> dict[Node, tuple[Transition, ...]]:
    """Where runs begin to avoid the goal, each with the way to it. Raises LimitError and EvaluationFault."""
    start, _ = symbolic.initial_situation(graph.model)
    zones = [z for z in [start.invariant and dbm.intersect(dbm.point(graph.model.layout.starts), start.invariant)] if z]
    if not zones:
        raise ValueError("the initial state violates an invariant")
    if trigger is None:
        return dict.fromkeys(graph.avoiding(start, zones), ())
    reached: Graph[Node] = build(graph.widened(start, symbolic.elapse(start, zones)), graph.follow, budget)
    starts: dict[Node, tuple[Transition, ...]] = {}
    for node in reached.came:
        here = graph.situation(node[0])
        met = symbolic.intersections([node[1]], symbolic.where(graph.model, here, trigger))
        for begun in graph.avoiding(here, met):
            starts.setdefault(begun, reached.way(node)[1])
    return starts


@dataclass(slots=True)
class _Zones:
    """The widened zones of a network, with and without those of a goal.

    Attributes:
        since: the number of the clock that says how long ago the last beat was; None where there are no beats.
    """

    model: PreparedNetwork
    goal: Expression
    constants: ClockConstants
    since: int | None = None
    situations: dict[DiscreteState, Situation] = field(default_factory=dict)
    goals: dict[DiscreteState, Federation] = field(default_factory=dict)
    endings: dict[DiscreteState, list[tuple[RunEnd, Federation]]] = field(default_factory=dict)

    def situation(self, discrete: DiscreteState) -> Situation:
        if discrete not in self.situations:
            self.situations[discrete] = symbolic.situation(self.model, discrete)
        return self.situations[discrete]

    def met(self, here: Situation) -> Federation:
        """Where the goal is true."""
        if here.discrete not in self.goals:
            self.goals[here.discrete] = symbolic.where(self.model, here, self.goal)
        return self.goals[here.discrete]

    def widened(self, here: Situation, zones: Federation, beat: bool = False) -> Iterator[Node]:
        return ((here.discrete, part, beat) for zone in zones for part in widen(self.constants, zone))

    def avoiding(self, here: Situation, zones: Federation, beat: bool = False) -> Iterator[Node]:
        """What is reached by letting time pass without meeting the goal."""
        goal = self.met(here)
        return self.widened(here, elapse_before(here, dbm.subtract_all(zones, goal), goal), beat)

    def follow(self, node: Node) -> Iterator[tuple[Transition | None, Node]]:
        for transition, there, fired, beat in self._fired(node):
            yield from ((transition, after) for after in self.widened(there, symbolic.elapse(there, fired), beat))

    def follow_avoiding(self, node: Node) -> Iterator[tuple[Transition | None, Node]]:
        for transition, there, fired, beat in self._fired(node):
            yield from ((transition, after) for after in self.avoiding(there, fired, beat))

    def _fired(self, node: Node) -> Iterator[tuple[Transition, Situation, Federation, bool]]:
        """What the moves lead to, before time passes, and whether with a beat. Raises EvaluationFault."""
        self._check_faults(node)
        here = self.situation(node[0])
        for zone, beat in self._by_beat(node[1]):
            for move in here.moves:
                fired = symbolic.fire(here, [zone], move)
                if fired:
                    assert move.target is not None
                    if beat and self.since is not None:
                        fired = [dbm.reset(part, self.since, 0) for part in fired]
                    yield move.transition, self.situation(move.target), fired, beat

    def _by_beat(self, zone: Zone) -> Iterator[tuple[Zone, bool]]:
        if self.since is None:
            yield zone, False
            return
        early = (self.since, 0, dbm.raw_bound(1, True))
        for constraint, beat in ((early, False), (dbm.complement(early), True)):
            part = dbm.constrain(zone, constraint)
            if part is not None:
                yield part, beat

    def _check_faults(self, node: Node) -> None:
        here, zones = self.situation(node[0]), [node[1]]
        for asked in here.faults:
            if symbolic.intersections(zones, asked.domain):
                raise asked.fault
        for move in here.moves:
            if move.fault is not None and symbolic.intersections(zones, move.domain):
                raise move.fault

    def end(self, node: Node) -> RunEnd | None:
        """How a run can end here, or go on by time alone, without the goal. Raises EvaluationFault."""
        self._check_faults(node)
        if node[0] not in self.endings:
            here = self.situation(node[0])
            goal = self.met(here)
            self.endings[node[0]] = [
                (RunEnd.IDLE, idles_for_ever(here, goal)),
                (RunEnd.STUCK, ends_in_deadlock(here, goal)),
            ]
        return next((kind for kind, where in self.endings[node[0]] if symbolic.intersections([node[1]], where)), None)
