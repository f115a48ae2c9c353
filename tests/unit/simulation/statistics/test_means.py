"""Intervals for means contain them as often as they say: computed over all samples of some distributions."""

from __future__ import annotations

from itertools import product
from math import comb, prod

import numpy as np
import pytest

from tachk.simulation.statistics.means import asymptotic_mean, bounded_mean


def _coverages(
    values: tuple[float, ...], chances: tuple[float, ...], runs: int, confidence: float
) -> tuple[float, float]:
    """How often the bounded interval is above the mean, and how often it is below, over all sequences."""
    mean = sum(v * c for v, c in zip(values, chances, strict=True))
    above = below = 0.0
    for drawn in product(range(len(values)), repeat=runs):
        sample = np.array([values[n] for n in drawn])
        low, high = bounded_mean(sample, sample, 0.0, 1.0, confidence)
        share = prod(chances[n] for n in drawn)
        above += share * (low > mean)
        below += share * (high < mean)
    return above, below


@pytest.mark.parametrize(
    ("values", "chances", "runs"),
    [((0.0, 1.0), (0.5, 0.5), 9), ((0.0, 1.0), (0.9, 0.1), 9), ((0.0, 0.3, 1.0), (0.2, 0.7, 0.1), 5)],
)
def test_each_end_misses_at_most_half_of_what_may_be_missed(
    values: tuple[float, ...], chances: tuple[float, ...], runs: int
) -> None:
    above, below = _coverages(values, chances, runs, 0.8)
    assert max(above, below) <= 0.1
    assert above + below > 0  # the test sees misses


def test_the_asymptotic_interval_is_no_guarantee() -> None:
    # What is 1 in two of a hundred runs is not seen in sixty of them with probability 0.3.
    covered = 0.0
    for ones in range(61):
        low, high = asymptotic_mean(np.array([1.0] * ones + [0.0] * (60 - ones)), 0.95)
        covered += comb(60, ones) * 0.02**ones * 0.98 ** (60 - ones) * (low <= 0.02 <= high)
    assert covered < 0.75


def test_many_runs_of_a_steady_value_make_a_narrow_interval() -> None:
    values = np.tile([4.9, 5.1], 5000)
    low, high = bounded_mean(values, values, 0.0, 100.0, 0.95)
    assert low < 5 < high
    assert high - low < 0.1


def test_unknown_runs_widen_the_interval() -> None:
    known = np.full(99, 5.0)
    low, high = bounded_mean(np.append(known, 0.0), np.append(known, 10.0), 0.0, 10.0, 0.95)
    sure = bounded_mean(known, known, 0.0, 10.0, 0.95)
    assert low < sure[0] and high > sure[1]
