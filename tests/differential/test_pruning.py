"""Random networks in which much is lost: the answers with and without dropping it are the same, runs are replayed,
and no run-time error is overlooked."""

from __future__ import annotations

from random import Random

import pytest

import tachk
from tachk.engine.compiler.lower import lower
from tachk.engine.options import BoundScope, Extrapolation, Limits, LocalTimes, Options, SearchOrder
from tachk.engine.outcome import Status
from tachk.engine.zone import explore
from tachk.verify.verdict import Answer, Verdict
from tachk.verify.verify import verify
from tests.support.missed_moments import random_missed_moments
from tests.support.oracles import reference
from tests.support.queries import elaborate_queries
from tests.support.seeds import seeds

WAYS = (
    Options(),
    Options().off("cone", "symmetry", "local-times", "unblocked", "merging", "alu", "attempts"),
    Options(order=SearchOrder.DFS),
    Options(partial_order=True),
    Options(extrapolation=Extrapolation.MAX),
    Options(shortest=True),
    Options(local_times=LocalTimes.ALWAYS),
    Options(subsumption=False, order=SearchOrder.BFS),
    Options(order=SearchOrder.BEST_FIRST),
    Options(vector=False, scale=False, bounds=BoundScope.GLOBAL),
    Options(pack_clocks=0),
)
LIMITS = Limits(states=20_000)


def is_proof(verdict: Verdict) -> bool:
    """Whether the verdict says that no run reaches the target, and that none meets a run-time error."""
    absent = Answer.HOLDS if verdict.query.holds_when_reached is False else Answer.FAILS
    return verdict.answer is absent and not verdict.unexamined


@pytest.mark.parametrize("seed", seeds(range(60)))
def test_random_networks(seed: int) -> None:
    case = random_missed_moments(Random(seed))
    model = tachk.loads(case.text)
    queries, _ = elaborate_queries(model.loaded, "\n".join(case.queries))
    way = WAYS[seed % len(WAYS)]
    for group in [queries] if seed % 3 == 0 else [(query,) for query in queries]:
        pruned, whole = (verify(model.network, group, options, LIMITS) for options in (way, way.off("pruning")))
        for one, other in zip(pruned, whole, strict=True):
            assert {one.answer, other.answer} != {Answer.HOLDS, Answer.FAILS}, one.query.text
            assert other.fault is None or not is_proof(one), "a run-time error is overlooked"
            assert one.fault is None or not is_proof(other)
            assert one.answer is not Answer.UNKNOWN or one.fault or other.answer is Answer.UNKNOWN
            if way.shortest and one.trace is not None and other.trace is not None:
                assert len(one.trace.path) == len(other.trace.path)


@pytest.mark.parametrize("seed", seeds(range(15)))
def test_the_reference_agrees(seed: int) -> None:
    case = random_missed_moments(Random(seed))
    model = tachk.loads(case.text)
    queries, _ = elaborate_queries(model.loaded, "\n".join(case.queries))
    for query in queries:
        assert query.target is not None
        program, goals = lower(model.network, [query.target])
        found = explore(program, goals, WAYS[seed % len(WAYS)], LIMITS).goals[0].status
        plain = reference.explore(model.network, [query.target], Limits(states=300)).goals[0].status
        assert {found, plain} != {Status.REACHED, Status.UNREACHABLE}, query.text
