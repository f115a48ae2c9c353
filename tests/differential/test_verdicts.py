"""Whole verdicts with and without each reduction; `bench/random_agreement.py` does it for thousands of networks."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

import pytest

from tachk.verify.verdict import Answer
from tests.support.reductions.verdict_agreement import compare_verdicts, random_questions, ways_of
from tests.support.seeds import enough, seeds
from tests.support.strategies import without_first_tries

pytestmark = pytest.mark.drawn


@pytest.fixture
def _without_first_tries() -> Iterator[None]:
    with without_first_tries():
        yield


@pytest.mark.usefixtures("_without_first_tries")
@pytest.mark.parametrize("block", range(3))
def test_no_reduction_changes_a_verdict(block: int) -> None:
    decided: Counter[str] = Counter()
    fewer = 0
    for seed in seeds(range(20_000 + 10 * block, 20_010 + 10 * block)):
        found = compare_verdicts(random_questions(seed), ways_of(seed))
        assert found.problems == (), f"seed {seed}"
        for name, verdicts in found.verdicts.items():
            decided[name] += sum(verdict.answer is not Answer.UNKNOWN for verdict in verdicts)
        plain, default = (found.verdicts[name] for name in ("no reduction", "default"))
        fewer += sum(
            one.statistics.states_stored < other.statistics.states_stored
            for one, other in zip(default, plain, strict=True)
        )
    assert enough(decided["no reduction"] > 30 and decided["default"] > 30 and fewer > 5)
