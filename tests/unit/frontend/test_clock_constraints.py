"""Comparisons of clocks: normal form, convexity, rates."""

from __future__ import annotations

from typing import Any

import pytest

from tachk.base.diagnostics.diagnostic import InputError
from tachk.base.span import Source
from tachk.formats.loading.load import load_model
from tachk.model.evaluate import Environment, evaluate
from tachk.model.expressions import (
    Binary,
    Conditional,
    Constant,
    Expression,
    Field,
    Index,
    Reference,
    Unary,
)
from tachk.model.fault import EvaluationFault, RuntimeErrorKind
from tachk.model.variable_layout import variable_layout

DECLARATIONS = "clock x, y, z[2]; int n; bool b, d[2]; struct { clock c; int k; } r; const int N = 2;"


def show(expression: Expression | None) -> str:
    """The expression as text with all parentheses."""
    match expression:
        case None:
            return "true"
        case Constant(value):
            return str(value)
        case Reference(variable):
            return variable.name
        case Index(base, index):
            return f"{show(base)}[{show(index)}]"
        case Field(base, name):
            return f"{show(base)}.{name}"
        case Unary(operator, operand):
            return f"{operator}{show(operand)}"
        case Binary(operator, left, right):
            return f"({show(left)} {operator} {show(right)})"
        case Conditional(condition, then, otherwise):
            return f"({show(condition)} ? {show(then)} : {show(otherwise)})"
        case _:
            return type(expression).__name__


@pytest.mark.parametrize(
    ("written", "expected"),
    [
        ("x <= 5", "(x <= 5)"),
        ("5 > x", "(x < 5)"),
        ("x == n", "(x == n)"),
        ("x + 2 <= n", "(x <= (n - 2))"),
        ("x <= N + 3", "(x <= 5)"),
        ("x - y < 3", "((x - y) < 3)"),
        ("x < y", "((x - y) < 0)"),
        ("x < y + 2", "((x - y) < 2)"),
        ("-x < -3", "(x > 3)"),
        ("3 < x - y", "((x - y) > 3)"),
        ("n < -x", "(x < -n)"),
        ("x - x < 3", "1"),
        ("z[n] <= 5 && z[0] > 1", "((z[n] <= 5) && (z[0] > 1))"),
        ("r.c >= r.k", "(r.c >= r.k)"),
        ("!(x < 5)", "(x >= 5)"),
        ("!(x < 5 || y > 3)", "((x >= 5) && (y <= 3))"),
        ("!b || x <= 5", "(!b || (x <= 5))"),
        ("b imply x <= 5", "(!b || (x <= 5))"),
        ("x <= 5 imply b", "((x > 5) || b)"),
        ("b ? x <= 5 : x <= 7", "((!b || (x <= 5)) && (b || (x <= 7)))"),
        ("forall (i : int[0,1]) z[i] <= i + 1", "((z[0] <= 1) && (z[1] <= 2))"),
        ("forall (i : int[0,1]) d[i] imply z[i] <= 1", "((!d[0] || (z[0] <= 1)) && (!d[1] || (z[1] <= 1)))"),
        ("!exists (i : int[0,1]) z[i] > 1", "((z[0] <= 1) && (z[1] <= 1))"),
        ("(b ? x : y) <= 5", "((b ? x : y) <= 5)"),
        ("n > 0 && x > 1 && (n < 3 || b)", "(((n > 0) && (x > 1)) && ((n < 3) || b))"),
        ("N == 2 || x < 1 || y < 2", "1"),
        ("n", "n"),
    ],
)
def test_guards_in_normal_form(load: Any, edge: Any, written: str, expected: str) -> None:
    model = load(edge(DECLARATIONS, f"guard {written};"))
    assert show(model.network.processes[0].edges[0].guard) == expected


@pytest.mark.parametrize(
    ("written", "code", "underlined"),
    [
        ("x <= 5 || y <= 5", "E0331", "x <= 5 || y <= 5"),
        ("!(x < 5 && y < 3)", "E0331", "(x < 5 && y < 3)"),
        ("x < 5 imply y < 3", "E0331", "x < 5 imply y < 3"),
        ("exists (i : int[0,1]) z[i] > 1", "E0331", "exists (i : int[0,1]) z[i] > 1"),
        ("(x < 5) == b", "E0331", "(x < 5) == b"),
        ("(x < 5) + 1 > n", "E0331", "(x < 5) + 1 > n"),
        ("x < 5 ? b : d[0]", "E0331", "x < 5 ? b : d[0]"),
        ("x != 5", "E0332", "x != 5"),
        ("!(x == 5)", "E0332", "(x == 5)"),
        ("x + y < 5", "E0335", "x + y < 5"),
        ("2 * x < 5", "E0750", "2 * x"),
        ("x", "E0305", "x"),
        ("x' == 0", "E0334", "x'"),
        ("z < 5", "E0301", "z"),
    ],
)
def test_rejected_guards(find: Any, edge: Any, written: str, code: str, underlined: str) -> None:
    assert find(edge(DECLARATIONS, f"guard {written};")) == [(code, underlined)]


