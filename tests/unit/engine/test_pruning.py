"""States from which a goal is out of reach are dropped: which ones are, and which ones must not be."""

from __future__ import annotations

from io import BytesIO

import pytest

import tachk
from tachk.base.resources import data_root
from tachk.engine.options import Options
from tachk.meaning.judge.certificate import CertificateWriter, read_certificates
from tachk.verify.certificates import Checker, check_proof, find_proof
from tachk.verify.verdict import Verdict
from tests.support.strategies import switched

ALONE = Options().off("cone", "unblocked", "symmetry", "local-times", "merging", "alu", "attempts")


def searched(text: str, query: str, options: Options = ALONE) -> tuple[Verdict, Verdict]:
    """The verdicts with and without pruning."""
    with_it, without = (
        next(iter(tachk.loads(text).verify(query, options=switched(options, on, "pruning")).record.verdicts))
        for on in (True, False)
    )
    assert without.statistics.lost == 0
    assert with_it.answer is without.answer
    return with_it, without


def states(text: str, query: str, options: Options = ALONE) -> tuple[int, int]:
    """How many states are stored with and without pruning."""
    with_it, without = searched(text, query, options)
    return with_it.statistics.states_stored, without.statistics.states_stored


MOMENTS = """
process Hand(const int[1, 3] me) {
    clock x;
    init location first { to second { guard x == me; assign x = 0; } }
    location second { to top { guard x == me; assign x = 0; } }
    location top { to first { guard x == me; assign x = 0; } }
}
A = Hand(1); B = Hand(2); C = Hand(3);
system A, B, C;
"""
IN_TIME = "A[] !(A.top && A.x <= 1 && C.top && C.x == 1)"


def test_who_misses_a_moment_is_lost() -> None:
    found, _ = searched(MOMENTS, "E<> A.top && B.top && C.top")
    assert found.answer is tachk.Answer.HOLDS and found.trace is not None
    assert found.statistics.lost > 0
    fewer, all_ = states(MOMENTS, "E<> A.top && B.top && C.top && A.x > 1")
    assert 4 * fewer < all_


def test_an_invariant_that_holds_is_proved_with_fewer_states() -> None:
    """C is at the top for 6 <= t <= 9 modulo 9, A for 2 <= t <= 3 modulo 3, as long as they miss nothing."""
    found, without = searched(MOMENTS, IN_TIME)
    assert found.answer is tachk.Answer.HOLDS
    assert found.statistics.states_stored < without.statistics.states_stored


def test_only_who_is_named_counts() -> None:
    found, _ = searched(
        MOMENTS.replace("init location first {", "init location first { to first { }"), "E<> A.top && A.x > 1"
    )
    assert found.statistics.states_stored > 1


ONE_WAY = """
{declared}
process P() {{
    clock x;
    init location a {{ to b {{ {before} }} to c; }}
    location b {{ to b {{ guard x >= 1; assign x = 0; {loop} }} }}
    location c {{ to d {{ guard x {guard}; }} }}
    location d;
}}
process Q() {{
    clock y;
    init location e {{ to f {{ guard y >= 2; {other} }} }}
    location f {{ to e {{ assign y = 0; }} }}
}}
system P, Q;
"""


def one_way(declared: str = "", before: str = "", loop: str = "", guard: str = ">= 1", other: str = "") -> str:
    return ONE_WAY.format(declared=declared, before=before, loop=loop, guard=guard, other=other)


def test_a_location_without_a_way_back_is_lost() -> None:
    found, without = searched(one_way(), "E<> P.d && P.x > 4 && Q.f && Q.y < 0")
    assert found.statistics.states_stored < without.statistics.states_stored


@pytest.mark.parametrize(
    ("bound", "guard", "is_lost"),
    [
        ("x < 2", ">= 2", True),
        ("x <= 2", ">= 2", False),
        ("x <= 2", "> 2", True),
        ("x == 2", ">= 2", False),
        ("x == 2", "> 2", True),
        ("x > 2", "<= 3", False),
        ("x >= 4", ">= 2", False),
    ],
)
def test_strict_and_other_bounds(bound: str, guard: str, is_lost: bool) -> None:
    """Where the guard and the goal exclude each other all is lost from the beginning."""
    found, _ = searched(one_way(guard=guard), f"E<> P.d && P.{bound}")
    assert (found.answer is tachk.Answer.FAILS) is is_lost
    assert (found.statistics.states_explored == 0) is is_lost


