"""The oracle for obligations that knows nothing of zones: one point of every region, and the steps between them.

The steps are transitions and delays into the next region. As regions are bisimilar (Alur and Dill 1994), a run without
the goal stays for ever in a circle of this finite graph, or ends where no step is left.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

from tachk.engines.avoiding_runs import Budget, Graph, LimitError, avoiding_run, build, outcome_of
from tachk.engines.digitised import delayed, region_steps
from tachk.engines.options import Limits
from tachk.engines.outcome import LivenessOutcome, Obligation, RunEnd, RunTimeFault, Statistics
from tachk.model.fault import EvaluationFault
from tachk.model.network import Network
from tachk.semantics.discrete import prepare
from tachk.semantics.step import StepError, initial_state, satisfies, successors
from tachk.semantics.timed_trace import TimedState, Transition


def check_by_regions(network: Network, obligation: Obligation, limits: Limits = Limits()) -> LivenessOutcome:
    """Exact. Raises ValueError for networks with stopwatches, and if the initial state violates an invariant."""
    model = prepare(network)
    predicates = [e for e in (obligation.goal, obligation.trigger) if e is not None]
    normalised, next_delay = region_steps(network, predicates)
    budget = Budget(limits)

    def normal(state: TimedState) -> TimedState:
        return replace(state, clocks=normalised(state.clocks), time=Fraction(0))

    def steps(state: TimedState) -> Iterator[tuple[Transition | None, TimedState]]:
        for transition, after in successors(model, state):
            yield transition, normal(after)
        duration = next_delay(state.clocks)
        # Behind all constants one more unit of time changes nothing, and may pass again.
        later = delayed(model, state, Fraction(1) if duration is None else duration)
        if later is not None:
            yield None, normal(later)

    def without_goal(state: TimedState) -> bool:
        return not satisfies(model, state, obligation.goal)

    def unmet(state: TimedState) -> list[tuple[Transition | None, TimedState]]:
        return [(transition, after) for transition, after in steps(state) if without_goal(after)]

    def ending(state: TimedState) -> RunEnd | None:
        return RunEnd.STUCK if next(steps(state), None) is None else None

    found, reason, fault = None, "", None
    try:
        try:
            start = normal(initial_state(model))
        except StepError as error:
            raise ValueError(str(error)) from error
        starts: dict[TimedState, tuple[Transition, ...]] = {start: ()} if obligation.trigger is None else {}
        if obligation.trigger is not None:
            trigger = obligation.trigger
            reached: Graph[TimedState] = build([start], steps, budget)
            starts = {s: reached.way(s)[1] for s in reached.came if satisfies(model, s, trigger)}
        found = avoiding_run({s: way for s, way in starts.items() if without_goal(s)}, unmet, ending, budget)
    except LimitError as limit:
        reason = str(limit)
    except EvaluationFault as error:
        fault, reason = RunTimeFault(error.kind, error.span, (), None), "run-time error"
    statistics = Statistics(budget.nodes, budget.nodes, 0, time.monotonic() - budget.started)
    return outcome_of(found, statistics, reason, fault)
