"""Intervals for means contain them as often as they say: computed over all samples of some distributions."""

from __future__ import annotations

from itertools import combinations_with_replacement
from math import factorial, prod

import numpy as np
import pytest

from tachk.statistics.means import asymptotic_mean, bounded_mean


def _coverages(
    values: tuple[float, ...], chances: tuple[float, ...], runs: int, confidence: float
) -> tuple[float, float]:
    """Of the bounded interval and of the asymptotic one."""
    mean = sum(v * c for v, c in zip(values, chances, strict=True))
    sound = asymptotic = 0.0
    for drawn in combinations_with_replacement(range(len(values)), runs):
        counts = [drawn.count(n) for n in range(len(values))]
        share = factorial(runs) / prod(factorial(n) for n in counts)
        share *= prod(c**n for c, n in zip(chances, counts, strict=True))
        sample = np.array([values[n] for n in drawn])
        low, high = bounded_mean(sample, sample, 0.0, 1.0, confidence)
        sound += share * (low <= mean <= high)
        low, high = asymptotic_mean(sample, confidence)
        asymptotic += share * (low <= mean <= high)
    return sound, asymptotic


@pytest.mark.parametrize("confidence", [0.9, 0.99])
@pytest.mark.parametrize(
    ("values", "chances", "runs"),
    [((0.0, 1.0), (0.5, 0.5), 60), ((0.0, 1.0), (0.98, 0.02), 60), ((0.0, 0.3, 1.0), (0.5, 0.45, 0.05), 20)],
)
def test_the_coverage_is_never_below_the_confidence(
    values: tuple[float, ...], chances: tuple[float, ...], runs: int, confidence: float
) -> None:
    assert _coverages(values, chances, runs, confidence)[0] >= confidence


def test_the_asymptotic_interval_is_no_guarantee() -> None:
    # What is 1 in two of a hundred runs is not seen in sixty of them with probability 0.3.
    assert _coverages((0.0, 1.0), (0.98, 0.02), 60, 0.95)[1] < 0.75


def test_many_runs_of_a_steady_value_make_a_narrow_interval() -> None:
    values = np.tile([4.9, 5.1], 5000)
    low, high = bounded_mean(values, values, 0.0, 100.0, 0.95)
    assert low < 5 < high
    assert high - low < 0.3


def test_unknown_runs_widen_the_interval() -> None:
    known = np.full(99, 5.0)
    low, high = bounded_mean(np.append(known, 0.0), np.append(known, 10.0), 0.0, 10.0, 0.95)
    sure = bounded_mean(known, known, 0.0, 10.0, 0.95)
    assert low < sure[0] and high > sure[1]
