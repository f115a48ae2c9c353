"""From queries to verdicts."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tachk.base.diagnostics.diagnostic import InputError
from tachk.engine.options import Limits, Options, SearchOrder
from tachk.model.fault import RuntimeErrorKind
from tachk.verify.verdict import Answer, Verdict

Verdicts = Callable[..., dict[str, Verdict]]

COUNTER = """
int[0,3] n;
process P() {
    clock x;
    init location go {
        invariant x <= 2;
        to go { guard x >= 1 && n < 3; assign n++, x = 0; }
        to stop { guard n == 3; }
    }
    location stop;
}
system P;
property reaches : E<> n == 3 expect holds;
property small : A[] n <= 2 expect fails;
property bounded : A[] n <= 3;
property stops : E<> deadlock && P.stop;
property wrongly : A[] n <= 1 expect holds;
property slow : E<> n == 3 && P.x > 2 && P.go;
"""


def test_answers_expectations_and_evidence(verdicts: Verdicts) -> None:
    found = verdicts(COUNTER)
    assert list(found) == ["reaches", "small", "bounded", "stops", "wrongly", "slow"]
    assert {name: (v.answer, v.met) for name, v in found.items()} == {
        "reaches": (Answer.HOLDS, True),
        "small": (Answer.FAILS, True),
        "bounded": (Answer.HOLDS, True),
        "stops": (Answer.HOLDS, True),
        "wrongly": (Answer.FAILS, False),
        "slow": (Answer.FAILS, False),
    }
    assert all(v.exact and not v.reason and v.fault is None for v in found.values())
    assert {name for name, v in found.items() if v.trace is not None} == {"reaches", "small", "stops", "wrongly"}


def test_breadth_first_search_gives_the_shortest_run_with_the_earliest_times(verdicts: Verdicts) -> None:
    run = verdicts(COUNTER)["wrongly"].trace
    assert run is not None
    assert [step.delay for step in run.steps if step.transition is not None] == [1, 1]


@pytest.mark.parametrize("order", list(SearchOrder))
def test_the_order_of_search_changes_no_answer(verdicts: Verdicts, order: SearchOrder) -> None:
    found = verdicts(COUNTER, options=Options(order))
    assert [v.answer.value for v in found.values()] == ["holds", "fails", "holds", "holds", "fails", "fails"]


def test_no_trace_is_made_where_none_is_wanted(verdicts: Verdicts) -> None:
    assert all(v.trace is None for v in verdicts(COUNTER, trace=False).values())


@pytest.mark.parametrize(("limits", "reason"), [(Limits(states=2), "state limit"), (Limits(depth=1), "depth limit")])
def test_a_limit_gives_unknown_unless_the_answer_is_known_before(
    verdicts: Verdicts, limits: Limits, reason: str
) -> None:
    found = verdicts(COUNTER + "property at_once : E<> n == 0;", limits=limits)
    assert found["at_once"].answer is Answer.HOLDS
    bounded = found["bounded"]
    assert (bounded.answer, bounded.reason, bounded.met) == (Answer.UNKNOWN, reason, None)


def test_a_query_that_cannot_be_checked_leaves_the_others_alone(verdicts: Verdicts) -> None:
    found = verdicts(COUNTER + "property unsure : E<> deadlock + 1 == 1;\n")
    assert found["bounded"].answer is Answer.HOLDS
    unsure = found["unsure"]
    assert unsure.unsupported is not None
    assert (unsure.answer, unsure.unsupported.code) == (Answer.UNKNOWN, "E0706")
    assert unsure.unsupported.span.text.startswith("deadlock")


def test_only_violated_initial_invariants_are_named(verdicts: Verdicts) -> None:
    with pytest.raises(InputError) as caught:
        verdicts(
            "int n = 3;\n"
            "process Fine() { clock x; init location a { invariant x <= 2; } }\n"
            "process Free() { init location b; }\n"
            "process Broken() { init location c { invariant n < 3; } }\n"
            "process Late() { clock x; init location d { invariant x > 0; } }\n"
            "system Fine, Free, Broken, Late;\n"
            "property p : E<> n == 3;"
        )
    assert [(d.code, d.span.text) for d in caught.value.diagnostics] == [("E0409", "c"), ("E0409", "d")]
    assert "Broken.c" in caught.value.diagnostics[0].message


def test_an_update_that_goes_wrong_is_reported_with_its_values_and_run(verdicts: Verdicts) -> None:
    found = verdicts(
        "int[0,2] n;\n"
        "process P() { clock x; init location a { to a { guard x >= 4; assign n = n + 1, x = 0; } } }\n"
        "system P;\n"
        "property p : A[] n <= 2;\n"
        "property q : E<> n == 1;"
    )
    broken, early = found["p"], found["q"]
    assert (broken.answer, broken.met) == (Answer.UNKNOWN, None)
    assert broken.reason == "run-time error"
    fault = broken.fault
    assert fault is not None
    assert fault.kind is RuntimeErrorKind.RANGE
    assert "3" in fault.detail and "2" in fault.detail
    assert fault.run is not None
    assert [step.delay for step in fault.run.steps if step.transition is not None] == [4, 4]
    assert early.answer is Answer.HOLDS


def test_an_initial_invariant_that_cannot_be_evaluated_is_a_run_time_error(verdicts: Verdicts) -> None:
    found = verdicts(
        "int a[2]; int i = 2;\n"
        "process P() { init location s { invariant a[i] == 0; } }\n"
        "system P;\n"
        "property p : E<> P.s;"
    )
    fault = found["p"].fault
    assert found["p"].answer is Answer.UNKNOWN
    assert fault is not None and fault.kind is RuntimeErrorKind.INDEX


STOPWATCH = """
process P() {
    clock x, w;
    init location run { invariant w' == 0 && x <= 5; to done { guard x == 5 && w <= 3; } }
    location done { to done; }
}
system P;
property no_deadlock : A[] not deadlock;
property done : E<> P.done;
property moves : E<> P.w > 0 && P.run;
"""


def test_stopwatches_give_the_exact_answer_or_a_reason(verdicts: Verdicts) -> None:
    found = verdicts(STOPWATCH)
    for name, answer in [("no_deadlock", Answer.HOLDS), ("done", Answer.HOLDS), ("moves", Answer.FAILS)]:
        verdict = found[name]
        if verdict.answer is Answer.UNKNOWN:
            assert verdict.reason and not verdict.exact
        else:
            assert verdict.answer is answer


def test_a_stopwatch_that_deadlocks_does_not_hold(verdicts: Verdicts) -> None:
    text = STOPWATCH.replace("w <= 3", "w >= 1")
    verdict = verdicts(text)["no_deadlock"]
    assert verdict.answer is Answer.FAILS or (verdict.answer is Answer.UNKNOWN and verdict.reason)


def test_a_constant_that_is_stored_changes_the_state_in_its_chunk(verdicts: Verdicts) -> None:
    text = """
    int a[20];
    process P() {
        init location A {
            to A { guard a[19] == 0; assign a[19] = 1; }
            to A { guard a[18] == 0; assign a[18] = a[19] + 1; }
        }
    }
    system P;
    property Q : E<> a[19] == 1;
    """
    assert verdicts(text, options=Options(chunk_words=1))["Q"].answer is Answer.HOLDS


def test_a_state_that_is_covered_later_keeps_its_own_path(verdicts: Verdicts) -> None:
    text = """
    process P() {
        clock x;
        init location A { to B { guard x >= 5; } to B { guard x <= 1; } to M; }
        urgent location B;
        location M { to B; to N; }
        location N { to C; }
        location C;
    }
    system P;
    property near : E<> P.B && P.x <= 1;
    property late : E<> P.B && P.x >= 5;
    property far : E<> P.C && P.x >= 0;
    """
    found = verdicts(text)
    assert {verdict.answer for verdict in found.values()} == {Answer.HOLDS}
    assert found["near"].trace is not None


@pytest.mark.parametrize("query", ["A[] deadlock <= 2", "E<> deadlock + 1 > 0", "E<> n == deadlock + 1"])
def test_a_deadlock_is_not_a_number(query: str, verdicts: Verdicts) -> None:
    text = "int n; process P() { init location A { to A { guard n == 0; } } } system P; property Q : "
    verdict = verdicts(f"{text}{query};")["Q"]
    assert verdict.answer is Answer.UNKNOWN
    assert verdict.unsupported is not None
    assert (verdict.unsupported.code, verdict.unsupported.message) == (
        "E0706",
        "`deadlock` is not a number to compare or to count with",
    )
