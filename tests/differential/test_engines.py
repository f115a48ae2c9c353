"""All engines on random networks: one answer, whatever the options, and a run that replays for every path found."""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import HealthCheck, given, settings

from tachk.testing import Case, Shape, cases, random_case
from tachk.testing.agreement import VARIANTS, Effort, compare

EFFORT = Effort(reference=200, sampled=300)

SHAPES = {
    "plain": Shape(),
    "small": Shape(processes=2, locations=3, clocks=2, constant=3),
    "closed": Shape(strict=False, deadlocks=False),
    "priorities": Shape(priorities=True, clocks=2),
    "diagonals": Shape(diagonals=True, clocks=2, constant=3),
    "everything": Shape(diagonals=True, priorities=True, clocks=2, constant=3),
    "stopwatches": Shape(stopwatches=True, clocks=2),
}


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("block", range(4))
def test_engines_agree_on_seeded_networks(shape: str, block: int) -> None:
    for seed in range(10 * block, 10 * block + 10):
        assert compare(random_case(Random(seed), SHAPES[shape]), VARIANTS, EFFORT).problems == (), f"seed {seed}"


@settings(max_examples=40, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
@given(cases(Shape(processes=2, locations=3, clocks=2, constant=3)))
def test_engines_agree_on_networks_that_hypothesis_finds(case: Case) -> None:
    assert compare(case, (), EFFORT).problems == ()
