from __future__ import annotations

import pytest

import tachk
from tachk.base.diagnostics.explanation import explanations
from tachk.engine.options import Limits
from tachk.model.run import TimedTrace
from tachk.verify.semantic_lint.findings import DeepCheck

pytestmark = pytest.mark.drawn

DEEP_CODES = explanations("semantic_lint")


def check(text: str, **limits: float) -> DeepCheck:
    return tachk.loads(text).check(Limits(**limits))  # type: ignore[arg-type]


@pytest.mark.parametrize("code", DEEP_CODES)
def test_the_examples_of_a_code_show_it(code: str) -> None:
    explanation = DEEP_CODES[code]
    assert code in [finding.code for finding in check(explanation.bad).findings]
    assert code not in [finding.code for finding in check(explanation.good).findings]
    assert found(explanation.good) == []


def found(text: str) -> list[tuple[str, str]]:
    """Everything but Zeno loops and unused names, which a short example is full of."""
    left_out = ("W0607", "W0608", "W0609")
    return [(finding.code, finding.span.text) for finding in check(text).findings if finding.code not in left_out]


def answer(result: DeepCheck, question: str) -> str:
    return next(part.answer for part in result.parts if part.question == question)


def test_a_location_that_no_process_of_the_template_reaches_is_reported_once() -> None:
    body = (
        "{ clock x; init location a { invariant x <= 3; to b { guard x > LIMIT; } to a { assign x = 0; } } "
        "location b; }"
    )
    declared = "process P(const int[0,1] k) "
    nobody = declared + body.replace("LIMIT", "4 + k") + "\nsystem P;"
    assert ("W0601", "b") in found(nobody)
    somebody = check(declared + body.replace("LIMIT", "3 - k") + "\nsystem P;")
    assert "W0601" not in [finding.code for finding in somebody.findings]
    assert answer(somebody, "locations never reached") == "none, and 1 only in some processes of a template"


def test_an_edge_is_reported_with_its_guard_where_that_is_the_reason() -> None:
    text = "int n;\nprocess P() { init location a { to a { guard n > 3; } to a { assign n = 1 - n; } } }\nsystem P;"
    assert found(text) == [("W0603", "n > 3")]


def test_an_edge_without_a_partner_is_reported() -> None:
    text = """chan c;
    process P() { init location a { to a { sync c!; } } }
    process Q() { init location a; location b { to b { sync c?; } } }
    system P, Q;"""
    assert [code for code, _ in found(text)] == ["W0606", "W0602"]


def test_what_constants_switch_off_is_not_reported() -> None:
    text = "const bool ON = false;\nprocess P() { init location a { to a { guard ON; } to a; } }\nsystem P;"
    assert found(text) == []


def test_a_guard_that_excludes_nothing() -> None:
    text = "int n;\nprocess P() { init location a { to a { guard n < 2; assign n = 1; } } }\nsystem P;"
    assert found(text) == [("W0604", "n < 2")]
    assert found(text.replace("n = 1", "n++")) == [("W0606", "a")]


def ends(result: DeepCheck) -> tuple[str, str]:
    return answer(result, "time-locks"), answer(result, "deadlocks in which time passes")


@pytest.mark.parametrize(
    ("location", "expected"),
    [
        ("location b { invariant x <= 3; }", ("reached by every run", "none")),
        ("location b { invariant n == 0 imply x <= 3; }", ("reached by every run", "none")),
        ("location b { invariant n == 1 imply x <= 3; }", ("none", "reached")),
        ("location b { invariant x >= 0; }", ("none", "reached")),
        ("location b { invariant x - y <= 3; }", ("none", "reached")),  # says nothing about time
        ("urgent location b;", ("reached by every run", "none")),
        ("committed location b;", ("reached by every run", "none")),
        ("location b;", ("none", "reached")),
        ("location b { invariant x <= 3; to a { assign x = 0; } }", ("none", "none")),
        ("location b { invariant x <= 3; to a { guard x >= 2; assign x = 0; } }", ("none", "none")),
    ],
)
def test_a_time_lock_is_distinguished_from_a_deadlock(location: str, expected: tuple[str, str]) -> None:
    start = "clock x, y; init location a { invariant x <= 1; to b; }"
    result = check(f"int n;\nprocess P() {{ {start} {location} }}\nsystem P;")
    assert ends(result) == expected


