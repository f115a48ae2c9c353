"""What many discrete states admit together is what each of them admits by itself."""

from __future__ import annotations

from random import Random

import numpy as np
import pytest

from tachk.meaning import symbolic
from tachk.meaning.dbm import constrain_all, universe
from tachk.meaning.discrete import PreparedNetwork, initial_discrete, prepare, stopped_clocks
from tachk.meaning.many_states import ManyStates
from tachk.model.builder import NetworkBuilder
from tachk.model.random_networks import Shape, random_case
from tachk.model.run import DiscreteState
from tests.support.seeds import seeds

SHAPES = [
    Shape(broadcast=True, clocks_on_broadcast=True),
    Shape(language=True),
    Shape(urgent_channels=True, committed=True, broadcast=True),
    Shape(stopwatches=True),
    Shape(copies=0.5),
    Shape(copies=0.5, language=True),
    Shape(language=True, faults=0.5),
]


def some_states(model: PreparedNetwork, most: int) -> list[DiscreteState]:
    """Those that a few moves lead to, whatever the clocks."""
    found = [initial_discrete(model)]
    for state in found:
        targets = (move.target for move in symbolic.situation(model, state).moves)
        found += [t for t in dict.fromkeys(targets) if t is not None and t not in found][: most - len(found)]
    return found


@pytest.mark.parametrize("seed", seeds(range(20)))
def test_moves_of_many_states_are_those_of_each(seed: int) -> None:
    model = prepare(random_case(Random(seed), SHAPES[seed % len(SHAPES)]).network)
    try:
        states = some_states(model, 12)
    except symbolic.EvaluationFault:
        pytest.skip("an invariant cannot be evaluated")
    many = ManyStates(model)
    many.numbers(np.array([[*state.locations, *state.values, 0] for state in states]))
    many.explore(many.settle())
    many.settle()
    for number, state in enumerate(states):
        here = symbolic.situation(model, state)
        limits = constrain_all(universe(model.dimension), many.invariants[many.limits[number]])
        assert limits == here.invariant
        assert set(np.flatnonzero(many.stands[number]).tolist()) == {0, *stopped_clocks(model, state)}
        if here.invariant is None:
            continue
        assert many.waits[number] == (here.delays and not here.urgent)
        together = {}
        for move in many.moves:
            for row, target in zip(move.rows.tolist(), move.targets.tolist(), strict=False):
                if row == number and target not in many.invalid and many.limits[target]:
                    together[move.transition] = many.states[target, :-1].tolist(), move.resets
        alone = {
            move.transition: ([*move.target.locations, *move.target.values], move.resets)
            for move in here.moves
            if move.target is not None and move.fault is None
        }
        assert {t: together.get(t) for t in alone} == alone


def test_a_receiver_copies_what_the_sender_has_set() -> None:
    network = NetworkBuilder()
    x, y, z = (network.clock(name) for name in "xyz")
    channel = network.channel("c")
    sender, receiver = network.process("S"), network.process("R")
    a, b = sender.location("A"), receiver.location("B")
    sender.edge(a, a, send=channel, updates=[x.assign(z + 1)])
    receiver.edge(b, b, receive=channel, updates=[y.assign(x + 2), z.assign(0)])
    model = prepare(network.build())
    many, start = ManyStates(model), initial_discrete(model)
    many.numbers(np.array([[*start.locations, *start.values, 0]]))
    many.explore(many.settle())
    assert [move.resets for move in many.moves] == [((1, 3, 1), (2, 3, 3), (3, 0, 0))]
