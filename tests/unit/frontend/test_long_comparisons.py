"""Chains of comparisons: the work for them grows with their length, not with its square."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import nullcontext

import pytest

from tachk.base.diagnostics.diagnostic import InputError
from tachk.base.span import Source
from tachk.formats.catalogue import export_model
from tachk.formats.loading.load import load_model
from tachk.formats.plain.text_types import TextTypes
from tachk.frontend.hybrid_clocks import computed_clocks, declared_names, hybrid_clocks
from tachk.recordings.monitors import compiler
from tachk.recordings.monitors.formulas import read_formulas
from tachk.recordings.monitors.offline import evaluate_formulas
from tachk.recordings.traces.trace_files import open_trace
from tachk.syntax import ast, walk

OPERATORS = ("==", "!=", "<")


def model(invariant: str) -> Source:
    head = "int n; clock x; double d; void f() { n = (n == 1) == 0; } process P() { state A { x <= 2 && ("
    return Source("m.ta", f"{head}{invariant}) }}, B; init A; trans A -> B {{ }}; }} system P;")


def chain(operator: str, length: int) -> str:
    return f" {operator} ".join(["n"] * length)


class Counter:
    def __init__(self) -> None:
        self.count = 0

    def around(self, function: Callable[..., object]) -> Callable[..., object]:
        def counted(*args: object) -> object:
            self.count += 1
            return function(*args)

        return counted


@pytest.mark.parametrize("operator", OPERATORS)
def test_looking_for_hybrid_clocks(operator: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def visited(length: int) -> int:
        items = load_model(model(chain(operator, length))).items
        counter = Counter()
        with monkeypatch.context() as patched:
            patched.setattr(walk, "_parts", counter.around(walk._parts))
            assert hybrid_clocks(items) == frozenset()
            comparison = next(walk.nodes_of_kind(items, ast.BinaryExpression))
            assert computed_clocks(comparison, declared_names(items), measured=False) == frozenset()
        return counter.count

    assert visited(400) < 5 * visited(100)


@pytest.mark.parametrize("operator", OPERATORS)
def test_writing_conditions_on_clocks(operator: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def asked(length: int) -> int:
        loaded = load_model(model(chain(operator, length)))
        counter = Counter()
        with monkeypatch.context() as patched:
            patched.setattr(TextTypes, "reads_clock", counter.around(TextTypes.reads_clock))
            export_model(loaded, "xml")
        return counter.count

    assert asked(400) < 5 * asked(100)


@pytest.mark.parametrize("values", [[True, False], [1, 2]])
def test_monitoring(values: list[object], monkeypatch: pytest.MonkeyPatch) -> None:
    trace = open_trace({"time": [0, 1], "n": values})

    def printed(length: int) -> int:
        texts: list[str] = []

        def noted(node: ast.Expression) -> str:
            texts.append(original(node))
            return texts[-1]

        original = compiler.print_expression
        formulas = read_formulas(f"G ({chain('==', length)})")
        with monkeypatch.context() as patched:
            patched.setattr(compiler, "print_expression", noted)
            with nullcontext() if values[0] is True else pytest.raises(InputError, match="E0904"):
                evaluate_formulas(formulas, trace)
        return sum(map(len, texts))

    assert printed(400) < 5 * printed(100)


@pytest.mark.parametrize(
    ("invariant", "found"),
    [
        ("((x < n) == (n < 3)) == (d < 1.5)", {"x"}),
        ("((x < 1.5) == (n < 3)) == (n < 2)", {"x"}),
        ("x < n && d < 1.5", set()),
        ("x' == (d > 0.5)", set()),
        ("x' == 2", {"x"}),
    ],
)
def test_what_is_inexact_inside_of_a_comparison(invariant: str, found: set[str]) -> None:
    assert hybrid_clocks(load_model(model(invariant), keeps_doubles=True).items) == found
