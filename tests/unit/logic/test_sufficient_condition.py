"""Conditions on one state that are enough for a formula."""

from __future__ import annotations

import pytest

import tachk
from tachk.base.span import Source
from tachk.logic.sufficient_condition import sufficient_condition
from tachk.syntax.formulas.parser import parse_formula
from tachk.syntax.printing.expression_printer import print_expression

MODEL = """
process P() {
    clock x;
    init location idle { invariant x <= 5; to busy { guard x >= 2; assign x = 0; } }
    location busy { invariant x <= 3; to idle { guard x >= 1; assign x = 0; } }
}
system P;
"""
QUERIES = ("A[] P.busy imply !P.idle", "G (P.busy -> F[0,2] !P.idle)", "G (P.busy -> F[0,2] P.idle)")


@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        ("G p", "p"),
        ("G (p -> q)", "p imply q"),
        ("G (p -> F[0,5] q)", "p imply q"),
        ("G (rise(p) -> F[0,5] (q || r))", "p imply (q || r)"),
        ("F[2,5] G p", "p"),
        ("G (p && (q -> F[0,1] r))", "p && (q imply r)"),
        ("G (q || F[1,2] p)", "q"),
        ("G (p -> F[1,5] q)", None),
        ("G (p -> F(0,5] q)", None),
        ("G (p -> F[0,0) q)", None),
        ("F[1,1) p", None),
        ("G (fall(p) -> q)", None),
        ("G (p -> G[0,5] q)", None),
        ("p U[0,5] q", None),
        ("G (p -> O[0,5] q)", None),
    ],
)
def test_of_a_formula(formula: str, expected: str | None) -> None:
    tree, diagnostics = parse_formula(Source("formula", formula))
    assert tree is not None and not diagnostics
    found = sufficient_condition(tree)
    assert (None if found is None else print_expression(found)) == expected


def test_it_says_when_the_formula_holds() -> None:
    """One search decides both; without it, each of the formulas is searched for with its observer."""
    model = tachk.loads(MODEL)
    together = model.verify(*QUERIES)
    assert [result.strategy for result in together] == ["zones"] * 3
    assert [result.answer for result in together] == ["holds", "holds", "fails"]
    alone = model.verify(*QUERIES, options=tachk.Options().off("sufficient"))
    assert [result.answer for result in alone] == ["holds", "holds", "fails"]
    assert together[0].statistics == together[1].statistics != together[2].statistics
    assert alone[0].statistics != alone[1].statistics  # as the seconds of two searches differ
    assert together[2].trace is not None
