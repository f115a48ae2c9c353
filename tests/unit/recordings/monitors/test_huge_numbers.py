"""Numbers of so many digits that nobody means them are refused, wherever they stand, before they are worked out."""

from pathlib import Path

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import TachkError
from tachk.base.exact_numbers import exact_number
from tachk.simulation.times import parsed_time_bound

NINES = 5000 * "9"
TRACE = {"time": [0, 1], "x": [1, 2]}


@pytest.mark.parametrize("number", [NINES, "1e99999", "1e-99999999", f"0.{NINES}"])
def test_in_formulas(number: str) -> None:
    for formula in (
        f"G F[0, {number}] x < 3",
        f"G (x < {number})",
        f"whenever x > 1, within {number}, x < 3 must be true.",
    ):
        with pytest.raises(TachkError):
            tachk.monitor(formula, TRACE)


@pytest.mark.parametrize("number", [NINES, "1e99999999", "1e-99999999", "1/0"])
def test_as_values_and_times(number: str, tmp_path: Path) -> None:
    with pytest.raises(TachkError):
        tachk.monitor("G (x < T)", TRACE, constants={"T": number})
    with pytest.raises(TachkError):
        parsed_time_bound(number, "")
    with pytest.raises(TachkError):
        tachk.mine("G (x < T)", [TRACE], {"T": (0, number)})
    with pytest.raises(ValueError, match=r"too many digits|division"):
        exact_number(number)


def test_in_arrays() -> None:
    for trace in ({"time": [0, 1], "x": [1, 10**400]}, {"time": [0, 10**400], "x": [1, 2]}):
        with pytest.raises(TachkError):
            tachk.monitor("G (x < 5)", trace)
    assert tachk.monitor("G (x < 5)", {"time": [0, 1], "x": [1, 2**70]}).truth is tachk.Truth.FALSE
