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
from tachk.simulation.stepping.reasons import (
    NoSuchProcessError,
    StepReason,
    edges_meant,
    process_named,
    why_no_delay,
    why_no_transition,
)
from tachk.simulation.stepping.submitted import SubmittedRun, SubmittedState, SubmittedStep

_MOST_AT_ONCE = 10_000
"""The number of states that are kept if the trace leaves out hidden processes."""


@dataclass(frozen=True, slots=True)
class StepRejection:
    """Attributes:
    step: the first one that cannot be taken, from 1; 0 is the initial state.
    wanted: the submitted step; None for the initial state.
    """

    step: int
    wanted: SubmittedStep | None
    reason: StepReason


@dataclass(frozen=True, slots=True)
class Replayed:
    """Attributes:
    trace: the run, as far as it is one.
    refusal: why it goes no further; None if all of it is a run.
    """

    trace: TimedTrace
    refusal: StepRejection | None


@dataclass(frozen=True, slots=True)
class _ReachedState:
    """A state that fits everything so far, and how it was reached."""

    state: TimedState
    step: TimedStep | None
    before: _ReachedState | None


def replay_submitted(names: RunNames, run: SubmittedRun) -> Replayed:
    """Executes a submitted run, step by step.

    Where a step may mean several transitions, one is looked for with which all that follows can be taken.

    Raises InputError where there is no initial state, and StoppedError.
    """
    start = beginning(names.model)
    nodes = [_ReachedState(start, None, None)]
    difference = _difference(names, start, run.initial)
    if difference:
        return Replayed(TimedTrace(start, ()), StepRejection(0, None, StepReason(difference)))
    for number, wanted in enumerate(run.steps, start=1):
        check_job()
        following = _after(names, nodes, wanted)
        if not following:
            return Replayed(_trace(nodes[0]), StepRejection(number, wanted, _why(names, nodes[0].state, wanted)))
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


def take(names: RunNames, state: TimedState, wanted: SubmittedStep) -> list[TimedStep]:
    """The steps that a submitted step may mean. Empty if there is none."""
    waited = _wait(state, wanted)
    try:
        later = delay(names.model, state, waited)
    except (StepError, EvaluationFault, ValueError):
        return []
    if not wanted.moves:
        return [TimedStep(waited, None, later)] if not _difference(names, later, wanted.after) else []
    found = []
    for transition in dict.fromkeys(_fitting(names, later, wanted)):
        if wanted.channel and names.event(later.discrete, transition).channel != wanted.channel:
            continue
        try:
            after = fire(names.model, later, transition)
        except (StepError, EvaluationFault):
            continue
        if not _difference(names, after, wanted.after):
            found.append(TimedStep(waited, transition, after))
    return found


def _wait(state: TimedState, wanted: SubmittedStep) -> Fraction:
    return wanted.time if wanted.relative else wanted.time - state.time


def _after(names: RunNames, nodes: list[_ReachedState], wanted: SubmittedStep) -> list[_ReachedState]:
    found: dict[TimedState, _ReachedState] = {}
    for node in nodes:
        for step in take(names, node.state, wanted):
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


def _fitting(names: RunNames, state: TimedState, wanted: SubmittedStep) -> Iterator[Transition]:
    """The transitions whose guards hold and that a submitted step may mean."""
    try:
        meant = [
            (process := process_named(names, move.process), edges_meant(names, state, process, move))
            for move in wanted.moves
        ]
    except NoSuchProcessError:
        return
    processes = [process for process, _ in meant]
    edges = {each for _, found in meant for each in found}
    partial = wanted.partial and any(map(names.network.hides, names.network.processes))
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


def _why(names: RunNames, state: TimedState, wanted: SubmittedStep) -> StepReason:
    waited = _wait(state, wanted)
    try:
        later = delay(names.model, state, waited)
    except (StepError, EvaluationFault, ValueError):
        return why_no_delay(names, state, waited)
    if not wanted.moves:
        return StepReason(_difference(names, later, wanted.after) or "time cannot pass")
    try:
        for transition in _fitting(names, later, wanted):
            after = fire(names.model, later, transition)
            difference = _difference(names, after, wanted.after)
            if difference:
                return StepReason(difference)
    except (StepError, EvaluationFault):
        pass
    try:
        return why_no_transition(names, later, wanted)
    except NoSuchProcessError as error:
        return StepReason(str(error))
    except EvaluationFault as fault:
        return StepReason(str(fault), (Label(fault.span, "here"),))


def _difference(names: RunNames, state: TimedState, state_in_file: SubmittedState | None) -> str:
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
    for known, submitted, shown in pairs:
        for name, value in submitted.items():
            if name not in known:
                return f"the model has no {name}, which the file names"
            if known[name] != value:
                return f"{name} is {shown(known[name])}, not {shown(value)} as the file says"
    return ""
