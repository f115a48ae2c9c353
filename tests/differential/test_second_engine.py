"""The engine on z3 on random networks: what it decides, the other engines and the oracles decide the same way."""

from __future__ import annotations

from random import Random

import pytest

from tachk.engine.outcome import Status
from tests.support import Shape, random_case
from tests.support.agreement import Effort, compare
from tests.support.seeds import enough, seeds

pytestmark = pytest.mark.drawn

EFFORT = Effort(reference=200, sampled=300, unrolled=8)

SHAPES = {
    "plain": Shape(clocks=2),
    "closed": Shape(strict=False, clocks=2),
    "diagonals": Shape(diagonals=True, clocks=2, constant=3),
    "stopwatches": Shape(stopwatches=True, clocks=2),
    "copies": Shape(copies=0.5, clocks=2),
    "copies that stop": Shape(copies=0.5, stopwatches=True, clocks=2),
    "copies in functions": Shape(copies=0.5, language=True, clocks=2, processes=2, locations=3),
    "priorities": Shape(priorities=True, deadlocks=True, clocks=1),
    "deadlocks": Shape(deadlocks=True, clocks=2, processes=2),
    "language": Shape(language=True, faults=0.3, clocks=1, processes=2, locations=3),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_z3_agrees_with_the_other_engines(shape: str) -> None:
    decided = 0
    for seed in seeds(range(5)):
        found = compare(random_case(Random(seed), SHAPES[shape]), (), EFFORT)
        assert found.problems == (), f"seed {seed}"
        if "smt" in found.outcomes:
            decided += sum(goal.status is not Status.UNDECIDED for goal in found.outcomes["smt"].goals)
    assert enough(decided >= 5)
