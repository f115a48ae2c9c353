"""Typing of expressions and functions, and what they evaluate to."""

from __future__ import annotations

from typing import Any

import pytest

from tachk.base.span import Source
from tachk.frontend.loaded import LoadedModel
from tachk.model.evaluate import ClockChanges, Environment, evaluate, execute
from tachk.model.expressions import Constant
from tachk.model.fault import EvaluationFault, RuntimeErrorKind
from tachk.model.variable_layout import variable_layout

DECLARATIONS = """
const int N = 3;
const int POW[4] = {1, 2, 4, 8};
typedef int[0, N-1] id_t;
typedef struct { int a; bool b; int[0,5] c[2]; } rec_t;
const rec_t K = {1, true, {2, 3}};
int n = 4, m = 5, arr[3] = {1, 2, 3}, other[3];
bool flags[id_t];
rec_t r = K, rs[2] = {K, {a: 3, b: false, c: {1, 1}}};
clock x, xs[2];
int fact(int k) { int p = 1; while (k > 1) { p *= k; k--; } return p; }
void swap(int &a, int &b) { int t = a; a = b; b = t; }
int total(int a[3]) { int i, s = 0; for (i = 0; i < 3; i++) s += a[i]; return s; }
bool any(const bool &f[id_t]) { for (k : id_t) if (f[k]) return true; return false; }
int largest(const int &a, const int &b) { return a >? b; }
rec_t bump(rec_t q) { q.a++; q.c[0] = 0; return q; }
int down(int k) { do { k = k - 1; } while (k > 0); assert k == 0; return k; }
void restart(clock &c) { c = 2; }
int shadow() { int n = 1; { int n = 2; m = n; } return n; }
int hidden(int n) { const int two = 2; int a[two] = {n, two}; typedef int[0,9] t; t d = a[0]; return d + a[1]; }
int both() { int i, j; for (i = 0, j = 9; i < j; i++, j--) {} return i; }
int nothing() { ; return n > 3 ? (n < 9 ? 1 : 2) : 3; }
"""


def environment(model: LoadedModel) -> Environment:
    layout = variable_layout(model.network)
    return Environment(layout, list(layout.initial))


def after(load: Any, update: str) -> tuple[dict[str, int], ClockChanges]:
    """The slots, and the clock resets, after an update of the initial state."""
    model = load(DECLARATIONS + f"process P() {{ int local; state s; init s; trans s -> s {{ assign {update}; }}; }}")
    env = environment(model)
    execute(model.network.processes[0].edges[0].updates, env)
    return dict(zip(env.layout.names, env.values, strict=True)), env.resets


@pytest.mark.parametrize(
    ("written", "value"),
    [
        ("1 + 2 * 3 - 4 / 3", 6),
        ("-7 / 2", -3),
        ("7 % 3 << 2", 4),
        ("6 & 3 | 8 ^ 1", 11),
        ("2 ** 3 * 2", 16),
        ("1 <? 2 >? 3", 3),
        ("!0 && not false", 1),
        ("true imply false or true", 1),
        ("true xor true", 0),
        ("5 == true", 0),
        ("n == 4 ? 10 : 20", 10),
        ("fact(5)", 120),
        ("total(arr) + total(other)", 6),
        ("any(flags)", 0),
        ("largest(3, n)", 4),
        ("bump(r).a", 2),
        ("bump(r).c[0] + bump(rs[1]).c[1]", 1),
        ("down(3)", 0),
        ("POW[3]", 8),
        ("POW[n - 2]", 4),
        ("K.c[1]", 3),
        ("r == K", 1),
        ("r != rs[1]", 1),
        ("arr == other", 0),
        ("forall (i : id_t) arr[i] > 0", 1),
        ("exists (i : id_t) flags[i]", 0),
        ("sum (i : id_t) arr[i] * i", 8),
        ("forall (i : int[0,1]) exists (j : id_t) rs[i].c[0] == j", 1),
        ("shadow()", 1),
        ("hidden(3)", 5),
        ("both()", 5),
        ("nothing()", 1),
        ("-2147483648 + 1", -2147483647),
        ("abs(3 - n) + abs(n)", 5),
        ("abs(INT32_MAX)", 2**31 - 1),
    ],
)
def test_values(load: Any, written: str, value: int) -> None:
    model = load(f"{DECLARATIONS}process P() {{ state s; init s; trans s -> s {{ assign m = 0 + ({written}); }}; }}")
    update = model.network.processes[0].edges[0].updates[0]
    assert evaluate(update.value, environment(model)) == value


