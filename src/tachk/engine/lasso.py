"""From a run that avoids a goal, as a search gives it, to the same run with exact rational delays.

A loop is made periodic where that is possible: with the same delays in every round. The rounds before it, which may
differ, belong to the stem. Where bounds are strict there may be no such run (delays that grow shorter and shorter);
then the trace has the loop once, and it is the zone from which it can be taken again and again that is exact.
"""

from __future__ import annotations

from collections.abc import Iterator

from tachk.base.records import replace
from tachk.engine.exact.concretise import at_end, conditions, discrete_run, of_phase, reached, timed_trace
from tachk.engine.exact.schedule import PhaseConstraint, ScheduleRequirement, any_solution, earliest
from tachk.engine.outcome import AvoidingRun, Obligation, RunEnd
from tachk.engine.periodic import repeating
from tachk.meaning import avoidance, dbm, symbolic
from tachk.meaning.constraints import certain
from tachk.meaning.dbm import LESS_EQUAL_ZERO, Federation, Zone, complement
from tachk.meaning.discrete import PreparedNetwork, environment
from tachk.meaning.repetition import observable_clocks
from tachk.model.expressions import Expression
from tachk.model.fault import EvaluationFault
from tachk.model.run import Ending, TimedTrace, Transition
from tachk.model.traversal import asks_deadlock

ROUNDS = (0, 1, 2, 4, 8)
"""The numbers of rounds that are tried before the loop is periodic."""

MOST_TRANSITIONS = 1500
"""Up to this length runs are tried with more than one round of the loop before."""


def lasso(model: PreparedNetwork, run: AvoidingRun, obligation: Obligation) -> TimedTrace | None:
    """The run with its delays, and with its ending; None if there is none.

    There is none either where evaluating something goes wrong. Where clocks stop, the run is a candidate that the judge
    may refuse, and may be missed.
    """
    try:
        if run.end is not RunEnd.LOOP:
            return _ending(model, run, obligation)
        for takes_time in (True, False):
            for rounds in ROUNDS:
                if rounds < _early_rounds(run, obligation):
                    continue
                if rounds and len(run.stem) + (rounds + 1) * len(run.loop) > MOST_TRANSITIONS:
                    break
                found = _periodic(model, run, obligation, rounds, takes_time)
                if found is not None:
                    return found
        return _recurrent(model, run, obligation)
    except EvaluationFault:
        return None


def _early_rounds(run: AvoidingRun, obligation: Obligation) -> int:
    """The least number of rounds before the loop: one if the goal may be due only during the first delay."""
    return int(obligation.trigger is not None and run.begins == len(run.stem))


class _UnrolledRun:
    """A lasso unrolled to a path, with the requirements on its phases that avoid the goal from where it is due."""

    def __init__(self, model: PreparedNetwork, run: AvoidingRun, obligation: Obligation, rounds: int) -> None:
        path: list[Transition | None] = [*run.stem, *(run.loop * rounds)]
        self.model, self.goal = model, obligation.goal
        due = run.begins
        if obligation.trigger is not None:
            # The trigger may come to hold during a delay: a moment of its own.
            path.insert(due, None)
            due += 1
        self.path = path
        self.states, self.phases = discrete_run(model, path)
        self.requirements = [r for k in range(len(path) + 1) for r in self._of(k)]
        for phase in range(due, len(path) + 1):
            self.requirements += self.avoiding(phase)
        if obligation.trigger is not None:
            met = self.where(obligation.trigger, due - 1)
            self.requirements.append(at_end(due - 1, conditions(met)))

    def _of(self, phase: int) -> Iterator[ScheduleRequirement]:
        transition = self.path[phase] if phase < len(self.path) else None
        return of_phase(self.model, self.states[phase], phase, transition)

    def where(self, predicate: Expression, phase: int) -> Federation:
        """The valuations within the invariants at which a predicate holds; within the reached zone if it contains
        `deadlock`."""
        if asks_deadlock(predicate):
            return symbolic.where(self.model, self.situation(phase), predicate)
        invariant = symbolic.invariant_zone(self.model, self.states[phase])
        if invariant is None:
            return []
        conjunctions = certain(predicate, environment(self.model, self.states[phase]))
        found = (dbm.constrain_all(invariant, conjunction) for conjunction in conjunctions)
        return [zone for zone in found if zone is not None]

    def situation(self, phase: int) -> symbolic.Situation:
        """The valuations that the state of a phase allows, of those that the path can reach there."""
        here = symbolic.situation(self.model, self.states[phase])
        if here.invariant is None:
            return here
        zone = reached(self.model, self.states[: phase + 1], self.phases, self.path[:phase])
        return replace(here, invariant=dbm.intersect(here.invariant, zone) or here.invariant)

    def avoiding(self, phase: int) -> Iterator[ScheduleRequirement]:
        """The goal is not met in a phase, from its beginning to its end."""
        for zone in self.where(self.goal, phase):
            yield _never_in(phase, zone)


