"""Errors of tests, computed over all that can happen."""

from __future__ import annotations

import pytest

from tachk.simulation.statistics.deciding import Decision, Errors, comparison_test, threshold_test


def _errors(test_of: object, hit: float, runs: int) -> dict[Decision, float]:
    """With which probability a test has decided what after so many runs: all numbers of hits, run by run."""
    alive = {0: 1.0}
    decided = dict.fromkeys(Decision, 0.0)
    for run in range(1, runs + 1):
        later: dict[int, float] = {}
        for hits, share in alive.items():
            for more, probability in ((1, hit), (0, 1 - hit)):
                later[hits + more] = later.get(hits + more, 0.0) + share * probability
        alive = {}
        for hits, share in later.items():
            decision = test_of(run, hits)  # type: ignore[operator]
            if decision is Decision.UNKNOWN:
                alive[hits] = share
            else:
                decided[decision] += share
    decided[Decision.UNKNOWN] = sum(alive.values())
    return decided


def _replayed(probability: float, errors: Errors) -> object:
    """The decision of the test after so many runs with so many hits: the ratio does not depend on their order."""

    def decision(runs: int, hits: int) -> Decision:
        test = threshold_test(probability, errors)
        test._ratio = hits * test._hit + (runs - hits) * test._miss
        test._ratio -= test._miss
        return test.add(False)

    return decision


@pytest.mark.parametrize(("alpha", "beta"), [(0.05, 0.05), (0.01, 0.1)])
def test_the_errors_of_a_test_are_bounded(alpha: float, beta: float) -> None:
    errors = Errors(alpha, beta, 0.1)
    test_of = _replayed(0.4, errors)
    at_end = _errors(test_of, 0.5, 250)
    assert at_end[Decision.FAILS] <= alpha
    assert at_end[Decision.HOLDS] > 0.9
    at_other_end = _errors(test_of, 0.3, 250)
    assert at_other_end[Decision.HOLDS] <= beta
    assert at_other_end[Decision.FAILS] > 0.9


def test_a_test_beside_certainty_ends_at_once() -> None:
    test = threshold_test(0.995, Errors(delta=0.01))
    assert test.add(False) is Decision.FAILS
    assert test.add(True) is Decision.FAILS


def test_pairs_that_differ_decide_a_comparison() -> None:
    test = comparison_test(Errors(delta=0.2))
    while test.decision is Decision.UNKNOWN:
        test.add(True)
    assert test.decision is Decision.HOLDS


def test_a_region_must_be_one() -> None:
    with pytest.raises(ValueError):
        threshold_test(0.5, Errors(delta=0.0))
