"""A transition is fired where the enumeration of all transitions has it, and nowhere else: also one with a receiver
too many, with one too few, or with other edges."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from fractions import Fraction
from random import Random

import pytest

from tachk.meaning.discrete import PreparedNetwork, prepare
from tachk.meaning.step import StepError, delay, fire, initial_state, possible_receivers, successors
from tachk.model.fault import EvaluationFault
from tachk.model.run import TimedState, Transition
from tests.support import Shape, random_case
from tests.support.seeds import enough, seeds

pytestmark = pytest.mark.drawn

SHAPES = (
    Shape(clocks_on_broadcast=True, receivers=2, priorities=True),
    Shape(clocks_on_broadcast=True, receivers=3, language=True, diagonals=True),
)


def walk(model: PreparedNetwork, random: Random) -> Iterator[tuple[TimedState, list[Transition]]]:
    state = initial_state(model)
    for _ in range(15):
        with suppress(StepError):
            state = delay(model, state, Fraction(random.randint(0, 6), random.choice((1, 2, 3))))
        found = successors(model, state)
        yield state, [transition for transition, _ in found]
        if not found:
            return
        state = random.choice(found)[1]


def changed(model: PreparedNetwork, state: TimedState, transition: Transition, random: Random) -> Transition:
    """The transition with a participant less, more, or with another edge of its location."""
    participants = list(transition.participants)
    place = random.randrange(len(participants) + 1)
    process = random.randrange(len(model.network.processes))
    others = model.instances[process][state.discrete.locations[process]]
    if others and random.random() < 0.7:
        participants[place : place + random.randint(0, 1)] = [random.choice(others)]
    elif len(participants) > 1:
        del participants[place % len(participants)]
    return Transition(tuple(participants))


def is_fired(model: PreparedNetwork, state: TimedState, transition: Transition) -> bool:
    try:
        fire(model, state, transition)
    except StepError:
        return False
    return True


def test_transitions_are_fired_where_the_enumeration_has_them() -> None:
    fired = rejected = broadcasts = 0
    for seed in seeds(range(60)):
        random = Random(seed)
        model = prepare(random_case(random, random.choice(SHAPES)).network)
        with suppress(EvaluationFault):
            for state, found in walk(model, random):
                tried = [*found, *(changed(model, state, one, random) for one in found for _ in range(4))]
                for transition in tried:
                    assert is_fired(model, state, transition) == (transition in found), (seed, transition)
                    fired, rejected = fired + (transition in found), rejected + (transition not in found)
                for transition in found:
                    first, *receivers = transition.participants
                    joined = {participant.process for participant in receivers}
                    broadcasts += len(joined) > 1
                    assert len(joined) < 2 or joined <= possible_receivers(model, state.discrete, first)
    assert enough(fired and rejected and broadcasts)