def test_an_invariant_ends_the_waiting() -> None:
    text = one_way(guard=">= 3").replace("location c {", "location c { invariant x < 3;")
    found, _ = searched(text, "E<> P.d")
    assert found.answer is tachk.Answer.FAILS and found.statistics.states_explored == 0


def test_no_time_passes_in_an_urgent_location() -> None:
    """The clock is 0 at first: from there time passes, but in c it does not."""
    text = one_way(guard=">= 3").replace("location c {", "urgent location c {")
    found, _ = searched(text, "E<> P.d")
    assert found.answer is tachk.Answer.HOLDS
    early, _ = searched(text.replace("to c;", "to c { guard x < 3; }"), "E<> P.d")
    assert early.answer is tachk.Answer.FAILS and early.statistics.states_explored == 0


def test_a_clock_that_another_process_sets_is_left_open() -> None:
    text = one_way(declared="clock g;", guard=">= 0", other="assign g = 0;")
    text = text.replace("guard x >= 0", "guard g < 1").replace("to c;", "to c { guard g > 3; }")
    found, _ = searched(text, "E<> P.d")
    assert found.answer is tachk.Answer.HOLDS
    alone, _ = searched(text.replace("assign g = 0;", ""), "E<> P.d")
    assert alone.answer is tachk.Answer.FAILS and alone.statistics.states_explored == 0


def test_each_disjunct_must_be_lost() -> None:
    assert searched(one_way(), "E<> P.d && Q.f || P.b && Q.f")[0].statistics.lost == 0
    lost = searched(one_way(), "E<> P.d && Q.f && Q.y > 9 && Q.y < 8 || P.d && Q.e && Q.y > 5 && Q.y < 4")
    assert lost[0].statistics.states_explored == 0


def test_each_open_goal_must_be_lost() -> None:
    """Both queries share a search, in which the goal of the second one is reached at last."""
    text = one_way() + "property one : E<> P.d && Q.f && P.x < 1; property other : E<> P.b && Q.f && P.x > 7;"
    found = tachk.loads(text).verify(options=ALONE)
    assert [verdict.answer.value for verdict in found] == ["fails", "holds"]


def test_a_note_about_a_trigger_is_not_made_of_what_is_lost() -> None:
    """P.b is reached only in states that are lost for the property itself."""
    text = one_way(before="guard x > 2;")
    (verdict,) = tachk.loads(text).verify("A[] (P.b imply !(P.d && Q.f))", options=ALONE)
    assert verdict.answer is tachk.Answer.HOLDS and not verdict.notes


GROWING = """
int[0, 9] n; int[-9, 0] m; int[0, 3] k;
process P() {
    init location a {
        to a { guard n < 9; assign n = n + 1; }
        to a { guard m > -7; assign m = m - 2; }
        to a { assign k = 0; }
        to a { guard k < 2; assign k = k + 1; }
    }
}
system P;
"""


@pytest.mark.parametrize(
    ("query", "most"),
    [
        ("E<> n == 3 && m == -1", 1),
        ("E<> n <= 3 && m == -9", 1),
        ("A[] !(n == 3 && m == -7)", 1),
        ("E<> k == 3", 1),
        ("E<> n == 3 && m == -4 && n == 4", 1),
        (
            "A[] (n == 2 and m == -6) imply k != 3",
            27,
        ),  # up to the first state of the left side, which is looked for as well
    ],
)
def test_a_variable_that_only_grows_does_not_come_back(query: str, most: int) -> None:
    fewer, all_ = states(GROWING, query)
    assert fewer <= most < all_


def test_values_behind_those_wanted_are_lost() -> None:
    fewer, all_ = states(GROWING, "E<> n <= 2 && m >= -4 && k == 2 && (n + m + k == 40)")
    assert fewer == 3 * 3 * 3 < all_
    found, _ = searched(GROWING, "E<> n == 9 && m == -8 && k == 0")
    assert found.answer is tachk.Answer.HOLDS


def test_a_variable_that_is_set_to_anything_is_left_open() -> None:
    text = GROWING.replace("to a { assign k = 0; }", "to a { assign k = 0, n = m + 9; }")
    found, _ = searched(text, "E<> n == 1 && m == -8")
    assert found.answer is tachk.Answer.HOLDS


