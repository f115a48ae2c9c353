"""The search for runs that avoid a goal, under all its options, against two oracles on random networks.

Every run that it finds becomes one with delays that the judge accepts.
"""

from __future__ import annotations

from random import Random

import pytest

from tests.support import Shape, random_case
from tests.support.agreement import VARIANTS, Effort
from tests.support.liveness_agreement import compare_obligation
from tests.support.obligations import random_obligations
from tests.support.seeds import seeds

pytestmark = pytest.mark.drawn

EFFORT = Effort(reference=150, sampled=150)
LASTING = [options for options in VARIANTS if not options.shortest]
"""The search goes to the depth first: it knows no shortest paths."""

SHAPES = {
    "plain": Shape(),
    "small": Shape(processes=2, locations=3, clocks=2, constant=3),
    "priorities": Shape(priorities=True, clocks=2),
    "copies": Shape(copies=0.5, clocks=2),
    "diagonals": Shape(diagonals=True, clocks=2, constant=3),
    "stopwatches": Shape(stopwatches=True, clocks=2, deadlocks=False),
    "copies that stop": Shape(copies=0.5, stopwatches=True, clocks=2, deadlocks=False),
    "language": Shape(language=True, faults=0.08, exact=0.3, processes=2, locations=3, clocks=2, deadlocks=False),
    "faults": Shape(language=True, faults=1.0, processes=2, locations=3, clocks=1, deadlocks=False),
}


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("block", range(2))
def test_engines_agree_on_obligations(shape: str, block: int) -> None:
    for seed in seeds(range(10 * block, 10 * block + 10)):
        case = random_case(Random(seed), SHAPES[shape])
        variants = [LASTING[(seed + turn) % len(LASTING)] for turn in range(6)]
        for obligation in random_obligations(Random(seed), case):
            assert compare_obligation(case, obligation, variants, EFFORT).problems == (), f"seed {seed}"
