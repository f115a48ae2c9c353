"""Intervals contain the probability as often as they say, also where the number of runs depends on them: computed by
dynamic programming over all places where a rule may stop, not simulated."""

from __future__ import annotations

import numpy as np
import pytest

from tachk.simulation.intervals import clopper_pearson
from tachk.simulation.statistics.stopping import StoppingRule, runs_for


def _stops(rule: StoppingRule, probability: float) -> dict[tuple[int, int], float]:
    """With which probability the rule stops at each look and number of hits: run by run, with a list for what is
    alive."""
    alive = [1.0]
    found = {}
    runs = 0
    for analysis, size in enumerate(rule.analyses):
        for _ in range(size - runs):
            alive = [
                (alive[k] * (1 - probability) if k < len(alive) else 0.0) + (alive[k - 1] * probability if k else 0.0)
                for k in range(len(alive) + 1)
            ]
        runs = size
        for hits, share in enumerate(alive):
            if rule.stops(analysis, hits):
                found[analysis, hits] = share
                alive[hits] = 0.0
    return found


@pytest.mark.parametrize(("confidence", "half_width"), [(0.9, 0.2), (0.95, 0.15), (0.99, 0.2), (0.999, 0.25)])
def test_the_coverage_is_never_below_the_confidence(confidence: float, half_width: float) -> None:
    rule = StoppingRule(confidence, half_width)
    everywhere = _stops(rule, 0.5)
    intervals = {place: rule.interval(*place) for place, share in everywhere.items() if share > 0}
    ends = sorted({end for interval in intervals.values() for end in interval})
    tried = {end + shift for end in ends for shift in (-1e-7, 1e-7) if 0 < end + shift < 1}
    coverages = []
    for probability in sorted(tried)[:: max(1, len(tried) // 60)]:
        stops = _stops(rule, probability)
        assert sum(stops.values()) == pytest.approx(1)
        coverages.append(sum(stops[place] for place, (low, high) in intervals.items() if low <= probability <= high))
    assert min(coverages) >= confidence
    assert max(high - low for low, high in intervals.values()) <= 2 * half_width


def test_places_are_as_probable_as_runs_say() -> None:
    rule = StoppingRule(0.95, 0.1)
    places = rule.places(len(rule.analyses) - 1)
    expected = _stops(rule, 0.3)
    found = {
        (rule.analyses.index(int(runs)), int(hits)): share
        for runs, hits, share in zip(places.runs, places.hits, places.probabilities(0.3), strict=True)
    }
    for (analysis, hits), share in expected.items():
        if 2 * hits <= rule.analyses[analysis]:
            assert found.get((analysis, hits), 0.0) == pytest.approx(share, abs=1e-12)


def test_few_runs_are_enough_where_nothing_happens() -> None:
    rule = StoppingRule(0.95, 0.05)
    first = next(analysis for analysis in range(len(rule.analyses)) if rule.stops(analysis, 0))
    assert rule.analyses[first] < 60 < 400 < rule.analyses[-1]
    low, high = rule.interval(first, 0)
    assert low == 0 and high == pytest.approx(1 - 0.025 ** (1 / rule.analyses[first]))
    assert rule.interval(first, rule.analyses[first]) == pytest.approx((1 - high, 1))


def test_a_fixed_number_of_runs() -> None:
    assert runs_for(0.95, 0.05) == 402
    for runs, narrow in ((401, False), (402, True)):
        low, high = clopper_pearson(runs // 2, runs)
        assert (high - low <= 0.1) is narrow


def test_the_rule_treats_hits_and_misses_alike() -> None:
    rule = StoppingRule(0.95, 0.1)
    analysis = len(rule.analyses) - 2
    runs = rule.analyses[analysis]
    for hits in np.linspace(0, rule.edges[analysis], 4).astype(int).tolist():
        low, high = rule.interval(analysis, hits)
        assert rule.interval(analysis, runs - hits) == pytest.approx((1 - high, 1 - low))
