"""The oracle for obligations that knows nothing of zones: one point of every region, and the steps between them.

The steps are transitions and delays into the next region. As regions are bisimilar (Alur and Dill 1994), a run without
the goal stays for ever in a circle of this finite graph, or ends where no step is left. Time diverges in such a run if
time passes in the circle and each clock is set there or is beyond all constants ("progressive", ibid.).
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import partial

from tachk.engine.options import Limits
from tachk.engine.outcome import LivenessOutcome, Obligation, RunEnd, Statistics
from tachk.meaning.clock_constants import clock_constants
from tachk.meaning.discrete import PreparedNetwork, prepare
from tachk.meaning.step import StepError, initial_state, satisfies, successors
from tachk.model.expressions import Expression
from tachk.model.fault import EvaluationFault
from tachk.model.network import Network
from tachk.model.run import RunTimeFault, TimedState, Transition
from tests.support.oracles.avoiding_runs import Budget, Condition, Graph, LimitError, avoiding_run, build, outcome_of
from tests.support.oracles.digitised import Clocks, delayed, region_steps


def check_by_regions(network: Network, obligation: Obligation, limits: Limits = Limits()) -> LivenessOutcome:
    """Exact. Raises ValueError for networks with stopwatches, if the initial state violates an invariant, and, where
    only runs count in which time diverges, for clocks that are compared with each other."""
    regions = _regions(network, obligation)
    budget = Budget(limits)
    found, reason, fault = None, "", None
    try:
        try:
            start = regions.normal(initial_state(regions.model))
        except StepError as error:
            raise ValueError(str(error)) from error
        starts: dict[TimedState, tuple[Transition, ...]] = {start: ()} if obligation.trigger is None else {}
        if obligation.trigger is not None:
            trigger = obligation.trigger
            reached: Graph[TimedState] = build([start], regions.steps, budget)
            starts = {s: reached.way(s)[1] for s in reached.came if satisfies(regions.model, s, trigger)}
        unmet = {s: way for s, way in starts.items() if regions.without_goal(s)}
        conditions = regions.divergence() if obligation.diverges else []
        found = avoiding_run(unmet, regions.steps_without_goal, regions.ending, budget, conditions)
    except LimitError as limit:
        reason = str(limit)
    except EvaluationFault as error:
        fault, reason = RunTimeFault(error.kind, error.span, (), None), "run-time error"
    statistics = Statistics(budget.nodes, budget.nodes, 0, time.monotonic() - budget.started)
    return outcome_of(found, statistics, reason, fault)


def _regions(network: Network, obligation: Obligation) -> _Regions:
    predicates = [e for e in (obligation.goal, obligation.trigger) if e is not None]
    constants = clock_constants(network, predicates)
    if obligation.diverges and constants.diagonals:
        raise ValueError("which clocks keep time from diverging is not known where clocks are compared with each other")
    normalised, next_delay = region_steps(network, predicates)
    return _Regions(prepare(network), obligation.goal, normalised, next_delay, tuple(constants.maximum[1:]))


@dataclass(frozen=True, slots=True)
class _Regions:
    """``largest``: what each clock is compared with at most."""

    model: PreparedNetwork
    goal: Expression
    normalised: Callable[[Clocks], Clocks]
    next_delay: Callable[[Clocks], Fraction | None]
    largest: tuple[int, ...]

    def normal(self, state: TimedState) -> TimedState:
        return replace(state, clocks=self.normalised(state.clocks), time=Fraction(0))

    def steps(self, state: TimedState) -> Iterator[tuple[Transition | None, TimedState]]:
        for transition, after in successors(self.model, state):
            yield transition, self.normal(after)
        duration = self.next_delay(state.clocks)
        # Behind all constants one more unit of time changes nothing, and may pass again.
        later = delayed(self.model, state, Fraction(1) if duration is None else duration)
        if later is not None:
            yield None, self.normal(later)

    def without_goal(self, state: TimedState) -> bool:
        return not satisfies(self.model, state, self.goal)

    def steps_without_goal(self, state: TimedState) -> list[tuple[Transition | None, TimedState]]:
        return [(transition, after) for transition, after in self.steps(state) if self.without_goal(after)]

    def ending(self, state: TimedState) -> RunEnd | None:
        return RunEnd.STUCK if next(self.steps(state), None) is None else None

    def divergence(self) -> list[Condition[TimedState]]:
        """What a circle must meet in which time may diverge: time passes, and nothing keeps any clock below a bound."""

        def passes_time(_before: TimedState, transition: Transition | None, _after: TimedState) -> bool:
            return transition is None

        return [passes_time, *(partial(self._frees, clock) for clock in range(len(self.largest)))]

    def _frees(self, clock: int, before: TimedState, transition: Transition | None, after: TimedState) -> bool:
        """Whether a step sets a clock, or the clock is beyond all that it is compared with."""
        if before.clocks[clock] > self.largest[clock]:
            return True
        return transition is not None and any(
            there.clocks[clock] != before.clocks[clock]
            for fired, there in successors(self.model, before)
            if fired == transition and self.normal(there) == after
        )
