"""All engines on random networks: one answer, whatever the options, and a run that replays for every path found."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from random import Random

import pytest
from hypothesis import HealthCheck, given, settings

from tachk.base.diagnostics.diagnostic import InputError
from tachk.engine import zone
from tachk.engine.compiler.lower import lower
from tachk.engine.local_times import obstacle
from tachk.engine.options import BoundScope, Extrapolation, Limits, LocalTimes, Options, SearchOrder
from tachk.engine.program_image import encode
from tachk.meaning.discrete import prepare
from tachk.meaning.initial_state import check_initial_state
from tachk.model.expressions import BOOL, Constant
from tests.support import RandomCase, Shape, cases, random_case
from tests.support.agreement import VARIANTS, Effort, compare
from tests.support.seeds import enough, seeds

pytestmark = pytest.mark.drawn

EFFORT = Effort(reference=200, sampled=300)

SHAPES = {
    "plain": Shape(),
    "small": Shape(processes=2, locations=3, clocks=2, constant=3),
    "closed": Shape(strict=False, deadlocks=False),
    "priorities": Shape(priorities=True, clocks=2),
    "diagonals": Shape(diagonals=True, clocks=2, constant=3),
    "everything": Shape(diagonals=True, priorities=True, clocks=2, constant=3),
    "stopwatches": Shape(stopwatches=True, clocks=2),
    "copies": Shape(copies=0.5),
    "copies and others": Shape(copies=0.4, own_data=0.3, exact=0.4, priorities=True, receivers=1, blockers=1),
    "copies and diagonals": Shape(copies=0.4, advances=False, diagonals=True, constant=3),
    "copies that stop": Shape(copies=0.5, stopwatches=True, clocks=2),
    "copies that stop and diagonals": Shape(
        copies=0.5, advances=False, stopwatches=True, diagonals=True, processes=2, locations=3, constant=3
    ),
}

APART = Shape(own_data=0.9, committed=False, urgent_channels=False, broadcast=False, clocks=1)
"""Processes that seldom meet, for searches over local times."""

LONG_TIMES = {
    "tens": Shape(unit=10),
    "hundreds": Shape(unit=200, uneven=True, diagonals=True, clocks=2, constant=3),
    "copies of tens": Shape(unit=10, copies=0.5),
    "copies of millions": Shape(unit=2**25, uneven=True, copies=0.5),
    "millions": Shape(unit=2**25, uneven=True),
    "all 31 bits": Shape(unit=2**29 - 1, uneven=True, diagonals=True, clocks=2, constant=3),
}


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("block", range(2))
def test_engines_agree_on_seeded_networks(shape: str, block: int) -> None:
    for seed in seeds(range(10 * block, 10 * block + 10)):
        assert compare(random_case(Random(seed), SHAPES[shape]), VARIANTS, EFFORT).problems == (), f"seed {seed}"


def test_searches_over_local_times_agree_with_the_others() -> None:
    always = Options(local_times=LocalTimes.ALWAYS)
    local = (
        always,
        replace(always, order=SearchOrder.DFS, pack_clocks=0),
        replace(always, extrapolation=Extrapolation.MAX, bounds=BoundScope.GLOBAL),
        replace(always, subsumption=False, chunk_words=1, rows_after=0),
    )
    suited = stuck = 0
    for seed in seeds(range(24)):
        case = random_case(Random(seed), APART)
        program, goals = lower(case.network, case.predicates)
        is_suited = obstacle(encode(program, goals)) is None
        suited += is_suited
        stuck += is_suited and any(goal.asks_deadlock for goal in goals)
        assert compare(case, local, Effort(reference=100, sampled=150)).problems == (), f"seed {seed}"
    assert enough(suited > 16 and stuck > 4)


@pytest.mark.parametrize("shape", LONG_TIMES)
def test_engines_agree_on_long_times(shape: str) -> None:
    for seed in seeds(range(12)):
        assert compare(random_case(Random(seed), LONG_TIMES[shape]), VARIANTS, EFFORT).problems == (), f"seed {seed}"


@pytest.mark.parametrize("unit", [16383, 2**26, 2**29 - 1])
@pytest.mark.parametrize("diagonals", [False, True])
def test_times_a_thousand_times_as_long_mean_the_same(unit: int, diagonals: bool) -> None:
    """Pruning is left out: it drops fewer states where times are not counted in units."""
    shape, plain = Shape(diagonals=diagonals, clocks=2, constant=3), Options().off("pruning")
    for seed in seeds(range(15)):
        small = random_case(Random(seed), shape)
        large = random_case(Random(seed), replace(shape, unit=unit))
        program, goals = lower(small.network, small.predicates)
        expected = zone.explore(program, goals, plain, Limits(states=20_000))
        program, goals = lower(large.network, large.predicates)
        for options in (plain, replace(plain, scale=False), replace(plain, vector=False, scale=False)):
            found = zone.explore(program, goals, options, Limits(states=20_000))
            assert [g.status for g in found.goals] == [g.status for g in expected.goals], f"seed {seed}"
            assert found.statistics.states_stored == expected.statistics.states_stored, f"seed {seed}"


FAULTS = {
    "language": Shape(language=True, faults=0.08, exact=0.3, processes=2, locations=3, clocks=2, constant=3),
    "faults": Shape(language=True, faults=1.0, processes=2, locations=3, clocks=2, constant=3),
    "priorities": Shape(language=True, faults=1.0, priorities=True, processes=2, locations=3, clocks=1),
    "left out": Shape(language=True, faults=0.5, receivers=1, blockers=1, processes=2, locations=3, clocks=1),
    "stopwatches": Shape(language=True, faults=0.3, stopwatches=True, processes=2, locations=3, clocks=2),
    "diagonals": Shape(language=True, faults=0.3, exact=0.3, diagonals=True, processes=2, locations=3, clocks=2),
    "copies": Shape(language=True, faults=0.5, copies=0.5, processes=2, locations=3, clocks=2),
}
FEW_VARIANTS = (Options(order=SearchOrder.DFS), Options(extrapolation=Extrapolation.MAX), Options(chunk_words=1))


@pytest.mark.parametrize("shape", FAULTS)
def test_engines_agree_on_run_time_errors(shape: str) -> None:
    met = 0
    for seed in seeds(range(100, 116)):
        case = random_case(Random(seed), FAULTS[shape])
        everything = replace(case, predicates=(*case.predicates, Constant(0, BOOL)))
        agreement = compare(everything, FEW_VARIANTS, EFFORT)
        assert agreement.problems == (), f"seed {seed}"
        met += any(outcome.fault is not None for outcome in agreement.outcomes.values())
    assert enough(met > 0)


@settings(max_examples=40, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
@given(cases(Shape(processes=2, locations=3, clocks=2, constant=3)))
def test_engines_agree_on_networks_that_hypothesis_finds(case: RandomCase) -> None:
    assert compare(case, (), EFFORT).problems == ()


BEGUN = {
    "begun": Shape(starts=0.6, clocks=2, constant=3),
    "begun and compared": Shape(starts=0.6, diagonals=True, copies=0.3, advances=False, clocks=2, constant=3),
    "begun and stopped": Shape(starts=0.6, stopwatches=True, clocks=2, processes=2),
    "begun apart": replace(APART, starts=0.7),
    "begun later": Shape(starts=0.6, unit=200, uneven=True, diagonals=True, clocks=2, constant=3),
}
"""Clocks that do not begin with 0."""


@pytest.mark.parametrize("shape", BEGUN)
def test_engines_agree_where_clocks_begin_with_other_values(shape: str) -> None:
    variants = (*VARIANTS, Options(local_times=LocalTimes.ALWAYS))
    compared = 0
    for seed in seeds(range(6)):
        case = random_case(Random(seed), BEGUN[shape])
        with suppress(InputError):
            check_initial_state(prepare(case.network))
            assert compare(case, variants, EFFORT).problems == (), f"seed {seed}"
            compared += 1
    assert enough(compared > 3)
