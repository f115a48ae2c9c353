"""Asks all engines at once."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tachk.engine import zone
from tachk.engine.compiler.lower import lower
from tachk.engine.exact.concretise import concretise
from tachk.engine.options import Limits
from tachk.engine.outcome import Status
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.replay import replay
from tachk.model.builder import NetworkBuilder, Term
from tests.support.oracles import digitised, reference

Reaches = Callable[[NetworkBuilder, Term], bool]


@pytest.fixture
def reaches() -> Reaches:
    """Whether a state of the predicate can be reached: the one answer of all engines, shown by a replayed run."""

    def ask(builder: NetworkBuilder, predicate: Term) -> bool:
        network, goal = builder.build(), predicate.expression
        program, goals = lower(network, [goal])
        outcomes = [
            reference.explore(network, [goal], Limits(states=1000)),
            digitised.explore_regions(network, [goal], Limits(states=20_000)),
            zone.explore(program, goals),
        ]
        statuses = {outcome.goals[0].status for outcome in outcomes}
        assert len(statuses) == 1, outcomes
        for outcome in outcomes:
            path = outcome.goals[0].path
            if path is not None:
                run = concretise(prepare(network), path, goal)
                assert run is not None
                replay(prepare(network), run, goal)
        (status,) = statuses
        assert status is not Status.UNDECIDED
        return status is Status.REACHED

    return ask
