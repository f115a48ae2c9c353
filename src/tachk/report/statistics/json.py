"""Answers to statistical queries for programs: what docs/schema/estimate.schema.json describes."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from typing import Any, assert_never

from tachk.simulation.statistics.estimate import Decided, DrawnRuns, Estimate, Estimated, Mean, Settings, Split
from tachk.simulation.statistics.sampling import SampledRuns
from tachk.simulation.statistics.trajectories import Trajectory


def estimates_document(model: str, found: Sequence[Estimate], settings: Settings) -> dict[str, Any]:
    return {
        "model": model,
        "seed": settings.source.seed,
        "confidence": settings.confidence,
        "alpha": settings.errors.alpha,
        "beta": settings.errors.beta,
        "delta": settings.errors.delta,
        "answers": [answer_document(each) for each in found],
    }


def answer_document(found: Estimate) -> dict[str, Any]:
    head = {"name": found.query.name, "query": " ".join(found.query.text.split())}
    match found:
        case Estimated():
            return {
                **head,
                "kind": "probability",
                "low": found.low,
                "high": found.high,
                "frequency": found.frequency,
                "method": found.method,
                "samples": [_sample(found.sample)],
                "times": found.sample.all_times.tolist(),
            }
        case Decided():
            return {
                **head,
                "kind": "test",
                "answer": found.decision.value,
                "interval": None if found.interval is None else list(found.interval),
                "frequencies": list(found.frequencies),
                "samples": [_sample(sample) for sample in found.samples],
            }
        case Mean():
            return {
                **head,
                "kind": "mean",
                "mean": _finite(found.mean),
                "low": found.low,
                "high": found.high,
                "asymptotic": [_finite(end) for end in found.asymptotic],
                "bounds": None if found.values is None else list(found.values),
                "samples": [_sample(found.sample)],
            }
        case Split():
            return {**head, **_splitting(found)}
        case DrawnRuns():
            picked = None if found.picked is None else _sample(found.picked)
            interval = None if found.interval is None else list(found.interval)
            runs = [_run(run) for run in found.runs]
            return {**head, "kind": "trajectories", "runs": runs, "picked": picked, "interval": interval}
        case never:
            assert_never(never)


def _finite(number: float) -> float | None:
    return number if isfinite(number) else None


def _splitting(found: Split) -> dict[str, Any]:
    rare = found.rare
    return {
        "kind": "splitting",
        "mean": rare.mean,
        "low": found.low,
        "high": found.high,
        "replications": rare.probabilities.tolist(),
        "levels": rare.levels,
        "states": rare.states,
        "whole": rare.whole,
        "transitions": rare.transitions,
        "unknown": rare.unknown,
    }


def _run(run: Trajectory) -> dict[str, Any]:
    return {
        "run": run.number,
        "ending": run.ending.value,
        "end": run.end,
        "lines": [{"name": l.name, "times": l.times.tolist(), "values": l.values.tolist()} for l in run.lines],
    }


def _sample(sample: SampledRuns) -> dict[str, Any]:
    return {
        "runs": sample.runs,
        "hits": sample.hits,
        "unknown": sample.unknown,
        "transitions": sample.transitions,
        "endings": {ending.value: count for ending, count in sample.endings.items()},
    }