@pytest.mark.parametrize(
    ("update", "slots"),
    [
        ("n = 1, m := n + 1", {"n": 1, "m": 2}),
        ("n += 3, m *= n", {"n": 7, "m": 35}),
        (
            "n -= 1, m /= 2, arr[0] <<= 3, arr[1] >>= 1, arr[2] %= 2",
            {"n": 3, "m": 2, "arr[0]": 8, "arr[1]": 1, "arr[2]": 1},
        ),
        ("n &= 6, m |= 2, arr[0] ^= 3", {"n": 4, "m": 7, "arr[0]": 2}),
        ("m = n++, arr[0] = ++n, arr[1] = n--", {"m": 4, "arr[0]": 6, "arr[1]": 6, "n": 5}),
        ("swap(n, m)", {"n": 5, "m": 4}),
        ("swap(arr[0], arr[2])", {"arr[0]": 3, "arr[2]": 1}),
        ("other = arr", {"other[2]": 3}),
        ("r = rs[1], r.c = rs[0].c", {"r.a": 3, "r.b": 0, "r.c[0]": 2}),
        ("(n > 3 ? n : m) = 9", {"n": 9, "m": 5}),
        ("flags[1] = 7, r.b = n", {"flags[1]": 1, "r.b": 1}),
        ("rs[1] = bump(rs[1])", {"rs[1].a": 4, "rs[1].c[0]": 0}),
        ("local = n, n = local + 1", {"P.local": 4, "n": 5}),
        ("m = shadow()", {"m": 1, "n": 4}),
        ("m = abs(1 - n++)", {"m": 3, "n": 5}),
        ("n = m = 2", {"n": 2, "m": 2}),
    ],
)
def test_updates(load: Any, update: str, slots: dict[str, int]) -> None:
    values, resets = after(load, update)
    assert {name: values[name] for name in slots} == slots
    assert resets == {}


def test_clock_resets(load: Any) -> None:
    assert after(load, "x = 0, xs[n % 2] = n, restart(xs[1])")[1] == {1: (0, 0), 2: (0, 4), 3: (0, 2)}
    assert after(load, "xs[0] = x, x = n + xs[1] + 1, xs[1] = x")[1] == {1: (3, 5), 2: (1, 0), 3: (3, 5)}


def test_range_errors_stay_for_run_time(load: Any) -> None:
    with pytest.raises(EvaluationFault) as caught:
        after(load, "r.c[0] = 6")
    assert caught.value.kind is RuntimeErrorKind.RANGE
    assert caught.value.span.text == "r.c[0] = 6"


@pytest.mark.parametrize("written", ["1 / 0", "arr[3]", "POW[-1]", "2147483647 + 1", "1 << 40"])
def test_folding_keeps_run_time_errors(load: Any, written: str) -> None:
    with pytest.raises(EvaluationFault):
        after(load, f"n = {written}")


def test_dead_code_is_no_error(load: Any) -> None:
    assert after(load, "n = false && POW[-1] == 1")[0]["n"] == 0


def test_parameters_and_constants_fold(load: Any) -> None:
    body = "int v; state s; init s; trans s -> s { assign v = A[i] + i; };"
    model = load(f"const int A[2] = {{3, 4}};\nprocess P(const int i) {{ {body} }}\nQ = P(1);\nsystem Q;")
    assert model.network.processes[0].edges[0].updates[0].value == Constant(5)


