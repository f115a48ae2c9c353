"""The symbolic semantics: all that a network can do from a set of clock valuations, exactly, as unions of zones.

What depends on the discrete state only is worked out once, as a `Situation`: for each transition the set of clock
valuations where it is possible, as a federation. Guards with disjunctions, processes that stay out of a broadcast
because their guards are false, priorities, urgency and deadlock are all set operations on these federations.

Exact without stopwatches; with them `elapse` and `where` lean to the side that finds more states.
"""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress

from tachk.base.job import check_job
from tachk.base.records import dataclass
from tachk.meaning import dbm
from tachk.meaning.constraints import (
    FALSE,
    TRUE,
    Conjunction,
    Disjunction,
    TooManyConjunctionsError,
    certain,
    conditional_constraints,
    conjunction,
    tidied,
)
from tachk.meaning.dbm import ClockValues, Federation, Zone
from tachk.meaning.discrete import (
    PreparedNetwork,
    bind_selects,
    channel_named,
    channel_of,
    enabled_receivers,
    environment,
    execute_updates,
    initial_discrete,
    initiators,
    is_urgent,
    may_delay,
    priority,
    stopped_clocks,
    transitions_with,
)
from tachk.meaning.memory import by_state
from tachk.model.evaluate import Environment
from tachk.model.expressions import Expression
from tachk.model.fault import EvaluationFault
from tachk.model.run import DiscreteState, Participant, Transition


@dataclass(frozen=True, slots=True)
class Move:
    """A transition from a discrete state.

    Attributes:
        domain: the clock valuations, among those that satisfy the invariants, where it is possible.
        resets: what it sets clocks to.
        target: the discrete state after it; None if its updates or the invariants behind them go wrong.
        fault: what goes wrong then; the domain is then where the guards hold.
        blockers: the domains of the moves with a higher priority.
    """

    transition: Transition
    domain: Federation
    resets: ClockValues
    target: DiscreteState | None
    fault: EvaluationFault | None
    blockers: Federation


@dataclass(frozen=True, slots=True)
class Fault:
    """A guard or a channel index that cannot be evaluated, and the clock valuations at which it is evaluated."""

    domain: Federation
    fault: EvaluationFault


@dataclass(frozen=True, slots=True)
class Situation:
    """Attributes:
    faults: the guards and channel indices that go wrong; what they would have led to is not among the moves.
    invariant: the valuations that satisfy all invariants; None if there are none.
    delays: time may pass: no current location is urgent or committed.
    urgent: where the guards of a synchronisation over an urgent channel hold.
    alive: valuations from which some transition is possible, now or after a delay; all of them if no clock stops.
    perhaps_alive: all such valuations, and perhaps others if a clock stops.
    """

    discrete: DiscreteState
    invariant: Zone | None
    delays: bool
    stopped: frozenset[int]
    moves: tuple[Move, ...]
    urgent: Federation
    alive: Federation
    perhaps_alive: Federation
    faults: tuple[Fault, ...] = ()


@by_state
def situation(model: PreparedNetwork, discrete: DiscreteState) -> Situation:
    """The behaviour of a discrete state. Raises EvaluationFault for invariants that go wrong."""
    invariant = invariant_zone(model, discrete)
    delays = may_delay(model, discrete)
    stopped = stopped_clocks(model, discrete)
    if invariant is None:
        return Situation(discrete, None, delays, stopped, (), [], [], [])
    guarded, faulty = guarded_transitions(model, discrete)
    faults = tuple(Fault(domain, f) for c, f in faulty if (domain := _part(invariant, c)))
    moves = [m for m in (_move(model, discrete, invariant, t, g) for t, g in guarded) if m.domain]
    if model.has_priorities:
        ranks = [priority(model, discrete, m.transition) for m in moves]
        moves = [
            Move(
                m.transition,
                m.domain,
                m.resets,
                m.target,
                m.fault,
                [zone for other, higher in zip(moves, ranks, strict=True) if higher > rank for zone in other.domain],
            )
            for m, rank in zip(moves, ranks, strict=True)
        ]
    urgent = [z for t, g in guarded if is_urgent(model, discrete, t) for z in _part(invariant, g)]
    somewhere = [zone for m in moves for zone in m.domain]
    alive = _alive(invariant, urgent, somewhere) if delays and not stopped else somewhere
    # The past of a zone is a zone only if no clock stops.
    perhaps_alive = [invariant] if somewhere and delays and stopped else alive
    return Situation(discrete, invariant, delays, stopped, tuple(moves), urgent, alive, perhaps_alive, faults)


