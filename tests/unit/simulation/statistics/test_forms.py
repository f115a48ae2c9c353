"""Forms of statistical queries beside closed forms.

L is when A leaves: uniform on 0 to 5. From then on x counts from 0, n is 3, and the cost e grows by 1 in place of 5.
"""

from __future__ import annotations

import numpy as np
import pytest

import tachk
from tachk.simulation.statistics.estimate import Decided, DrawnRuns, Estimated, Mean

MODEL = """
clock t, x, e;
int[0, 9] n = 1;
process A() {
    init location s { invariant t <= 5 && e' == 5; to u { assign x = 0, n = 3; } }
    location u { invariant e' == 1; }
}
system A;
"""
RUNS = 4000


@pytest.mark.parametrize(
    ("query", "exact"),
    [
        ("Pr(<>[0,3] A.u)", 0.6),
        ("Pr(<>[2,4] A.s)", 0.6),
        ("Pr(<>[2,4] (A.u && x <= 1))", 0.6),  # L in [1, 4]
        ("Pr([][1,3] A.s)", 0.4),
        ("Pr([][4,6] A.u)", 0.8),
        ("Pr(A.s U[1,3] A.u)", 0.4),
        ("Pr(A.s U[0,3] (A.u && t >= 1))", 0.4),
        ("Pr[e<=10](<> A.u)", 0.4),
        ("Pr[e<=10]([] A.s)", 0.6),
        ("Pr[e<=10](A.s U A.u)", 0.4),
        ("Pr[<=5](<> 2 * t >= 6 && A.s)", 0.4),
        ("Pr[<=5](<> sin(t) >= 0.5 && A.u)", 0.5236 / 5 + 2.6180 / 5 - 0.5236 / 5),
    ],
)
def test_probabilities(query: str, exact: float) -> None:
    found = tachk.loads(MODEL).estimate(query, runs=RUNS, seed=4, confidence=0.999)[0]
    assert isinstance(found, Estimated)
    assert found.low <= exact <= found.high


@pytest.mark.parametrize(
    ("query", "exact"),
    [
        ("E[<=10; 4000](max: n + x)", 10.5),  # 3 + 10 - L
        ("E[<=10; 4000](max: 2 * x)", 15.0),
        ("E[<=10; 4000](min: 3 - x)", 3 - 7.5),
        ("E[<=6; 4000](max: x > 3 ? 1 : 0)", 1.0),  # L > 3, or 6 - L > 3
        ("E[<=5; 4000](max: x > 3 ? 1 : 0)", 0.8),  # L > 3, or 5 - L > 3
        ("E[e<=10; 4000](max: t)", 3.6),
        ("E[e<=10; 4000](max: n)", 1 + 2 * 0.4),
    ],
)
def test_means(query: str, exact: float) -> None:
    found = tachk.loads(MODEL).estimate(query, seed=4, confidence=0.999)[0]
    assert isinstance(found, Mean)
    low, high = found.asymptotic
    assert low - 0.01 <= exact <= high + 0.01, "hybrid clocks are looked at every hundredth of a unit"


def test_bounds_are_expressions_of_constants() -> None:
    model = tachk.loads(f"const int N = 5, K = 2;{MODEL}")
    pairs = [("Pr[<= N - K](<> A.u)", "Pr[<=3](<> A.u)"), ("Pr(<>[K-1, (N - K)] A.u)", "Pr(<>[1,3] A.u)")]
    for written, number in pairs:
        one, other = model.estimate(written, number, runs=200)
        assert isinstance(one, Estimated)
        assert isinstance(other, Estimated)
        assert one.sample.hits == other.sample.hits
    drawn = model.estimate("simulate [<=K-1; N-K] {n}")[0]
    assert isinstance(drawn, DrawnRuns)
    assert [run.end for run in drawn.runs] == [1, 1, 1]
    with pytest.raises(tachk.InputError, match="must not be negative"):
        model.estimate("Pr[<=K-N](<> A.u)")


def test_tests_of_intervals() -> None:
    found = tachk.loads(MODEL).estimate("Pr(<>[0,3] A.u) >= 0.5", "Pr([][1,3] A.s) >= Pr(<>[0,3] A.u)")
    assert [each.decision.value for each in found if isinstance(each, Decided)] == ["holds", "fails"]


def test_conditions_pick_runs() -> None:
    every = tachk.loads(MODEL).estimate("simulate [<=10; 40] {n, A.u}")[0]
    some = tachk.loads(MODEL).estimate("simulate [<=10; 40] {n, A.u} : 3 : A.u && t < 2")[0]
    assert isinstance(every, DrawnRuns)
    assert isinstance(some, DrawnRuns)
    early = [run for run in every.runs if run.lines[0].times[1] < 2]
    assert [run.number for run in some.runs] == [run.number for run in early[:3]]
    for one, other in zip(early, some.runs, strict=False):
        assert [line.times.tolist() for line in one.lines] == [line.times.tolist() for line in other.lines]
    assert some.picked is not None
    assert (some.picked.runs, some.picked.hits) == (40, len(early))


def test_all_runs_that_meet_a_condition() -> None:
    found = tachk.loads(MODEL).estimate("simulate 30 [<=10] {n} : A.u && t < 2")[0]
    assert isinstance(found, DrawnRuns)
    assert found.picked is not None
    assert len(found.runs) == found.picked.hits < 30


