"""Networks of two components with one counter of losses: the answers without one component are those of the whole."""

from __future__ import annotations

from random import Random

import pytest

import tachk
from tachk import Limits
from tachk.engine.outcome import Status
from tachk.verify import over_approximations
from tests.support.independent.lossy_links import compare, random_components
from tests.support.oracles import reference
from tests.support.seeds import enough, seeds

pytestmark = pytest.mark.drawn

LIMITS = Limits(states=2000)


@pytest.mark.parametrize("carried_over_from", [0, over_approximations.WORTH_CARRYING_OVER])
def test_leaving_out_a_component_changes_no_answer(carried_over_from: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(over_approximations, "WORTH_CARRYING_OVER", carried_over_from)
    first = 12 * (carried_over_from == 0)
    found = [compare(random_components(Random(seed)), LIMITS) for seed in seeds(range(first, first + 12))]
    assert [problem for one in found for problem in one.problems] == []
    assert enough(sum(one.fewer for one in found) > 4)


def test_leaving_out_a_component_agrees_with_the_plain_oracle() -> None:
    decided = 0
    for seed in seeds((1042, *range(1000, 1008))):
        case = random_components(Random(seed))
        model = tachk.loads(case.text)
        verdicts = list(model.verify(*case.queries[:4], limits=LIMITS))
        targets = [verdict.query.target for verdict in verdicts if verdict.query.target is not None]
        goals = reference.explore(model.network, targets, Limits(states=120)).goals
        for verdict, goal in zip(verdicts, goals, strict=True):
            if goal.status is not Status.UNDECIDED and not verdict.reason:
                decided += 1
                reached = (verdict.answer.value == "holds") == verdict.query.holds_when_reached
                assert reached == (goal.status is Status.REACHED), f"seed {seed}"
    assert enough(decided > 8)
