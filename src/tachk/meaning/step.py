"""The concrete semantics: what a network can do from one state with exact clock values.

A delay passes if all invariants hold along it, no current location is urgent or committed, and the guards of no
synchronisation over an urgent channel hold at any moment before its end. A transition is *possible* if its guards hold,
the committed rule admits it, a broadcast takes along every process that can receive, and the state after its updates
satisfies all invariants. It is *enabled* if no possible transition has a higher priority.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from fractions import Fraction
from functools import partial
from math import lcm
from operator import contains

from tachk.base.operators import BinaryOperator, UnaryOperator
from tachk.base.records import dataclass, replace
from tachk.meaning.comparisons import comparisons
from tachk.meaning.constraints import Disjunction, conditional_constraints, satisfied
from tachk.meaning.dbm import INFINITY, ClockValues, Constraint, bound_value
from tachk.meaning.discrete import (
    PreparedNetwork,
    bind_selects,
    channel_named,
    clocks_after,
    enabled_receivers,
    environment,
    execute_updates,
    initial_clocks,
    initial_discrete,
    initiators,
    is_admitted,
    is_urgent,
    may_be_urgent,
    may_delay,
    priority,
    stopped_clocks,
    transitions_with,
)
from tachk.meaning.memory import by_state
from tachk.meaning.residual import Residual, residual
from tachk.model.evaluate import Environment, holds
from tachk.model.expressions import Binary, Expression, Unary
from tachk.model.fault import EvaluationFault
from tachk.model.run import DiscreteState, Participant, TimedState, Transition
from tachk.model.traversal import depends_on_clocks


class StepError(ValueError):
    """The network does not allow the step; the message says why."""


def initial_state(model: PreparedNetwork) -> TimedState:
    """The initial state. Raises StepError if it violates an invariant."""
    state = TimedState(initial_discrete(model), initial_clocks(model), Fraction(0))
    if not satisfies_invariants(model, state):
        raise StepError("the initial state violates an invariant")
    return state


def satisfies_invariants(model: PreparedNetwork, state: TimedState) -> bool:
    """True if all invariants hold; none is evaluated after a false one. Raises EvaluationFault."""
    requirements, wrong = _relevant_invariants(model, state.discrete)
    if not all(_holds_at(model, state, requirement) for requirement in requirements):
        return False
    return wrong is None or satisfies_invariant(model, state, wrong)


@by_state
def _relevant_invariants(
    model: PreparedNetwork, discrete: DiscreteState
) -> tuple[tuple[_StepRequirement, ...], int | None]:
    """The invariants that are not true whatever the clocks, up to one that is false or goes wrong, and that process."""
    found: list[_StepRequirement] = []
    for process in range(len(discrete.locations)):
        try:
            requirement = _invariant_requirement(model, discrete, process)
        except EvaluationFault:
            return tuple(found), process
        if not requirement.constraints:
            return tuple(found), process
        if requirement.of_clocks:
            found.append(requirement)
    return tuple(found), None


def satisfies_invariant(model: PreparedNetwork, state: TimedState, process: int) -> bool:
    """True if the invariant of a process's location holds. Raises EvaluationFault."""
    return _holds_at(model, state, _invariant_requirement(model, state.discrete, process))


@dataclass(frozen=True, slots=True)
class _StepRequirement:
    """The requirement of a guard or an invariant in a discrete state.

    Attributes:
        condition: None: nothing.
        of: whose guard it is.
        constraints: the constraints of the condition on the clocks.
        of_clocks: the condition compares clocks.
        residual: the condition as a function of the clocks, if it has a simple form.
    """

    condition: Expression | None
    of: Participant | None
    constraints: Disjunction
    of_clocks: bool
    residual: Residual | None


@by_state
def _invariant_requirement(model: PreparedNetwork, discrete: DiscreteState, process: int) -> _StepRequirement:
    return _requirement(model, discrete, model.current(discrete)[process].invariant, None)


@by_state
def _guard_requirement(model: PreparedNetwork, discrete: DiscreteState, participant: Participant) -> _StepRequirement:
    return _requirement(model, discrete, model.edge(participant).guard, participant)