def test_no_run_meets_a_condition() -> None:
    report = tachk.loads(f"{MODEL}property none : simulate [<=10; 5] {{n}} : n > 3 expect fails;").verify()
    assert report.met is True


def test_functions_of_clocks_are_values_on_runs() -> None:
    found = tachk.loads(MODEL).estimate("simulate [<=3; 1] {sin(t), t > 1, n + t}")[0]
    assert isinstance(found, DrawnRuns)
    sine, late, sums = found.runs[0].lines
    assert np.allclose(sine.values, np.sin(sine.times), atol=0.011)
    assert np.array_equal(late.values[late.times < 0.99], np.zeros(np.sum(late.times < 0.99)))
    assert late.values[-1] == 1
    assert sums.values[-1] == pytest.approx(3 + (3 if sums.values[-1] > 5 else 1))


@pytest.mark.parametrize("bound", ["x <= 4", "e <= 10"])
def test_runs_up_to_a_value_of_a_clock(bound: str) -> None:
    model = tachk.loads(MODEL)
    drawn = model.estimate(f"simulate [{bound}; 20] {{n}}")[0]
    assert isinstance(drawn, DrawnRuns)
    for run in drawn.runs:
        left = float(run.lines[0].times[1]) if run.lines[0].values[-1] == 3 else None
        if bound.startswith("e"):
            assert run.end == pytest.approx(2 if left is None else 10 - 4 * left, abs=1e-6)
        else:
            assert run.end == pytest.approx(4 if left is None else 4 + left)


def test_clocks_stay_exact_where_they_need_not_be_computed_with() -> None:
    text = "clock x; process A() { init location s { invariant x <= 5; to u; } location u; } system A;"
    found = tachk.loads(text).estimate("E[<=10; 20](max: x)", "Pr[<=10](<> x >= 3)")
    assert all(each.query.network is None for each in found)


def test_copies_beside_stopwatches() -> None:
    text = """
    clock x, y, s;
    process A() {
        init location a { invariant x <= 5 && s' == 0; to b { guard x >= 2; assign y = x + 1, x = 0; } }
        location b { invariant s' == 1; }
    }
    system A;
    """
    model = tachk.loads(text)
    found = model.estimate("Pr[<=10; 4000](<> y >= 5 && x <= 0)", "E[<=10; 4000](max: y)", confidence=0.999)
    assert isinstance(found[0], Estimated)
    assert found[0].low <= 1 / 3 <= found[0].high  # L + 1 >= 5
    answers = [each.answer for each in model.verify("E<> A.b && y >= 6 && x <= 0", "E<> A.b && y > 6 && x <= 0")]
    assert answers == ["holds", "fails"]


def test_clocks_are_drawn_flat_only_where_they_stand_still() -> None:
    """Also where a clock has the same value before and behind a transition, because it was set or has just begun."""
    text = """
    clock x, s, many[2];
    int[0, 1] n;
    process A() {
        init location a { invariant x <= 2 && s' == 0 && many[1]' == 0; to b { guard x >= 2; assign x = 0, n = 1; } }
        location b { invariant x <= 2; to c { guard x >= 2; assign x = 0; } }
        location c { invariant x <= 2 && many[1]' == 0; to c { guard x >= 2; assign x = 0; } }
    }
    system A;
    """
    (drawn,) = tachk.loads(text).estimate("simulate [<=7; 1] {x, s, many[1], n}")
    assert isinstance(drawn, DrawnRuns)
    x, s, many, n = ([*zip(line.times.round(6), line.values.round(6), strict=True)] for line in drawn.runs[0].lines)
    assert x == [(0, 0), (2, 2), (2, 0), (4, 2), (4, 0), (6, 2), (6, 0), (7, 1)]
    assert (s[0], s[-1]) == ((0, 0), (7, 5)) and (2, 0) in s
    assert (many[0], many[-1]) == ((0, 0), (7, 2)) and (4, 2) in many
    assert (n[0], n[-1]) == ((0, 0), (7, 1))


def test_clock_guards_over_urgent_channels() -> None:
    text = """
    clock x, y; urgent chan go; int[0, 1] done;
    process A() { state A, B; init A; trans A -> B { guard x >= 3; sync go!; }; }
    process C() { state A {y <= 6}, R; init A; trans A -> R { guard y >= 4; sync go?; assign done = 1; }; }
    system A, C;
    """
    drawn = tachk.loads(text).estimate("simulate [<=10; 3] {done}")[0]
    assert isinstance(drawn, DrawnRuns)
    assert [float(run.lines[0].times[1]) for run in drawn.runs] == pytest.approx([4, 4, 4], abs=1e-6)


@pytest.mark.parametrize(
    ("query", "said"),
    [
        ("Pr(<>[5,3] A.u)", "must not end before it begins"),
        ("Pr(<>[3] A.u)", "two ends"),
        ("Pr(<> A.u)", "expected an interval"),
        ("simulate [<=10; 5] {n} : 0 : A.u", "at least 1"),
        ("Pr[n<=10](<> A.u)", "bounded by its time"),
    ],
)
def test_wrong_forms(query: str, said: str) -> None:
    with pytest.raises(tachk.InputError, match=said):
        tachk.loads(MODEL).estimate(query)


def test_runs_that_last_no_time_end_at_once() -> None:
    text = "process P() { init location A { to A; exponential_rate 1; } } system P;"
    found = tachk.loads(f"int n; {text}").estimate("simulate [<=0; 2] {n}")[0]
    assert [run.end for run in found.runs] == [0.0, 0.0]
