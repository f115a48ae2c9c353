"""From the path of an exploration to a run with exact rational delays."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from math import lcm

from tachk.base.records import dataclass, replace
from tachk.engine.exact.schedule import (
    PhaseConstraint,
    SchedulePhase,
    ScheduleRequirement,
    Standstill,
    any_solution,
    earliest,
    extreme_solution,
)
from tachk.meaning import dbm, symbolic
from tachk.meaning.constraints import certain
from tachk.meaning.dbm import LESS_EQUAL_ZERO, Constraint, Zone, complement, raw_bound
from tachk.meaning.discrete import (
    PreparedNetwork,
    environment,
    execute_updates,
    initial_discrete,
    may_delay,
    stopped_clocks,
)
from tachk.meaning.memory import by_state
from tachk.model.expressions import Expression
from tachk.model.fault import EvaluationFault
from tachk.model.run import DiscreteState, TimedState, TimedStep, TimedTrace, Transition
from tachk.model.traversal import asks_deadlock


def concretise(
    model: PreparedNetwork, path: Sequence[Transition], predicate: Expression | None = None
) -> TimedTrace | None:
    """A run that takes the transitions of a path, early, and ends in a state of the predicate; None if there is none.

    The predicate may ask for deadlock. There is no run either where evaluating something goes wrong. A delay after the
    last transition is added where the predicate needs it. Raises ValueError if a transition cannot belong to the path
    for its edges and values alone.
    """
    try:
        states, phases, requirements = requirements_of(model, path, predicate)
    except EvaluationFault:
        return None
    solve = any_solution if any(phase.stopped for phase in phases) else earliest
    durations = solve(phases, requirements)
    return None if durations is None else timed_trace(model, states, phases, path, durations)


@dataclass(frozen=True, slots=True)
class TimeOptimalRun:
    """A run along a path that is as fast or as slow as possible.

    Attributes:
        total: how long the fastest run takes, or when the last transition of the slowest one fires; None where there is
            no limit.
        attained: the run is at the limit; otherwise runs come as close to it as one likes, and none is at it.
    """

    run: TimedTrace
    total: Fraction | None
    attained: bool


def time_optimal_run(
    model: PreparedNetwork, path: Sequence[Transition], predicate: Expression, latest: bool, seconds: float | None
) -> TimeOptimalRun | None:
    """A run that takes the transitions of a path and ends in a state of the predicate; None if there is none.

    Args:
        latest: the one whose last transition is latest; otherwise the one that ends earliest.

    Raises TimeoutError if that is not found in so many seconds.
    """
    try:
        states, phases, requirements = requirements_of(model, path, predicate)
    except EvaluationFault:
        return None
    found = extreme_solution(phases, requirements, latest, None if seconds is None else int(seconds * 1000))
    if found is None:
        return None
    return TimeOptimalRun(timed_trace(model, states, phases, path, found.durations), found.total, found.attained)


def requirements_of(
    model: PreparedNetwork, path: Sequence[Transition], predicate: Expression | None
) -> tuple[list[DiscreteState], list[SchedulePhase], list[ScheduleRequirement]]:
    """The discrete states and the phases of a path, and what its durations must satisfy. Raises EvaluationFault."""
    states, phases = discrete_run(model, path)
    requirements = [r for k, t in enumerate(path) for r in of_phase(model, states[k], k, t)]
    requirements += of_phase(model, states[-1], len(path), None)
    if predicate is not None:
        requirements.append(at_end(len(path), _final(model, states, phases, path, predicate)))
    return states, phases, requirements


def discrete_run(
    model: PreparedNetwork, path: Sequence[Transition | None]
) -> tuple[list[DiscreteState], list[SchedulePhase]]:
    """The discrete states of the path, and its phases. None stands for a moment at which nothing happens.

    Behind the clocks of the model the phases have one more, which is 0 at the beginning of every phase.
    """
    states = [initial_discrete(model)]
    resets = [(0, value) for value in (0, *model.layout.starts, 0)]
    phases = [SchedulePhase(tuple(resets), stopped_clocks(model, states[0]))]
    for number, transition in enumerate(path, start=1):
        stood = _stood(phases[-1], number - 1)
        if transition is None:
            resets[model.dimension] = (number, 0)
            states.append(states[-1])
            phases.append(SchedulePhase(tuple(resets), phases[-1].stopped, stood))
            continue
        if any(model.edge(p).source != states[-1].locations[p.process] for p in transition.participants):
            raise ValueError(f"transition {number} does not start in the state before it")
        state, assigned = execute_updates(model, states[-1], transition)
        before = [(number, 0), *resets[1:]]
        for clock, source, more in assigned:
            since, value = before[source]
            resets[clock] = since, value + more
        resets[model.dimension] = (number, 0)
        states.append(state)
        phases.append(SchedulePhase(tuple(resets), stopped_clocks(model, state), _assigned(stood, assigned)))
    return states, phases


def _stood(before: SchedulePhase, number: int) -> Mapping[int, Standstill]:
    """When clocks stood still, at the end of the phase of this number."""
    if not before.stopped:
        return before.stood
    return {**before.stood, **{clock: Standstill(number, before.stood.get(clock)) for clock in before.stopped}}


def _assigned(stood: Mapping[int, Standstill], assigned: Iterable[tuple[int, int, int]]) -> Mapping[int, Standstill]:
    """When clocks stood still, behind assignments (clock, source, more) that all read what was there before them."""
    if not stood:
        return stood
    standstills = dict(stood)
    for clock, source, _ in assigned:
        standstills.pop(clock, None)
        if source in stood:
            standstills[clock] = stood[source]
    return standstills


def of_phase(
    model: PreparedNetwork, discrete: DiscreteState, phase: int, leaves_by: Transition | None
) -> Iterator[ScheduleRequirement]:
    """The constraints under which control can stay in a state for the phase and leave it by a transition."""
    return (ScheduleRequirement(phase, choice) for choice in _choices(model, discrete, leaves_by))


_Choice = Sequence[Sequence[PhaseConstraint]]


@by_state
def _choices(model: PreparedNetwork, discrete: DiscreteState, leaves_by: Transition | None) -> list[_Choice]:
    """The conjunctions of each requirement of a phase."""
    waiting = model.dimension
    found = [_at(True, [((0, waiting, LESS_EQUAL_ZERO),)])]
    if not may_delay(model, discrete):
        found.append(_at(True, [((waiting, 0, LESS_EQUAL_ZERO),)]))
    for process, location in enumerate(model.current(discrete)):
        if location.invariant is not None:
            condition = symbolic.invariant_of(model, discrete, process)
            found += [_at(False, condition), _at(True, condition)]
    if leaves_by is not None:
        found.append(_at(True, symbolic.guard_of(model, discrete, leaves_by)))
        if model.has_priorities:
            found.append(_at(True, _unblocked(model, discrete, leaves_by)))
    if may_delay(model, discrete) and any(type_.urgent for type_, _ in model.channels):
        here = symbolic.situation(model, discrete)
        found += [_not_while_urgent(zone, here, waiting) for zone in here.urgent]
    return found


def at_end(phase: int, condition: Sequence[Sequence[Constraint]]) -> ScheduleRequirement:
    return ScheduleRequirement(phase, _at(True, condition))


def _at(end: bool, condition: Sequence[Sequence[Constraint]]) -> _Choice:
    return [tuple(PhaseConstraint(end, c) for c in conjunction) for conjunction in condition]


def _unblocked(model: PreparedNetwork, discrete: DiscreteState, transition: Transition) -> list[tuple[Constraint, ...]]:
    """The clock valuations at which no transition of a higher priority is possible."""
    here = symbolic.situation(model, discrete)
    for move in here.moves:
        if move.transition == transition:
            return conditions(dbm.subtract_all([dbm.universe(model.dimension)], move.blockers))
    return []


def conditions(federation: Sequence[Zone]) -> list[tuple[Constraint, ...]]:
    return [tuple(zone.constraints()) for zone in federation]


def _not_while_urgent(zone: Zone, here: symbolic.Situation, waiting: int) -> _Choice:
    """No time passes in a phase while the clocks are in a zone.

    Either no time passes at all; or the phase begins outside because of an upper bound or a difference, which time does
    not mend; or it ends before, or at, the moment a lower bound becomes true. With stopped clocks this is stricter than
    it need be for differences of a running and a stopped clock.
    """
    options = [(PhaseConstraint(True, (waiting, 0, LESS_EQUAL_ZERO)),)]
    for constraint in zone.constraints():
        i, j, raw = constraint
        if here.invariant is not None and raw >= here.invariant[i, j]:
            continue
        if i == 0:
            options.append((PhaseConstraint(True, (j, 0, raw_bound(-dbm.bound_value(raw), strict=False))),))
        else:
            options.append((PhaseConstraint(False, complement(constraint)),))
    return options


def reached(
    model: PreparedNetwork,
    states: Sequence[DiscreteState],
    phases: Sequence[SchedulePhase],
    path: Sequence[Transition | None],
) -> Zone:
    """A zone that holds the clock values in which the path can end, and as a rule little more."""
    zone = dbm.point(model.layout.starts)
    for number, state in enumerate(states):
        invariant = symbolic.invariant_zone(model, state)
        needed: list[Iterable[Constraint]] = [] if invariant is None else [invariant.constraints()]
        if may_delay(model, state):
            zone = dbm.up(zone, phases[number].stopped)
        transition = path[number] if number < len(path) else None
        if transition is not None and len(guard := symbolic.guard_of(model, state, transition)) == 1:
            needed.append(guard[0])
        for condition in needed:
            narrowed = dbm.constrain_all(zone, condition)
            if narrowed is None:
                return dbm.universe(model.dimension)
            zone = narrowed
        if number < len(path):
            zone = dbm.assign(zone, () if transition is None else execute_updates(model, state, transition)[1])
    return zone


def _final(
    model: PreparedNetwork,
    states: Sequence[DiscreteState],
    phases: Sequence[SchedulePhase],
    path: Sequence[Transition],
    predicate: Expression,
) -> list[tuple[Constraint, ...]]:
    """The clock valuations at which the predicate holds; within the reached zone if it contains `deadlock`.

    Subtracting one action after the other from all valuations would leave exponentially many pieces, most of them out
    of reach.
    """
    if asks_deadlock(predicate):
        here = symbolic.situation(model, states[-1])
        if here.invariant is not None:
            here = replace(here, invariant=dbm.intersect(here.invariant, reached(model, states, phases, path)))
        return conditions(symbolic.where(model, here, predicate))
    return certain(predicate, environment(model, states[-1]))


def timed_trace(
    model: PreparedNetwork,
    states: Sequence[DiscreteState],
    phases: Sequence[SchedulePhase],
    path: Sequence[Transition | None],
    durations: Sequence[Fraction],
) -> TimedTrace:
    """The run that takes the transitions of a path after these durations. None in the path ends no delay."""
    unit = lcm(*(duration.denominator for duration in durations))
    fractions = _Fractions(unit)
    clocks = tuple(value * unit for value in model.layout.starts)  # clocks, and times, count units of 1 / unit

    def state_at(discrete: DiscreteState, clocks: Sequence[int], time: int) -> TimedState:
        return TimedState(discrete, tuple(map(fractions.__getitem__, clocks)), fractions[time])

    state = state_at(states[0], clocks, 0)
    initial, steps, time, waited = state, [], 0, 0
    for phase, transition in enumerate([*path, None]):
        wait, stopped = int(durations[phase] * unit), phases[phase].stopped
        if wait:
            clocks = tuple(v if n in stopped else v + wait for n, v in enumerate(clocks, start=1))
            waited, time = waited + wait, time + wait
        if transition is not None:
            after = list(clocks)
            for clock, source, more in execute_updates(model, states[phase], transition)[1]:
                after[clock - 1] = more * unit + (clocks[source - 1] if source else 0)
            clocks = tuple(after)
            state = state_at(states[phase + 1], clocks, time)
            steps.append(TimedStep(fractions[waited], transition, state))
            waited = 0
    if waited:
        steps.append(TimedStep(fractions[waited], None, state_at(states[len(path)], clocks, time)))
    return TimedTrace(initial, tuple(steps))


class _Fractions(dict[int, Fraction]):
    """Multiples of 1 / unit as fractions, each made once: a long run shows the same values again and again."""

    def __init__(self, unit: int) -> None:
        super().__init__()
        self.unit = unit

    def __missing__(self, number: int) -> Fraction:
        found = self[number] = Fraction(number, self.unit)
        return found
