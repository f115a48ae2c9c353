"""`Model.estimate`."""

from __future__ import annotations

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.simulation.statistics.estimate import Estimated

TEXT = """
double share = 0.25;
process P() {
    committed init location A { to way; }
    branchpoint way { to B { probability 1; } to C { probability 3; } }
    location B; location C;
}
system P;
property p: Pr[<=1](<> P.B);
property q: E<> P.B;
"""


def test_a_model_answers_its_statistical_properties() -> None:
    found = tachk.loads(TEXT).estimate(seed=3, epsilon=0.1)
    assert len(found) == 1
    answer = found["p"]
    assert isinstance(answer, Estimated) and answer.low < 0.25 < answer.high
    assert found.to_dict()["answers"][0]["name"] == "p"
    assert found.to_text().startswith("p: ")


def test_it_answers_others_with_floating_point_variables() -> None:
    (answer,) = tachk.loads(TEXT).estimate("Pr[<=1](<> P.C && share < 0.5)", runs=200)
    assert isinstance(answer, Estimated) and answer.sample.runs == 200 and answer.low < 0.75 < answer.high


def test_what_asks_for_no_probability_is_rejected() -> None:
    with pytest.raises(UsageError):
        tachk.loads(TEXT).estimate("E<> P.B")