def reaching(here: Situation, somewhere: Federation) -> Federation:
    """The valuations from which ``somewhere`` is met now or after a delay that can pass. No clock may be stopped."""
    if not here.delays or here.invariant is None:
        return somewhere
    return _alive(here.invariant, here.urgent, somewhere)


def _alive(invariant: Zone, urgent: Federation, somewhere: Federation) -> Federation:
    """The valuations from which ``somewhere`` can be reached by a delay, all clocks running."""
    if not urgent:
        return [dbm.down(z) for z in somewhere]
    waiting = _before_and_after(dbm.subtract_all([invariant], urgent), urgent, invariant.dimension)
    return somewhere + [
        zone
        for start, region in waiting
        for zone in intersections([start], [dbm.down(z) for z in intersections(somewhere, region)])
    ]


def _part(zone: Zone, condition: Disjunction) -> Federation:
    """The part of a zone where a condition holds."""
    return [z for z in (dbm.constrain_all(zone, c) for c in condition) if z is not None]


def guarded_transitions(
    model: PreparedNetwork, discrete: DiscreteState
) -> tuple[list[tuple[Transition, Disjunction]], list[tuple[Disjunction, EvaluationFault]]]:
    """The transitions that the discrete state admits, each with the clock constraints of all its guards; and the faults
    of guards that cannot be evaluated, each with the constraints under which it is.

    Raises TooManyConjunctionsError where there are more transitions, and of their guards more conjunctions, than the
    model's `most_cases`.
    """
    cases = 0
    guards: dict[Participant, Disjunction] = {}
    found: list[tuple[Transition, Disjunction]] = []
    faults: list[tuple[Disjunction, EvaluationFault]] = []

    def received_channel(participant: Participant, required: Disjunction) -> int | None:
        """The channel that an edge names if its guard can hold; None if not or where something goes wrong."""
        scratch = environment(model, discrete)
        bind_selects(model, participant, scratch)
        try:
            guards[participant] = conditional_constraints(model.edge(participant).guard, scratch)
            if not guards[participant]:
                return None
            required = conjunction(required, guards[participant])
            return channel_named(model, participant, scratch)
        except EvaluationFault as fault:
            guards.setdefault(participant, FALSE)
            faults.append((required, fault))
            return None

    for first in initiators(model, discrete):
        before = len(faults)
        channel = received_channel(first, TRUE)
        if not guards[first] or len(faults) > before:
            continue
        if channel is None:
            found.append((Transition((first,)), guards[first]))
            continue
        receiving = [
            [p for p in of_process if received_channel(p, guards[first]) == channel]
            for of_process in enabled_receivers(model, discrete, first, channel)
        ]
        for transition in transitions_with(
            model, discrete, first, channel, receiving, lambda receivers: all(() not in guards[r] for r in receivers)
        ):
            with suppress(EvaluationFault):  # which is among the faults
                found.append((transition, guard_of(model, discrete, transition)))
                cases += 1 + len(found[-1][1])
            if cases > model.most_cases:
                raise TooManyConjunctionsError
    return found, faults


