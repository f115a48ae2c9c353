"""Which values a constant takes."""

from __future__ import annotations

import pytest

from tachk import UsageError
from tachk.campaign.grid import grid_of


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
        (["N=1", "N=2"], "-D N is given twice"),
        (["N=1..1000000000000"], "more than 1000000 values"),
        (["A=1..2000", "B=1..2000"], "4000000 combinations"),
    ],
)
def test_mistakes(texts: list[str], message: str) -> None:
    with pytest.raises(UsageError, match=message):
        grid_of(texts)
