"""Answers to statistical queries for programs: what docs/schema/estimate.schema.json describes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import isfinite
from typing import Any

from tachk.base.plain_data import Fields, PlainData
from tachk.simulation.statistics.answers import NoEstimate, StatisticalAnswer
from tachk.simulation.statistics.estimate import Decided, DrawnRuns, Estimate, Estimated, Mean, Settings, Split
from tachk.simulation.statistics.sampling import SampledRuns
from tachk.simulation.statistics.trajectories import Trajectory


def estimates_document(model: str, found: Sequence[Estimate | NoEstimate], settings: Settings) -> dict[str, Any]:
    return {"model": model, **_PLAIN.of(settings), "answers": _PLAIN(list(found))}


def answered_document(answer: StatisticalAnswer) -> dict[str, Any]:
    """An estimate of docs/schema/verify.schema.json."""
    return _PLAIN.of(answer)


def _answer(kind: str, names: str, **computed: Callable[[Any], object]) -> Fields:
    computed |= {"query": lambda found: " ".join(found.query.text.split()), "kind": lambda found: kind}
    return Fields(f"name=query.name query kind {names}", **computed)


def _one_sample(found: Estimated | Mean) -> list[SampledRuns]:
    return [found.sample]


def _finite(number: float) -> float | None:
    return number if isfinite(number) else None


FORMS: dict[type, Fields | Callable[[Any], object]] = {
    Settings: Fields("seed=source.seed confidence alpha=errors.alpha beta=errors.beta delta=errors.delta"),
    StatisticalAnswer: Fields(
        "name=query.name title=query.title query=query.text expected=query.expectation met reason "
        "seed=settings.source.seed confidence=settings.confidence alpha=settings.errors.alpha "
        "beta=settings.errors.beta delta=settings.errors.delta found"
    ),
    Estimated: _answer("probability", "low high frequency method samples times=sample.all_times", samples=_one_sample),
    Decided: _answer("test", "answer=decision interval frequencies samples"),
    Mean: _answer(
        "mean",
        "mean low high asymptotic bounds=values samples",
        mean=lambda found: _finite(found.mean),
        asymptotic=lambda found: [_finite(end) for end in found.asymptotic],
        samples=_one_sample,
    ),
    Split: _answer(
        "splitting",
        "mean=rare.mean low high replications=rare.probabilities levels=rare.levels states=rare.states "
        "whole=rare.whole transitions=rare.transitions unknown=rare.unknown",
    ),
    DrawnRuns: _answer("trajectories", "runs picked interval"),
    NoEstimate: _answer("unknown", "reason"),
    Trajectory: Fields("run=number ending end lines"),
    SampledRuns: Fields("runs hits unknown transitions endings"),
}
_PLAIN = PlainData(FORMS)
