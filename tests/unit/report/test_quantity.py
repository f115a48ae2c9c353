from __future__ import annotations

from fractions import Fraction

import pytest

from tachk.model.quantity import decimal, duration, seconds


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (Fraction(0), "0"),
        (Fraction(12), "12"),
        (Fraction(5, 2), "2.5"),
        (Fraction(1, 8), "0.125"),
        (Fraction(-1, 4), "-0.25"),
        (Fraction(7, 3), "7/3"),
        (Fraction(1, 10**9), "0.000000001"),
        (Fraction(1, 10**10), "1/10000000000"),
    ],
)
def test_decimal_is_exact(value: Fraction, text: str) -> None:
    assert decimal(value) == text


@pytest.mark.parametrize(
    ("unit", "text"), [("", "1.5"), ("ms", "1.5 ms"), ("1 ms", "1.5 ms"), ("10 ms", "15 ms"), ("0.1 s", "0.15 s")]
)
def test_duration_applies_the_factor_of_the_unit(unit: str, text: str) -> None:
    assert duration(Fraction(3, 2), unit) == text


def test_seconds_choose_a_unit() -> None:
    assert [seconds(0.0012), seconds(3.21), seconds(200.4)] == ["1.2 ms", "3.2 s", "3 min 20 s"]
