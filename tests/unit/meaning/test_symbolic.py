"""Zones and points tell the same story: the symbolic semantics against the concrete one on random networks."""

from __future__ import annotations

from fractions import Fraction
from math import ceil
from random import Random

import pytest

from tachk.meaning import dbm, step, symbolic
from tachk.meaning.discrete import prepare
from tachk.model.run import TimedState
from tests.support import Shape, random_case
from tests.support.seeds import seeds

SHAPES = [
    Shape(clocks_on_urgent=True),
    Shape(priorities=True, clocks_on_urgent=True),
    Shape(diagonals=True, clocks=2),
    Shape(copies=0.5),
]
DELAYS = [Fraction(n, 3) for n in range(10)]


def walk(random: Random, model: step.PreparedNetwork, steps: int) -> list[TimedState]:
    """States along a random run."""
    states = [step.initial_state(model)]
    for _ in range(steps):
        try:
            waited = step.delay(model, states[-1], random.choice(DELAYS))
        except step.StepError:
            waited = states[-1]
        after = step.successors(model, waited)
        states += [waited, *([random.choice(after)[1]] if after else [])]
    return states


@pytest.mark.parametrize("shape", SHAPES)
def test_what_is_possible_at_a_point_is_what_the_domains_say(shape: Shape) -> None:
    for seed in seeds(range(25)):
        random = Random(seed)
        model = prepare(random_case(random, shape).network)
        for state in walk(random, model, 6):
            here = symbolic.situation(model, state.discrete)
            assert here.invariant is not None
            assert dbm.contains(here.invariant, state.clocks)
            allowed = {
                move.transition: move.target
                for move in here.moves
                if any(dbm.contains(z, state.clocks) for z in move.domain)
                and not any(dbm.contains(z, state.clocks) for z in move.blockers)
            }
            assert allowed == {t: after.discrete for t, after in step.successors(model, state)}
            assert step.urgent(model, state) == any(dbm.contains(z, state.clocks) for z in here.urgent)
            assert step.deadlocked(model, state) != any(dbm.contains(z, state.clocks) for z in here.alive)


@pytest.mark.parametrize("shape", SHAPES)
def test_a_delay_can_pass_exactly_if_the_elapsed_region_has_its_end(shape: Shape) -> None:
    """Only points of the region on the same line reach a later point, and they do what the given point does."""
    for seed in seeds(range(25)):
        random = Random(seed)
        model = prepare(random_case(random, shape).network)
        for state in walk(random, model, 4):
            here = symbolic.situation(model, state.discrete)
            start = region(state)
            elapsed = symbolic.elapse(here, [start])
            for duration in DELAYS[1:7]:
                later = tuple(v + duration for v in state.clocks)
                if not dbm.contains(start, later):
                    assert passes(model, state, duration) == any(dbm.contains(z, later) for z in elapsed)


def passes(model: step.PreparedNetwork, state: TimedState, duration: Fraction) -> bool:
    try:
        step.delay(model, state, duration)
    except step.StepError:
        return False
    return True


def region(state: TimedState) -> dbm.Zone:
    """The smallest zone with integer bounds around a point."""
    point = (Fraction(0), *state.clocks)
    differences = [x - y for x in point for y in point]
    zone = dbm.close(len(point), [dbm.raw_bound(ceil(d), strict=d.denominator != 1) for d in differences])
    assert zone is not None
    return zone
