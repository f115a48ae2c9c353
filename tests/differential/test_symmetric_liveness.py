"""Runs that avoid a goal, interchangeable processes sorted or not: the same answers, also where the goal asks for
clocks or for deadlock, so that steps end in parts of zones."""

from __future__ import annotations

from random import Random

import pytest

import tachk
from tachk import Answer, Limits, Options
from tachk.engine.options import NEVER
from tachk.engine.outcome import LivenessStatus, Obligation
from tachk.verify.verdict import Verdict, answers_of
from tests.support.oracles.liveness_reference import check_by_zones
from tests.support.oracles.liveness_regions import check_by_regions
from tests.support.seeds import enough, seeds
from tests.support.symmetric.cases import random_symmetric_case
from tests.support.symmetric.controllers import random_controller_case
from tests.support.symmetric.cycles import random_ring_case

pytestmark = pytest.mark.drawn

_OF_INSTANCES = (
    "P(1).L1",
    "P(1).x > 1",
    "P(1).L1 && P(1).x >= 1",
    "(P(1).x < 1 || P(1).x > 2)",
    "(exists (i : id_t) P(i).L1 && P(i).x > 1)",
    "(forall (i : id_t) P(i).x < 2)",
    "(forall (i : id_t) P(i).L0 imply P(i).x <= 1)",
    "(exists (i : id_t) P(i).L2)",
    "P(1).x - P(2).x > 0",
    "count == 2",
    "deadlock",
    "(deadlock && P(1).x > 1)",
)
_OF_PROCESSES = ("P1.L1", "x1 > 1", "(x1 < 1 || x2 > 2)", "P2.L2 && x2 >= 1", "(P1.L2 || P2.L2 || P3.L2)", "deadlock")
CASES = {
    "groups": (random_symmetric_case, _OF_INSTANCES),
    "rings": (random_ring_case, tuple(one.replace("P(2)", "P(0)") for one in _OF_INSTANCES)),
    "controllers": (random_controller_case, _OF_PROCESSES),
}
SORTED = (
    Options(),
    Options(proof_after=0),
    Options(proof_after=NEVER).off("attempts"),
    Options(subsumption=False),
    Options(pack_clocks=0, chunk_words=1),
)
PLAIN = Options().off("symmetry")
LIMITS = Limits(states=1500)


def random_questions(random: Random, conditions: tuple[str, ...]) -> list[str]:
    """Questions about runs; the last one has a clock."""
    clocks = [condition for condition in conditions if "x" in condition.replace("exists", "")]
    one, other, by_clocks = random.choice(conditions), random.choice(conditions), random.choice(clocks)
    goal = random.choice((by_clocks, f"{by_clocks} && {one}", f"{by_clocks} || {one}", f"!({by_clocks})"))
    return [
        f"A<> {one}",
        f"A<> {goal}",
        f"E[] !({goal})",
        f"{one} --> {other}",
        f"{other} --> {goal}",
        f"{goal} --> {one}",
    ]


def compared(seed: int, kind: str) -> list[tuple[Verdict, Verdict]]:
    """The verdicts of a sorted and of the plain search, where both are decided compared, and with the oracles."""
    random = Random(seed)
    draw, conditions = CASES[kind]
    model = tachk.loads(draw(random).text)
    if all("(" not in process.name for process in model.network.processes) and "P(1)" in str(conditions):
        return []  # instances by other names
    pairs = []
    for question in random_questions(random, conditions):
        (plain,) = model.verify(question, options=PLAIN, limits=LIMITS)
        for options in (SORTED[0], random.choice(SORTED[1:])):
            (one,) = model.verify(question, options=options, limits=LIMITS)
            if not (plain.reason.endswith("limit") or one.reason.endswith("limit")):
                assert (one.answer, one.fault is None) == (plain.answer, plain.fault is None), f"{seed}: {question}"
        pairs.append((one, plain))
        expected = _expected(model, plain)
        if expected is not None and one.answer is not Answer.UNKNOWN:
            assert one.answer is expected, f"{seed}: {question}"
    return pairs


def _expected(model: tachk.Model, verdict: Verdict) -> Answer | None:
    """The answer of two oracles; None if neither has one. They may meet fewer run-time errors."""
    query = verdict.query
    assert query.avoided is not None
    obligation = Obligation(query.avoided, query.begins)
    for oracle, most in ((check_by_zones, 100), (check_by_regions, 100)):
        outcome = oracle(model.network, obligation, Limits(states=most))
        if outcome.status is not LivenessStatus.UNDECIDED:
            return answers_of(query)[0 if outcome.status is LivenessStatus.FOUND else 1]
    return None


@pytest.mark.parametrize("kind", CASES)
def test_symmetry_changes_no_answer(kind: str) -> None:
    reduced = 0
    for seed in seeds(range(300, 308)):
        pairs = compared(seed, kind)
        reduced += sum(one.statistics.states_stored < plain.statistics.states_stored for one, plain in pairs)
    assert enough(reduced > 0)
