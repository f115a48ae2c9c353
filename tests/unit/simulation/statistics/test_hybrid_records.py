"""Hybrid clocks that are fields of records, elements of arrays in records, and clocks of a named type."""

from __future__ import annotations

import pytest

import tachk
from tachk.simulation.columns import all_columns
from tachk.simulation.simulated import simulated
from tachk.simulation.statistics.estimate import DrawnRuns, Estimated

RECORDS = """
typedef struct { hybrid clock x; int[0, 9] n; } c_t;
typedef struct { clock y[2]; } p_t;
typedef hybrid clock h_t;
c_t c[2]; p_t p; h_t h[2]; clock t;
process P(c_t &mine) {
    state A { t <= 5 && c[0].x' == 2 && forall (i : int[0, 1]) p.y[i]' == 3 + i && h[1]' == 0.5 && mine.x' == 4 }, B;
    init A;
    trans A -> B { guard c[0].x >= 5 && mine.n == 0; assign mine.x = 100.0, mine.n = 7; };
}
Q = P(c[1]);
system Q;
"""


def test_each_has_its_own_rate() -> None:
    values = ("c[0].x", "c[1].x", "p.y[0]", "p.y[1]", "h[0]", "h[1]", "c[1].n")
    drawn = tachk.loads(RECORDS).estimate(f"simulate [<=2; 1] {{{', '.join(values)}}}")[0]
    assert isinstance(drawn, DrawnRuns)
    ends = [line.values[-1] for line in drawn.runs[0].lines]
    assert ends == pytest.approx([4, 8, 6, 8, 2, 1, 0])


def test_conditions_and_assignments() -> None:
    found = tachk.loads(RECORDS).estimate(
        "Pr[<=10](<> Q.A && c[0].x >= 7.5)",  # leaves at t in [2.5, 5]
        "Pr[<=10](<> Q.B && c[1].x >= 105)",
        "Pr[<=10](<> p.y[0] >= 15.5)",  # rate 3 until t, then 1 up to 10: 10 + 2 t
        "E[<=3; 10](max: c[1].n)",
        runs=2000,
        confidence=0.999,
    )
    exact = [0.5, 1.0, 1 - (2.75 - 2.5) / 2.5]
    for answer, value in zip(found, exact, strict=False):
        assert isinstance(answer, Estimated)
        assert answer.low <= value <= answer.high


def test_columns_of_runs() -> None:
    names = {column.name for column in all_columns(simulated(tachk.loads(RECORDS).loaded, "").network)}
    assert {"c[0].x", "c[0].n", "p.y[1]", "h[1]"} <= names


def test_a_record_with_an_initial_value() -> None:
    text = """
    typedef struct { hybrid clock x; int n; } c_t;
    c_t c = { 2.5, 1 };
    process P() { state A { c.x' == c.n }; init A; trans A -> A { guard c.x >= 4.5; assign c.n = 0, c.x = 0.0; }; }
    system P;
    """
    drawn = tachk.loads(text).estimate("simulate [<=1; 1] {c.x}")[0]
    assert isinstance(drawn, DrawnRuns)
    assert drawn.runs[0].lines[0].values[-1] == pytest.approx(3.5)


def test_fields_beside_a_hybrid_clock_are_no_hybrid_clocks() -> None:
    text = """
    typedef struct { hybrid clock x; double d; clock y; } c_t;
    c_t c;
    process P() { state A { c.d' == 2 }; init A; }
    system P;
    """
    with pytest.raises(tachk.InputError, match="only clocks have a rate, not double"):
        tachk.loads(text).estimate("simulate [<=1; 1] {c.d}")


def test_verify_rejects_them() -> None:
    model = tachk.loads(RECORDS)
    with pytest.raises(tachk.UnsupportedError, match="hybrid clocks are not supported"):
        assert model.network
