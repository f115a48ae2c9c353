"""Which constants are proved monotone: whatever is wrongly called so makes regions wrong."""

from __future__ import annotations

import pytest

from tachk import loads
from tachk.frontend.loaded import with_constants
from tachk.model.query import Query
from tachk.verify.questions import Questions
from tachk.verify.synthesis.bounds_of_parameters import NoBound, ParameterBound, bounds_of_parameters

MODEL = """
const int P = 2;
const int S = 3;
clock x, y;
{declarations}
int[0, 5] n = 0;
chan c;
broadcast chan b;
urgent chan u;

process A({parameters}) {{
    {local}
    init location a {{ {invariant} to z {{ {edge} }} }}
    location z;
}}
process B() {{ init location a {{ to z {{ {other} }} }} location z; }}
one = A({arguments});
two = B();
system one, two;
property p : {query};
"""


def found(
    edge: str = "",
    invariant: str = "",
    other: str = "",
    declarations: str = "",
    local: str = "",
    parameters: str = "",
    arguments: str = "",
    query: str = "A[] not one.z",
    box: tuple[int, int] = (0, 9),
    name: str = "P",
) -> ParameterBound | NoBound:
    text = MODEL.format(
        edge=edge,
        invariant=invariant,
        other=other,
        declarations=declarations,
        local=local,
        parameters=parameters,
        arguments=arguments,
        query=query,
    )
    model = loads(text)
    opened = with_constants(model.loaded, {}, ["p"], ["P", "S"])
    (asked,) = Questions("", ("p",)).about(opened)
    assert isinstance(asked, Query)
    ranges = {"P": box, "S": box}
    return bounds_of_parameters(opened.network, asked, opened.context.open_constants, ranges)[name]


@pytest.mark.parametrize(
    ("where", "bound"),
    [
        ({"invariant": "invariant x <= P;"}, ParameterBound.UPPER),
        ({"invariant": "invariant x < 2 * P + 1;"}, ParameterBound.UPPER),
        ({"edge": "guard x <= P;"}, ParameterBound.UPPER),
        ({"edge": "guard x >= P;"}, ParameterBound.LOWER),
        ({"edge": "guard P < x;"}, ParameterBound.LOWER),
        ({"edge": "guard x - y <= P;"}, ParameterBound.UPPER),
        ({"edge": "guard x - P <= y;"}, ParameterBound.UPPER),
        ({"edge": "guard x + P <= 9;"}, ParameterBound.LOWER),
        ({"edge": "guard x <= 9 - P;"}, ParameterBound.LOWER),
        ({"edge": "guard x <= -(3 - P);"}, ParameterBound.UPPER),
        ({"edge": "guard x >= 9 - 2 * P;"}, ParameterBound.UPPER),
        ({"edge": "guard x <= S * P;"}, ParameterBound.UPPER),
        ({"edge": "guard x <= P + n;"}, ParameterBound.UPPER),
        ({"edge": "guard n > 1 || x <= P;"}, ParameterBound.UPPER),
        ({"edge": "guard not (x > P);"}, ParameterBound.UPPER),
        ({"edge": "guard n > 1 imply x <= P;"}, ParameterBound.UPPER),
        ({"edge": "guard x <= (n > 1 ? 3 : 2);"}, ParameterBound.ABSENT),
        ({"edge": "guard x <= P; sync c!;", "other": "guard y <= P; sync c?;"}, ParameterBound.UPPER),
        ({"edge": "guard x <= P; sync b!;", "other": "sync b?;"}, ParameterBound.UPPER),
        ({"edge": "sync u!;", "other": "sync u?;", "invariant": "invariant x <= P;"}, ParameterBound.UPPER),
        ({"declarations": "const int T = 2 * P + S;", "edge": "guard x <= T;"}, ParameterBound.UPPER),
        ({"declarations": "const int T = 2 * S - P;", "edge": "guard x <= T;"}, ParameterBound.LOWER),
        ({"local": "const int T = P + 1;", "edge": "guard x <= T;"}, ParameterBound.UPPER),
        ({"parameters": "const int T", "arguments": "P", "edge": "guard x <= T;"}, ParameterBound.UPPER),
        ({"parameters": "int T", "arguments": "P + 1", "edge": "guard x <= T;"}, ParameterBound.UPPER),
        ({"query": "E<> one.z && x <= P"}, ParameterBound.UPPER),
        ({"query": "A[] one.z imply x <= P"}, ParameterBound.LOWER),
        ({"query": "A[] not (one.z && x <= P)"}, ParameterBound.UPPER),
        ({"query": "E<> not (one.z imply x <= P)"}, ParameterBound.LOWER),
        ({"query": "F[0, 3] one.z", "invariant": "invariant x <= P;"}, ParameterBound.UPPER),
        ({}, ParameterBound.ABSENT),
        ({"declarations": "int unused(int a) { return a + P; }"}, ParameterBound.ABSENT),
    ],
)
def test_bounds_of_clocks_are_monotone(where: dict[str, str], bound: ParameterBound) -> None:
    assert found(**where) is bound


