"""The oracle against answers worked out by hand, and against laws of the logic."""

from __future__ import annotations

import math
from fractions import Fraction
from random import Random

import pytest

from tests.support.exact_monitor import satisfaction, value_at, verdict
from tests.support.exact_trace import Ending, ExactTrace, Value, pulses
from tests.support.formulas import random_monitoring_case
from tests.support.seeds import seeds
from tests.support.tricky import TRICKY_CASES, TrickyCase, read_formula


def truth(text: str, trace: ExactTrace, instant: Fraction | float = 0) -> bool | None:
    return value_at(read_formula(text), trace, Fraction(instant)).truth


def steps(*rows: tuple[float, float], end: float, ending: Ending = Ending.FINISHED) -> ExactTrace:
    times = tuple(Fraction(time) for time, _ in rows)
    return ExactTrace(times, {"x": tuple(Fraction(x) for _, x in rows)}, Fraction(end), ending)


@pytest.mark.parametrize("case", TRICKY_CASES, ids=lambda case: case.name)
def test_tricky_cases(case: TrickyCase) -> None:
    assert value_at(read_formula(case.formula), case.trace, case.instant).truth is case.truth
    assert verdict(read_formula(case.at_start), case.trace).truth is case.truth


@pytest.mark.parametrize(
    ("text", "instant", "expected"),
    [
        ("F[0,3) q", 2, False),
        ("F[0,3] q", 2, True),
        ("F(0,3] q", 5, True),
        ("F(0,1] q", 6, False),
        ("F(1,1] q", 4, False),
        ("G(1,1] q", 4, True),
        ("F[1,1) q", 4, False),
        ("O[1,2] q", 6, True),
        ("O(1,2] q", 6, False),
        ("O(0,1] q", 5, False),
        ("O[1,2] q", 7, True),
        ("O[1,2) q", 8, False),
        ("O(1,2) q", 7, True),
        ("H[0,1] q", 5.5, False),
        ("H[0,0.5] q", 5.5, True),
    ],
)
def test_bounds_of_windows(text: str, instant: float, expected: bool) -> None:
    assert truth(text, pulses(20, q=[(5, 6)]), instant) is expected


def test_isolated_points_are_seen_between_the_rows() -> None:
    trace = pulses(20, q=[(5, 6)])
    assert truth("F[1,1] rise(q)", trace, 4) is True
    assert truth("F(1,2] rise(q)", trace, 4) is False
    assert truth("F(1,2] rise(q)", trace, 3.5) is True
    assert truth("fall(q)", trace, 6) is True
    assert truth("fall(q)", trace, 5.5) is False


def test_edges_at_the_beginning() -> None:
    trace = pulses(20, p=[(0, 1)], q=[])
    assert truth("rise(p)", trace) is True
    assert truth("fall(!p)", trace) is False
    assert truth("fall(q)", trace) is False
    assert truth("change(p)", trace) is False
    assert truth("change(p)", trace, 1) is True


def test_rise_compares_with_the_limit_from_the_left() -> None:
    """`F[0,5) q` holds after instant 0, not at it: there is no first instant at which it holds, so it never rises."""
    trace = pulses(20, q=[(5, 6)])
    assert truth("F[0,5) q", trace) is False
    assert truth("F[0,5) q", trace, 0.001) is True
    assert truth("F[0,1] rise(F[0,5) q)", trace) is False


def test_until_in_the_open_begins_with_the_instant_itself() -> None:
    trace = pulses(20, p=[], q=[(5, 6)])
    assert truth("p U[0,2] q", trace, 5.5) is True
    assert truth("p U(0,2] q", trace, 5.5) is False
    assert truth("p S[0,2] q", trace, 5.5) is True
    assert truth("p S(0,2] q", trace, 5.5) is False


