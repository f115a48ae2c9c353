"""Which formulas are in STL_{lb=0}, and how far formulas look ahead."""

from __future__ import annotations

from fractions import Fraction

import pytest

from tachk.logic.fragment import outside_fragment
from tachk.logic.horizon import horizon
from tests.support.tricky import read_formula


@pytest.mark.parametrize(
    "text",
    [
        "true",
        "p && !q",
        "G (p -> F[0, 180] q)",
        "G (rise(p) -> G[0, 50] !q)",
        "G (p -> q U[0, 5) r)",
        "F[0, 5] G[0, 3] p",
        "(G p) && G (q -> F[0, 1 s] r)",
        "!F[0, N] p",
        "G change(x + 1)",
    ],
)
def test_inside(text: str) -> None:
    assert outside_fragment(read_formula(text)) is None


@pytest.mark.parametrize(
    ("text", "part", "reason"),
    [
        ("G (p -> F[1, 5] q)", "F[1, 5] q", "[1, 5] does not begin at 0"),
        ("G (p -> F(0, 5] q)", "F(0, 5] q", "leaves out the present"),
        ("F p", "F p", "no upper bound"),
        ("G (p -> F q)", "F q", "no upper bound"),
        ("G G p", "G p", "no upper bound"),
        ("!G p", "G p", "no upper bound"),
        ("G[2, inf) p", "G[2, inf) p", "does not begin at 0"),
        ("p W q", "p W q", "has no end"),
        ("G (p -> O[0, 5] q)", "O[0, 5] q", "looks back"),
        ("G (p -> q S r)", "q S r", "looks back"),
        ("G (rise(F[0, 1] p) -> q)", "rise(F[0, 1] p)", "'rise' is about the temporal formula F[0, 1] p"),
        ("F[N, 5] p", "F[N, 5] p", "does not begin at 0"),
        ("F[0, 2] (q U[1, 2] r) && F[3, 4] p", "(q U[1, 2] r)", "does not begin at 0"),
    ],
)
def test_outside(text: str, part: str, reason: str) -> None:
    offence = outside_fragment(read_formula(text))
    assert offence is not None
    assert offence.span.text == part
    assert reason in offence.reason


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("p && !q", 0),
        ("F[1, 5] G[0, 2.5] p", Fraction(15, 2)),
        ("F[0, 5] p || G[0, 7) q", 7),
        ("(F[0, 2] p) U[1, 5] q", 7),
        ("O[3, 8] F[0, 5] p", 2),
        ("O[3, 8] F[0, 1] p", 0),
        ("p S F[0, 2] q", 2),
        ("rise(F[0, 2] q)", 2),
        ("G p", None),
        ("F[0, 2] (p W q)", None),
    ],
)
def test_horizon(text: str, expected: Fraction | int | None) -> None:
    assert horizon(read_formula(text)) == expected