def _requirement(
    model: PreparedNetwork, discrete: DiscreteState, condition: Expression | None, of: Participant | None
) -> _StepRequirement:
    scratch = environment(model, discrete)
    if of is not None:
        bind_selects(model, of, scratch)
    found = conditional_constraints(condition, scratch)
    if condition is None or not depends_on_clocks(condition):
        return _StepRequirement(condition, of, found, False, None)
    return _StepRequirement(condition, of, found, True, residual(condition, scratch))


def _holds_at(model: PreparedNetwork, state: TimedState, requirement: _StepRequirement) -> bool:
    """True if a guard or an invariant holds, evaluated as docs/semantics.md says. Raises EvaluationFault.

    The rule says what goes wrong, and what is false whatever the clocks; the evaluator, which knows nothing of
    constraints, says what holds, unless it meets in the order of the text what the rule does not ask.
    """
    if requirement.condition is None or not requirement.constraints or not requirement.of_clocks:
        return bool(requirement.constraints)
    if requirement.residual is not None:
        return requirement.residual(state.clocks)
    scratch = environment(model, state.discrete, state.clocks)
    if requirement.of is not None:
        bind_selects(model, requirement.of, scratch)
    try:
        return holds(requirement.condition, scratch)
    except EvaluationFault:
        return satisfied(requirement.constraints, state.clocks)


def is_open(model: PreparedNetwork, state: TimedState, participant: Participant) -> bool:
    """True if the guard of an edge holds. Raises EvaluationFault."""
    return _holds_at(model, state, _guard_requirement(model, state.discrete, participant))


@by_state
def _channel(model: PreparedNetwork, discrete: DiscreteState, participant: Participant) -> int | None:
    scratch = environment(model, discrete)
    bind_selects(model, participant, scratch)
    return channel_named(model, participant, scratch)


@by_state
def _open_to_receive(
    model: PreparedNetwork, discrete: DiscreteState, first: Participant, channel: int
) -> tuple[tuple[tuple[Participant, _StepRequirement], ...], ...]:
    """For each process that has some, the receiving edges whose guards are not false whatever the clocks, and these.

    Raises EvaluationFault.
    """
    of_processes = (
        tuple((p, guard) for p in of_process if (guard := _guard_requirement(model, discrete, p)).constraints)
        for of_process in enabled_receivers(model, discrete, first, channel)
    )
    return tuple(filter(None, of_processes))


@by_state
def possible_receivers(model: PreparedNetwork, discrete: DiscreteState, first: Participant) -> frozenset[int]:
    """The processes that have to receive the broadcast that an edge begins, for some values of clocks; none if it
    begins no broadcast.

    Raises EvaluationFault.
    """
    channel = _channel(model, discrete, first)
    if channel is None or not model.channels[channel][0].broadcast:
        return frozenset()
    of_processes = _open_to_receive(model, discrete, first, channel)
    return frozenset(participant.process for of_process in of_processes for participant, _ in of_process)


def _receiving(model: PreparedNetwork, state: TimedState, first: Participant, channel: int) -> list[list[Participant]]:
    """For each process that has some, the edges that can receive now. Raises EvaluationFault."""
    of_processes = (
        [
            p
            for p, guard in of_process
            if _holds_at(model, state, guard) and _channel(model, state.discrete, p) == channel
        ]
        for of_process in _open_to_receive(model, state.discrete, first, channel)
    )
    return list(filter(None, of_processes))


def _guarded_transitions(model: PreparedNetwork, state: TimedState) -> Iterator[Transition]:
    """The transitions whose guards hold and that the committed rule admits, in the order of processes and edges."""
    for first in initiators(model, state.discrete):
        if is_open(model, state, first):
            yield from begun_by(model, state, first)


def begun_by(model: PreparedNetwork, state: TimedState, first: Participant) -> Iterator[Transition]:
    """The transitions that an edge begins whose guard holds. Raises EvaluationFault."""
    channel = _channel(model, state.discrete, first)
    if channel is None:
        yield Transition((first,))
        return
    receiving = _receiving(model, state, first, channel)
    yield from transitions_with(model, state.discrete, first, channel, receiving, may_abstain=lambda _: False)


