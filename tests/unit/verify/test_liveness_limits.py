"""Searches for runs that end early, or at a run-time error: what is proved is said, what is not is unknown."""

from __future__ import annotations

import pytest

from tachk.engine.options import NEVER, Limits, Options
from tachk.model.fault import RuntimeErrorKind
from tachk.verify import liveness
from tachk.verify.verdict import Answer
from tests.support.strategies import switched

ROUNDS = """\
int n = 0;
process P() {
    clock x;
    init location a { invariant x <= 2; to b { guard x >= 1 && n < 50; assign x = 0, n++; } to c { guard n == 50; } }
    location b { invariant x <= 2; to a { guard x >= 1; assign x = 0; } }
    location c;
}
system P;
"""
QUERIES = "property met : A<> P.c; property answered : P.a && n == 3 --> P.c;"


@pytest.mark.parametrize("proof_after", [0, NEVER])
@pytest.mark.parametrize(
    ("limits", "reason"),
    [
        (Limits(states=10), "state limit"),
        (Limits(memory_bytes=1000), "memory limit"),
        (Limits(depth=20), "depth limit"),
        (Limits(seconds=0.0), "time limit"),
    ],
)
def test_a_limit_gives_no_verdict(verdicts, limits: Limits, reason: str, proof_after: int) -> None:
    options = Options(proof_after=proof_after)
    for verdict in verdicts(ROUNDS + QUERIES, options=options).values():
        assert verdict.answer is Answer.HOLDS
    for verdict in verdicts(ROUNDS + QUERIES, options=options, limits=limits).values():
        assert (verdict.answer, verdict.reason) == (Answer.UNKNOWN, reason)


def test_a_run_that_is_found_within_the_limits_is_a_verdict(verdicts) -> None:
    found = verdicts(ROUNDS + "property met : A<> n == 60;", limits=Limits(depth=102))
    assert found["met"].answer is Answer.FAILS


def test_a_run_is_found_before_all_states_are_reached(verdicts) -> None:
    text = """\
int n = 0;
process P() { init location a { to c; to a { guard n < 500; assign n++; } } location c; }
system P;
property back : P.c && n == 2 --> P.a;
"""
    early, late = (
        verdicts(text, options=switched(Options(), attempts, "attempts"))["back"] for attempts in (True, False)
    )
    assert early.answer is late.answer is Answer.FAILS
    assert early.statistics.states_explored < 50 < 500 < late.statistics.states_explored
    assert early.trace is not None and len(early.trace.steps) == 3


@pytest.mark.parametrize("proof_after", [0, NEVER])
def test_a_run_time_error_on_the_way_gives_no_verdict(verdicts, proof_after: int) -> None:
    text = ROUNDS.replace("int n = 0", "int[0, 20] n = 0")
    for verdict in verdicts(text + QUERIES, options=Options(proof_after=proof_after)).values():
        assert verdict.answer is Answer.UNKNOWN
        assert verdict.fault is not None and verdict.fault.kind is RuntimeErrorKind.RANGE
        assert verdict.fault.run is not None and len(verdict.fault.run.steps) >= 40


def test_an_error_behind_the_goal_does_not_count(verdicts) -> None:
    text = ROUNDS.replace("int n = 0", "int[0, 20] n = 0")
    assert verdicts(text + "property met : A<> n == 5;")["met"].answer is Answer.HOLDS


def test_a_goal_that_fails_to_have_a_value_is_an_error(verdicts) -> None:
    found = verdicts("int t[3]; " + ROUNDS + "property met : A<> t[n] == 1;")
    assert found["met"].fault is not None
    assert found["met"].fault.kind is RuntimeErrorKind.INDEX


def test_an_answer_stands_where_there_is_no_time_to_find_delays(verdicts, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(liveness, "SECONDS_FOR_DELAYS", 0.0)
    found = verdicts(
        ROUNDS + "property met : A<> n == 60; property stays : E[] n < 60; property answered : P.a --> n == 60;"
    )
    answers = {"met": Answer.FAILS, "stays": Answer.HOLDS, "answered": Answer.FAILS}
    assert {name: verdict.answer for name, verdict in found.items()} == answers
    for verdict in found.values():
        assert verdict.exact and verdict.trace is None
        assert verdict.notes == (liveness.NO_DELAYS,)


def test_without_delays_a_run_along_which_clocks_stop_proves_nothing(verdicts, monkeypatch: pytest.MonkeyPatch) -> None:
    text = """\
process P() { clock x; init location a { invariant x' == 0; to b; } location b; }
system P;
property met : A<> P.b;
"""
    assert verdicts(text)["met"].answer is Answer.FAILS
    monkeypatch.setattr(liveness, "SECONDS_FOR_DELAYS", 0.0)
    verdict = verdicts(text)["met"]
    assert verdict.answer is Answer.UNKNOWN and verdict.trace is None and not verdict.exact


GOING_ROUND = """\
process P(const int[0, 8] me) {
    clock x;
    init location a { invariant x <= 3; to b { guard x >= 1; assign x = 0; } }
    location b { invariant x <= 3; to c { guard x >= 1; assign x = 0; } }
    location c { invariant x <= 3; to a { guard x >= 1; assign x = 0; } }
}
system P;
property met : A<> P(0).c && P(1).c;
"""


def test_a_run_is_found_during_the_search_for_a_proof(verdicts) -> None:
    """Depth first it takes a few more states than are explored before the proof, which has no end here."""
    limits = Limits(states=60_000)
    assert verdicts(GOING_ROUND, limits=limits)["met"].answer is Answer.FAILS
    assert verdicts(GOING_ROUND, options=Options().off("attempts"), limits=limits)["met"].reason == "state limit"
