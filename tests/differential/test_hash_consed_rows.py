"""However zones are held, whole, in rows or reduced: the same states, runs and numbers, in less memory."""

from __future__ import annotations

from dataclasses import replace
from random import Random

import pytest

import tachk
from tachk.base.resources import data_root
from tachk.engine.compiler.lower import lower
from tachk.engine.options import BoundScope, Extrapolation, Limits, Options, SearchOrder
from tachk.engine.outcome import Outcome
from tachk.engine.zone import explore
from tachk.model.random_networks import RandomCase, Shape, random_case
from tests.support.seeds import enough, seeds

pytestmark = pytest.mark.drawn

WHOLE = Options(rows_after=2**32 - 1, reduced_after=2**32 - 1).off("local-times")
SHAPES = (
    Shape(groups=2, clocks=3, processes=3, locations=4),
    Shape(groups=2, clocks=2, processes=2, locations=4, diagonals=True),
    Shape(stopwatches=True, clocks=3, processes=4, locations=5),
    Shape(clocks=3, processes=4, locations=5),
)
VARIANTS = (
    WHOLE,
    replace(WHOLE, order=SearchOrder.DFS, reclaim=False),
    replace(WHOLE, shortest=True),
    replace(WHOLE, extrapolation=Extrapolation.MAX, pack_clocks=0, width=32),
    replace(WHOLE, subsumption=False),
)


def searched(case: RandomCase, options: Options) -> Outcome:
    program, goals = lower(case.network, case.predicates)
    outcome = explore(program, goals, options, Limits(states=1_000))
    return replace(outcome, statistics=replace(outcome.statistics, seconds=0.0, user_seconds=0.0, peak_bytes=0))


def test_random_networks() -> None:
    large = 0
    for seed in seeds(range(80)):
        case = random_case(Random(seed), SHAPES[seed % len(SHAPES)])
        options = VARIANTS[seed % len(VARIANTS)]
        whole = searched(case, options)
        for rows_after in (0, 1):
            assert searched(case, replace(options, rows_after=rows_after)) == whole, f"seed {seed}"
        large += whole.statistics.states_stored > 20
    assert enough(large > 20)


MANY_CLOCKS = (
    Shape(clocks=10, processes=3, locations=5),
    Shape(clocks=14, processes=2, locations=6, diagonals=True),
    Shape(clocks=22, processes=3, locations=5),
    Shape(clocks=22, processes=4, locations=4, stopwatches=True),
    Shape(clocks=30, processes=2, locations=6),
)


def test_reduced_form() -> None:
    reduced = 0
    for seed in seeds(range(40)):
        case = random_case(Random(seed), MANY_CLOCKS[seed % len(MANY_CLOCKS)])
        options = replace(VARIANTS[seed % len(VARIANTS)], pack_clocks=2**32 - 1, bounds=BoundScope.GLOBAL)
        whole = searched(case, options)
        for reduced_after in (0, 20):
            assert searched(case, replace(options, reduced_after=reduced_after)) == whole, f"seed {seed}"
        program, _ = lower(case.network, case.predicates)
        reduced += whole.statistics.states_stored > 20 and program.clocks >= 8
    assert enough(reduced > 3)


def bytes_a_state(model: str, query: str, size: int, options: Options) -> float:
    loaded = tachk.load(data_root() / "models" / "classics" / model, N=size)
    (verdict,) = loaded.verify(query, options=options.off("symmetry", "local-times"))
    return verdict.statistics.peak_bytes / verdict.statistics.states_stored


def test_how_much_memory_a_state_takes() -> None:
    fischer = ("fischer.ta", "E<> exists (p : pid_t) P(p).critical && id != p", 9)
    csma_cd = ("csma_cd.ta", "E<> false", 9)
    assert bytes_a_state(*fischer, Options()) < 60
    assert bytes_a_state(*csma_cd, Options()) < 65
    assert bytes_a_state(*csma_cd, WHOLE) > 150
