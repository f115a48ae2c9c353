"""Obligations of which only runs count in which time diverges: the search, with options on and off, and two oracles."""

from __future__ import annotations

from random import Random

import pytest

from tachk.engine.options import Options
from tachk.verify.verdict import Answer
from tests.support import Shape, random_case
from tests.support.agreement import Effort
from tests.support.endless.diverging_agreement import compare_diverging
from tests.support.obligations import random_obligations
from tests.support.seeds import enough, seeds
from tests.support.strategies import with_states

pytestmark = pytest.mark.drawn

SMALL = {"processes": 2, "locations": 3, "clocks": 2, "constant": 3, "deadlocks": False}
SHAPES = {
    "plain": Shape(**SMALL),
    "exact": Shape(**SMALL, exact=0.5),
    "priorities": Shape(**SMALL, priorities=True),
    "diagonals": Shape(**SMALL, diagonals=True),
    "one process": Shape(**{**SMALL, "processes": 1, "locations": 4}),
    "stopwatches": Shape(**SMALL, stopwatches=True),
    "copies": Shape(**SMALL, copies=0.5),
    "faults": Shape(**SMALL, language=True, faults=0.3),
}
VARIANTS = (Options(subsumption=False), Options(pack_clocks=0, chunk_words=1, rows_after=0))


@pytest.mark.parametrize("shape", SHAPES)
def test_the_search_finds_what_the_oracles_find(shape: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """With short delays, and with long ones."""
    decided = set()
    for seed in seeds(range(100, 112)):
        with_states(monkeypatch, "short-delays", 2000 if seed % 2 else 0)
        random = Random(seed)
        case = random_case(random, SHAPES[shape])
        for obligation in random_obligations(random, case, 1):
            found = compare_diverging(case, obligation, VARIANTS[seed % 2 :][:1], Effort(reference=200, sampled=400))
            assert not found.problems, f"seed {seed}: {found.problems}"
            decided.update(found.answers.values())
    assert enough({Answer.HOLDS, Answer.FAILS} <= decided)
