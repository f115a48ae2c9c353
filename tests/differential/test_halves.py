"""Networks of two halves with one budget: what leaving out a half tells is what a search of the whole tells."""

from __future__ import annotations

from random import Random

import pytest

import tachk
from tachk import Limits, Options
from tachk.engines import reference
from tachk.engines.outcome import Status
from tests.differential.halves import random_halves

LIMITS = Limits(states=5000)


@pytest.mark.parametrize("block", range(4))
def test_leaving_out_a_half_changes_no_answer(block: int) -> None:
    fewer = 0
    for seed in range(20 * block, 20 * block + 20):
        case = random_halves(Random(seed))
        model = tachk.loads(case.text)
        quick, whole = (
            list(model.verify(*case.queries, options=options, limits=LIMITS))
            for options in (Options(), Options(drop_bystanders=False, hold_spectators=False))
        )
        for one, other in zip(quick, whole, strict=True):
            fewer += one.statistics.states_stored < other.statistics.states_stored
            if not other.reason and not one.reason:
                assert (one.answer, one.trace is None) == (other.answer, other.trace is None), f"seed {seed}"
    assert fewer > 5


def test_leaving_out_a_half_agrees_with_the_plain_oracle() -> None:
    decided = 0
    for seed in range(1000, 1016):
        case = random_halves(Random(seed))
        model = tachk.loads(case.text)
        for verdict in model.verify(*case.queries, limits=LIMITS):
            assert verdict.query.target is not None
            (goal,) = reference.explore(model.network, [verdict.query.target], Limits(states=300)).goals
            if goal.status is not Status.UNDECIDED and not verdict.reason:
                decided += 1
                reached = (verdict.answer.value == "holds") == verdict.query.holds_when_reached
                assert reached == (goal.status is Status.REACHED), f"seed {seed}"
    assert decided > 5