def test_the_guard_of_a_receiver_is_about_the_value_before_the_sender() -> None:
    text = """
    int[0, 5] n; chan c;
    process P() { init location a { to b { sync c!; assign n = n + 2; } } location b; }
    process Q() { init location a { to b { guard n == 0; sync c?; assign n = n + 1; } } location b; }
    system P, Q;
    """
    found, _ = searched(text, "E<> n == 3")
    assert found.answer is tachk.Answer.HOLDS


@pytest.mark.parametrize(
    "failing",
    [
        "to f { guard y > 8; assign n = n + 2; }",
        "to f { guard y > 8; assign n = 1 / (n - 1); }",
        "to f { guard y > 8 && 1 / (n - 1) == 2; }",
    ],
)
def test_no_run_time_error_is_overlooked(failing: str) -> None:
    """Everything is lost for the goal from the beginning, but not for the error."""
    text = one_way(declared="int[0, 2] n = 1;", guard="< 1").replace("location f {", f"location f {{ {failing}")
    text = text.replace("to c;", "to c { guard x > 1; }")
    found, without = searched(text, "E<> P.d")
    assert found.fault is not None and without.fault is not None
    assert found.fault.kind is without.fault.kind
    harmless = text.replace(failing, "to f { guard y > 8 && n > 1; assign n = n - 1; }")
    proved, _ = searched(harmless, "E<> P.d")
    assert proved.answer is tachk.Answer.FAILS and proved.statistics.states_explored == 0


def test_an_error_in_the_query_is_not_overlooked() -> None:
    text = one_way(declared="int[0, 2] n = 1;")
    found, without = searched(text, "E<> P.c && P.x > 2 && P.x < 1 && 1 / (n - 1) == 3")
    assert (found.fault is None) == (without.fault is None)


def test_where_all_states_are_asked_for_none_is_dropped() -> None:
    text = MOMENTS + "property largest : sup: A.x; property never : E<> false; property stuck : A[] not deadlock;"
    assert [verdict.statistics.lost for verdict in tachk.loads(text).verify(options=ALONE)] == [0, 0, 0]
    found = tachk.loads(MOMENTS).verify("A<> A.top", "A.first --> A.top", options=ALONE)
    assert [verdict.statistics.lost for verdict in found] == [0, 0]


def test_clocks_that_stop_switch_it_off() -> None:
    text = MOMENTS.replace("location second {", "location second { invariant x' == 0;")
    assert searched(text, "E<> A.top && B.top && C.top")[0].statistics.lost == 0


def test_processes_that_are_exchanged_are_lost_alike() -> None:
    text = """
    typedef int[1, 4] id_t;
    process P(const id_t me) {
        clock x;
        init location a { to b { guard x == 1; assign x = 0; } to a { guard x >= 2; } }
        location b { to c { guard x == 2; } to b { guard x >= 3; } }
        location c { to c { guard x > 1; } }
    }
    system P;
    """
    options = ALONE.on("symmetry")
    fewer, all_ = states(text, "E<> forall (i : id_t) P(i).c && P(i).x > 5 && P(i).x < 5", options)
    assert fewer < all_
    found, _ = searched(text, "E<> forall (i : id_t) P(i).c", options)
    assert found.answer is tachk.Answer.HOLDS and found.statistics.interchangeable == 4
    assert found.statistics.lost > 0


def test_a_published_protocol_takes_fewer_states() -> None:
    model = tachk.load(data_root() / "models" / "classics" / "critical_region.ta", N=4, CAREFUL=True, IN_TURN=False)
    with_it, without = (
        model.verify(property="in_time", options=options)["in_time"]
        for options in (Options(), Options().off("pruning"))
    )
    assert with_it.answer is without.answer is tachk.Answer.HOLDS
    assert 10 * with_it.statistics.states_stored < without.statistics.states_stored


def test_a_certificate_says_what_is_dropped() -> None:
    model = tachk.loads(MOMENTS)
    (verdict,) = model.verify(IN_TIME).record.verdicts
    assert verdict.statistics.lost > 0
    proof = find_proof(model.network, "m.ta", verdict.query)
    assert not isinstance(proof, str) and proof.header.traps
    stream = BytesIO()
    CertificateWriter(stream).write(proof.header, proof.blocks())
    for checker in Checker:
        (certificate,) = read_certificates(BytesIO(stream.getvalue()))
        assert check_proof(model.network, verdict.query, certificate, checker) is None
