"""However many threads look for states: the same states, the same answers, the same runs."""

from __future__ import annotations

from dataclasses import replace
from random import Random

import pytest

import tachk
from tachk.base.resources import data_root
from tachk.engine.compiler.lower import lower
from tachk.engine.options import Extrapolation, Limits, LocalTimes, Options, SearchOrder
from tachk.engine.outcome import Outcome, Status
from tachk.engine.zone import explore, explore_everything
from tachk.model.random_networks import RandomCase, Shape, random_case
from tests.support.oracles import reference
from tests.support.symmetric.cases import random_symmetric_case

ONE = Options(threads=1, threads_after=0, local_times=LocalTimes.NEVER)
SHAPES = (
    Shape(groups=2, clocks=2, processes=3, locations=4),
    Shape(groups=3, hurried=0.5, clocks=1, processes=2, locations=3),
    Shape(groups=2, clocks=2, processes=2, locations=3, copies=0.5),
    Shape(language=True, faults=0.5, clocks=3, processes=4, locations=5),
    Shape(groups=2, clocks=2, processes=2, locations=4, diagonals=True),
    Shape(groups=2, priorities=True, clocks=2, processes=2, locations=4),
    Shape(stopwatches=True, clocks=3, processes=4, locations=5),
)
VARIANTS = (
    ONE,
    replace(ONE, shortest=True),
    replace(ONE, order=SearchOrder.PROGRESS),
    replace(ONE, subsumption=False, order=SearchOrder.BFS),
    replace(ONE, extrapolation=Extrapolation.MAX, pack_clocks=0),
    replace(ONE.off("alu"), chunk_words=1, rows_after=0),
    replace(ONE, reclaim=False, width=64),
)


def told(outcome: Outcome) -> Outcome:
    """All of it but how long it took, and how many threads."""
    return replace(outcome, statistics=replace(outcome.statistics, seconds=0.0, user_seconds=0.0, threads=1))


def searched(case: RandomCase, options: Options, limits: Limits) -> Outcome:
    program, goals = lower(case.network, case.predicates)
    return told(explore(program, goals, options, limits))


@pytest.mark.parametrize("block", range(4))
def test_random_networks(block: int) -> None:
    large = 0
    for seed in range(50 * block, 50 * block + 50):
        case = random_case(Random(seed), SHAPES[seed % len(SHAPES)])
        options = VARIANTS[seed % len(VARIANTS)]
        limits = Limits(states=Random(seed).choice((60, 1_000)))
        alone = searched(case, options, limits)
        for threads in (2, 3):
            assert searched(case, replace(options, threads=threads), limits) == alone, f"seed {seed}"
        large += alone.statistics.states_stored > 20
    assert large > 10


def test_zones_that_diagonals_split() -> None:
    """A piece may be covered although the whole is not."""
    several = 0
    for seed in range(97, 136, 2):
        case = random_case(Random(seed), Shape(diagonals=True, clocks=2, constant=3))
        alone = searched(case, ONE, Limits(states=1_000))
        assert searched(case, replace(ONE, threads=2), Limits(states=1_000)) == alone, f"seed {seed}"
        several += alone.statistics.states_stored > 4
    assert several > 8


@pytest.mark.parametrize("chunk_words", [0, 1, 8])
def test_large_discrete_states(chunk_words: int) -> None:
    """They are held in parts, of which a successor has most."""
    model = tachk.load(data_root() / "models" / "micro_xrce_dds" / "publication.ta")
    one, two = (
        model.verify(
            "E<> false",
            options=replace(ONE.off("unblocked", "sliced"), threads=threads, chunk_words=chunk_words),
            limits=Limits(states=3_000),
        )[0].statistics
        for threads in (1, 2)
    )
    assert replace(two, seconds=0.0, user_seconds=0.0, threads=1) == replace(one, seconds=0.0, user_seconds=0.0)
    assert two.threads == 2 and two.states_stored > 2_500


