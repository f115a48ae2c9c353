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
    """What contains the mean at least with the confidence, for a number of runs fixed beforehand.

    Two intervals, each of which misses half as often, are intersected: that of the distribution function (Anderson,
    "Confidence limits for the expected value of an arbitrary bounded random variable", 1969, with the bound of Massart,
    1990), and the empirical one of Bernstein (Maurer, Pontil, "Empirical Bernstein bounds and sample variance
    penalization", 2009), which is narrow where the values vary little.

    Args:
        lowest, highest: the value of each run; they differ where it is not known.
        least, most: all values lie between.
    """
    miss = (1 - confidence) / 2
    anderson = (_anderson(lowest, least, miss), -_anderson(-highest, -most, miss))
    bernstein = (_bernstein(lowest, most - least, miss), -_bernstein(-highest, most - least, miss))
    low, high = max(anderson[0], bernstein[0], least), min(anderson[1], bernstein[1], most)
    return low, high


def _anderson(values: Floats, least: float, miss: float) -> float:
    """Below the mean but for ``miss / 2``: a share of the largest values is taken for the least one."""
    count = len(values)
    share = sqrt(log(2 / miss) / (2 * count))
    # Weights of the values in order, if the distribution function is larger by that share: the largest are moved.
    upper = np.minimum(np.arange(1, count + 1) / count + share, 1)
    weights = np.diff(upper, prepend=min(share, 1.0))
    return float(min(share, 1.0) * least + weights @ np.sort(values))


def _bernstein(values: Floats, width: float, miss: float) -> float:
    """Below the mean but for ``miss / 2``."""
    count = len(values)
    if count < 2:
        return -inf
    surprise = log(4 / miss)
    spread = sqrt(2 * float(np.var(values, ddof=1)) * surprise / count)
    return float(np.mean(values)) - spread - 7 * width * surprise / (3 * (count - 1))


def asymptotic_mean(values: Floats, confidence: float) -> tuple[float, float]:
    """What would contain the mean with the confidence if there were very many runs; with few it is a guess."""
    mean, count = float(np.mean(values)), len(values)
    if count < 2:
        return -inf, inf
    reach = NormalDist().inv_cdf((1 + confidence) / 2) * sqrt(float(np.var(values, ddof=1)) / count)
    return mean - reach, mean + reach
