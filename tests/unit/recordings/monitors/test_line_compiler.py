"""What has no meaning where numbers move in straight lines is found with its place."""

from __future__ import annotations

import pytest

from tachk.recordings.monitors.line_compiler import line_findings
from tests.support.tricky import read_formula

MOVING = ("x", "y")


def found(formula: str) -> list[tuple[str, str]]:
    return [(each.code, each.span.text) for each in line_findings(read_formula(formula), MOVING)]


@pytest.mark.parametrize(
    "formula",
    [
        "G (2 * x + y / 4 - abs(x - y) <= max(x, 3) * (1 + 2))",
        "G (rise(x >= 5) -> F[0, 3] x > 7)",
        "G (fall(x > 5) -> rise(!(x < 5) && p))",
        "rise(x <= 3 || x == 4) && fall(x != 4)",
        "change(p) || rise(p != q)",
        "rise(p -> x >= 3)",
        "rise(F[0, 2] x >= 3)",
        "p * 3 > 1",
        "x / (7 - 2 * 3) < 1",
    ],
)
def test_what_has_a_meaning_on_lines(formula: str) -> None:
    assert found(formula) == []


@pytest.mark.parametrize(
    ("formula", "code", "place"),
    [
        ("G x * y < 3", "E0905", "x * y"),
        ("G (p -> 2 * (x * p) < 3)", "E0905", "(x * p)"),
        ("F 3 / x < 3", "E0905", "3 / x"),
        ("F x % 2 == 1", "E0905", "x % 2"),
        ("F x / (2 - 2) == 1", "E0905", "x / (2 - 2)"),
        ("G change(x)", "E0906", "x"),
        ("G change(x + 1)", "E0906", "x + 1"),
        ("G change(x > 3)", "E0906", "x > 3"),
        ("G rise(x > 5)", "E0907", "x > 5"),
        ("G rise(p && !(x >= 5))", "E0907", "(x >= 5)"),
        ("G rise(x >= 5 -> p)", "E0907", "x >= 5"),
        ("G fall(x < 5 + y || p)", None, ""),
        ("G fall(x <= 5 + y || p)", "E0907", "x <= 5 + y"),
        ("G rise(x != 5)", "E0907", "x != 5"),
        ("G rise(F[0, 3] x > 5)", "E0907", "x > 5"),
        ("G rise(x)", "E0907", "x"),
        ("G fall(x == 2)", "E0907", "x == 2"),
    ],
)
def test_what_has_none(formula: str, code: str | None, place: str) -> None:
    assert found(formula) == ([] if code is None else [(code, place)])


def test_a_better_comparison_is_named() -> None:
    (finding,) = line_findings(read_formula("G (rise(x + 1 < y) -> p)"), MOVING)
    assert finding.help is not None
    assert "write `x + 1 <= y`" in finding.help


def test_everything_is_reported_once_in_the_order_of_the_text() -> None:
    assert found("rise(x > 1) && F x * x > 3 && change(y)") == [
        ("E0907", "x > 1"),
        ("E0905", "x * x"),
        ("E0906", "y"),
    ]


def test_columns_that_do_not_move_may_be_compared_as_they_like() -> None:
    assert line_findings(read_formula("rise(p > 0) && change(p)"), MOVING) == ()
