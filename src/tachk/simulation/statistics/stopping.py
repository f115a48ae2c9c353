"""The number of runs to draw, and intervals that are exact for a number of runs that depends on them.

The runs are analysed after certain numbers of them, and no more are drawn as soon as the interval is narrow enough.
The interval of Clopper and Pearson for a fixed number of runs would miss the probability more often than it says then.
So the interval is made anew from what can happen under this rule: all the places where it may stop, in the order in
which they speak for a larger probability (Armitage, "Numerical studies in the sequential estimation of a binomial
parameter", 1958; Jennison, Turnbull, "Confidence intervals for a binomial parameter following a multistage test",
1983).

A place is a number of runs and of hits. If each run is a hit with a larger probability, then no place before it becomes
more probable: runs that leave the region downwards leave it later, or upwards. Hence the probability to stop at this
place or a later one grows with the probability of a hit, and the ends of the interval are where it, and that of this
place or an earlier one, is half of what the interval may miss.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import ceil, lgamma, log
from statistics import NormalDist

import numpy as np
from numpy.typing import NDArray

from tachk.simulation.intervals import clopper_pearson

MOST_RUNS = 20_000
"""Rules that may need more runs have too many places; a number of runs that is fixed beforehand has none."""

_GROWTH = 1.05
_STEPS = 60
_OUTWARDS = 1e-9

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class StoppingRule:
    """The rule that stops once the interval is at most twice the half-width wide."""

    confidence: float
    half_width: float

    @property
    def _width(self) -> float:
        """The target of the formula for the width: it is not exact, least of all for few runs."""
        slack = 0.99 if self.half_width <= 0.1 and self.confidence >= 0.9 else 0.95
        return 2 * self.half_width * slack

    @cached_property
    def analyses(self) -> tuple[int, ...]:
        """After how many runs they are analysed; at the last of these numbers it stops in any case."""
        z = _quantile(self.confidence)
        last = ceil((z / self._width) ** 2)
        while _width(np.array([last // 2]), last, z)[0] > self._width:
            last = ceil(last * 1.01)
        sizes = [min(last, ceil(z * z / (4 * self.half_width)))]
        while sizes[-1] < last:
            sizes.append(min(last, max(sizes[-1] + 1, ceil(sizes[-1] * _GROWTH))))
        return tuple(sizes)

    @cached_property
    def edges(self) -> tuple[int, ...]:
        """For each analysis the number of hits up to which it stops, and likewise of misses; -1 where it never does."""
        z = _quantile(self.confidence)
        found = []
        for runs in self.analyses[:-1]:
            wide = _width(np.arange(runs // 2 + 1), runs, z) > self._width
            found.append(int(np.argmax(wide)) - 1 if wide.any() else runs)
        return (*found, self.analyses[-1])

    def stops(self, analysis: int, hits: int) -> bool:
        runs, edge = self.analyses[analysis], self.edges[analysis]
        return hits <= edge or runs - hits <= edge

    def interval(self, analysis: int, hits: int) -> tuple[float, float]:
        """A confidence interval of the probability of a hit, for a place where the rule stops."""
        runs = self.analyses[analysis]
        if 2 * hits > runs:  # the rule is the same for hits and misses
            low, high = self.interval(analysis, runs - hits)
            return 1 - high, 1 - low
        miss = (1 - self.confidence) / 2
        places = self.places(analysis)
        before = places.up_to(runs, hits - 1)
        there = places.up_to(runs, hits)
        low = 0.0 if len(before) == 0 else _first(lambda p: 1 - before.probability(p) > miss)[0]
        high = _first(lambda p: there.probability(p) < miss)[1]
        return max(0.0, low * (1 - _OUTWARDS)), min(1.0, high * (1 + _OUTWARDS))

    def places(self, last_analysis: int) -> Places:
        """The places where it may stop up to an analysis, with at most as many hits as misses, in the order in which
        they speak for a larger probability of a hit."""
        runs_, hits_, shares_ = [], [], []
        shares = np.ones(1)
        runs = 0
        for size, edge in zip(self.analyses[: last_analysis + 1], self.edges, strict=False):
            while runs < size:
                runs += 1
                shares = _one_more_run(shares, runs)
            end = min(edge, size // 2) + 1
            hits = np.flatnonzero(shares[:end])
            runs_.append(np.full(len(hits), size))
            hits_.append(hits)
            shares_.append(shares[hits])
            shares = shares.copy()
            shares[: edge + 1] = 0
            shares[max(0, size - edge) :] = 0
        return Places(np.concatenate(runs_), np.concatenate(hits_), np.concatenate(shares_))


class Places:
    """The places at which a rule may stop.

    Attributes:
        runs, hits: of each place.
        shares: of all orders of so many hits and misses those that the rule does not stop before.
    """

    def __init__(self, runs: NDArray[np.int64], hits: NDArray[np.int64], shares: Floats) -> None:
        self.runs, self.hits, self.shares = runs, hits, shares
        pairs = zip(runs.tolist(), hits.tolist(), strict=True)
        self._ways = np.array([lgamma(n + 1) - lgamma(k + 1) - lgamma(n - k + 1) for n, k in pairs])

    def __len__(self) -> int:
        return len(self.runs)

    def up_to(self, runs: int, hits: int) -> Places:
        """The places with fewer runs, and those with as many runs and at most ``hits`` hits."""
        up_to_here = (self.runs < runs) | ((self.runs == runs) & (self.hits <= hits))
        return Places(self.runs[up_to_here], self.hits[up_to_here], self.shares[up_to_here])

    def probabilities(self, hit: float) -> Floats:
        """The probability of stopping at each of them, if a run is a hit with probability ``hit``."""
        if hit <= 0 or hit >= 1:
            return np.where(self.hits == (0 if hit <= 0 else self.runs), self.shares, 0.0)
        logarithms = self._ways + self.hits * log(hit) + (self.runs - self.hits) * np.log1p(-hit)
        result: Floats = self.shares * np.exp(logarithms)
        return result

    def probability(self, hit: float) -> float:
        return float(self.probabilities(hit).sum())


def runs_for(confidence: float, half_width: float) -> int:
    """The least number of runs for which no interval of Clopper and Pearson is wider than twice the half-width."""
    low, high = 0, 1
    while not _is_narrow(high, confidence, half_width):
        low, high = high, 2 * high
    while high - low > 1:
        middle = (low + high) // 2
        if _is_narrow(middle, confidence, half_width):
            high = middle
        else:
            low = middle
    return high


def _is_narrow(runs: int, confidence: float, half_width: float) -> bool:
    low, high = clopper_pearson(runs // 2, runs, confidence)
    return high - low <= 2 * half_width


def _quantile(confidence: float) -> float:
    return NormalDist().inv_cdf((1 + confidence) / 2)


def _width(hits: NDArray[np.int64], runs: int, z: float) -> Floats:
    """Nearly the width of the interval of Clopper and Pearson: Wilson's with a correction for continuity (Newcombe,
    "Two-sided confidence intervals for the single proportion", 1998, method 4)."""
    share = hits / runs
    below = np.maximum(z * z - 2 - 1 / runs + 4 * share * (runs - hits + 1), 0)
    above = np.maximum(z * z + 2 - 1 / runs + 4 * share * (runs - hits - 1), 0)
    low = np.where(hits == 0, 0.0, (2 * hits + z * z - 1 - z * np.sqrt(below)) / (2 * (runs + z * z)))
    high = (2 * hits + z * z + 1 + z * np.sqrt(above)) / (2 * (runs + z * z))
    result: Floats = np.minimum(high, 1) - np.maximum(low, 0)
    return result


def _one_more_run(shares: Floats, runs: int) -> Floats:
    """The shares of the orders of k hits among one more run that have not stopped: a hit or a miss comes last."""
    hits = np.arange(runs + 1)
    longer = np.zeros(runs + 1)
    longer[:-1] = shares * (runs - hits[:-1]) / runs
    longer[1:] += shares * hits[1:] / runs
    return longer


def _first(is_large: Callable[[float], bool]) -> tuple[float, float]:
    """Two neighbouring numbers between which a condition becomes true that is false for small ones."""
    low, high = 0.0, 1.0
    for _ in range(_STEPS):
        middle = (low + high) / 2
        if is_large(middle):
            high = middle
        else:
            low = middle
    return low, high