@pytest.mark.parametrize(
    ("declarations", "expected"),
    [
        ("int f() { return g(); }", [("E0201", "g")]),
        ("int f(int a, int a) { return a; }", [("E0202", "a")]),
        ("int f() { int a; bool a; return a; }", [("E0202", "a")]),
        ("int f(int a) { int a; return a; }", [("E0202", "a")]),
        ("int f(int a) { { int a; return a; } }", []),
        ("int f() { int f = 1; return f; }", []),
        ("int f() { return; }", [("E0312", "return;")]),
        ("int a[2]; int f() { return a; }", [("E0312", "a")]),
        ("int f() { while (true) { } }", []),
        ("int f(int i) { for (k : int[0,1]) { return k; } }", []),
        ("int f(int i) { while (i > 0) { return i; } }", [("E0311", "f")]),
        ("int f(bool b) { if (b) return 1; else return 2; }", []),
        ("chan f() { }", [("E0315", "chan")]),
        ("void f(chan c) { }", [("E0315", "chan c")]),
        ("void f() { clock c; }", [("E0315", "c")]),
        ("void f() { const int k; }", [("E0607", "k")]),
        ("void f() { for (i : int[0,3]) i = 2; }", [("E0303", "i")]),
        ("void f(const int &a) { a = 2; }", [("E0303", "a")]),
        ("void f(int a) { a = 2; }", []),
        ("int n; void g(int &a) { a = 1; } void f() { g(3); }", [("E0317", "3")]),
        ("const int n = 1; void g(int &a) { a = 1; } void f() { g(n); }", [("E0317", "n")]),
        ("const int k[2] = {1, 2}; void g(int &a[2]) { a[0] = 1; } void f() { g(k); }", [("E0303", "k")]),
        ("const int k[2] = {1, 2}; int g(const int &a[2]) { return a[0]; } int f() { return g(k); }", []),
        ("void f() { 3 = 4; }", [("E0303", "3")]),
        ("typedef scalar[2] s; typedef scalar[2] t; s a; t b; bool f() { return a == b; }", [("E0304", "a == b")]),
        ("typedef scalar[2] s; s a; bool f() { return a == 0; }", [("E0304", "a == 0")]),
        ("typedef scalar[2] s; s a; void f() { a = 1; }", [("E0302", "a = 1")]),
        ("typedef scalar[2] s; s a, b; int w[s]; bool f() { w[a] = 1; a = b; return a == b && a != b; }", []),
        ("typedef scalar[2] s; s a; int f() { return a + 1; }", [("E0301", "a")]),
        (
            "typedef scalar[2] s; s a; bool f() { return a < a; }",
            [
                ("E0301", "a"),
            ],
        ),
        ("typedef scalar[2] s; int w[s]; int f() { return w[0]; }", [("E0306", "0")]),
        ("typedef scalar[2] s; s a; int w[2]; int f() { return w[a]; }", [("E0306", "a")]),
        ("clock x; int f() { return x; }", [("E0312", "x")]),
        ("clock x, y; void f() { x = y; }", []),
        ("clock x, y; void f() { x = y - 1; }", [("W0407", "f")]),
        ("clock x; void f() { x += 1; }", [("W0407", "f")]),
        ("clock x; void f() { x++; }", [("E0301", "x")]),
        ("int f() { return deadlock; }", [("E0501", "deadlock")]),
        ("int f() { return random(3); }", [("W0407", "f")]),
        ("bool abs(int k) { return k > 1; } const int two[2] = {1, 2}; bool b = abs(1) == false;", []),
        ("clock x; int f() { return abs(x); }", [("E0309", "x")]),
        ("int n; int f() { return n'; }", [("E0334", "n'")]),
        ("bool f() { return forall (i : int[0,1]) i; }", []),
        ("int f(int &n) { n = 1; return n; } bool g() { int k; return forall (i : int[0,1]) f(k) == i; }", []),
    ],
)
def test_findings(find: Any, declarations: str, expected: list[tuple[str, str]]) -> None:
    assert find(declarations) == expected


def test_spans_are_exact(load: Any) -> None:
    text = "int a, b;\nprocess P() { state s; init s; trans s -> s { guard a + 1 < b; }; }\nsystem P;"
    guard = load(text).network.processes[0].edges[0].guard
    assert (guard.span.text, guard.left.span.text) == ("a + 1 < b", "a + 1")
    assert isinstance(guard.span.source, Source)
