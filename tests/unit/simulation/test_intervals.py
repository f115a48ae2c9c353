"""Intervals contain the probability as often as they say: their coverage is computed, not simulated."""

from __future__ import annotations

from math import comb

import pytest

from tachk.simulation.intervals import clopper_pearson, student_quantile


def _coverage(runs: int, confidence: float, probability: float, intervals: list[tuple[float, float]]) -> float:
    """The probability that the interval of the hits contains the probability of a hit."""
    return sum(
        comb(runs, hits) * probability**hits * (1 - probability) ** (runs - hits)
        for hits, (low, high) in enumerate(intervals)
        if low <= probability <= high
    )


@pytest.mark.parametrize("confidence", [0.9, 0.95, 0.99, 0.999])
@pytest.mark.parametrize("runs", [1, 2, 10, 37, 100])
def test_the_coverage_is_never_below_the_confidence(runs: int, confidence: float) -> None:
    intervals = [clopper_pearson(hits, runs, confidence) for hits in range(runs + 1)]
    # Coverage as a function of the probability is least just outside the end of an interval.
    ends = [end for interval in intervals for end in interval]
    tried = [end + shift for end in ends for shift in (-1e-7, 0, 1e-7) if 0 <= end + shift <= 1]
    tried += [n / 97 for n in range(98)]
    assert min(_coverage(runs, confidence, probability, intervals) for probability in tried) >= confidence


def test_known_intervals() -> None:
    # Newcombe, "Two-sided confidence intervals for the single proportion", 1998, table I, method 5.
    for hits, runs, low, high in ((81, 263, 0.2527, 0.3676), (15, 148, 0.0578, 0.1617), (1, 29, 0.0009, 0.1776)):
        assert clopper_pearson(hits, runs) == pytest.approx((low, high), abs=5e-5)
    # All or nothing: the bound is (miss / 2) ** (1 / runs).
    assert clopper_pearson(0, 10) == pytest.approx((0, 1 - 0.025**0.1))
    assert clopper_pearson(10**6, 10**6) == pytest.approx((0.025**1e-6, 1))


def test_runs_that_may_be_hits_widen_the_interval() -> None:
    low, high = clopper_pearson(5, 100, maybe=10)
    assert low == clopper_pearson(5, 100)[0]
    assert high == clopper_pearson(15, 100)[1]


def test_nonsense_is_rejected() -> None:
    for hits, runs, maybe in ((-1, 10, 0), (11, 10, 0), (5, 10, 6), (0, 0, 0)):
        with pytest.raises(ValueError):
            clopper_pearson(hits, runs, maybe=maybe)


def test_quantiles_of_student() -> None:
    # Abramowitz, Stegun, "Handbook of mathematical functions", 1964, table 26.10.
    known = ((0.95, 1, 12.706), (0.95, 15, 2.131), (0.99, 15, 2.947), (0.9, 30, 1.697), (0.95, 120, 1.980))
    for confidence, freedom, quantile in known:
        assert student_quantile(confidence, freedom) == pytest.approx(quantile, abs=5e-4)
    assert student_quantile(0.95, 10**6) == pytest.approx(1.95996, abs=1e-4)