def _is_guarded(model: PreparedNetwork, state: TimedState, transition: Transition) -> bool:
    """True if the guards of one transition hold and the committed rule admits it; nothing else is evaluated."""
    first, *others = transition.participants
    if not _may_begin(model, state.discrete, first) or not is_open(model, state, first):
        return False
    channel = _channel(model, state.discrete, first)
    if channel is None:
        return not others
    if not model.channels[channel][0].broadcast:
        return len(others) == 1 and _can_receive(model, state, first, others[0], channel)
    receiving = _receiving(model, state, first, channel)
    takes_part = len(others) == len(receiving) and all(map(contains, receiving, others))
    return takes_part and is_admitted(model, state.discrete, transition)


@by_state
def _may_begin(model: PreparedNetwork, discrete: DiscreteState, participant: Participant) -> bool:
    return participant in initiators(model, discrete)


def _can_receive(
    model: PreparedNetwork, state: TimedState, first: Participant, receiver: Participant, channel: int
) -> bool:
    """True if an edge can receive what another one sends; the guards of no others are evaluated."""
    audience = (p for of_process in enabled_receivers(model, state.discrete, first, channel) for p in of_process)
    return (
        receiver in audience
        and is_open(model, state, receiver)
        and _channel(model, state.discrete, receiver) == channel
    )


def possible(model: PreparedNetwork, state: TimedState) -> list[tuple[Transition, TimedState]]:
    """The possible transitions with the states behind them, whatever their priorities."""
    candidates = ((t, _successor(model, state, t)) for t in _guarded_transitions(model, state))
    return [(t, after) for t, after in candidates if satisfies_invariants(model, after)]


def successors(model: PreparedNetwork, state: TimedState) -> list[tuple[Transition, TimedState]]:
    """The enabled transitions, those of the highest priority, with the states behind them. Raises EvaluationFault."""
    found = possible(model, state)
    if not found or not model.has_priorities:
        return found
    highest = max(priority(model, state.discrete, t) for t, _ in found)
    return [(t, after) for t, after in found if priority(model, state.discrete, t) == highest]


def is_possible(model: PreparedNetwork, state: TimedState, transition: Transition) -> bool:
    """True if a transition whose guards hold leads to a state that satisfies the invariants. Raises EvaluationFault."""
    return satisfies_invariants(model, _successor(model, state, transition))


def fire(model: PreparedNetwork, state: TimedState, transition: Transition) -> TimedState:
    """The state after an enabled transition. Raises StepError if it is not enabled, and EvaluationFault."""
    if not _is_guarded(model, state, transition):
        raise StepError("the transition is not enabled: a guard is false, or it is not a transition of this state")
    after = _successor(model, state, transition)
    if not satisfies_invariants(model, after):
        raise StepError("the transition is not enabled: it would violate an invariant")
    if model.has_priorities and _is_blocked(model, state, transition):
        raise StepError("the transition is not enabled: one of higher priority is possible")
    return after


def _is_blocked(model: PreparedNetwork, state: TimedState, transition: Transition) -> bool:
    """True if a transition of higher priority is possible. The updates of no others are evaluated."""
    own = priority(model, state.discrete, transition)
    return any(
        priority(model, state.discrete, other) > own and is_possible(model, state, other)
        for other in _guarded_transitions(model, state)
    )


def _successor(model: PreparedNetwork, state: TimedState, transition: Transition) -> TimedState:
    discrete, resets = execute_updates(model, state.discrete, transition)
    return TimedState(discrete, clocks_after(state.clocks, resets), state.time)


def time_passes(model: PreparedNetwork, state: TimedState) -> bool:
    """True if some time can pass in a state; not where that cannot be computed."""
    # No bound is nearer than this to a clock that is not at it.
    finest = lcm(*(value.denominator for value in state.clocks))
    try:
        delay(model, state, Fraction(1, 2 * finest))
    except (StepError, EvaluationFault):
        return False
    return True


def delay(model: PreparedNetwork, state: TimedState, duration: Fraction) -> TimedState:
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
    if _perhaps_urgent(model, state.discrete):
        for moment in relevant_moments(model, state, before=duration):
            if urgent(model, _later(model, state, moment)):
                raise StepError(f"a synchronisation over an urgent channel is enabled {moment} units into the delay")
    return after


