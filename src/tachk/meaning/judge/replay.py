"""The judge of timed traces: walks a trace through the concrete semantics and accepts it only if all of it is right."""

from __future__ import annotations

from tachk.meaning.discrete import PreparedNetwork
from tachk.meaning.step import StepError, delay, fire, initial_state, satisfies
from tachk.model.expressions import Expression
from tachk.model.fault import EvaluationFault
from tachk.model.run import TimedState, TimedStep, TimedTrace


class ReplayError(Exception):
    """Attributes:
    step: the number of the step that is wrong, from 1; 0 is the initial state.
    reason: what is wrong with it.
    """

    def __init__(self, step: int, reason: str) -> None:
        self.step = step
        self.reason = reason
        super().__init__(f"step {step}: {reason}")


def replay(model: PreparedNetwork, trace: TimedTrace, predicate: Expression | None = None) -> None:
    """Checks that a trace is a run of the model and, if a predicate is given, that it holds in the last state.

    Every delay must be able to pass, every transition must be enabled, every state must be the one that results.
    Raises ReplayError otherwise.
    """
    number = 0
    try:
        state = initial_state(model)
        _compare(number, state, trace.initial)
        for number, step in enumerate(trace.steps, start=1):
            state = _after(model, state, step)
            _compare(number, state, step.state)
        if predicate is not None and not satisfies(model, state, predicate):
            raise ReplayError(number, "the predicate does not hold in the last state")
    except (StepError, EvaluationFault) as error:
        raise ReplayError(number, str(error)) from error


def _after(model: PreparedNetwork, state: TimedState, step: TimedStep) -> TimedState:
    waited = delay(model, state, step.delay)
    return waited if step.transition is None else fire(model, waited, step.transition)


def _compare(number: int, computed: TimedState, submitted: TimedState) -> None:
    if computed.discrete != submitted.discrete:
        raise ReplayError(number, "locations or variables differ from the computed ones")
    if computed.clocks != submitted.clocks or computed.time != submitted.time:
        raise ReplayError(number, "clock values or the time differ from the computed ones")
