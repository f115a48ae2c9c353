"""Queries, properties and signals."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import pytest

from tachk.base.diagnostics.diagnostic import InputError
from tachk.base.span import Source
from tachk.base.words import QueryKind
from tachk.formats.loading.load import load_model
from tachk.model.evaluate import Environment, holds
from tachk.model.expressions import LocationTest
from tachk.model.query import Expectation
from tachk.model.variable_layout import variable_layout
from tests.support.queries import elaborate_queries

MODEL = """
typedef int[0,2] id_t;
const int LIMIT = 5;
int n = 2, a[3] = {1, 2, 3};
struct { int f; } r;
clock x;
int twice(int k) { return 2 * k; }
process T(const id_t id) {
    clock c;
    int v = id, w[2] = {id, 7};
    bool odd() { return v % 2 == 1; }
    state Idle, Busy;
    init Idle;
    trans Idle -> Busy { }, Busy -> Idle { };
}
process S() { int v = 9; state Off, On; init Off; trans Off -> On { }, On -> Off { }; }
Single = S();
system T, Single;
"""


@pytest.mark.parametrize(
    ("predicate", "expected"),
    [
        ("Single.Off", True),
        ("Single.On", False),
        ("T(1).Busy", True),
        ("T(0).Idle && not T(0).Busy", True),
        ("Single.v == 9 && T(2).v == 2", True),
        ("T(1).w[1] == 7 && T(LIMIT - 3).w[0] == 2", True),
        ("T(2).id == 2", True),
        ("T(1).odd() && !T(2).odd()", True),
        ("forall (i : id_t) T(i).v == i", True),
        ("exists (i : id_t) T(i).Busy && i == 1", True),
        ("forall (i : id_t) forall (j : id_t) T(i).Busy && T(j).Busy imply i == j", True),
        ("(sum (i : id_t) T(i).v) == 3", True),
        ("sum (i : id_t) T(i).Busy", True),
        ("forall (i : id_t) a[i] > 0", True),
        ("twice(n) == 4 && r.f == 0", True),
        ("x <= 5 and T(0).c > 1", True),
        ("x != 3", False),
        ("T(0).c - x > 0", False),
        ("n", True),
    ],
)
def test_predicates(load: Any, predicate: str, expected: bool) -> None:
    loaded = load(MODEL)
    ((query,), _) = elaborate_queries(loaded, f"E<> {predicate}")
    layout = variable_layout(loaded.network)
    env = Environment(layout, list(layout.initial), (0, 1, 0, 0), tuple(Fraction(3) for _ in layout.clock_slots))
    assert holds(query.predicate, env) is expected


def test_every_operator(load: Any) -> None:
    text = """
        E<> n > 1
        A[] not deadlock
        A<> Single.On
        E[] n < 3
        T(0).Idle --> T(0).Busy
        sup{Single.On}: x, n
        inf: n + 1
        bounds: x - T(0).c
    """
    queries, _ = elaborate_queries(load(MODEL), text)
    assert [q.kind for q in queries] == [
        QueryKind.POSSIBLY,
        QueryKind.INVARIANTLY,
        QueryKind.EVENTUALLY,
        QueryKind.POTENTIALLY_ALWAYS,
        QueryKind.LEADS_TO,
        QueryKind.SUPREMUM,
        QueryKind.INFIMUM,
        QueryKind.BOUNDS,
    ]
    assert [q.name for q in queries] == [f"q{i}" for i in range(1, 9)]
    assert [len(q.operands) for q in queries] == [0, 0, 0, 0, 1, 2, 1, 1]
    assert queries[1].text == "A[] not deadlock"
    assert queries[5].predicate == LocationTest(3, 1)
    assert queries[6].predicate is None


def test_properties_of_the_model(load: Any) -> None:
    text = """
        signal waiting = forall (i : id_t) T(i).Idle;
        signal level = n + twice(1);
        property one "the first" : E<> waiting && level > 3 expect holds;
        /// what it says
        property two : A[] n < 3 expect fails;
        property three : A[] n < 3;
        property four : Pr[<=10](<> n > 1);
    """
    loaded = load(MODEL + text)
    assert [(q.name, q.title, q.expectation) for q in loaded.queries] == [
        ("one", "the first", Expectation.HOLDS),
        ("two", "what it says", Expectation.FAILS),
        ("three", "", None),
    ]
    assert [(u.name, u.family) for u in loaded.unchecked] == [("four", "statistical")]
    assert [s.name for s in loaded.network.signals] == ["waiting", "level"]


def test_unchecked_queries_keep_their_numbers(load: Any) -> None:
    queries, unchecked = elaborate_queries(load(MODEL), "simulate [<=10] { n }\n// the second\nE<> n == 2\n")
    assert [(q.name, q.title) for q in queries] == [("q2", "the second")]
    assert [u.name for u in unchecked] == ["q1"]


def test_array_constants_fold_in_queries(load: Any) -> None:
    loaded = load("const int A[2] = {3, 4}; int n; process P() { state s; init s; }\nsystem P;")
    ((query,), _) = elaborate_queries(loaded, "E<> n == A[1]")
    assert query.predicate.right.value == 4


@pytest.mark.parametrize(
    ("query", "code", "underlined"),
    [
        ("E<> Single.Of", "E0207", "Of"),
        ("E<> Singel.Off", "E0201", "Singel"),
        ("E<> T.Idle", "E0206", "T"),
        ("E<> T(3).Idle", "E0206", "T(3)"),
        ("E<> T(x).Idle", "E0301", "x"),
        ("E<> T(0, 1).Idle", "E0308", "T(0, 1)"),
        ("E<> Single(0).Off", "E0206", "Single(0)"),
        ("E<> Single", "E0203", "Single"),
        ("E<> Single.odd()", "E0207", "odd"),
        ("E<> T(0).odd", "E0203", "T(0).odd"),
        ("E<> n = 3", "E0101", None),
        ("E<> n++ > 1", "E0313", "n++"),
        ("E<> x", "E0305", "x"),
        ("sup: x > 3", "E0503", "x > 3"),
        ("sup: a", "E0503", "a"),
        ("sup: x + n", "E0503", "x + n"),
        ("inf: Single.Off + x", "E0503", "Single.Off + x"),
        ("E<> forall (i : id_t) T(i).Idel", "E0207", "Idel"),
    ],
)
def test_findings(load: Any, query: str, code: str, underlined: str | None) -> None:
    loaded = load(MODEL)
    with pytest.raises(InputError) as caught:
        elaborate_queries(loaded, query)
    (found,) = caught.value.diagnostics
    if underlined is not None:
        assert (found.code, found.span.text) == (code, underlined)


def test_findings_of_all_queries_are_collected(load: Any) -> None:
    loaded = load(MODEL)
    with pytest.raises(InputError) as caught:
        elaborate_queries(loaded, "E<> foo\nE<> bar\nE<> n > 1")
    assert [d.span.text for d in caught.value.diagnostics] == ["foo", "bar"]
    assert len(elaborate_queries(loaded, "E<> n > 1")[0]) == 1


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("signal sig = n++;", [("E0313", "n++")]),
        ("signal sig = deadlock;", [("E0501", "deadlock")]),
        ("signal sig = foo;", [("E0201", "foo")]),
        ("signal n = 1;", [("E0202", "n")]),
        ("signal Single = 1;", [("E0202", "Single")]),
        ("signal b = foo; property p : E<> b;", [("E0201", "foo")]),
        ("property p : E<> n > 1; property p : E<> n > 2;", [("E0202", "p")]),
    ],
)
def test_findings_in_signals_and_properties(find: Any, text: str, expected: list[tuple[str, str]]) -> None:
    assert find(MODEL + text) == expected


def test_the_inside_of_a_process_is_hidden_from_the_model(find: Any) -> None:
    text = "process A() { int v; state s; init s; } process B() { state s; init s; trans s -> s { guard A.v > 1; }; }"
    assert find(text + "\nsystem A, B;") == [("E0206", "A")]


def test_nested_quantifiers_over_processes_are_bounded(load: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tachk.formats.loading.load.INSTANCES", 1000)
    loaded = load("process T(int[0,1] k) { state s; init s; }\nsystem T;")
    shallow = "".join(f"forall (i{j} : int[0,0]) " for j in range(60))
    deep = "".join(f"forall (i{j} : int[0,1]) " for j in range(30))
    assert len(elaborate_queries(loaded, f"E<> {shallow} T(i0).s")[0]) == 1
    with pytest.raises(InputError) as caught:
        elaborate_queries(loaded, f"E<> {deep} T(i0).s")
    assert [d.code for d in caught.value.diagnostics] == ["E0609"]


def test_without_a_system_line_properties_are_not_evaluated() -> None:
    text = "process P(int[0, 1] i) { init location s; }\nproperty stays : A[] P(0).s;"
    with pytest.raises(InputError) as caught:
        load_model(Source("model.ta", text))
    assert [found.code for found in caught.value.diagnostics] == ["E0410"]


def test_a_process_that_does_not_run_is_rejected_with_those_that_do(load: Any) -> None:
    loaded = load(
        "process T(const int i) { init location a; } process U() { init location b; } T1 = T(1); T2 = T(2);\n"
        "system T1, T2;\nproperty p : E<> T.a;\nproperty q : E<> U.b;\nproperty r : E<> T1.a;"
    )
    assert [query.name for query in loaded.queries] == ["r"]
    found = {query.name: query.diagnostics[0] for query in loaded.unchecked}
    assert {name: (d.code, d.span.text, d.help) for name, d in found.items()} == {
        "p": ("E0733", "T", "made from `T` and running: `T1`, `T2`"),
        "q": ("E0733", "U", "a property is checked where the system line names `U`"),
    }
    assert not any(query.is_wrong for query in loaded.unchecked)


def test_a_signal_of_a_process_that_does_not_run_is_a_mistake(load: Any) -> None:
    with pytest.raises(InputError) as caught:
        load("process P() { init location a; } process U() { init location b; } system P; signal s = U.b;")
    codes = {d.code for d in caught.value.diagnostics}
    assert "E0206" in codes and "E0733" not in codes
