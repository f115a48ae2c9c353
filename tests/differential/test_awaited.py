"""Formulas without deadline against an oracle without observers and zones; `bench/awaited_agreement.py` does more."""

from __future__ import annotations

import pytest

from tests.support.endless.awaited_agreement import compare_awaited
from tests.support.endless.awaited_oracle import FORMS
from tests.support.seeds import enough, seeds

pytestmark = pytest.mark.drawn


@pytest.mark.parametrize("block", range(len(FORMS)))
def test_formulas_without_deadline_are_decided_as_the_tables_say(block: int) -> None:
    found = [
        each for seed in seeds(range(5 * block, 5 * block + 5)) for each in compare_awaited(seed, FORMS[block:][:2])
    ]
    assert enough(len(found) > 4)
    assert [each for each in found if not each.agrees] == []
