"""Sequential tests: is a probability above or below a number, or above another probability?

Wald's sequential probability ratio test, with ends at which each error is bounded: if the ratio of likelihoods of two
hypotheses is a fair game under one of them, then it exceeds 1/a at any time with probability at most a (Ville, 1939).
Wald's own ends are a little nearer ("Sequential tests of statistical hypotheses", 1945), and bound the sum of the
errors only.
"""

from __future__ import annotations

from enum import StrEnum
from math import inf, log

from tachk.base.arguments import check_argument, check_proportion
from tachk.base.records import dataclass


class Decision(StrEnum):
    """The answer of a test about ``Pr >= p``."""

    HOLDS = "holds"
    FAILS = "fails"
    UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True)
class Errors:
    """The error probabilities, upper bounds.

    Attributes:
        alpha: of saying that the probability is too small, where it is at least ``p + delta``.
        beta: of saying that it is large enough, where it is at most ``p - delta``.
        delta: half of the indifference region, within which both answers are right.

    Raises UsageError where an error does not lie between 0 and 1, or delta is not a number.
    """

    alpha: float = 0.05
    beta: float = 0.05
    delta: float = 0.01

    def __post_init__(self) -> None:
        check_proportion("alpha", self.alpha)
        check_proportion("beta", self.beta)
        check_argument("delta", self.delta, "float")


class RatioTest:
    """The sequential test if the probability of a hit is at least ``above`` or at most ``below``, run by run."""

    def __init__(self, above: float, below: float, errors: Errors) -> None:
        """Raises ValueError unless 0 <= below < above <= 1."""
        if not 0 <= below < above <= 1:
            raise ValueError(f"{below} to {above} is not a region between two probabilities")
        self._hit = _logarithm(above) - _logarithm(below)
        self._miss = _logarithm(1 - above) - _logarithm(1 - below)
        self._holds = log(1 / errors.beta)
        self._fails = log(errors.alpha)
        self._ratio = 0.0
        self.decision = Decision.UNKNOWN

    def add(self, hit: bool) -> Decision:
        """One more run; a decision stays."""
        if self.decision is Decision.UNKNOWN:
            self._ratio += self._hit if hit else self._miss
            if self._ratio >= self._holds:
                self.decision = Decision.HOLDS
            elif self._ratio <= self._fails:
                self.decision = Decision.FAILS
        return self.decision


def threshold_test(probability: float, errors: Errors) -> RatioTest:
    """The test of ``Pr >= probability``; the region of indifference ends at 0 and at 1."""
    return RatioTest(min(1.0, probability + errors.delta), max(0.0, probability - errors.delta), errors)


def comparison_test(errors: Errors) -> RatioTest:
    """The test of ``Pr1 >= Pr2`` on pairs of runs of which exactly one is a hit: a hit of the test is a pair whose
    first run is one.

    If the probabilities differ by delta, then such a pair is in favour of the larger one with probability at least
    ``(1 + delta) / 2``.
    """
    return RatioTest((1 + errors.delta) / 2, (1 - errors.delta) / 2, errors)


def _logarithm(number: float) -> float:
    return log(number) if number > 0 else -inf
