"""Intervals for the mean of a quantity that lies between two known numbers.

Nothing else is known of its distribution, so that no interval from a table of Gauss or Student holds what it says: of a
value that is large once in ten thousand runs, a thousand runs usually know nothing. These hold for every distribution.
"""

from __future__ import annotations

from math import inf, log, sqrt
from statistics import NormalDist

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def bounded_mean(lowest: Floats, highest: Floats, least: float, most: float, confidence: float) -> tuple[float, float]:
    """A confidence interval of the mean, for a number of runs fixed beforehand.

    Somebody bets on each run that its value is larger than a number, with stakes that depend on the runs before. If the
    number is not below the mean, the wealth from 1 on is hardly ever 1 / p: with probability at most p (Ville 1939). So
    numbers against which it becomes that are below the mean (Waudby-Smith, Ramdas, "Estimating means of bounded random
    variables by betting", 2024; the stakes of section 4).

    Args:
        lowest, highest: the value of each run, in the order of the runs; they differ where it is not known.
        least, most: all values lie between.
    """
    width = most - least
    if not width > 0 or not len(lowest):
        return least, most
    miss = (1 - confidence) / 2
    low = least + width * _below_the_mean(np.clip((lowest - least) / width, 0, 1), miss)
    high = most - width * _below_the_mean(np.clip((most - highest) / width, 0, 1), miss)
    return min(low, high), max(low, high)


_LARGEST_STAKE = 0.75
"""As a share of what can be lost."""
_ROUNDS = 45
"""The number of rounds of bisection for the point at which the wealth is large enough."""


def _below_the_mean(values: Floats, miss: float) -> float:
    """A lower bound of the mean of values in [0, 1] but for ``miss``."""
    stakes = _stakes(values, miss)
    wanted = log(1 / miss)
    low, high = 0.0, 1.0
    for _ in range(_ROUNDS):
        middle = (low + high) / 2
        # The wealth against a larger number is smaller, at each moment.
        wealth = np.cumsum(np.log1p(np.minimum(stakes, _LARGEST_STAKE / middle) * (values - middle)))
        if wealth.max() >= wanted:
            low = middle
        else:
            high = middle
    return low


def _stakes(values: Floats, miss: float) -> Floats:
    """For each value, from those before it: the less they vary, the more."""
    count = len(values)
    number = np.arange(1, count + 1)
    means = (0.5 + np.cumsum(values)) / (number + 1)
    variances = (0.25 + np.cumsum((values - means) ** 2)) / (number + 1)
    before = np.concatenate(([0.25], variances[:-1]))
    return np.sqrt(2 * log(1 / miss) / (count * before))


def asymptotic_mean(values: Floats, confidence: float) -> tuple[float, float]:
    """The asymptotic confidence interval of the mean; with few runs it is a guess."""
    mean, count = float(np.mean(values)), len(values)
    if count < 2:
        return -inf, inf
    reach = NormalDist().inv_cdf((1 + confidence) / 2) * sqrt(float(np.var(values, ddof=1)) / count)
    return mean - reach, mean + reach
