"""Runs of the slice that preserves liveness, carried over to the whole network, against searches of it."""

from __future__ import annotations

from collections import Counter
from random import Random

import pytest

from tachk.engine.options import Limits, Options
from tachk.engine.outcome import LivenessStatus, Obligation
from tachk.meaning.discrete import prepare
from tachk.model.query import Query, QueryKind
from tachk.model.random_networks import RandomCase
from tachk.transform.liveness_slice import liveness_preserving_slice
from tachk.verify.plan import Analysis, Search, Task
from tachk.verify.strategies import avoidable
from tachk.verify.verdict import Answer
from tests.support import Shape, random_case
from tests.support.obligations import random_obligations
from tests.support.oracles.liveness_reference import check_by_zones
from tests.support.oracles.liveness_regions import check_by_regions
from tests.support.seeds import enough, seeds

pytestmark = pytest.mark.drawn

SMALL = {"processes": 2, "locations": 3, "clocks": 2, "constant": 3, "deadlocks": False}
SHAPES = {
    "companions": Shape(**SMALL, companions=2),
    "many companions": Shape(**{**SMALL, "processes": 1}, companions=4),
    "blockers": Shape(**SMALL, companions=1, blockers=2),
    "watchers": Shape(**SMALL, companions=1, receivers=2),
    "hurried": Shape(**SMALL, companions=2, hurried=0.5),
    "faults": Shape(**SMALL, companions=2, language=True, faults=0.3),
}
LIMITS = Limits(states=20_000)
PLAIN = Options().off("sliced")
CARRIED = Options().off("some-states", "any-run")
"""What is found is a run that was carried over, or none."""


def query_of(obligation: Obligation) -> Query:
    if obligation.trigger is None:
        return Query("q", QueryKind.EVENTUALLY, obligation.goal)
    return Query("q", QueryKind.LEADS_TO, obligation.trigger, (obligation.goal,))


def compared(case: RandomCase, obligation: Obligation) -> tuple[str, set[Answer]]:
    """Who has answered where only runs carried over count, and all answers."""
    model, search = prepare(case.network), Search(Analysis.LIVENESS, (Task(0, query_of(obligation)),))
    verdicts = [avoidable(model, search, each, LIMITS, True)[0] for each in (CARRIED, PLAIN, Options())]
    answers = {verdict.answer for verdict in verdicts}
    for check in (check_by_regions, check_by_zones):
        status = check(case.network, obligation, Limits(states=300)).status
        if status is not LivenessStatus.UNDECIDED:
            answers.add(Answer.FAILS if status is LivenessStatus.FOUND else Answer.HOLDS)
    return verdicts[0].strategy, answers - {Answer.UNKNOWN}


@pytest.mark.parametrize("shape", SHAPES)
def test_answers_are_those_of_the_whole_network(shape: str) -> None:
    by: Counter[str] = Counter()
    for seed in seeds(range(24)):
        random = Random(seed)
        case = random_case(random, SHAPES[shape])
        for obligation in random_obligations(random, case, 2):
            asked = [one for one in (obligation.goal, obligation.trigger) if one is not None]
            if liveness_preserving_slice(case.network, asked).network == case.network:
                continue
            who, answers = compared(case, obligation)
            assert len(answers) <= 1, f"seed {seed}"
            by[who] += 1
    assert enough(by["accompanied"] > 0 and by["sliced"] > 0)