@pytest.mark.parametrize(
    "where",
    [
        {"edge": "guard x == P;"},
        {"edge": "guard x <= P;", "invariant": "invariant y >= P;"},
        {"edge": "guard x >= P;", "invariant": "invariant x <= P;"},
        {"edge": "guard x <= P;", "query": "A[] one.z imply x <= P"},
        {"edge": "guard x <= P && n < P;"},
        {"edge": "guard n < P;"},
        {"edge": "guard x <= P * P - 3 * P;"},
        {"edge": "guard x <= P * n; assign n = 1;", "declarations": "int[-1, 1] m;", "other": "guard x <= P * m;"},
        {"edge": "guard x <= P % 3;"},
        {"edge": "guard x <= 9 / (P + 1);"},
        {"edge": "guard x <= P << 1;"},
        {"edge": "guard x <= (P > 2 ? 1 : 2);"},
        {"edge": "guard P > 2 ? x <= 1 : x >= 2;"},
        {"declarations": "const bool T = P > 2;", "edge": "guard T;"},
        {"declarations": "const bool T = P > 2;", "edge": "guard !T || x <= 3;"},
        {"declarations": "int f() { return P; }", "edge": "guard x <= f();"},
        {"declarations": "int f(int a) { return 5 - a; }", "edge": "guard x <= f(P);"},
        {"declarations": "const int[0, 20] T = P;", "edge": "guard x <= T;"},
        {"declarations": "const int T[2] = {P, 3};", "edge": "guard x <= T[0];"},
        {"declarations": "int a[P + 1];", "edge": "guard x <= P;"},
        {"declarations": "int[0, 20] m = P;", "edge": "guard x <= P;"},
        {"declarations": "typedef int[0, P] t;", "edge": "select i : t; guard x >= i;"},
        {"declarations": "clock w[9];", "edge": "guard w[P] <= 3;"},
        {"declarations": "chan d[9];", "edge": "guard x <= 3; sync d[P]!;", "other": "sync d[2]?;"},
        {"edge": "assign n = P;"},
        {"edge": "assign x = P;"},
        {"declarations": "void f() { x = P; }", "edge": "assign f();"},
        {"parameters": "int T", "arguments": "P", "edge": "guard x <= T; assign T = T - 1;"},
        {"edge": "guard x <= P; sync b?;", "other": "sync b!;"},
        {"edge": "guard x >= P; sync b?;", "other": "sync b!;"},
        {"edge": "guard x <= P;", "query": "A[] not deadlock"},
        {"edge": "guard x <= P;", "query": "A[] deadlock imply one.z"},
        {"edge": "guard x <= P;", "query": "A<> one.z"},
        {"edge": "guard x <= P;", "query": "E[] one.a"},
        {"edge": "guard x <= P;", "query": "one.a --> one.z"},
        {"edge": "guard x <= P;", "query": "G (one.a -> F one.z)"},
        {"query": "A[] one.z imply x == P"},
        {"query": "A[] n <= P"},
        {"query": "G (n < P -> F[0, 3] one.z)"},
        {"declarations": "chan priority c < b;", "edge": "guard x <= P; sync c!;", "other": "sync c?;"},
    ],
)
def test_everything_else_is_not(where: dict[str, str]) -> None:
    assert isinstance(found(**where), NoBound)


def test_the_guard_of_an_urgent_edge_is_not() -> None:
    # The engine refuses clocks there; the proof must not rely on that.
    assert isinstance(found(edge="guard x <= P; sync u!;", other="sync u?;"), NoBound)


def test_a_sum_that_may_wrap_around_is_not() -> None:
    guard = "guard x <= 100000000 * P;"
    assert found(edge=guard, box=(0, 20)) is ParameterBound.UPPER
    assert isinstance(found(edge=guard, box=(0, 22)), NoBound)


def test_the_sign_of_a_factor_must_be_known() -> None:
    assert found(edge="guard x <= S * P + 50;", box=(-3, 0)) is ParameterBound.LOWER
    assert isinstance(found(edge="guard x <= S * P + 50;", box=(-3, 3)), NoBound)


def test_the_place_of_what_is_in_the_way_is_reported() -> None:
    reason = found(edge="guard x == P;")
    assert isinstance(reason, NoBound)
    assert reason.span.text == "P"
    assert "==" in reason.reason


def test_constants_are_distinguished() -> None:
    assert found(edge="guard x <= P && x >= S;", name="S") is ParameterBound.LOWER
    assert found(edge="guard x <= P && x >= S;", name="P") is ParameterBound.UPPER


@pytest.mark.parametrize(
    ("query", "bound"),
    [
        ("G (one.a -> F[0, P] one.z)", ParameterBound.LOWER),
        ("G (one.a -> F[P, 20] one.z)", ParameterBound.UPPER),
        ("G (one.a -> G[0, P] two.a)", ParameterBound.UPPER),
        ("G (F[0, P] one.z -> two.a)", ParameterBound.UPPER),
        ("G (one.a -> F[0, 20 - 2 * P] one.z)", ParameterBound.UPPER),
        ("G (one.a -> (two.a U[0, P] one.z))", ParameterBound.LOWER),
        ("G (one.a && G[0, S] two.a -> F[0, P] one.z)", ParameterBound.LOWER),
        ("A<>[<= P] one.z", ParameterBound.LOWER),
        ("one.a -->[< P] one.z", ParameterBound.LOWER),
    ],
)
def test_bounds_of_the_property_are_monotone_where_nothing_else_has_them(query: str, bound: ParameterBound) -> None:
    assert found(query=query) is bound


@pytest.mark.parametrize(
    "where",
    [
        {"query": "G (one.a -> F[0, P] one.z) && G (two.a -> G[0, P] one.a)"},
        {"query": "G (one.a -> F[P, 2 * P] one.z)"},
        {"query": "G (one.a -> F[0, P * S] one.z)"},
        {"query": "G (one.a -> F[0, T] one.z)", "declarations": "const int T = 12 - P;"},
        {"query": "G (one.a -> F[0, P] one.z)", "edge": "guard x >= P;"},
        {"query": "G (one.a && n < P -> F[0, P] one.z)"},
        {"query": "A<>[<= P] n == P"},
        {"query": "one.a -->[<= P] one.z", "edge": "guard n < P;"},
    ],
)
def test_bounds_of_the_property_that_count_otherwise_are_not(where: dict[str, str]) -> None:
    assert isinstance(found(**where), NoBound)
