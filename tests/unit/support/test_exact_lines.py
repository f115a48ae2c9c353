"""The oracle of lines and of robustness in time, on cases worked out by hand."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest

from tests.support.exact_lines import InTime, OnLines, above, is_worth
from tests.support.exact_trace import ExactTrace, pulses
from tests.support.tricky import read_formula

SLOPE = ExactTrace(
    (Fraction(0), Fraction(10), Fraction(13)),
    {"x": (Fraction(0), Fraction(10), Fraction(9)), "p": (True, False, True)},
    Fraction(20),
)
SMALL = Fraction(1, 1009)


@pytest.mark.parametrize(
    ("formula", "truth"),
    [
        ("F[0,6] x > 5", True),
        ("F[0,5] x > 5", False),
        ("F[0,5] x >= 5", True),
        ("G[0,5) x < 5", True),
        ("G[0,9] p", True),
        ("F[0,9] (x == 7 && p)", True),
        ("F[2.5, 2.5] 2 * x == 5", True),
        ("F rise(x >= 5)", True),
        ("F rise(x > 5)", False),
        ("G[14,20] x == 9", True),
        ("G[14,21] x == 9", None),
        ("F[0,9] abs(x - 4) <= 0", True),
        ("F[0,3] abs(x - 4) <= 0", False),
    ],
)
def test_truth_on_lines(formula: str, truth: bool | None) -> None:
    assert above(read_formula(formula), OnLines(SLOPE)).value(Fraction(0)).truth is truth


@pytest.mark.parametrize(
    ("formula", "low", "high"),
    [
        ("F[0,6] x > 5", 1, 1),
        ("G[0,6] x > 5", -5, -5),
        ("!F[0,6] x > 5", -1, -1),
        ("F[11,12] x == 9.5", 0, 0),
        ("F[0,30] x > 12", -2, math.inf),
        ("x < 3 U[2,4] x > 3", 0, 0),
        ("p", math.inf, math.inf),
    ],
)
def test_robustness_on_lines(formula: str, low: float, high: float) -> None:
    assert _is_worth(formula, OnLines(SLOPE), low, high)
    for wrong in (low + 0.25, low - 0.25):
        assert not _is_worth(formula, OnLines(SLOPE), wrong, high) or math.isinf(low)
        assert not _is_worth(formula, OnLines(SLOPE), low, wrong) or math.isinf(high)


PULSES = pulses(20, p=[(1, 2)], q=[(5, 9)])


@pytest.mark.parametrize(
    ("formula", "ahead", "behind"),
    [
        ("q", (-5, -5), (0, 0)),
        ("F[6,6] q", (3, 3), (1, 1)),
        ("F[0,10] q", (4, 4), (4, 4)),
        ("G[6,7] q", (2, 2), (1, 1)),
        ("G[6,10] q", (-math.inf, -11), (-1, -1)),
        ("F[15,15] q", (-math.inf, -5), (-6, -6)),
        ("G[1,15] (p -> F[0,6] q)", (4, 4), (2, 2)),
        ("F[18,25] q", (-math.inf, math.inf), (-9, math.inf)),
    ],
)
def test_robustness_in_time(formula: str, ahead: tuple[float, float], behind: tuple[float, float]) -> None:
    for looks_ahead, (low, high) in ((True, ahead), (False, behind)):
        assert _is_worth(formula, InTime(PULSES, looks_ahead), low, high), looks_ahead
        for wrong in (low + 0.5, low - 0.5):
            assert not _is_worth(formula, InTime(PULSES, looks_ahead), wrong, high) or math.isinf(low)


def _is_worth(formula: str, worth: OnLines | InTime, low: float, high: float) -> bool:
    bounds = [bound if math.isinf(bound) else Fraction(bound) for bound in (low, high)]
    return is_worth(read_formula(formula), worth, Fraction(0), bounds[0], bounds[1], SMALL)