@by_state
def guard_of(model: PreparedNetwork, discrete: DiscreteState, transition: Transition) -> Disjunction:
    """The clock constraints of all guards of one transition, those that keep others out of a broadcast included.

    False if the guards rule the transition out in the discrete state. Its committed rule is not looked at. Raises
    EvaluationFault, and TooManyConjunctionsError where they are more conjunctions than the model's `most_cases`.
    """
    scratch = environment(model, discrete)
    whole = TRUE
    for participant in transition.participants:
        bind_selects(model, participant, scratch)
        whole = _few(model, conjunction(whole, conditional_constraints(model.edge(participant).guard, scratch)))
    channel = channel_of(model, discrete, transition)
    if channel is None or not model.channels[channel][0].broadcast:
        return whole
    joined = {p.process for p in transition.participants}
    for of_process in enabled_receivers(model, discrete, transition.participants[0], channel):
        for participant in of_process:
            if participant.process not in joined:
                whole = _few(model, conjunction(whole, _stays_out(model, participant, channel, scratch)))
    return whole


def _few(model: PreparedNetwork, condition: Disjunction) -> Disjunction:
    """A product that has grown by a factor. Raises TooManyConjunctionsError."""
    check_job()
    found = condition if len(condition) == 1 else tidied(condition)
    if len(found) > model.most_cases:
        raise TooManyConjunctionsError
    return found


def _stays_out(model: PreparedNetwork, participant: Participant, channel: int, scratch: Environment) -> Disjunction:
    """The valuations at which an edge does not receive a broadcast: where its guard is false; everywhere if it names
    another channel. If its index goes wrong, so that it names none, only the guard counts."""
    edge = model.edge(participant)
    bind_selects(model, participant, scratch)
    if not conditional_constraints(edge.guard, scratch):
        return TRUE
    with suppress(EvaluationFault):
        if channel_named(model, participant, scratch) != channel:
            return TRUE
    return certain(edge.guard, scratch, negated=True) if edge.guard is not None else FALSE


def _move(
    model: PreparedNetwork, discrete: DiscreteState, invariant: Zone, transition: Transition, guard: Disjunction
) -> Move:
    domain = _part(invariant, guard)
    if not domain:
        return Move(transition, [], (), None, None, [])
    try:
        target, resets = execute_updates(model, discrete, transition)
        after = invariant_zone(model, target)
    except EvaluationFault as fault:
        return Move(transition, domain, (), None, fault, [])
    before = None if after is None else dbm.undo_assign(after, resets)
    if before is None:
        return Move(transition, [], resets, target, None, [])
    return Move(transition, intersections(domain, [before]), resets, target, None, [])


def invariant_zone(model: PreparedNetwork, discrete: DiscreteState) -> Zone | None:
    """The clock valuations that satisfy all invariants. Raises as `invariant_constraints` does."""
    constraints = invariant_constraints(model, discrete)
    return None if constraints is None else dbm.constrain_all(dbm.universe(model.dimension), constraints)


@by_state
def invariant_constraints(model: PreparedNetwork, discrete: DiscreteState) -> Conjunction | None:
    """The conjunction of all invariants as constraints; None if it is false whatever the clocks.

    Once one is false, those of later processes are not evaluated. Raises EvaluationFault, and ValueError if they are
    not convex.
    """
    whole = TRUE
    for process in range(len(discrete.locations)):
        whole = conjunction(whole, invariant_of(model, discrete, process))
        if not whole:
            return None
    if len(whole) > 1:
        raise ValueError("an invariant cannot be a disjunction of clock constraints")
    return whole[0]


@by_state
def invariant_of(model: PreparedNetwork, discrete: DiscreteState, process: int) -> Disjunction:
    """The clock constraints of the invariant of a process's location. Raises as `conditional_constraints` does."""
    return conditional_constraints(model.current(discrete)[process].invariant, environment(model, discrete))


def intersections(left: Iterable[Zone], right: Iterable[Zone]) -> Federation:
    others = list(right)
    return [z for z in (dbm.intersect(a, b) for a in left for b in others) if z is not None]


