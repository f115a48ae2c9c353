"""The replay of a submitted trace: the concrete semantics, which knows no search and no core, executes it."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError, Label
from tachk.base.job import check_job
from tachk.base.records import dataclass
from tachk.meaning.discrete import PreparedNetwork, initiators
from tachk.meaning.initial_state import check_initial_state
from tachk.meaning.run_view import RunNames
from tachk.meaning.step import StepError, begun_by, delay, fire, initial_state, is_open
from tachk.model.fault import EvaluationFault
from tachk.model.quantity import decimal
from tachk.model.run import TimedState, TimedStep, TimedTrace, Transition
from tachk.simulation.stepping.claims import ClaimedRun, ClaimedState, ClaimedStep
from tachk.simulation.stepping.reasons import (
    NoSuchProcessError,
    StepReason,
    edges_meant,
    process_named,
    why_no_delay,
    why_no_transition,
)

_MOST_AT_ONCE = 10_000
"""The number of states that are kept if the trace leaves out hidden processes."""


@dataclass(frozen=True, slots=True)
class StepRefusal:
    """Attributes:
    step: the first one that cannot be taken, from 1; 0 is the initial state.
    claim: what is said of it; None of the initial state.
    """

    step: int
    claim: ClaimedStep | None
    reason: StepReason


@dataclass(frozen=True, slots=True)
class Replayed:
    """Attributes:
    trace: the run, as far as it is one.
    refusal: why it goes no further; None if all of it is a run.
    """

    trace: TimedTrace
    refusal: StepRefusal | None


@dataclass(frozen=True, slots=True)
class _ReachedState:
    """A state that fits everything so far, and how it was reached."""

    state: TimedState
    step: TimedStep | None
    before: _ReachedState | None


def replay_claims(names: RunNames, run: ClaimedRun) -> Replayed:
    """Executes what is claimed, step by step.

    Where a step may mean several transitions, one is looked for with which all that follows can be taken.

    Raises InputError where there is no initial state, and StoppedError.
    """
    start = beginning(names.model)
    nodes = [_ReachedState(start, None, None)]
    difference = _difference(names, start, run.initial)
    if difference:
        return Replayed(TimedTrace(start, ()), StepRefusal(0, None, StepReason(difference)))
    for number, claim in enumerate(run.claims, start=1):
        check_job()
        following = _after(names, nodes, claim)
        if not following:
            return Replayed(_trace(nodes[0]), StepRefusal(number, claim, _why(names, nodes[0].state, claim)))
        nodes = following
    return Replayed(_trace(nodes[0]), None)


def beginning(model: PreparedNetwork) -> TimedState:
    """The initial state. Raises InputError (E0409) if it violates an invariant, or one cannot be evaluated there."""
    check_initial_state(model)
    try:
        return initial_state(model)
    except EvaluationFault as fault:
        message = f"there is no initial state: {fault.detail or fault.kind.name.lower()}"
        raise InputError([Diagnostic("E0409", message, fault.span)]) from None


def take(names: RunNames, state: TimedState, claim: ClaimedStep) -> list[TimedStep]:
    """The steps that a claim may mean. Empty if there is none."""
    waited = _wait(state, claim)
    try:
        later = delay(names.model, state, waited)
    except (StepError, EvaluationFault, ValueError):
        return []
    if not claim.moves:
        return [TimedStep(waited, None, later)] if not _difference(names, later, claim.after) else []
    found = []
    for transition in dict.fromkeys(_fitting(names, later, claim)):
        if claim.channel and names.event(later.discrete, transition).channel != claim.channel:
            continue
        try:
            after = fire(names.model, later, transition)
        except (StepError, EvaluationFault):
            continue
        if not _difference(names, after, claim.after):
            found.append(TimedStep(waited, transition, after))
    return found


def _wait(state: TimedState, claim: ClaimedStep) -> Fraction:
    return claim.time if claim.relative else claim.time - state.time


def _after(names: RunNames, nodes: list[_ReachedState], claim: ClaimedStep) -> list[_ReachedState]:
    found: dict[TimedState, _ReachedState] = {}
    for node in nodes:
        for step in take(names, node.state, claim):
            found.setdefault(step.state, _ReachedState(step.state, step, node))
            if len(found) >= _MOST_AT_ONCE:
                return list(found.values())
    return list(found.values())


def _trace(node: _ReachedState) -> TimedTrace:
    steps: list[TimedStep] = []
    here: _ReachedState | None = node
    while here is not None and here.step is not None and here.before is not None:
        steps.append(here.step)
        here = here.before
    assert here is not None
    return TimedTrace(here.state, tuple(reversed(steps)))


def _fitting(names: RunNames, state: TimedState, claim: ClaimedStep) -> Iterator[Transition]:
    """The transitions whose guards hold and that a claim may mean."""
    try:
        meant = [
            (process := process_named(names, move.process), edges_meant(names, state, process, move))
            for move in claim.moves
        ]
    except NoSuchProcessError:
        return
    processes = [process for process, _ in meant]
    edges = {each for _, found in meant for each in found}
    partial = claim.partial and any(map(names.network.hides, names.network.processes))
    for first in initiators(names.model, state.discrete):
        if first not in edges and not (partial and names.network.hides(names.network.processes[first.process])):
            continue
        try:
            if not is_open(names.model, state, first):
                continue
            begun = list(begun_by(names.model, state, first))
        except EvaluationFault:
            continue
        for transition in begun:
            shown = [p for p in transition.participants if p in edges]
            others = [p for p in transition.participants if p not in edges]
            hidden = all(partial and names.network.hides(names.network.processes[p.process]) for p in others)
            if hidden and sorted(p.process for p in shown) == sorted(processes):
                yield transition


def _why(names: RunNames, state: TimedState, claim: ClaimedStep) -> StepReason:
    waited = _wait(state, claim)
    try:
        later = delay(names.model, state, waited)
    except (StepError, EvaluationFault, ValueError):
        return why_no_delay(names, state, waited)
    if not claim.moves:
        return StepReason(_difference(names, later, claim.after) or "time cannot pass")
    try:
        for transition in _fitting(names, later, claim):
            after = fire(names.model, later, transition)
            difference = _difference(names, after, claim.after)
            if difference:
                return StepReason(difference)
    except (StepError, EvaluationFault):
        pass
    try:
        return why_no_transition(names, later, claim)
    except NoSuchProcessError as error:
        return StepReason(str(error))
    except EvaluationFault as fault:
        return StepReason(str(fault), (Label(fault.span, "here"),))


def _difference(names: RunNames, state: TimedState, state_in_file: ClaimedState | None) -> str:
    """The difference between a state and the submitted one; empty if there is none."""
    if state_in_file is None:
        return ""
    view = names.timed_snapshot(state)
    if state_in_file.time is not None and state_in_file.time != state.time:
        return f"the time is {decimal(state.time)}, not {decimal(state_in_file.time)} as the file says"
    pairs = (
        (dict(view.locations), state_in_file.locations, str),
        (dict(view.variables), state_in_file.variables, str),
        (dict(view.clocks or ()), state_in_file.clocks, lambda value: decimal(Fraction(value))),
    )
    for known, claimed, shown in pairs:
        for name, value in claimed.items():
            if name not in known:
                return f"the model has no {name}, which the file speaks of"
            if known[name] != value:
                return f"{name} is {shown(known[name])}, not {shown(value)} as the file says"
    return ""
