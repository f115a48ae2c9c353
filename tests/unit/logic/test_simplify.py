"""What simplification and negation make of formulas."""

from __future__ import annotations

import pytest

from tachk.logic.simplify import simplify
from tachk.syntax.formulas.printer import print_formula
from tests.support.tricky import read_formula


@pytest.mark.parametrize(
    ("text", "simpler"),
    [
        ("!!p", "p"),
        ("p && true && (q && p)", "p && q"),
        ("p || false || q || p", "p || q"),
        ("p && false", "false"),
        ("p && (q || p)", "p"),
        ("p || q && p && r", "p"),
        ("true -> p", "p"),
        ("p -> false", "!p"),
        ("!p -> false", "p"),
        ("p -> true", "true"),
        ("F[0,0] p", "p"),
        ("G[0,0] F[0,0] !(!p)", "p"),
        ("F[1,2] F[3,4] p", "F[4, 6] p"),
        ("F(1,2] F[3,4) p", "F(4, 6) p"),
        ("G G p", "G p"),
        ("G[1,inf) G(2,inf) p", "G(3, inf) p"),
        ("O[1,2] O p", "O[1, inf) p"),
        ("H[1,2] H[0,1] H p", "H[1, inf) p"),
        ("F[2,2) p", "false"),
        ("G(2,2] p", "true"),
        ("p U(0,0) q", "false"),
        ("F[0,5] true", "true"),
        ("G false", "false"),
        ("true U[0,3] p", "F[0, 3] p"),
        ("true S p", "O p"),
        ("false U p", "p"),
        ("false U[1,2] p", "false"),
        ("p U true", "true"),
        ("p U[0,5] p", "p"),
        ("p W false", "G p"),
        ("p W p", "p"),
        ("rise(false)", "false"),
        ("fall(true)", "false"),
    ],
)
def test_rules(text: str, simpler: str) -> None:
    assert print_formula(simplify(read_formula(text))) == simpler


@pytest.mark.parametrize(
    "text",
    [
        "p || !p",
        "p && !p",
        "p -> p",
        "3 < 5",
        "rise(true)",
        "change(3)",
        "F F[0, 5] p",
        "F[0, 5] F p",
        "G[5, 5] G p",
        "F[1, inf) true",
        "O[1, 2] true",
        "G(0, inf) false",
        "F[0, N] F[0, 2] p",
        "F[0, N) true",
        "F[0, 5 s] F[0, 2] p",
        "p U[1, 2] true",
    ],
)
def test_what_only_looks_simpler_is_left_alone(text: str) -> None:
    formula = read_formula(text)
    assert simplify(formula) == formula