def urgent(model: PreparedNetwork, state: TimedState) -> bool:
    """True if the guards of a synchronisation over an urgent channel hold now. No other guards are evaluated."""
    return any(
        is_urgent(model, state.discrete, transition)
        for first in _perhaps_urgent(model, state.discrete)
        if is_open(model, state, first)
        for transition in begun_by(model, state, first)
    )


@by_state
def _perhaps_urgent(model: PreparedNetwork, discrete: DiscreteState) -> tuple[Participant, ...]:
    """The edges that can begin a synchronisation over an urgent channel, but for those whose guards are false whatever
    the clocks."""
    return tuple(
        first
        for first in initiators(model, discrete)
        if may_be_urgent(model, first) and _may_be_open(model, discrete, first)
    )


def _may_be_open(model: PreparedNetwork, discrete: DiscreteState, participant: Participant) -> bool:
    """True unless the guard of an edge is false whatever the clocks; also where something goes wrong."""
    try:
        return bool(_guard_requirement(model, discrete, participant).constraints)
    except EvaluationFault:
        return True


def deadlocked(model: PreparedNetwork, state: TimedState) -> bool:
    """True if no transition is possible, now or after any delay that can pass."""
    if possible(model, state):
        return False
    if not may_delay(model, state.discrete):
        return True
    for moment in relevant_moments(model, state, before=None):
        try:
            after = delay(model, state, moment)
        except StepError:
            return True
        if possible(model, after):
            return False
    return True


def satisfies(model: PreparedNetwork, state: TimedState, predicate: Expression) -> bool:
    """True if a state predicate, which may ask for deadlock, is true.

    Raises EvaluationFault only if that depends on something that cannot be evaluated.
    """
    scratch = environment(model, state.discrete, state.clocks)
    scratch.deadlock = lambda: deadlocked(model, state)
    return _truth(predicate, scratch)


def _truth(predicate: Expression, scratch: Environment) -> bool:
    match predicate:
        case Unary(UnaryOperator.NOT, operand):
            return not _truth(operand, scratch)
        case Binary(BinaryOperator.AND, left, right):
            return not _either(left, True, right, True, scratch)
        case Binary(BinaryOperator.OR, left, right):
            return _either(left, False, right, False, scratch)
        case Binary(BinaryOperator.IMPLY, left, right):
            return _either(left, True, right, False, scratch)
        case _:
            return holds(predicate, scratch)


def _either(left: Expression, left_negated: bool, right: Expression, right_negated: bool, scratch: Environment) -> bool:
    """True if one of two predicates, each perhaps negated, is true, even if the other cannot be evaluated."""
    try:
        if _truth(left, scratch) is not left_negated:
            return True
    except EvaluationFault:
        if _truth(right, scratch) is not right_negated:
            return True
        raise
    return _truth(right, scratch) is not right_negated


def _later(model: PreparedNetwork, state: TimedState, duration: Fraction) -> TimedState:
    stopped = stopped_clocks(model, state.discrete)
    clocks = tuple(v if n in stopped else _sum(v, duration) for n, v in enumerate(state.clocks, start=1))
    return replace(state, clocks=clocks, time=_sum(state.time, duration))


def _sum(one: Fraction, other: Fraction) -> Fraction:
    """The sum, which is found faster where both are whole, as most times are."""
    if one.denominator == 1 == other.denominator:
        return Fraction(one.numerator + other.numerator)
    return one + other


def relevant_moments(
    model: PreparedNetwork, state: TimedState, before: Fraction | None, predicates: Sequence[Expression] = ()
) -> list[Fraction]:
    """Moments in ``[0, before)`` such that whatever is possible in that time is possible at one of them, and predicates
    that are true at one moment are true at one of these.

    These are the moments when a clock constraint that matters changes its truth value, and one between any two of them.
    """
    stopped = stopped_clocks(model, state.discrete) | {0}
    changes = {Fraction(0)}
    point = (Fraction(0), *state.clocks)
    for i, j, raw in _constraints_before_steps(model, state.discrete, tuple(predicates)):
        speed = (i not in stopped) - (j not in stopped)
        if speed and raw < INFINITY:
            moment = (bound_value(raw) - (point[i] - point[j])) / speed
            if moment >= 0 and (before is None or moment < before):
                changes.add(moment)
    ordered = sorted(changes)
    end = ordered[-1] + 2 if before is None else before
    between = [(a + b) / 2 for a, b in zip(ordered, [*ordered[1:], end], strict=True)]
    return sorted([*ordered, *between])