def _never_in(phase: int, zone: Zone) -> ScheduleRequirement:
    """The clocks are at no moment of a phase in a zone: some upper bound or difference is false at its beginning, or
    some lower bound at its end. The differences of a canonical zone say when its bounds are never true at once."""
    constraints = (c for c in zone.constraints() if c != (0, c[1], LESS_EQUAL_ZERO))
    return ScheduleRequirement(phase, [(PhaseConstraint(c[0] == 0, complement(c)),) for c in constraints])


def _ending(model: PreparedNetwork, run: AvoidingRun, obligation: Obligation) -> TimedTrace | None:
    unrolled = _UnrolledRun(model, run, obligation, 0)
    last = len(unrolled.path)
    here, goal = unrolled.situation(last), unrolled.where(obligation.goal, last)
    if run.end is RunEnd.STUCK:
        target, ending = avoidance.ends_in_deadlock(here, goal), Ending.STUCK
    else:
        whole = symbolic.situation(model, unrolled.states[last])
        target, ending = avoidance.idles_for_ever(whole, goal), Ending.IDLE
        if whole.stopped and whole.invariant is not None:
            # The states after a delay are no zone then; the judge decides if the goal stays unmet.
            target = dbm.subtract_all([whole.invariant], goal)
    solve = any_solution if any(phase.stopped for phase in unrolled.phases) else earliest
    durations = solve(unrolled.phases, [*unrolled.requirements, at_end(last, conditions(target))])
    if durations is None:
        return None
    return replace(timed_trace(model, unrolled.states, unrolled.phases, unrolled.path, durations), ending=ending)


def _periodic(
    model: PreparedNetwork, run: AvoidingRun, obligation: Obligation, rounds: int, takes_time: bool
) -> TimedTrace | None:
    unrolled = _UnrolledRun(model, run, obligation, rounds + 1)
    start = len(unrolled.path) - len(run.loop)
    watched = [obligation.goal]
    seen = observable_clocks(model, unrolled.states[start:], watched)
    still = _no_delay(model, len(unrolled.path))
    durations = repeating(unrolled.phases, [*unrolled.requirements, still], start, seen, takes_time)
    if durations is None:
        return None
    trace = timed_trace(model, unrolled.states, unrolled.phases, unrolled.path, durations)
    return replace(trace, ending=Ending.PERIODIC, loop_start=len(trace.steps) - len(run.loop))


def _recurrent(model: PreparedNetwork, run: AvoidingRun, obligation: Obligation) -> TimedTrace | None:
    unrolled = _UnrolledRun(model, run, obligation, 1 + _early_rounds(run, obligation))
    start = len(unrolled.path) - len(run.loop)
    if any(phase.stopped for phase in unrolled.phases):
        return None
    again = avoidance.recurring(model, unrolled.states[start:-1], run.loop, obligation.goal)
    requirements = [*unrolled.requirements, _no_delay(model, len(unrolled.path))]
    requirements += [
        ScheduleRequirement(phase, [tuple(PhaseConstraint(False, c) for c in zone.constraints()) for zone in again])
        for phase in (start, len(unrolled.path))
    ]
    durations = earliest(unrolled.phases, requirements)
    if durations is None:
        return None
    trace = timed_trace(model, unrolled.states, unrolled.phases, unrolled.path, durations)
    return replace(trace, ending=Ending.RECURRENT, loop_start=len(trace.steps) - len(run.loop))


def _no_delay(model: PreparedNetwork, phase: int) -> ScheduleRequirement:
    return at_end(phase, [((model.dimension, 0, LESS_EQUAL_ZERO),)])