@pytest.mark.parametrize("threads", [1, 2, 3])
@pytest.mark.parametrize("query", ["A[] forall (p : pid_t) P(p).critical imply id == p", "A[] not deadlock"])
def test_as_many_threads_work_as_are_asked_for(threads: int, query: str) -> None:
    model = tachk.load(data_root() / "models" / "classics" / "fischer.ta", N=5)
    for options in (
        replace(ONE.off("symmetry"), threads=threads),
        replace(ONE.off("symmetry"), threads=threads, shortest=True),
        replace(ONE.off("unblocked", "sliced"), threads=threads, order=SearchOrder.PROGRESS),
    ):
        (verdict,) = model.verify(query, options=options)
        assert verdict.statistics.threads == threads


def test_several_threads_work_also_before_less_is_known() -> None:
    model = tachk.load(data_root() / "models" / "classics" / "csma_cd.ta", N=4)
    (verdict,) = model.verify(property="collision_noticed", options=replace(ONE, threads=2))
    assert verdict.statistics.threads == 2 and verdict.statistics.less_known == ()


def test_one_thread_works_where_others_could_not_help() -> None:
    model = tachk.load(data_root() / "models" / "classics" / "fischer.ta", N=4)
    for options in (
        replace(ONE.off("symmetry"), threads=2, threads_after=64, order=SearchOrder.DFS),
        replace(ONE.off("symmetry"), threads=2, passing=8),
        replace(ONE.off("symmetry"), threads=2, threads_after=10_000),
    ):
        (verdict,) = model.verify("A[] not deadlock", options=options)
        assert verdict.statistics.threads == 1


def test_random_networks_against_the_plain_oracle() -> None:
    decided = 0
    for seed in range(300, 330):
        case = random_case(Random(seed), Shape(clocks=2, processes=2))
        plain = reference.explore(case.network, case.predicates, Limits(states=150))
        found = searched(case, replace(ONE, threads=2), Limits())
        for one, other in zip(plain.goals, found.goals, strict=True):
            decided += one.status is not Status.UNDECIDED
            assert one.status in (Status.UNDECIDED, other.status), f"seed {seed}"
    assert decided > 15


def test_everything_that_is_taken_is_told() -> None:
    for seed in range(700, 740):
        case = random_case(Random(seed), SHAPES[seed % len(SHAPES)])
        program, goals = lower(case.network, case.predicates)
        found = [
            explore_everything(program, goals, replace(ONE, threads=threads), Limits(states=300)) for threads in (1, 2)
        ]
        (one, taken), (other, also_taken) = found
        assert (told(one), taken) == (told(other), also_taken), f"seed {seed}"


def test_interchangeable_processes() -> None:
    for seed in range(8):
        case = random_symmetric_case(Random(seed))
        model = tachk.loads(case.text)
        one, other = (
            [
                (verdict.answer, verdict.reason, verdict.trace, verdict.statistics.states_explored)
                for verdict in model.verify(
                    *case.queries, options=replace(ONE, threads=threads), limits=Limits(states=500), trace=True
                )
            ]
            for threads in (1, 3)
        )
        assert one == other, f"seed {seed}"


def test_a_hundred_repetitions_find_the_same_run() -> None:
    model = tachk.load(data_root() / "models" / "classics" / "fischer.ta", N=5)
    options = ONE.off("symmetry")

    def found(threads: int) -> list[object]:
        how = replace(options, threads=threads)
        verdicts = model.verify(
            "E<> exists (p : pid_t) P(p).critical && id != p", "A[] not deadlock", options=how, trace=True
        )
        return [
            (verdict.answer, verdict.trace, replace(verdict.statistics, seconds=0.0, user_seconds=0.0, threads=1))
            for verdict in verdicts
        ]

    alone = found(1)
    assert all(found(2) == alone for _ in range(100))
    assert all(found(3 + number % 2) == alone for number in range(6))
