"""States that are dropped because others simulate them: fewer states, the same answers."""

from __future__ import annotations

import pytest

import tachk
from tachk.base.resources import data_root
from tachk.engine.options import Extrapolation, Options
from tests.support.strategies import switched

MODEL = data_root() / "models" / "classics" / "single_sign_on.ta"


def stored(query: str, alu: bool, options: Options = Options()) -> tuple[str, int]:
    chosen = switched(options.off("merging", "symmetry", "local-times"), alu, "alu")
    (verdict,) = tachk.load(MODEL).verify(query, options=chosen, trace=False).record.verdicts
    return verdict.answer.value, verdict.statistics.states_stored


EVERYTHING = "A[] forall (i : id_t) Client(i).access imply Client(i).certificates >= Client(i).policy"


def test_what_is_simulated_is_not_stored() -> None:
    """TChecker stores as many states for its network of this name, with and without the algorithm aLU-covreach."""
    assert stored(EVERYTHING, alu=True) == ("holds", 265)
    assert stored(EVERYTHING, alu=False) == ("holds", 573)


@pytest.mark.parametrize(
    ("query", "answer"),
    [
        ("A[] deadlock imply exists (i : id_t) Client(i).begun >= EXPIRY", "holds"),
        ("sup{ Client(1).access }: Client(1).certificates", "holds"),
        ("inf{ Client(1).access }: Client(2).begun", "holds"),
    ],
)
def test_all_is_stored_where_more_matters_than_what_can_be_reached(query: str, answer: str) -> None:
    assert stored(query, alu=True) == stored(query, alu=False)
    assert stored(query, alu=True)[0] == answer


@pytest.mark.parametrize(
    "options", [Options(subsumption=False), Options(extrapolation=Extrapolation.MAX)], ids=["all", "max"]
)
def test_other_options_stay_what_they_are(options: Options) -> None:
    fewer, all_ = stored(EVERYTHING, True, options), stored(EVERYTHING, False, options)
    assert fewer[0] == all_[0] == "holds"
    assert (fewer == all_) == (not options.subsumption)
