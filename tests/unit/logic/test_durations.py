"""Bounds as numbers in one unit of time."""

from __future__ import annotations

from fractions import Fraction

import pytest

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError
from tachk.base.time_units import length_of
from tachk.logic.durations import resolve
from tachk.syntax import ast
from tachk.syntax.formulas.printer import print_formula
from tests.support.tricky import read_formula


def evaluate(expression: ast.Expression) -> int:
    match expression:
        case ast.NameExpression(name="N"):
            return 7
        case _:
            raise InputError([Diagnostic("E0601", "no constant", expression.span)])


def resolved(text: str, unit: str = "") -> str:
    return print_formula(resolve(read_formula(text), evaluate, unit))


@pytest.mark.parametrize(
    ("text", "unit", "expected"),
    [
        ("F[0, 5] p", "", "F[0, 5] p"),
        ("F[0, 5] p", "10 ms", "F[0, 5] p"),
        ("F[0, 2 min) p", "1 s", "F[0, 120) p"),
        ("F[0, 1.5 ms] p", "us", "F[0, 1500] p"),
        ("F[0, 1 ms] p", "3 ms", "F[0, 1/3] p"),
        ("F[0 s, N] p", "h", "F[0, 7] p"),
        ("p U(1 h, 1 d] q", "15 min", "p U(4, 96] q"),
        ("G[N ms, inf) p", "ns", "G[7000000, inf) p"),
    ],
)
def test_conversion(text: str, unit: str, expected: str) -> None:
    assert resolved(text, unit) == expected


def test_everything_wrong_is_reported_in_order() -> None:
    with pytest.raises(InputError) as caught:
        resolved("F[5, 2] p && G[0, 3 s] q && O[-1, M] p", "")
    assert [d.code for d in caught.value.diagnostics] == ["E0505", "E0506", "E0504", "E0601"]


@pytest.mark.parametrize(
    ("unit", "length"),
    [("1 ms", 10**6), ("s", 10**9), ("0.5 s", 5 * 10**8), ("2 us", 2000), ("1 tick", None), ("", None), ("0 s", None)],
)
def test_units(unit: str, length: int | None) -> None:
    assert length_of(unit) == (None if length is None else Fraction(length))
