"""The least and the largest values of integers, clocks and differences."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import pytest

from tachk.engine.options import Extrapolation, Limits, Options, SearchOrder
from tachk.verify.verdict import Answer, Verdict

Verdicts = Callable[..., dict[str, Verdict]]

LAMP = """
process Lamp() {
    clock x; clock total; int[0,9] presses;
    init location Off {
        invariant x <= 5;
        to On { guard x >= 2; assign presses = presses < 4 ? presses + 1 : presses; }
        to Broken { guard presses == 3; assign x = 0; }
    }
    location On { invariant x < 9; to Off { guard x > 3; assign x = 0; } }
    location Broken;
}
L = Lamp();
system L;
"""

LOOP = """
process P() {
    clock x, y, never;
    int[0,1] odd;
    init location A { invariant x <= 3; to A { guard x >= 3; assign x = 0, odd = 1 - odd; } to B { guard odd == 1; } }
    location B { invariant x <= 3; to C { guard x >= 3; assign y = 0; } }
    location C { invariant y <= 1; }
}
system P;
"""


def values(verdict: Verdict) -> list[tuple[int | None, bool] | None]:
    """The least and the largest value of each expression, each with whether it is strict."""
    assert verdict.answer is Answer.HOLDS, verdict.reason
    pairs = (extreme for found in verdict.extremes for extreme in (found.least, found.largest))
    return [None if extreme is None else (extreme.value, extreme.strict) for extreme in pairs]


@pytest.mark.parametrize(
    ("query", "expected"),
    [
        ("sup{L.Off}: L.x", [None, (5, False)]),
        ("inf{L.On}: L.x", [(2, False), None]),
        ("bounds: L.presses", [(0, False), (4, False)]),
        ("bounds{L.On}: 10 - 2 * L.presses", [(2, False), (8, False)]),
        ("inf: L.x", [(0, False), None]),
    ],
)
def test_extreme_values_that_are_taken(verdicts: Verdicts, query: str, expected: list[object]) -> None:
    verdict = verdicts(LAMP + f"property q : {query};")["q"]
    assert values(verdict) == expected


def test_a_bound_that_is_not_taken_is_strict(verdicts: Verdicts) -> None:
    found = verdicts(
        LAMP + "property most : sup{L.On}: L.x; property second : bounds{L.On && L.presses == 2}: L.total;"
    )
    assert values(found["most"]) == [None, (9, True)]
    assert values(found["second"]) == [(5, True), (18, True)]
    assert found["most"].extremes[0].largest.run is None
    assert found["most"].trace is None


def test_states_reached_by_waiting_count(verdicts: Verdicts) -> None:
    verdict = verdicts(
        "process P() { clock x; init location A { invariant x <= 7; } } system P; property q : sup: P.x;"
    )
    assert values(verdict["q"]) == [None, (7, False)]


def test_a_value_that_is_taken_has_a_run_that_ends_with_it(verdicts: Verdicts) -> None:
    verdict = verdicts(LAMP + "property q : bounds{L.On}: L.presses, L.x;")["q"]
    presses, clock = verdict.extremes
    assert presses.largest is not None and presses.largest.run is not None
    assert presses.largest.run.states[-1].discrete.values[2] == 4
    assert clock.least is not None and clock.least.run is not None
    assert clock.least.run.states[-1].clocks[0] == Fraction(2)
    assert verdict.trace is presses.least.run


def test_without_trace_there_are_values_and_no_runs(verdicts: Verdicts) -> None:
    verdict = verdicts(LAMP + "property q : bounds: L.presses;", trace=False)["q"]
    assert values(verdict) == [(0, False), (4, False)]
    assert verdict.trace is None


def test_a_clock_that_nothing_stops_has_no_largest_value(verdicts: Verdicts) -> None:
    found = verdicts(LAMP + "property idle : sup: L.x; property around : sup{L.On}: L.total;")
    assert values(found["idle"]) == values(found["around"]) == [None, (None, False)]


def test_a_loop_lets_a_clock_grow_that_stands_in_no_guard(verdicts: Verdicts) -> None:
    found = verdicts(
        LOOP
        + "property in_loop : bounds{P.A}: P.never; property behind : sup{P.C}: P.never;"
        + "property difference : bounds{P.C}: P.never - P.y; property reversed : bounds{P.C}: P.y - P.never;"
    )
    assert values(found["in_loop"]) == [(0, False), (None, False)]
    assert values(found["behind"]) == [None, (None, False)]
    assert values(found["difference"]) == [(6, False), (None, False)]
    assert values(found["reversed"]) == [(None, False), (-6, False)]


def test_a_loop_that_takes_no_time_lets_no_clock_grow(verdicts: Verdicts) -> None:
    text = """
    process P() {
        clock x, y;
        init location A { invariant x <= 4; to A { guard x < 4; assign y = 0; } }
    }
    system P;
    property q : bounds: P.x, P.y;
    """
    assert values(verdicts(text)["q"]) == [(0, False), (4, False), (0, False), (4, False)]


def test_values_far_above_all_constants_are_found(verdicts: Verdicts) -> None:
    text = """
    process P() {
        clock x, total; int[0,20] n;
        init location A { invariant x <= 10; to A { guard x >= 10 && n < 20; assign x = 0, n = n + 1; } }
    }
    system P;
    property q : sup: P.total; property late : inf{P.n == 20}: P.total;
    """
    found = verdicts(text)
    assert values(found["q"]) == [None, (210, False)]
    assert values(found["late"]) == [(200, False), None]


def test_there_is_no_value_where_no_state_is_reachable(verdicts: Verdicts) -> None:
    found = verdicts(
        LAMP + "property number : sup{L.On && L.Off}: L.presses; property timed : inf{L.On && L.x < 2}: L.x;"
        "property difference : sup{L.On && L.Off}: L.x - L.total;"
    )
    for verdict in found.values():
        assert (verdict.answer, verdict.extremes) == (Answer.FAILS, ())
        assert verdict.notes == ("no reachable state satisfies the restriction, so that there is no value",)


def test_deadlock_may_stand_in_the_restriction(verdicts: Verdicts) -> None:
    text = """
    process P() {
        clock x; int[0,3] n;
        init location A {
            invariant x <= 6;
            to A { guard x >= 2 && n < 3; assign x = 0, n = n + 1; }
            to B { guard n == 1 && x >= 4; }
        }
        location B { invariant x <= 5; }
    }
    system P;
    property timed : bounds{deadlock}: P.x; property number : bounds{deadlock}: P.n;
    """
    found = verdicts(text)
    assert values(found["number"]) == [(1, False), (3, False)]
    assert values(found["timed"]) == [(0, False), (6, False)]


def test_a_clock_may_grow_without_limit_where_there_is_a_deadlock(verdicts: Verdicts) -> None:
    text = """
    clock since;
    process P() {
        clock x;
        init location A { invariant x <= 3; to A { guard x >= 3; assign x = 0; } to B { guard x >= 2; } }
        location B { invariant x <= 5; to C { guard x >= 4; assign x = 0; } }
        location C { invariant x <= 1; }
    }
    process Q() { clock y; init location A; }
    system P, Q;
    property stuck : sup{deadlock}: P.x; property looped : bounds{deadlock}: since;
    property alive : bounds{not deadlock}: P.x; property other : bounds{deadlock && P.x < 1}: Q.y;
    """
    found = verdicts(text)
    assert values(found["stuck"]) == [None, (1, False)]
    assert values(found["looped"]) == [(4, False), (None, False)]
    assert values(found["alive"]) == [(0, False), (5, False)]
    assert values(found["other"]) == [(4, False), (None, False)]


@pytest.mark.parametrize("restriction", ["n == 1", "P.B && n == 1", "false", "n == 1 && P.x > 3", "n == 1 && deadlock"])
@pytest.mark.parametrize("kind", ["sup", "inf", "bounds"])
def test_a_restriction_may_be_false_before_the_search(verdicts: Verdicts, kind: str, restriction: str) -> None:
    text = """
    int[0,1] n = 0;
    process P() { clock x; init location A { to B { assign x = 0; } } location B; }
    system P;
    """
    found = verdicts(text + f"property q : {kind}{{{restriction}}}: P.x; property r : {kind}{{n == 0}}: P.x;")
    assert (found["q"].answer, found["q"].extremes) == (Answer.FAILS, ())
    assert found["r"].answer is Answer.HOLDS


def test_a_limit_leaves_the_value_unknown(verdicts: Verdicts) -> None:
    for query in ("sup: L.presses", "sup{L.On}: L.x", "sup{L.On}: L.x - L.total"):
        verdict = verdicts(LAMP + f"property q : {query};", limits=Limits(states=1))["q"]
        assert (verdict.answer, verdict.reason) == (Answer.UNKNOWN, "state limit")


def test_a_run_time_error_leaves_the_value_unknown(verdicts: Verdicts) -> None:
    text = """
    int[0,3] n; int a[3] = {1, 2, 3};
    process P() { init location A { to A { assign n = n + 1; } } }
    system P;
    property overflow : sup: n; property index : sup: a[n];
    """
    for verdict in verdicts(text).values():
        assert (verdict.answer, verdict.reason) == (Answer.UNKNOWN, "run-time error")
        assert verdict.fault is not None


def test_a_stopped_clock_keeps_its_value(verdicts: Verdicts) -> None:
    text = """
    process P() {
        clock x, y;
        init location A { invariant x <= 5; to B { guard x == 5; assign x = 0; } }
        location B { invariant x <= 5 && y' == 0; to C { guard x == 5; } }
        location C { invariant y' == 0 && x' == 0; }
    }
    system P;
    property q : sup: P.y;
    """
    assert values(verdicts(text)["q"]) == [None, (5, False)]


@pytest.mark.parametrize(
    "options",
    [
        Options(order=SearchOrder.DFS),
        Options(extrapolation=Extrapolation.MAX),
        Options(subsumption=False),
        Options(scale=False, width=64),
    ],
)
def test_no_option_changes_a_value(verdicts: Verdicts, options: Options) -> None:
    text = """
    int[0,50] n;
    process P() {
        clock x;
        init location A { invariant x <= 2000; to B { guard x >= 1000; assign n = 40; } }
        committed location B { to A { assign n = n - 39, x = 0; } }
    }
    system P;
    property q : sup: n, P.x;
    """
    assert values(verdicts(text, options=options)["q"]) == [None, (40, False), None, (2000, False)]
