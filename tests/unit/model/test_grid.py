"""Which values a constant takes."""

from __future__ import annotations

import pytest

from tachk import UsageError
from tachk.model.grid import Grid, grid_of, grid_of_values


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("N=3", (3,)),
        ("N=0..3", (0, 1, 2, 3)),
        ("N = -2 .. 2 : 2", (-2, 0, 2)),
        ("N=10,50,100..300:100", (10, 50, 100, 200, 300)),
        ("N=false,true", ("false", "true")),
        ("N=max(1, 2),{3, 4}[0]", ("max(1, 2)", "{3, 4}[0]")),
    ],
)
def test_values(text: str, values: tuple[int | str, ...]) -> None:
    (axis,) = grid_of([text]).axes
    assert axis.name == "N"
    assert axis.values == values


def test_cells() -> None:
    grid = grid_of(["A=1..2", "B=7", "C=0,5"])
    assert list(grid.cells()) == [(1, 7, 0), (1, 7, 5), (2, 7, 0), (2, 7, 5)]
    assert len(grid) == 4
    assert [axis.name for axis in grid.varied] == ["A", "C"]


@pytest.mark.parametrize(
    ("texts", "message"),
    [
        (["N"], "expected NAME=VALUE"),
        (["=3"], "expected NAME=VALUE"),
        (["N=1,,2"], "expected NAME=VALUE"),
        (["N=3..1"], "no values"),
        (["N=1..3:0"], "step of N must be at least 1"),
        (["N=1..3,2"], "the value 2 is given twice"),
        (["N=1", "N=2"], "N is given twice"),
        (["N=1,N=2"], "N is given twice"),
        (["N=1..1000000000000"], "more than 1000000 values"),
        (["A=1..2000", "B=1..2000"], "4000000 combinations"),
    ],
)
def test_mistakes(texts: list[str], message: str) -> None:
    with pytest.raises(UsageError, match=message):
        grid_of(texts)


def test_one_text_has_several_constants() -> None:
    assert grid_of(["A=0..1,B=5..20:5, C = x == 1,max(1, 2)"]) == grid_of(["A=0..1", "B=5..20:5", "C=x == 1,max(1, 2)"])


@pytest.mark.parametrize(
    "over",
    [
        "A=0..2,B=1,5",
        ["A=0..2", "B=1,5"],
        {"A": range(3), "B": [1, 5]},
        {"A": "0..2", "B": "1,5"},
        grid_of(["A=0..2", "B=1,5"]),
    ],
)
def test_a_program_says_the_same_in_each_form(over: str | list[str] | dict[str, object] | Grid) -> None:
    assert list(grid_of_values(over).cells()) == [(a, b) for a in range(3) for b in (1, 5)]


def test_values_of_python_are_those_of_the_language() -> None:
    grid = grid_of_values({"N": 4, "PULL": [False, True]})
    assert [axis.values for axis in grid.axes] == [(4,), ("false", "true")]


@pytest.mark.parametrize(
    "over", [[("A", [1, 2])], {"A": [1.5]}, {"A": []}, {"A": [1, 1]}, 7, "A", {"A": [None]}, {"A": "3..1"}]
)
def test_what_says_no_values_is_rejected_in_words_of_python(over: object) -> None:
    with pytest.raises(UsageError) as caught:
        grid_of_values(over)  # type: ignore[arg-type]
    assert "-D" not in str(caught.value)