def test_since_is_open_at_the_witness() -> None:
    assert truth("p S q", pulses(20, p=[(5, 9)], q=[(4, 5)]), 8) is False, (
        "after every witness comes a moment without p"
    )
    assert truth("p S rise(q)", pulses(20, p=[(4, 9)], q=[(4, 5)]), 8) is True
    assert truth("p S fall(q)", pulses(20, p=[(5, 9)], q=[(4, 5)]), 8) is True
    assert truth("p S fall(q)", pulses(20, p=[(5, 7)], q=[(4, 5)]), 8) is False


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("x < 3", 2),
        ("x >= 3", -2),
        ("x == 3", -2),
        ("x != 3", 2),
        ("F[0,4] x > 2", 5),
        ("G[0,4] x > 2", -1),
        ("G[0,2] x > 2", -1),
        ("x < 3 U[0,4] x > 5", 2),
        ("!(x < 3)", -2),
        ("F[1,3) x >= 2", -1),
        ("change(x)", -math.inf),
        ("F[3,3] change(x)", math.inf),
        ("F[3,3] change(x < 3)", 2),
        ("F[3,3] change(x < 9)", -2),
    ],
)
def test_robustness(text: str, expected: float) -> None:
    assert verdict(read_formula(text), steps((0, 1), (3, 7), end=10)) == Value(expected > 0, expected, expected)


def test_robustness_of_what_is_not_seen_is_an_interval() -> None:
    trace = steps((0, 1), (3, 7), end=4)
    assert verdict(read_formula("F[0,5] x > 2"), trace) == Value(True, Fraction(5), math.inf)
    assert verdict(read_formula("G[0,5] x > 0"), trace) == Value(None, -math.inf, Fraction(1))


def test_operators_without_bound_end_with_the_trace() -> None:
    trace = steps((0, 1), (3, 7), end=4)
    assert verdict(read_formula("G x > 0"), trace) == Value(True, Fraction(1), Fraction(1))
    assert truth("F[2,inf) x > 0", trace, 3) is False, "no instant is left"
    assert truth("F[0,9] G x > 0", trace, 0) is True
    assert truth("F[0,9] G x < 0", trace, 0) is None, "after the end it is open what follows"


def test_unfinished_traces_leave_the_end_open() -> None:
    trace = steps((0, 1), (3, 7), end=4, ending=Ending.SETTLED)
    assert truth("G x > 0", trace) is None
    assert truth("F x > 5", trace) is True
    assert truth("G x < 5", trace) is False
    assert truth("G[0,4] x > 0", trace) is True
    assert truth("G[0,4] x > 0", steps((0, 1), (3, 7), end=4, ending=Ending.OPEN)) is None
    assert truth("G[0,4) x > 0", steps((0, 1), (3, 7), end=4, ending=Ending.OPEN)) is True


def test_the_past_of_the_unknown_is_known() -> None:
    trace = pulses(10, q=[(3, 4)])
    assert truth("G[0,20] O[0,inf) q", trace, 3) is True
    assert truth("G[0,2] O[0,9] q", trace, 10) is True
    assert truth("G[0,2] O[0,7] q", trace, 10) is None


@pytest.mark.parametrize("seed", seeds(range(30)))
def test_what_a_prefix_decides_stays(seed: int) -> None:
    random = Random(seed)
    case = random_monitoring_case(random)
    final = verdict(case.formula, case.trace)
    earlier = Value(None, -math.inf, math.inf)
    for time in sorted({*case.trace.times, case.trace.end}):
        for ending in (Ending.OPEN, Ending.SETTLED):
            now = verdict(case.formula, case.trace.prefix(time, ending))
            assert earlier.low <= now.low <= final.low <= final.high <= now.high <= earlier.high
            assert earlier.truth in (None, now.truth)
            assert now.truth in (None, final.truth)
            earlier = now


@pytest.mark.parametrize("seed", seeds(range(30)))
def test_values_agree_with_their_truth(seed: int) -> None:
    case = random_monitoring_case(Random(1000 + seed))
    signal = satisfaction(case.formula, case.trace)
    for value in (*signal.at, *signal.after):
        assert value.low <= value.high
        assert not (value.truth is True and value.high < 0)
        assert not (value.truth is False and value.low > 0)
