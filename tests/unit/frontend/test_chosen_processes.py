"""Processes that variables name in queries, beside the same written out for each instance."""

from __future__ import annotations

import pytest

import tachk
from tachk.model.fault import RuntimeErrorKind
from tachk.simulation.statistics.estimate import DrawnRuns, Estimated, Mean
from tachk.verify.verdict import Answer

MODEL = """
typedef int[1, 3] id_t;
id_t who; int wide = 1;
process P(const id_t id) {
    clock z; int[0, 5] n = id;
    int a[2] = {id, 0};
    int twice() { return 2 * n; }
    int plus(int k) { return n + k; }
    bool busy() { return n > 2; }
    int first(int v[2]) { return v[0]; }
    state A { z <= 3 }, B { z <= 9 };
    init A;
    trans
        A -> B { guard z >= id; assign who = id, wide = id, z = 0, n = 5 - id; },
        B -> A { guard z >= 2; assign z = 0; };
}
process Wide() { state A, B; init A; trans A -> B { guard wide == 3; assign wide = 4; }; }
system P, Wide;
"""


def chosen(text: str, variable: str = "who") -> str:
    """``<body>`` for each process that the variable may name."""
    return "(" + " || ".join(f"({variable} == {i} && ({text.replace('@', str(i))}))" for i in (1, 2, 3)) + ")"


@pytest.mark.parametrize(
    ("query", "written_out"),
    [
        ("E<> P(who).B", f"E<> {chosen('P(@).B')}"),
        ("A[] P(who).B || P(1).A", f"A[] {chosen('P(@).B')} || P(1).A"),
        ("A[] who == 1 || P(who).n == 5 - who || P(who).n == who", "A[] true"),
        ("E<> P(who).z > 8", f"E<> {chosen('P(@).z > 8')}"),
        ("E<> P(who).z > 9", f"E<> {chosen('P(@).z > 9')}"),
        ("E<> P(who).z - P(1).z > 5", f"E<> {chosen('P(@).z - P(1).z > 5')}"),
        ("A[] !(P(who).A && P(4 - who).B)", f"A[] !({chosen('P(@).A')} && {chosen('P(@).B', '4 - who')})"),
        ("E<> P(who).twice() == 6", f"E<> {chosen('P(@).twice() == 6')}"),
        ("A[] P(who).busy() imply P(who).plus(who) > 3", f"A[] !{chosen('P(@).n > 2 && P(@).n + @ <= 3')}"),
        ("E<> P(who).plus(P(4 - who).n) == 6 && P(who).B", f"E<> {chosen('P(@).plus(P(4 - @).n) == 6 && P(@).B')}"),
        ("A[] P(who).first(P(4 - who).a) == 4 - who", "A[] true"),
        ("A[] P(4 - who).first(P(who).a) == who", "A[] true"),
        ("P(who).A --> P(who).B", f"{chosen('P(@).A')} --> {chosen('P(@).B')}"),
        ("A<> P(who).B", f"A<> {chosen('P(@).B')}"),
        ("E<> exists (i : id_t) i != who && P(i).n > P(who).n && P(who).B", "E<> who == 3 && P(3).B"),
        ("F[0, 4] P(who).B", f"F[0, 4] {chosen('P(@).B')}"),
        ("G (P(who).B -> F[0, 9] P(who).A)", f"G ({chosen('P(@).B')} -> F[0, 9] {chosen('P(@).A')})"),
    ],
)
def test_one_case_for_each_instance(query: str, written_out: str) -> None:
    one, other = tachk.loads(MODEL).verify(query, written_out)
    assert one.answer is other.answer is not Answer.UNKNOWN


def test_measured() -> None:
    found = tachk.loads(MODEL).verify(
        "sup: P(who).n", "inf{Wide.B && wide == 4}: P(who).n", "sup{P(who).B}: P(who).z", "sup: P(who).twice()"
    )
    rows = [row["values"] for row in found.to_rows()]
    assert rows == ["P(who).n ≤ 4", "P(who).n ≥ 2", "P(who).z ≤ 9", "P(who).twice() ≤ 8"]


def test_no_such_instance_is_a_run_time_error() -> None:
    other, third = tachk.loads(MODEL).verify("E<> Wide.B && P(wide).B", "A[] P(wide).n < 9")
    assert [each.answer.value for each in (other, third)] == ["unknown", "unknown"]
    assert third.fault is not None
    assert third.fault.kind is RuntimeErrorKind.RANGE


def test_two_parameters() -> None:
    text = """
    typedef int[0, 1] a_t; typedef int[5, 6] b_t; a_t a; b_t b = 5;
    process P(const a_t i, const b_t j) {
        state A, B; init A;
        trans A -> B { guard i == 1 && j == 6; }, A -> A { assign a = i, b = j; };
    }
    system P;
    """
    report = tachk.loads(text).verify("E<> P(a, b).B", "E<> P(a, b).B && (a == 0 || b == 5)", "A[] P(a, 6).A || a == 1")
    assert [each.answer.value for each in report] == ["holds", "fails", "holds"]


@pytest.mark.parametrize(
    ("query", "code"),
    [
        ("E<> P(who, 1).B", "E0308"),
        ("E<> P(who).C", "E0207"),
        ("E<> P(who).c()", "E0207"),
        ("E<> P(who).n()", "E0208"),
        ("E<> P(who).twice", "E0203"),
        ("E<> P(who).plus()", "E0308"),
        ("E<> P(who).plus(true, 2)", "E0308"),
        ("E<> P(P(1).z).B", "E0301"),
        ("E<> P(1.5 * who).B", "E0301"),
    ],
)
def test_wrong_names(query: str, code: str) -> None:
    with pytest.raises(tachk.InputError, match=code):
        tachk.loads(MODEL).verify(query)


def test_processes_do_not_name_each_other_so() -> None:
    text = """
    typedef int[0, 1] id_t; id_t w;
    process P(const id_t i) { state A, B; init A; trans A -> B { guard P(w).B; }; }
    system P;
    """
    with pytest.raises(tachk.InputError, match="E0206"):
        tachk.loads(text)


def test_random_runs() -> None:
    text = """
    typedef int[0, 1] id_t; id_t who;
    process P(const id_t id) {
        clock z; bool there() { return id == 1; } state A { z <= 2 }, B; init A;
        trans A -> B { guard id == 1; assign who = 1, z = 0; };
    }
    system P;
    """
    found = tachk.loads(text.replace("z <= 2", "z <= 2 || id == 0")).estimate(
        "Pr[<=1](<> P(who).B)",  # P(1) leaves at a time that is uniform on 0 to 2
        "E[<=2; 2000](max: P(who).z)",  # the larger one of L and 2 - L
        "simulate [<=3; 1] {P(who).z, P(who).B}",
        "Pr[<=1](<> P(who).there())",
        runs=2000,
        confidence=0.999,
    )
    assert isinstance(found[0], Estimated)
    assert found[0].low <= 0.5 <= found[0].high
    assert isinstance(found[1], Mean)
    assert found[1].asymptotic[0] - 0.01 <= 1.5 <= found[1].asymptotic[1] + 0.01
    assert isinstance(found[2], DrawnRuns)
    clock, place = found[2].runs[0].lines
    left = place.times[1]
    assert clock.values[-1] == pytest.approx(3 - left)
    assert isinstance(found[3], Estimated)
    assert found[3].sample.hits == found[0].sample.hits