@pytest.mark.parametrize(
    ("location", "every"),
    [
        ("location b { invariant x <= 5; }", True),
        ("location b { invariant x <= 5; to c; } location c { invariant x <= 5; }", True),
        ("location b { invariant x <= 5; to a { guard n < 3; assign n++; } }", True),
        ("location b { invariant x <= 5; to a; }", False),
        ("location b { invariant x <= 5; to c; } location c;", False),
    ],
)
def test_where_every_run_ends_in_a_time_lock(location: str, every: bool) -> None:
    start = "clock x; init location a { invariant x <= 1; to b; to d; } location d { invariant x <= 1; }"
    result = check(f"int[0,3] n;\nprocess P() {{ {start} {location} }}\nsystem P;")
    assert answer(result, "time-locks") == ("reached by every run" if every else "reached")
    assert ("W0610" in [finding.code for finding in result.findings]) is every


def test_the_run_behind_a_time_lock_ends_in_it() -> None:
    result = check(
        "process P() { clock x; init location a { invariant x <= 2; to b { guard x == 2; } } "
        "location b { invariant x <= 3; } }\n"
        "system P;"
    )
    (evidence,) = result.evidence
    assert evidence.finding.code == "W0605"
    assert "P.b" in evidence.finding.message
    run: TimedTrace = evidence.run
    assert run.states[-1].discrete.locations == (1,)


def test_an_urgent_channel_stops_time_where_an_invariant_forbids_its_edges() -> None:
    result = check(
        "urgent chan go;\n"
        "process P() { clock x; init location a { to b { guard x >= 1; } } location b { to c { sync go!; } } "
        "location c { invariant x <= 0; } }\n"
        "process Q() { init location a { to a { sync go?; } } }\n"
        "system P, Q;"
    )
    assert ends(result) == ("reached", "not decided")
    (evidence,) = result.evidence
    assert evidence.finding.code == "W0605"
    assert "urgent channel" in evidence.finding.message
    assert "sync go!" in evidence.finding.span.text


def test_a_limit_that_is_hit_is_reported_and_nothing_is_claimed() -> None:
    text = "int[0,9999] n;\nprocess P() { init location a { to a { guard n < 9999; assign n++; } } location b; }\n"
    result = check(text + "system P;", states=100)
    assert result.reason == "state limit"
    assert not result.decided
    assert {finding.code for finding in result.findings} <= {"W0608", "W0609"}
    decided = [part.question for part in result.parts if not part.answer.startswith("not decided")]
    assert decided == ["edges never taken", "Zeno loops", "names never used or read"]
    assert check(text + "system P;", seconds=0.0).reason == "time limit"


def test_a_run_time_error_is_a_finding() -> None:
    result = check("int[0,3] n;\nprocess P() { init location a { to a { assign n++; } } }\nsystem P;")
    assert "E0761" in [finding.code for finding in result.findings]
    assert result.reason == "run-time error"


def test_a_guard_is_not_asked_where_the_model_does_not_ask_it() -> None:
    """Only a sender makes the guard of a receiver be asked: with n = 5 its index is wrong, and nobody sends then."""
    result = check("""chan c; int a[2]; int[0,5] n = 5;
    process P() { clock x; init location i {
        to i { guard a[n] == 1; sync c?; }
        to i { guard n > 0 && x >= 1; assign n--, x = 0; }
        to i { guard n == 0 && x >= 1; assign x = 0; } } }
    process Q() { clock y; init location t { to t { guard n == 0 && y >= 1; sync c!; assign y = 0; } } }
    system P, Q;""")
    assert result.reason == ""


def test_with_stopped_clocks_a_deadlock_is_not_decided() -> None:
    text = "process P() { clock x; init location a { invariant x <= 3 && x' == 0; } }\nsystem P;"
    assert ends(check(text)) == ("not decided", "not decided")
    assert ends(check(text.replace("x' == 0; }", "x' == 0; to a; }"))) == ("none", "none")


