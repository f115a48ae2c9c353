"""Answers to statistical queries in words."""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil, floor, isfinite, log10
from typing import assert_never

from tachk.simulation.statistics.answers import NoEstimate
from tachk.simulation.statistics.deciding import Decision
from tachk.simulation.statistics.estimate import Decided, DrawnRuns, Estimate, Estimated, Mean, Settings, Split
from tachk.simulation.statistics.sampling import SampledRuns, endings_text
from tachk.simulation.statistics.trajectories import Polyline

_POINTS = 6


def answer_lines(found: Estimate | NoEstimate, settings: Settings) -> Iterator[str]:
    """The answer, then how it came about."""
    confidence = f"confidence {settings.confidence:.6g}"
    match found:
        case Estimated():
            yield f"{_head(found)}: {interval_text(found.low, found.high)}, {confidence}"
            yield from _sample_lines(found.sample, found.frequency, found.method)
        case Decided():
            yield f"{_head(found)}: {found.decision.value}"
            yield from _test_lines(found, settings, confidence)
        case Mean():
            yield from _mean_lines(found, confidence)
        case Split():
            yield f"{_head(found)}: {found.rare.mean:.3g}; {interval_text(found.low, found.high)}, {confidence}"
            yield from _split_lines(found)
        case DrawnRuns():
            yield f"{_head(found)}: {_count(len(found.runs), 'run')}"
            if found.picked is not None and found.interval is not None:
                hits = f"the condition becomes true on {found.picked.hits} of {_count(found.picked.runs, 'run')}"
                yield f"  {hits}: probability {interval_text(*found.interval)}, {confidence}"
            for run in found.runs:
                yield f"  run {run.number}, until {run.end:.6g}, {run.ending}"
                for line in run.lines:
                    yield f"    {line.name}: {_points(line)}"
        case NoEstimate(_, reason):
            yield f"{_head(found)}: unknown ({reason})"
        case never:
            assert_never(never)


def times_text(count: int) -> str:
    """A number of times in words."""
    return "once" if count == 1 else f"{count:,} times"


def interval_text(low: float, high: float) -> str:
    """Both ends, rounded outwards to three digits of their difference."""
    width = high - low
    if not isfinite(width) or width <= 0:
        return f"{low:.6g} to {high:.6g}"
    digits = 2 - floor(log10(width))
    if digits > 8:
        return f"{low:.3e} to {high:.3e}"
    scale = 10.0**digits
    shown = max(digits, 0)
    return f"{floor(low * scale) / scale:.{shown}f} to {ceil(high * scale) / scale:.{shown}f}"


def _head(found: Estimate | NoEstimate) -> str:
    return f"{found.query.name}: {' '.join(found.query.text.split())}"


def _sample_lines(sample: SampledRuns, frequency: float, method: str) -> Iterator[str]:
    number = " (a number fixed beforehand)" if method == "fixed" else ""
    unknown = f", {sample.unknown} of them unknown" if sample.unknown else ""
    yield f"  frequency {frequency:.6g} in {_count(sample.runs, 'run')}{number}{unknown}"
    yield from _endings(sample)


def _endings(sample: SampledRuns) -> Iterator[str]:
    for text in endings_text(sample.endings.most_common()):
        yield f"  {text}"
    if sample.fault is not None:
        kind, span = sample.fault
        yield f"  {span}: {kind.name.lower().replace('_', ' ')}"


def _test_lines(found: Decided, settings: Settings, confidence: str) -> Iterator[str]:
    for sample, frequency in zip(found.samples, found.frequencies, strict=True):
        yield from _sample_lines(sample, frequency, "fixed" if found.interval else "sequential")
    errors = settings.errors
    if found.interval is not None:
        yield f"  the probability is {interval_text(*found.interval)}, {confidence}"
    elif found.decision is Decision.UNKNOWN:
        yield "  no decision after so many runs"
    else:
        yield (
            f"  wrong with probability at most {errors.alpha:.6g} (fails) or {errors.beta:.6g} (holds), "
            f"unless the difference is below {errors.delta:.6g}"
        )


def _mean_lines(found: Mean, confidence: str) -> Iterator[str]:
    if not isfinite(found.asymptotic[0]):
        yield f"{_head(found)}: {_count(found.sample.runs - found.sample.unknown, 'run')} with a value say nothing"
        yield from _endings(found.sample)
        return
    asymptotic = interval_text(*found.asymptotic)
    if found.low is None or found.high is None or found.values is None:
        yield f"{_head(found)}: {found.mean:.6g}; asymptotically {asymptotic}, {confidence}"
        yield "  no bounds of the value are known, so that a few runs may mislead: the interval is no guarantee"
    else:
        low, high = found.values
        yield f"{_head(found)}: {found.mean:.6g}; {interval_text(found.low, found.high)}, {confidence}"
        yield f"  for any distribution on {low:.6g} to {high:.6g}; asymptotically {asymptotic}"
    unknown = f", {found.sample.unknown} of them unknown" if found.sample.unknown else ""
    yield f"  {_count(found.sample.runs, 'run')}{unknown}"
    yield from _endings(found.sample)


def _split_lines(found: Split) -> Iterator[str]:
    rare = found.rare
    yield (
        f"  by splitting: {_count(len(rare.probabilities), 'replication')}, {_count(rare.levels, 'level')} "
        f"from {_count(rare.states, 'state')}{'' if rare.whole else ' (there are more)'}"
    )
    yield "  the interval is no guarantee: it is right for many replications"
    if rare.unknown:
        yield f"  {_count(rare.unknown, 'run')} ended before it was known whether they reach it; they count as not"


def _points(line: Polyline) -> str:
    """The points of a line; of a long one the first ones and the last."""
    count = len(line.times)
    if count <= _POINTS + 1:
        return " ".join(_point(line, number) for number in range(count))
    begin = " ".join(_point(line, number) for number in range(_POINTS))
    return f"{begin} ... {_point(line, count - 1)} ({count} points)"


def _point(line: Polyline, number: int) -> str:
    return f"({line.times[number]:.6g}, {line.values[number]:.6g})"


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"