def initial_situation(model: PreparedNetwork) -> tuple[Situation, Federation]:
    """The initial discrete state, and what is reached in it by letting time pass. Empty if it violates an invariant."""
    start = situation(model, initial_discrete(model))
    if start.invariant is None:
        return start, []
    return start, elapse(start, [z for z in [dbm.intersect(dbm.point(model.layout.starts), start.invariant)] if z])


def fire(here: Situation, zones: Iterable[Zone], move: Move) -> Federation:
    """The valuations right after a move that is not blocked, from any of the zones; exact."""
    sources = dbm.subtract_all(intersections(zones, move.domain), move.blockers)
    return [dbm.assign(source, move.resets) for source in sources]


def elapse(here: Situation, zones: Iterable[Zone]) -> Federation:
    """The valuations reached from those that satisfy the invariants by delays that urgency allows."""
    if not here.delays or here.invariant is None:
        return list(zones)
    if here.stopped:
        waiting = list(zones)
        free_to_go = dbm.subtract_all(waiting, here.urgent)
        return waiting + intersections((dbm.up(z, here.stopped) for z in free_to_go), [here.invariant])
    result: Federation = []
    for zone in zones:
        if not here.urgent:
            result += intersections([dbm.up(zone)], [here.invariant])
            continue
        result += intersections([zone], here.urgent)
        for start, region in _before_and_after(dbm.subtract_all([zone], here.urgent), here.urgent, zone.dimension):
            result += intersections(intersections([dbm.up(start)], [here.invariant]), region)
    return result


def _before_and_after(starts: Federation, urgent: Federation, dimension: int) -> list[tuple[Zone, Federation]]:
    """Splits valuations outside the urgent zones by which of these lie in their future; each with where it may go.

    A valuation before an urgent zone may go on until it enters it: as far as the points before it, and those points of
    it that have no earlier point of it in their past.
    """
    pieces: list[tuple[Zone, Federation]] = [(start, [dbm.universe(dimension)]) for start in starts]
    for zone in urgent:
        past = dbm.down(zone)
        allowed = dbm.subtract(past, zone) + dbm.subtract(zone, _strictly_later(zone))
        split: list[tuple[Zone, Federation]] = []
        for start, region in pieces:
            split += [(outside, region) for outside in dbm.subtract(start, past)]
            inside = dbm.intersect(start, past)
            if inside is not None:
                split.append((inside, intersections(region, allowed)))
        pieces = split
    return pieces


def _strictly_later(zone: Zone) -> Zone:
    """The points reached from the zone by a delay greater than 0: all its lower bounds become strict."""
    later = dbm.constrain_all(dbm.up(zone), [(0, j, zone[0, j] & ~1) for j in range(1, zone.dimension)])
    assert later is not None
    return later


def where(model: PreparedNetwork, here: Situation, predicate: Expression) -> Federation:
    """The clock valuations, among those that satisfy the invariants, where a state predicate holds, whatever the parts
    of it are that cannot be evaluated. ``deadlock`` may occur anywhere in it; what it is cannot be said where an action
    is a run-time error now or later.
    """
    if here.invariant is None:
        return []

    def zones(scratch: Environment) -> Federation:
        assert here.invariant is not None
        return _part(here.invariant, certain(predicate, scratch))

    def assuming(answer: bool) -> Environment:
        scratch = environment(model, here.discrete)
        scratch.deadlock = lambda: answer
        return scratch

    if_dead, if_alive = zones(assuming(True)), zones(assuming(False))
    if if_dead == if_alive:
        return if_dead
    doubtful = [*(f.domain for f in here.faults), *(m.domain for m in here.moves if m.fault is not None)]
    unknown = [zone for domain in doubtful for zone in domain]
    if unknown and not here.stopped:
        unknown = reaching(here, unknown)
    dead = dbm.subtract_all(if_dead, [*here.alive, *unknown])
    alive = dbm.subtract_all(intersections(if_alive, here.perhaps_alive), unknown)
    return dead + alive + (intersections(if_dead, if_alive) if unknown else [])
