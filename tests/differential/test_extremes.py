"""Least and largest values in random networks: an oracle that walks from region to region contradicts none."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from random import Random

import pytest

from tachk.base.diagnostics.diagnostic import UnsupportedError
from tachk.engine.options import Extrapolation, Options, SearchOrder
from tachk.model.expressions import BOOL, Constant
from tests.support import Shape, random_case
from tests.support.extremes_agreement import compare_extremes, expressions_of
from tests.support.seeds import enough, seeds

pytestmark = pytest.mark.drawn

OPTIONS = (Options(), Options(order=SearchOrder.DFS, extrapolation=Extrapolation.MAX))

SHAPES = {
    "plain": Shape(),
    "closed": Shape(strict=False, deadlocks=False, clocks=2),
    "priorities": Shape(priorities=True, clocks=2),
    "copies": Shape(copies=0.5, clocks=2),
    "diagonals": Shape(diagonals=True, clocks=2, constant=3, processes=2, locations=3),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_no_value_is_contradicted(shape: str) -> None:
    decided = 0
    for seed in seeds(range(5)):
        random = Random(seed)
        case = random_case(random, SHAPES[shape])
        if seed % 2:
            case = replace(case, predicates=(Constant(1, BOOL),))
        with suppress(UnsupportedError):  # it asks for a difference of clocks, and copies make more of them
            found = compare_extremes(case, expressions_of(case, random, True), OPTIONS, 200)
            assert found.problems == (), f"seed {seed}"
            decided += found.decided
    assert enough(decided > 0)