def zeno(text: str) -> str:
    return answer(check(f"{text}\nsystem P{', Q' if 'process Q' in text else ''};"), "Zeno loops")


RESET, WAIT = "assign x = 0;", "guard x >= 1;"


@pytest.mark.parametrize(
    ("there", "back", "possible"),
    [
        (RESET, WAIT, False),
        (WAIT, RESET, False),
        (f"{WAIT} {RESET}", "", False),
        (RESET, "guard x > 0;", True),  # ever shorter delays
        (RESET, "guard x == 1;", False),
        (RESET, "guard x > 1;", False),
        (RESET, "guard n > 0 imply x >= 1;", True),
        ("assign x = 1;", WAIT, True),
        ("assign x = 0, x = 1;", WAIT, True),
        ("", WAIT, True),  # never reset: time need not pass
        (RESET, "", True),
        ("guard k < 3; assign k++;", "", False),
        ("guard k < 3; assign k = k + 2;", "", False),
        ("assign k -= 1;", "assign k += 1;", True),
        ("assign k += n;", "", True),
        ("assign k = 1 - k;", "", True),
        (RESET, "guard y >= 1; assign y = 0;", False),
        (RESET, "guard y >= 1;", True),
        ("assign reset(x);", WAIT, True),  # a function may reset it only now and then
        ("guard n < 3; assign n++;", "", False),
        ("guard n < 3; assign n++;", "assign n = 0;", True),
        ("assign b = 1;", "", True),
        ("guard !b; assign b = 1;", "", False),
        ("guard !b; assign b = 1;", "assign b = 0;", True),
        ("guard n < 3; assign n = n + 1, n = 0;", "", True),
    ],
)
def test_a_circle_without_time_is_excluded_where_a_clock_or_a_variable_does(
    there: str, back: str, possible: bool
) -> None:
    text = f"""int[0,3] n; int k; bool b;
    void reset(clock &c) {{ if (b) c = 0; }}
    process P() {{ clock x, y; init location a {{ to c {{ {there} }} }} location c {{ to a {{ {back} }} }} }}"""
    assert zeno(text) == ("found" if possible else "none possible")


def test_a_circle_that_needs_a_partner_is_excluded_with_it() -> None:
    text = """{kind} c;
    process P() {{ init location a {{ to a {{ sync c{one}; }} }} }}
    process Q() {{ clock x; init location a {{ to a {{ guard x >= 2; sync c{other}; assign x = 0; }} }} }}"""
    assert zeno(text.format(kind="chan", one="!", other="?")) == "none possible"
    assert zeno(text.format(kind="chan", one="?", other="!")) == "none possible"
    assert zeno(text.format(kind="broadcast chan", one="?", other="!")) == "none possible"
    assert zeno(text.format(kind="broadcast chan", one="!", other="?")) == "found"


def test_a_clock_that_is_reset_elsewhere_need_not_be_reset_in_the_circle() -> None:
    loop, way = "to a { guard x >= 1; }", "to c { assign x = 0; } } location c { to a { guard x >= 1; }"
    assert zeno(f"process P() {{ clock x; init location a {{ {loop} {way} }} }}") == "found"
    assert zeno(f"process P() {{ clock x; init location a {{ {way} }} }}") == "none possible"


def test_a_receiver_writes_after_the_sender() -> None:
    """Its guard is asked before: n is 0 there, and 2 when the receiver takes 2 away."""
    text = """chan c; int[0,3] n;
    process P() { init location a { to a { sync c!; assign n = 2; } } }
    process Q() { init location a { to a { guard n == 0; sync c?; assign n = n - 2; } } }"""
    assert zeno(text) == "found"


def test_an_edge_that_is_never_taken_is_in_no_zeno_loop() -> None:
    assert zeno("int[0,1] n;\nprocess P() { init location a { to a { guard n == 1; } to b; } location b; }") == (
        "none possible"
    )