@pytest.mark.parametrize(
    ("labels", "code"),
    [
        ("assign b = x < 5;", "E0330"),
        ("select i : int[0,1]; assign d[x > 1] = i;", "E0330"),
        ("guard (n = 3) > 0;", "E0313"),
        ("guard n++ > 0;", "E0313"),
    ],
)
def test_clocks_and_assignments_in_wrong_places(find: Any, edge: Any, labels: str, code: str) -> None:
    assert [c for c, _ in find(edge(DECLARATIONS, labels))] == [code]


def invariant(load: Any, written: str) -> Any:
    return load(f"{DECLARATIONS}\nprocess P() {{ state s {{ {written} }}; init s; }}").network.processes[0].locations[0]


@pytest.mark.parametrize(
    ("written", "condition", "rates"),
    [
        ("x <= 5", "(x <= 5)", []),
        ("x < 5 && y >= 2", "((x < 5) && (y >= 2))", []),
        ("x' == 0", "true", [("x", "0")]),
        ("x' == 1 && y <= 2", "(y <= 2)", []),
        ("x <= 5 && b == x' && y <= 2", "((x <= 5) && (y <= 2))", [("x", "b")]),
        ("x' == (n > 3)", "true", [("x", "(n > 3)")]),
        ("x' == (b ? 1 : 0)", "true", [("x", "(b ? 1 : 0)")]),
        ("forall (i : int[0,1]) z[i]' == d[i]", "true", [("z[0]", "d[0]"), ("z[1]", "d[1]")]),
        (
            "forall (i : int[0,1]) z[i]' == d[i] && z[i] <= 3",
            "((z[0] <= 3) && (z[1] <= 3))",
            [("z[0]", "d[0]"), ("z[1]", "d[1]")],
        ),
        ("forall (i : int[0,1]) z[i] <= n", "((z[0] <= n) && (z[1] <= n))", []),
    ],
)
def test_invariants(load: Any, written: str, condition: str, rates: list[tuple[str, str]]) -> None:
    location = invariant(load, written)
    assert show(location.invariant) == condition
    assert [(show(clock), show(rate)) for clock, rate in location.rates] == rates


@pytest.mark.parametrize(
    ("written", "code"),
    [
        ("x' == 2", "E0750"),
        ("x' == -1", "E0750"),
        ("n' == 0", "E0334"),
        ("x' <= 1", "E0334"),
        ("b || x' == 0", "E0334"),
        ("x <= 5 || y <= 5", "E0331"),
        ("n++ < 3", "E0313"),
    ],
)
def test_rejected_invariants(find: Any, written: str, code: str) -> None:
    assert [c for c, _ in find(f"{DECLARATIONS}\nprocess P() {{ state s {{ {written} }}; init s; }}")] == [code]


def test_a_rate_that_is_neither_0_nor_1_is_a_run_time_error(load: Any) -> None:
    model = load("clock x; int n; process P() { state s { x' == n }; init s; }")
    ((_, rate),) = model.network.processes[0].locations[0].rates
    layout = variable_layout(model.network)
    for n in (0, 1):
        assert evaluate(rate, Environment(layout, [1, n])) == n
    with pytest.raises(EvaluationFault) as caught:
        evaluate(rate, Environment(layout, [1, 2]))
    assert (caught.value.kind, caught.value.span.text) == (RuntimeErrorKind.RANGE, "n")


def test_disequality_of_clocks_in_a_query(load: Any) -> None:
    model = load("clock x;\nprocess P() { state s; init s; }\nsystem P;\nproperty p : E<> x != 5 && !(x < 3 || x > 7);")
    assert show(model.queries[0].predicate) == "(((x < 5) || (x > 5)) && !((x < 3) || (x > 7)))"


def test_a_rate_before_a_conditional_value_needs_brackets() -> None:
    model = "int n; hybrid clock e; process P() { init location a { invariant RATE; } } system P;"
    with pytest.raises(InputError) as refused:
        load_model(Source("m.ta", model.replace("RATE", "e' == n > 0 ? n : 1")), keeps_doubles=True)
    (found,) = refused.value.diagnostics
    assert (found.code, found.help) == ("E0334", "put brackets around the value: `e' == (n > 0 ? n : 1)`")
    assert load_model(Source("m.ta", model.replace("RATE", "e' == (n > 0 ? n : 1)")), keeps_doubles=True).network
