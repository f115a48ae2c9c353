"""Confidence intervals of estimates from runs."""

from __future__ import annotations

from math import exp, lgamma, log, log1p, sqrt

_STEPS = 100
_TINY = 1e-300
_OUTWARDS = 1e-9
"""By how much ends are moved apart, relatively: far more than the error of the computation."""


def clopper_pearson(hits: int, runs: int, confidence: float = 0.95, maybe: int = 0) -> tuple[float, float]:
    """An interval that contains the probability of a hit at least with the confidence, whatever the probability.

    For a number of runs fixed beforehand (Clopper, Pearson, "The use of confidence or fiducial limits", 1934).

    Args:
        maybe: how many further runs may be hits or not.

    Raises ValueError for numbers that make no sense.
    """
    most = hits + maybe
    if not 0 <= hits <= most <= runs or runs < 1 or not 0 < confidence < 1:
        raise ValueError(f"{hits} hits and perhaps {maybe} more of {runs} runs, confidence {confidence}")
    miss = (1 - confidence) / 2
    low = 0.0 if hits == 0 else _quantile(miss, hits, runs - hits + 1)[0] * (1 - _OUTWARDS)
    high = 1.0 if most == runs else 1 - (1 - _quantile(1 - miss, most + 1, runs - most)[1]) * (1 - _OUTWARDS)
    return low, high


def student_quantile(confidence: float, freedom: int) -> float:
    """The quantile of the absolute value of a variable with Student's distribution.

    Its square, divided by itself and the degrees of freedom, has the distribution Beta(1/2, freedom / 2).
    """
    share = _quantile(confidence, 0.5, freedom / 2)[1]
    return sqrt(freedom * share / (1 - share))


def _quantile(share: float, a: float, b: float) -> tuple[float, float]:
    """Two neighbouring numbers between which the Beta(a, b) distribution function reaches the share."""
    low, high = 0.0, 1.0
    for _ in range(_STEPS):
        middle = (low + high) / 2
        if not low < middle < high:
            break
        if _beta_distribution(middle, a, b) < share:
            low = middle
        else:
            high = middle
    return low, high


def _beta_distribution(x: float, a: float, b: float) -> float:
    """The regularised incomplete beta function, by its continued fraction (DLMF 8.17.22)."""
    if x <= 0 or x >= 1:
        return float(x >= 1)
    if x > (a + 1) / (a + b + 2):
        return 1 - _beta_distribution(1 - x, b, a)
    factor = exp(lgamma(a + b) - lgamma(a) - lgamma(b) + a * log(x) + b * log1p(-x)) / a
    c, d = 1.0, 1 / _not_zero(1 - (a + b) * x / (a + 1))
    result = d
    for m in range(1, 10_000):
        for numerator in (
            m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)),
            -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1)),
        ):
            d = 1 / _not_zero(1 + numerator * d)
            c = _not_zero(1 + numerator / c)
            change = c * d
            result *= change
        if abs(change - 1) < 1e-15:
            break
    return factor * result


def _not_zero(value: float) -> float:
    return value if abs(value) > _TINY else _TINY
