"""Interchangeable processes sorted or not: the same answers, and runs that replay with the names of the model."""

from __future__ import annotations

from random import Random

import pytest

import tachk
from tachk import Limits, Options
from tachk.engine.options import LocalTimes
from tachk.engine.outcome import Status
from tachk.verify import reachability
from tests.support.oracles import reference
from tests.support.seeds import enough, seeds
from tests.support.strategies import with_states
from tests.support.symmetric.cases import random_symmetric_case
from tests.support.symmetric.controllers import random_controller_case
from tests.support.symmetric.cycles import random_ring_case
from tests.support.symmetric.registers import random_register_case

pytestmark = pytest.mark.drawn

LIMITS = Limits(states=1500)


CASES = {
    "groups": random_symmetric_case,
    "rings": random_ring_case,
    "controllers": random_controller_case,
    "registers": random_register_case,
}


@pytest.mark.parametrize("kind", CASES)
@pytest.mark.parametrize("block", range(2))
def test_symmetry_changes_no_answer(kind: str, block: int, monkeypatch: pytest.MonkeyPatch) -> None:
    with_states(monkeypatch, "few-states", 0)
    reduced = of_all = 0
    ways = (Options(), Options(local_times=LocalTimes.ALWAYS), Options().off("symmetry"))
    for seed in seeds(range(12 * block, 12 * block + 12)):
        case = CASES[kind](Random(seed))
        model = tachk.loads(case.text)
        found = (list(model.verify(*case.queries, options=options, limits=LIMITS)) for options in ways)
        for one, local, other in zip(*found, strict=True):
            reduced += one.statistics.states_stored < other.statistics.states_stored
            of_all += one.statistics.asked_of_all
            if not other.reason.endswith("limit"):
                assert (one.answer, one.fault is None) == (other.answer, other.fault is None), f"seed {seed}"
                same = (local.answer, local.fault is None) == (other.answer, other.fault is None)
                assert same or local.reason.endswith("limit"), f"seed {seed}"
    assert enough(reduced > 0)
    assert enough(of_all > 0)


@pytest.mark.parametrize("kind", CASES)
def test_short_runs_change_no_answer(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Looked for in small networks, too. Runs that are found are replayed."""
    monkeypatch.setattr(reachability, "_MANY_EDGES", 0)
    found = 0
    for seed in seeds(range(300, 312)):
        case = CASES[kind](Random(seed))
        model = tachk.loads(case.text)
        attempted = model.verify(*case.queries)
        for one, other in zip(attempted, model.verify(*case.queries, options=Options().off("first-runs")), strict=True):
            found += one.strategy in ("simulated", "best-first")
            assert (one.answer, one.fault is None) == (other.answer, other.fault is None), f"seed {seed}"
            assert one.trace is None or one.strategy == other.strategy or len(one.trace.steps) <= 32
    assert enough(found > 0)


@pytest.mark.parametrize("kind", CASES)
def test_symmetry_agrees_with_the_plain_oracle(kind: str) -> None:
    decided = 0
    for seed in seeds(range(200, 206)):
        case = CASES[kind](Random(seed))
        model = tachk.loads(case.text)
        for verdict in model.verify(*case.queries, limits=LIMITS):
            assert verdict.query.target is not None
            (goal,) = reference.explore(model.network, [verdict.query.target], Limits(states=150)).goals
            if goal.status is not Status.UNDECIDED and not verdict.reason:
                decided += 1
                reached = (verdict.answer.value == "holds") == verdict.query.holds_when_reached
                assert reached == (goal.status is Status.REACHED), f"seed {seed}"
    assert enough(decided > 3)
