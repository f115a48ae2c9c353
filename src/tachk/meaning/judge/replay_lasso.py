"""The judge of runs that avoid a goal for ever.

Walks the run through the concrete semantics, looks at the goal at every moment that can tell, delays included, and
checks that the run goes on for ever, or ends, as it says.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from tachk.meaning import dbm
from tachk.meaning.avoidance import recurring
from tachk.meaning.discrete import PreparedNetwork, may_delay, stopped_clocks
from tachk.meaning.judge.replay import ReplayError, replay
from tachk.meaning.repetition import observable_clocks
from tachk.meaning.step import StepError, deadlocked, delay, relevant_moments, satisfies
from tachk.model.expressions import Expression
from tachk.model.fault import EvaluationFault
from tachk.model.run import Due, Ending, TimedState, TimedTrace


def replay_lasso(
    model: PreparedNetwork,
    trace: TimedTrace,
    goal: Expression,
    trigger: Expression | None,
    again: Sequence[Expression] = (),
    ends: Expression | None = None,
    diverges: bool = False,
) -> Due | None:
    """Checks that a trace is a run of the model that avoids a goal for ever: from a moment on at which the trigger
    holds, or (None) from its beginning on.

    Args:
        again: what each round of a loop has to meet behind one of its transitions.
        ends: where a run has to end that is not a loop; None: anywhere.
        diverges: each round of a loop takes time. That is not looked at where delays differ from round to round: they
            may grow shorter and shorter.

    Returns from where on the goal is awaited, if there is a trigger. Raises ReplayError otherwise.
    """
    replay(model, trace)
    last = len(trace.steps)
    try:
        due = _check_goal(model, trace, goal, trigger)
        _check_ending(model, trace, goal)
        _check_recurring(model, trace, again, ends)
        if diverges:
            _check_time(trace)
    except (StepError, EvaluationFault) as error:
        raise ReplayError(last, str(error)) from error
    return due


def _check_goal(model: PreparedNetwork, trace: TimedTrace, goal: Expression, trigger: Expression | None) -> Due | None:
    """The obligation begins, and from then on the goal is not met."""
    due = trigger is None
    since: Due | None = None
    met_at, looped = 0, trace.loop_start is None
    for number, state in _moments(model, trace, [goal] if trigger is None else [goal, trigger]):
        if trace.loop_start is not None and number > trace.loop_start and not looped:
            looped = True
            if not due:
                raise ReplayError(number, "the trigger does not hold before the loop")
        met = satisfies(model, state, goal)
        if met and trigger is None:
            raise ReplayError(number, "the run meets the goal that it should avoid")
        if met:
            due, met_at = False, number
        elif trigger is not None and not due:
            due = satisfies(model, state, trigger)
            since = Due(number if state is trace.states[number] else number - 1, state.time) if due else None
    if trace.loop_start is not None and met_at > trace.loop_start:
        raise ReplayError(met_at, "the loop meets the goal that it should avoid")
    if not due:
        raise ReplayError(len(trace.steps), "the run never has to meet the goal, or meets it last")
    return since


def _moments(
    model: PreparedNetwork, trace: TimedTrace, predicates: list[Expression]
) -> Iterator[tuple[int, TimedState]]:
    """The states of a run at all decisive moments, each with the number of its step."""
    state = trace.initial
    yield 0, state
    for number, step in enumerate(trace.steps, start=1):
        for moment in relevant_moments(model, state, step.delay, predicates) if step.delay > 0 else ():
            yield number, delay(model, state, moment)
        yield number, delay(model, state, step.delay)
        state = step.state
        yield number, state


def _check_ending(model: PreparedNetwork, trace: TimedTrace, goal: Expression) -> None:
    last, number = trace.states[-1], len(trace.steps)
    match trace.ending:
        case Ending.OPEN:
            raise ReplayError(number, "the run says nothing of what comes after it")
        case Ending.IDLE:
            _check_idle(model, last, goal, number)
        case Ending.STUCK:
            if not deadlocked(model, last):
                raise ReplayError(number, "something is still possible in the last state, or later")
            for later in _later(model, last, goal):
                if satisfies(model, later, goal):
                    raise ReplayError(number, "the goal is met by letting time pass in the last state")
        case Ending.PERIODIC:
            _check_period(model, trace, goal)
        case Ending.RECURRENT:
            _check_recurrence(model, trace, goal)


def _later(model: PreparedNetwork, state: TimedState, goal: Expression) -> Iterator[TimedState]:
    """The states that time leads to, at all decisive moments, as far as it can pass."""
    for moment in relevant_moments(model, state, None, [goal]) if may_delay(model, state.discrete) else ():
        try:
            yield delay(model, state, moment)
        except StepError:
            return


def _check_idle(model: PreparedNetwork, state: TimedState, goal: Expression, number: int) -> None:
    """The last of the decisive moments lies behind all changes: what can pass until then passes for ever."""
    for moment in relevant_moments(model, state, None, [goal]):
        try:
            later = delay(model, state, moment)
        except StepError as error:
            raise ReplayError(number, f"time cannot pass for ever in the last state: {error}") from error
        if satisfies(model, later, goal):
            raise ReplayError(number, "the goal is met by letting time pass in the last state")


def _check_recurring(
    model: PreparedNetwork, trace: TimedTrace, again: Sequence[Expression], ends: Expression | None
) -> None:
    number = len(trace.steps)
    if trace.loop_start is None:
        if ends is not None and not satisfies(model, trace.states[-1], ends):
            raise ReplayError(number, "the run ends where it may not")
        return
    rounds = trace.states[trace.loop_start + 1 :]
    for predicate in again:
        if not any(satisfies(model, state, predicate) for state in rounds):
            raise ReplayError(number, "the loop does not meet what it has to meet again and again")


def _check_time(trace: TimedTrace) -> None:
    if trace.ending is not Ending.PERIODIC or trace.loop_start is None:
        return
    if trace.states[-1].time <= trace.states[trace.loop_start].time:
        raise ReplayError(len(trace.steps), "the loop takes no time")


def _loop(trace: TimedTrace) -> tuple[int, TimedState, TimedState]:
    """The number of steps before the loop, and the states before and after it."""
    start, number = trace.loop_start, len(trace.steps)
    if start is None or not 0 <= start < number or any(step.transition is None for step in trace.steps):
        raise ReplayError(number, "the run has no loop of transitions")
    before, after = trace.states[start], trace.states[-1]
    if before.discrete != after.discrete:
        raise ReplayError(number, "the loop does not return to the same locations and values of variables")
    return start, before, after


def _check_period(model: PreparedNetwork, trace: TimedTrace, goal: Expression) -> None:
    start, before, after = _loop(trace)
    seen = observable_clocks(model, (state.discrete for state in trace.states[start:]), [goal])
    for clock, values in enumerate(zip(before.clocks, after.clocks, strict=True), start=1):
        if not seen.same(clock, *values):
            raise ReplayError(len(trace.steps), f"the loop does not return to the same value of clock number {clock}")


def _check_recurrence(model: PreparedNetwork, trace: TimedTrace, goal: Expression) -> None:
    start, before, _ = _loop(trace)
    states = [state.discrete for state in trace.states[start:-1]]
    if any(stopped_clocks(model, state) for state in states):
        raise ReplayError(len(trace.steps), "clocks stop in the loop, so that zones do not show that it recurs")
    loop = [step.transition for step in trace.steps[start:] if step.transition is not None]
    again = recurring(model, states, loop, goal)
    if not any(dbm.contains(zone, before.clocks) for zone in again):
        raise ReplayError(start, "the loop cannot be taken again and again from where it begins")
