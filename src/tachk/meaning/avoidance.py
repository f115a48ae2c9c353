"""Runs that avoid a goal, as operations on zones: delays, ends of runs, and loops that can be taken for ever.

The goal is a federation for each discrete state, within its invariants. All of it is exact for networks without
stopwatches.
"""

from __future__ import annotations

from collections.abc import Sequence

from tachk.base.job import check_job
from tachk.meaning import dbm, symbolic
from tachk.meaning.dbm import INFINITY, Federation, Zone
from tachk.meaning.discrete import PreparedNetwork
from tachk.meaning.symbolic import Situation
from tachk.model.expressions import Expression
from tachk.model.run import DiscreteState, Transition


def elapse_before(here: Situation, starts: Federation, goal: Federation) -> Federation:
    """The valuations reached from others without the goal by delays that do not meet the goal."""
    reached: Federation = []
    for start, ahead in _by_future(starts, goal):
        reached += _between(symbolic.elapse(here, [start]), ahead)
    return reached


def reaching_before(here: Situation, somewhere: Federation, goal: Federation) -> Federation:
    """The valuations without the goal from which ``somewhere`` is met, now or after a delay, before the goal is."""
    if here.invariant is None:
        return []
    reaching: Federation = []
    for start, ahead in _by_future(dbm.subtract_all([here.invariant], goal), goal):
        reaching += symbolic.intersections([start], symbolic.reaching(here, _between(somewhere, ahead)))
    return reaching


def _by_future(starts: Federation, goal: Federation) -> list[tuple[Zone, Federation]]:
    """Splits valuations without the goal by which of its zones they meet if only time passes."""
    pieces: list[tuple[Zone, Federation]] = [(start, []) for start in starts]
    for zone in goal:
        past = dbm.down(zone)
        split: list[tuple[Zone, Federation]] = []
        for start, ahead in pieces:
            split += [(outside, ahead) for outside in dbm.subtract(start, past)]
            inside = dbm.intersect(start, past)
            if inside is not None:
                split.append((inside, [*ahead, zone]))
        pieces = split
    return pieces


def _between(zones: Federation, ahead: Federation) -> Federation:
    """The valuations before all of the zones ahead: in the past of each, and not in it, as it lasts without a gap."""
    for zone in ahead:
        zones = symbolic.intersections(zones, dbm.subtract(dbm.down(zone), zone))
    return zones


def idles_for_ever(here: Situation, goal: Federation) -> Federation:
    """The valuations from which time can pass for ever and does not meet the goal."""
    invariant = here.invariant
    if invariant is None or not here.delays:
        return []
    if any(invariant[clock, 0] < INFINITY for clock in range(1, invariant.dimension)):
        return []
    return dbm.subtract_all([invariant], [dbm.down(zone) for zone in (*goal, *here.urgent)])


def ends_in_deadlock(here: Situation, goal: Federation) -> Federation:
    """The valuations from which nothing is possible, now or later, and letting time pass does not meet the goal."""
    if here.invariant is None:
        return []
    doubtful = [*(f.domain for f in here.faults), *(m.domain for m in here.moves if m.fault is not None)]
    unknown = [dbm.down(zone) if here.delays else zone for domain in doubtful for zone in domain]
    return dbm.subtract_all([here.invariant], [*here.alive, *symbolic.reaching(here, goal), *unknown])


def recurring(
    model: PreparedNetwork, states: Sequence[DiscreteState], loop: Sequence[Transition], goal: Expression
) -> Federation:
    """The valuations from which a loop can be taken again and again, at some moments, without meeting the goal.

    The greatest fixed point of the way back through the loop. All sets on the way are unions of regions, so it is
    reached after finitely many rounds. Raises EvaluationFault, and StoppedError.

    Args:
        states: the discrete state before each transition.
    """
    situations = {state: symbolic.situation(model, state) for state in states}
    goals = {state: symbolic.where(model, here, goal) for state, here in situations.items()}
    first = situations[states[0]]
    here = dbm.subtract_all([first.invariant] if first.invariant is not None else [], goals[states[0]])
    while here:
        check_job()
        back = here
        for state, transition in reversed(list(zip(states, loop, strict=True))):
            back = _before(situations[state], transition, back, goals[state])
        avoiding = symbolic.intersections(here, back)
        if not dbm.subtract_all(here, avoiding):
            break
        here = dbm.without_covered(avoiding)
    return here


def _before(here: Situation, transition: Transition, after: Federation, goal: Federation) -> Federation:
    """From where a transition can be taken into ``after``, now or after a delay, without meeting the goal."""
    move = next((m for m in here.moves if m.transition == transition), None)
    if move is None or move.target is None:
        return []
    landing = [z for z in (dbm.undo_assign(zone, move.resets) for zone in after) if z is not None]
    firing = dbm.subtract_all(symbolic.intersections(move.domain, landing), [*move.blockers, *goal])
    return dbm.without_covered(reaching_before(here, firing, goal))
