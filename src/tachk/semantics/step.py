"""The concrete semantics: what a network can do from one state with exact clock values.

A delay passes if all invariants hold along it, no current location is urgent or committed, and the guards of no
synchronisation over an urgent channel hold at any moment before its end. A transition is *possible* if its guards hold,
the committed rule admits it, a broadcast takes along every process that can receive, and the state after its updates
satisfies all invariants. It is *enabled* if no possible transition has a higher priority.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from fractions import Fraction

from tachk.model.evaluate import Environment, holds
from tachk.model.expressions import Expression
from tachk.model.fault import EvaluationFault
from tachk.semantics.constraints import disjunctive
from tachk.semantics.dbm import INFINITY, Constraint, bound_value
from tachk.semantics.discrete import (
    Model,
    combinations,
    environment,
    execute_updates,
    has_priorities,
    initial_discrete,
    is_urgent,
    may_delay,
    offers,
    priority,
    stopped_clocks,
)
from tachk.semantics.trace import DiscreteState, Participant, TimedState, Transition


class StepError(ValueError):
    """The network does not allow the step; the message says why."""


def initial_state(model: Model) -> TimedState:
    """The initial state. Raises StepError if it violates an invariant."""
    state = TimedState(initial_discrete(model), (Fraction(0),) * (model.dimension - 1), Fraction(0))
    if not satisfies_invariants(model, state):
        raise StepError("the initial state violates an invariant")
    return state


def satisfies_invariants(model: Model, state: TimedState) -> bool:
    scratch = environment(model, state.discrete, state.clocks)
    return all(holds(location.invariant, scratch) for location in model.current(state.discrete))


def _guarded_transitions(model: Model, state: TimedState) -> Iterator[Transition]:
    """The transitions whose guards hold and that the committed rule admits, in the order of processes and edges."""
    scratch = environment(model, state.discrete, state.clocks)
    offered = offers(model, scratch, lambda participant: holds(model.edge(participant).guard, scratch))
    return combinations(model, state.discrete, offered, may_abstain=lambda receivers: not receivers)


def possible(model: Model, state: TimedState) -> list[tuple[Transition, TimedState]]:
    """The possible transitions with the states behind them, whatever their priorities."""
    candidates = ((t, _successor(model, state, t)) for t in _guarded_transitions(model, state))
    return [(t, after) for t, after in candidates if satisfies_invariants(model, after)]


def successors(model: Model, state: TimedState) -> list[tuple[Transition, TimedState]]:
    """The enabled transitions, those of the highest priority, with the states behind them. Raises EvaluationFault."""
    found = possible(model, state)
    if not found or not has_priorities(model):
        return found
    highest = max(priority(model, state.discrete, t) for t, _ in found)
    return [(t, after) for t, after in found if priority(model, state.discrete, t) == highest]


def fire(model: Model, state: TimedState, transition: Transition) -> TimedState:
    """The state after an enabled transition. Raises StepError if it is not enabled, and EvaluationFault."""
    if transition not in _guarded_transitions(model, state):
        raise StepError("the transition is not enabled: a guard is false, or it is not a transition of this state")
    after = _successor(model, state, transition)
    if not satisfies_invariants(model, after):
        raise StepError("the transition is not enabled: it would violate an invariant")
    if has_priorities(model) and transition not in (t for t, _ in successors(model, state)):
        raise StepError("the transition is not enabled: one of higher priority is possible")
    return after


def _successor(model: Model, state: TimedState, transition: Transition) -> TimedState:
    discrete, resets = execute_updates(model, state.discrete, transition)
    clocks = tuple(Fraction(resets[n]) if n in resets else v for n, v in enumerate(state.clocks, start=1))
    return TimedState(discrete, clocks, state.time)


def delay(model: Model, state: TimedState, duration: Fraction) -> TimedState:
    """The state after a delay. Raises StepError if the delay cannot pass."""
    if duration < 0:
        raise StepError("a delay cannot be negative")
    if duration == 0:
        return state
    if not may_delay(model, state.discrete):
        raise StepError("time cannot pass in an urgent or committed location")
    after = _later(model, state, duration)
    # Invariants are conjunctions of difference constraints, hence convex: both ends are enough.
    if not satisfies_invariants(model, after):
        raise StepError("the delay violates an invariant")
    if any(type_.urgent for type_, _ in model.channels):
        for moment in _telling_moments(model, state, before=duration):
            if urgent(model, _later(model, state, moment)):
                raise StepError(f"a synchronisation over an urgent channel is enabled {moment} units into the delay")
    return after


def urgent(model: Model, state: TimedState) -> bool:
    """Whether the guards of a synchronisation over an urgent channel hold now."""
    return any(is_urgent(model, state.discrete, t) for t in _guarded_transitions(model, state))


def deadlocked(model: Model, state: TimedState) -> bool:
    """Whether no transition is possible, now or after any delay that can pass."""
    if possible(model, state):
        return False
    if not may_delay(model, state.discrete):
        return True
    for moment in _telling_moments(model, state, before=None):
        try:
            after = delay(model, state, moment)
        except StepError:
            return True
        if possible(model, after):
            return False
    return True


def satisfies(model: Model, state: TimedState, predicate: Expression) -> bool:
    """Whether a state predicate, which may ask for deadlock, is true. Raises EvaluationFault."""
    scratch = environment(model, state.discrete, state.clocks)
    scratch.deadlock = lambda: deadlocked(model, state)
    return holds(predicate, scratch)


def _later(model: Model, state: TimedState, duration: Fraction) -> TimedState:
    stopped = stopped_clocks(model, state.discrete)
    clocks = tuple(v if n in stopped else v + duration for n, v in enumerate(state.clocks, start=1))
    return replace(state, clocks=clocks, time=state.time + duration)


def _telling_moments(model: Model, state: TimedState, before: Fraction | None) -> list[Fraction]:
    """Moments in ``[0, before)`` such that whatever is possible in that time is possible at one of them.

    These are the moments when a clock constraint that matters changes its truth value, and one between any two of them.
    """
    stopped = stopped_clocks(model, state.discrete) | {0}
    changes = {Fraction(0)}
    point = (Fraction(0), *state.clocks)
    for i, j, raw in _constraints_in_sight(model, state.discrete):
        speed = (i not in stopped) - (j not in stopped)
        if speed and raw < INFINITY:
            moment = (bound_value(raw) - (point[i] - point[j])) / speed
            if moment >= 0 and (before is None or moment < before):
                changes.add(moment)
    ordered = sorted(changes)
    end = ordered[-1] + 2 if before is None else before
    between = [(a + b) / 2 for a, b in zip(ordered, [*ordered[1:], end], strict=True)]
    return sorted([*ordered, *between])


def _constraints_in_sight(model: Model, discrete: DiscreteState) -> Iterator[Constraint]:
    """The clock constraints of all guards, and of the invariants here and behind all transitions that values do not
    rule out."""
    scratch = environment(model, discrete)
    yield from _constraints(_invariants(model, discrete), scratch)
    in_guards: list[Constraint] = []

    def is_open(participant: Participant) -> bool:
        guard = disjunctive(model.edge(participant).guard, scratch)
        in_guards.extend(c for conjunction in guard for c in conjunction)
        return bool(guard)

    offered = offers(model, scratch, is_open)
    yield from in_guards
    for transition in combinations(model, discrete, offered, may_abstain=lambda receivers: True):
        try:
            target, _ = execute_updates(model, discrete, transition)
            constraints = list(_constraints(_invariants(model, target), environment(model, target)))
        except EvaluationFault:
            continue  # whoever tries the transition while its guard holds will meet the fault
        yield from constraints


def _invariants(model: Model, discrete: DiscreteState) -> Iterable[Expression | None]:
    return (location.invariant for location in model.current(discrete))


def _constraints(conditions: Iterable[Expression | None], scratch: Environment) -> Iterator[Constraint]:
    for condition in conditions:
        for conjunction in disjunctive(condition, scratch):
            yield from conjunction
