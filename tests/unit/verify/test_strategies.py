"""The tables of strategies: what each is worth, how they are switched off, and that budgets are kept."""

from __future__ import annotations

from dataclasses import replace

import pytest

import tachk
from tachk import Limits, Options
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.job import OutOfTimeError
from tachk.verify import strategies
from tachk.verify.strategy import NO_STRATEGY, Decides, Findings, Problem
from tests.support.strategies import changed, rows

MODEL = """
chan go;
process P() { clock x; init location A { to B { guard x >= 2; sync go!; } } location B; }
process Q() { init location C { to D { sync go?; } } location D; }
system P, Q;
property reached : E<> P.B;
property never : A[] P.B imply P.x >= 2;
property always : A<> P.B;
"""


def test_each_verdict_names_its_strategy() -> None:
    named = {verdict.query.name: verdict.strategy for verdict in tachk.loads(MODEL).verify().record.verdicts}
    assert named == {"reached": "zones", "never": "zones", "always": "any-run"}


def test_names_are_held_apart() -> None:
    names = [row.name for row in rows()]
    assert len(names) == len(set(names))
    assert not set(names) & {"alu", "merging", "attempts", "cone", "symmetry", "local-times"}


@pytest.mark.parametrize("name", strategies.names())
def test_without_a_strategy_no_known_answer_changes(name: str) -> None:
    model = tachk.loads(MODEL)
    usual = model.verify().record.verdicts
    for verdict, other in zip(usual, model.verify(options=Options().off(name)).record.verdicts, strict=True):
        assert other.strategy != name
        assert other.answer is verdict.answer or other.reason == NO_STRATEGY


def test_a_name_that_there_is_not_is_an_error() -> None:
    with pytest.raises(UsageError, match="no strategy `unblokked`"):
        tachk.loads(MODEL).verify(options=Options().off("unblokked"))


def test_a_strategy_that_is_stopped_leaves_the_others_their_turn() -> None:
    def stopped(problem: Problem) -> Findings:
        raise OutOfTimeError

    with changed(lambda row: replace(row, run=stopped) if row.name == "unblocked" else row):
        (verdict,) = tachk.loads(MODEL).verify(property="never").record.verdicts
    assert (verdict.answer.value, verdict.strategy) == ("holds", "zones")


def test_what_a_strategy_does_not_decide_is_not_believed() -> None:
    with changed(lambda row: replace(row, decides=Decides.REACHED) if row.name in ("unblocked", "zones") else row):
        reached, never = tachk.loads(MODEL).verify(property=["reached", "never"]).record.verdicts
    assert reached.answer.value == "holds"
    assert (never.answer.value, never.reason) == ("unknown", NO_STRATEGY)


def test_no_search_stores_more_than_its_budget() -> None:
    text = "int[0,5000] n; process P() { init location A { to A { guard n < 5000; assign n++; } } } system P;"
    (verdict,) = tachk.loads(text).verify("A[] n < 5000", limits=Limits(states=100))
    assert verdict.reason == "state limit"
    assert verdict.statistics.states_stored < 200
