"""Edges for many values of a select variable: compiled once, and the same as if each were compiled on its own."""

from __future__ import annotations

import pytest

from tachk.base.span import Source
from tachk.engine.compiler import lower as lowering
from tachk.engine.compiler.condition_code import ConditionCompiler
from tachk.engine.compiler.lower import lower
from tachk.engine.compiler.program import Program
from tachk.formats.loading.load import load_model

pytestmark = pytest.mark.drawn

_DECLARATIONS = (
    "int[0,99] n; int[-5,20] m; int a[100]; bool b; const int K = 7; clock x; chan c; broadcast chan d; chan e[100];"
    "int square(int k) { return k * k; } process Q() { init location z { to z { sync c!; } to z { sync d?; } } } "
)


def program(edge: str) -> Program:
    """That of a process with one edge; others write the variables, so that none is a constant."""
    others = "to p { assign n = 3; } to p { assign m = 3; } to p { assign a[n] = 3; } to p { assign b = !b; }"
    text = f"{_DECLARATIONS} process P() {{ init location p {{ to p {{ {edge} }} {others} }} }} system P, Q;"
    return lower(load_model(Source("model.ta", text)).network)[0]


_EDGES = [
    "guard i == n + 1 && n < 20; assign n = i;",
    "guard n == i;",
    "guard n < i && m >= i || b; assign m = i;",
    "guard i <= m && x <= 5; assign x = 0;",
    "guard !(n > i) && b; assign n = i, n++;",
    "guard n + m > i || i - m < 3 && a[n] == i; assign a[3] = i, n += i;",
    "guard 10 / n > 2 && n == i;",
    "guard n / i > 2;",
    "guard a[n + i] == 3;",
    "guard a[i] == n; assign a[i] = n;",
    "guard i > 3 && i == n;",
    "guard i * K == n && i == K + m;",
    "guard x <= i;",
    "guard x <= n + i && x - n > 2;",
    "guard n == square(i);",
    "guard square(n) == i;",
    "guard exists (k : int[0,5]) a[k] == i;",
    "guard n == i + i;",
    "guard (n == i) == b; sync c?; assign x = 3, m = n + i;",
    "guard n == i; sync d!; assign m = m * i - 2;",
    "guard n != i; sync d?; assign m = i + n, b = (i == m);",
    "sync e[i]!; assign n = i;",
    "assign x = i;",
    "assign n = (b ? i : 3);",
    "assign n = i, n = m;",
    "guard i == m; assign n++, m = i;",
    "guard i * 2 == n + 2 && n < 20; assign n = i;",
    "guard 3 * i - 7 == n; assign m = 2 * i - 30;",
    "guard 7 - 3 * i < m && -i + 2 <= n || b; assign n = 90 - i, m = -(2 * i);",
    "guard n == i && n == 2 * i;",
    "guard i * (i + 1) == n + m;",
    "guard 2 * (3 * i - 4) - i != n - m; assign a[i] = 1;",
    "guard i - i == n;",
    "guard 2 * i == 6 && n == m;",
    "guard i * 1000000000 == n + m;",
    "guard n - 2 * i >= m; assign n = n + 3 * i;",
    "guard i != 7 && n < 20; assign n = i;",
    "guard i == 7; assign n = i;",
    "guard 5 <= i && i < 12 || n == i;",
    "guard !(2 * i > 31) && n == i; assign m = i;",
    "guard (i < 9) == b; assign n = i;",
    "guard 3 * i - 7 != 2 && (i > 20 || n == 4) && x < 3; assign n = 90 - i;",
    "guard (i + 2) % 4 == 1; assign n = i;",
    "guard i / 3 != 5; assign n = i;",
]


@pytest.mark.parametrize("selects", ["i : int[0,99]", "i : int[-40,120]", "j : int[0,2], i : int[0,40]"])
@pytest.mark.parametrize("edge", _EDGES)
def test_edges_of_a_pattern_are_those_that_each_value_gives(
    edge: str, selects: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    patterned = program(f"select {selects}; {edge}")
    monkeypatch.setattr(lowering, "WIDE_SELECT", 2**31)
    assert patterned == program(f"select {selects}; {edge}")


@pytest.mark.parametrize(
    "edge",
    [
        "guard i == n + 1 && n < 20; assign n = i;",
        "guard n == i && x < 5; sync d?; assign x = 0, m = n + i;",
        "guard 2 * i == n + m; assign m = i;",
        "guard 3 - i == n + m; assign m = i - 5;",
        "guard i != 7; assign n = i;",
    ],
)
def test_a_wide_select_compiles_its_guard_a_few_times(edge: str, monkeypatch: pytest.MonkeyPatch) -> None:
    compiled = []
    whole = ConditionCompiler.compile
    monkeypatch.setattr(ConditionCompiler, "compile", lambda *given: compiled.append(given) or whole(*given))
    assert len([each for each in program(f"select i : int[0,99]; {edge}").edges if each.selects]) >= 99
    assert len(compiled) < 30


def test_values_that_the_range_of_a_variable_decides_are_compiled_on_their_own() -> None:
    edges = [each for each in program("select i : int[-40,120]; guard i < m; assign n = 3;").edges if each.selects]
    assert [each.selects[0] for each in edges] == list(range(-40, 20))
    assert [bool(each.guard.tests) for each in edges] == [each.selects[0] >= -5 for each in edges]
