"""Numbers out of their range are the user's mistake, never the core's surprise."""

from __future__ import annotations

from typing import Any

import pytest

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.span import Source
from tachk.engine.options import Limits, Options
from tachk.formats.loading.load import load_model
from tachk.verify.verdict import Answer
from tachk.verify.verify import verify


@pytest.mark.parametrize(
    "wrong",
    [{"seed": -1}, {"seed": 2**32}, {"chunk_words": -1}, {"chunk_words": 2**40}, {"width": 8}, {"width": 17}],
)
def test_an_option_out_of_its_range_is_rejected(wrong: dict[str, Any]) -> None:
    with pytest.raises(UsageError, match=next(iter(wrong))):
        Options(**wrong)


@pytest.mark.parametrize(
    "wrong", [{"states": -1}, {"seconds": -0.5}, {"seconds": float("nan")}, {"memory_bytes": -1}, {"depth": -1}]
)
def test_a_limit_below_zero_is_rejected(wrong: dict[str, Any]) -> None:
    with pytest.raises(UsageError, match=next(iter(wrong))):
        Limits(**wrong)


def test_limits_beyond_all_bounds_are_none() -> None:
    loaded = load_model(
        Source("model.ta", "process P() { init location a { to a; } } P1 = P(); system P1; property p : E<> P1.a;")
    )
    limits = Limits(states=2**64, seconds=1e300, memory_bytes=10**30, depth=2**32)
    (verdict,) = verify(loaded.network, loaded.queries, options=Options(seed=2**32 - 1), limits=limits)
    assert verdict.answer is Answer.HOLDS