@by_state
def observable_constraints(
    model: PreparedNetwork, discrete: DiscreteState, predicates: tuple[Expression, ...]
) -> frozenset[Constraint]:
    """The clock constraints of all guards, and of the invariants here and behind all transitions that values do not
    rule out; and those of predicates, whose ``deadlock`` depends on no others. Guards that cannot be evaluated are left
    out: a step that evaluates them will meet the fault.
    """
    behind = (constraint for _, constraints in _steps(model, discrete) for constraint in constraints)
    return _constraints_here(model, discrete, predicates).union(behind)


@by_state
def _constraints_before_steps(
    model: PreparedNetwork, discrete: DiscreteState, predicates: tuple[Expression, ...]
) -> frozenset[Constraint]:
    """The observable constraints, those behind a transition as constraints on the clocks before it."""
    before = (
        constraint for resets, constraints in _steps(model, discrete) for constraint in _before(constraints, resets)
    )
    return _constraints_here(model, discrete, predicates).union(before)


def _constraints_here(
    model: PreparedNetwork, discrete: DiscreteState, predicates: tuple[Expression, ...]
) -> frozenset[Constraint]:
    """The clock constraints of the invariants, of the guards that values do not rule out, and of predicates."""
    found = set(_constraints(_invariants(model, discrete), environment(model, discrete)))
    for predicate in predicates:
        for answer in (False, True):
            scratch = environment(model, discrete)
            scratch.deadlock = partial(bool, answer)
            found |= comparisons(predicate, scratch)
    guards, _ = _candidates(model, discrete)
    found.update(c for requirement in guards.values() for conjunction in requirement for c in conjunction)
    return frozenset(found)


def _steps(model: PreparedNetwork, discrete: DiscreteState) -> tuple[tuple[ClockValues, tuple[Constraint, ...]], ...]:
    """Of each transition that values do not rule out: the clocks it sets, and the constraints of the invariants
    behind it."""
    found = []
    for transition in _candidates(model, discrete)[1]:
        with suppress(EvaluationFault):
            target, resets = execute_updates(model, discrete, transition)
            found.append((resets, tuple(_constraints(_invariants(model, target), environment(model, target)))))
    return tuple(found)


@by_state
def _candidates(
    model: PreparedNetwork, discrete: DiscreteState
) -> tuple[dict[Participant, Disjunction], list[Transition]]:
    """The constraints of the guards, and the transitions, that values do not rule out."""
    closed: Disjunction = []
    guards: dict[Participant, Disjunction] = {}

    def guard(participant: Participant) -> Disjunction:
        if participant not in guards:
            scratch = environment(model, discrete)
            bind_selects(model, participant, scratch)
            with suppress(EvaluationFault):
                guards[participant] = conditional_constraints(model.edge(participant).guard, scratch)
        return guards.setdefault(participant, closed)

    candidates: list[Transition] = []
    for first in initiators(model, discrete):
        if not guard(first):
            continue
        with suppress(EvaluationFault):
            channel = _channel(model, discrete, first)
            if channel is None:
                candidates.append(Transition((first,)))
                continue
            receiving = [list(filter(guard, p)) for p in enabled_receivers(model, discrete, first, channel)]
            candidates.extend(transitions_with(model, discrete, first, channel, receiving, lambda receivers: True))
    return guards, candidates


def _before(constraints: Iterable[Constraint], resets: ClockValues) -> Iterator[Constraint]:
    """Constraints behind a transition that sets clocks, as constraints on the clocks before it."""
    values = {clock: (source, more) for clock, source, more in resets}
    for i, j, raw in constraints:
        (first, more), (second, less) = values.get(i, (i, 0)), values.get(j, (j, 0))
        if first != second and raw < INFINITY:
            yield first, second, raw - 2 * (more - less)


def _invariants(model: PreparedNetwork, discrete: DiscreteState) -> Iterable[Expression | None]:
    return (location.invariant for location in model.current(discrete))


def _constraints(conditions: Iterable[Expression | None], scratch: Environment) -> Iterator[Constraint]:
    for condition in conditions:
        for conjunction in conditional_constraints(condition, scratch):
            yield from conjunction
