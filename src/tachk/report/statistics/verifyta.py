"""Answers to statistical queries as UPPAAL's verifyta prints them, for scripts that look for its lines.

What is followed are public logs and the expressions by which public programs read them. Version 4.1 writes

     -- Formula is satisfied.
    (757 runs) Pr(<> ...) in [0,0.00999058]
    with confidence 0.9995.

and version 5.0

     -- Formula is satisfied.
     -- Result: (2994167/4000000 runs) Pr(<> …) in [0.748116,0.748967] (95% CI)

UPPAAL Stratego has the same words without ``-- Result:``, so that the line begins with the number of runs.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from math import ceil, isfinite, isnan, sqrt
from typing import assert_never

import numpy as np
from numpy.typing import NDArray

from tachk.model.statistical import (
    ExpectedValue,
    Path,
    PathProperty,
    Probability,
    ProbabilityComparison,
    Scale,
    Threshold,
)
from tachk.report.verifyta_notes import memory_lines, note
from tachk.simulation.statistics.answers import StatisticalAnswer, samples_of
from tachk.simulation.statistics.deciding import Decision
from tachk.simulation.statistics.estimate import Decided, DrawnRuns, Estimated, Mean, Settings, Split
from tachk.simulation.statistics.sampling import endings_text
from tachk.simulation.statistics.trajectories import Trajectory


class Form(StrEnum):
    """The version of UPPAAL whose lines are written."""

    V4 = "4.1"
    V5 = "5.0"
    STRATEGO = "stratego"

    @property
    def dots(self) -> str:
        """The placeholder for a condition."""
        return "..." if self is Form.V4 else "…"

    @property
    def result(self) -> str:
        """The words before a result."""
        return " -- Result: " if self is Form.V5 else ""


@dataclass(frozen=True, slots=True)
class Bars:
    """The bars of a histogram.

    Attributes:
        width: of a bar; None: from the number of bars.
        count: None: from the values.
    """

    width: float | None = None
    count: int | None = None


def statistical_lines(answer: StatisticalAnswer, form: Form = Form.V4, bars: Bars = Bars()) -> Iterator[str]:
    """The answer; only a reason where there is none."""
    found, settings = answer.found, answer.settings
    match found:
        case None:
            yield note(f"no answer: {answer.reason}")
            return
        case Decided() if found.decision is Decision.UNKNOWN:
            yield note("no answer: no decision after so many runs")
        case Decided():
            yield " -- Formula is satisfied." if found.decision is Decision.HOLDS else " -- Formula is NOT satisfied."
            yield from _test(found, form, settings)
        case Estimated():
            yield " -- Formula is satisfied."
            yield from _probability(found, form, settings)
            path = path_of(found)
            if isinstance(path, Path) and path.bound.scale is Scale.TIME and not path.always:
                yield from _values(found.sample.all_times, bars)
        case Mean() if isnan(found.mean):
            yield note("no answer: no run has a value")
        case Mean():
            yield " -- Formula is satisfied."
            yield from _mean(found, form, settings)
            yield from _values(found.sample.all_values[~np.isnan(found.sample.all_values)], bars)
        case DrawnRuns():
            yield f" -- Formula is {'' if found.runs else 'NOT '}satisfied."
            yield from _picked(found, form, settings)
            yield from _trajectories(found.runs)
        case Split():
            yield note("no answer: probabilities by splitting have no form here")
        case never:
            assert_never(never)
    for sample in samples_of(found):
        for line_text in endings_text(sample.endings.most_common()):
            yield note(line_text)


def statistical_summary(answer: StatisticalAnswer) -> Iterator[str]:
    """The figures of ``-u``."""
    if answer.found is None:
        return
    steps = sum(sample.transitions for sample in samples_of(answer.found))
    yield f" -- States explored : {steps} states"
    yield f" -- CPU user time used : {round(answer.seconds * 1000)} ms"
    yield from memory_lines()


def _picked(found: DrawnRuns, form: Form, settings: Settings) -> Iterator[str]:
    """The lines about the probability of the condition that picks runs."""
    if found.picked is None or found.interval is None:
        return
    interval = f"Pr(<> {form.dots}) in [{found.interval[0]:.6g},{found.interval[1]:.6g}]"
    yield from _interval_lines(interval, found.picked.hits, found.picked.runs, form, settings)


def _interval_lines(interval: str, hits: int, runs: int, form: Form, settings: Settings) -> Iterator[str]:
    if form is Form.V4:
        yield f"({runs} runs) {interval}"
        yield f"with confidence {settings.confidence:.6g}."
    else:
        yield f"{form.result}({hits}/{runs} runs) {interval} ({settings.confidence * 100:.6g}% CI)"


def path_of(found: Estimated) -> PathProperty | None:
    """The property evaluated on each run."""
    match found.query.question:
        case Probability(path) | Threshold(path):
            return path
        case _:
            return None


def _operator(path: PathProperty, form: Form) -> str:
    if not isinstance(path, Path):
        return f"Pr({form.dots})"
    if path.before is not None:
        return f"Pr({form.dots} U {form.dots})"
    return f"Pr({'[]' if path.always else '<>'} {form.dots})"


def _probability(found: Estimated, form: Form, settings: Settings) -> Iterator[str]:
    path, runs = path_of(found), found.sample.runs
    assert path is not None
    interval = f"{_operator(path, form)} in [{found.low:.6g},{found.high:.6g}]"
    yield from _interval_lines(interval, round(found.frequency * runs), runs, form, settings)


def _test(found: Decided, form: Form, settings: Settings) -> Iterator[str]:
    runs = found.samples[0].runs
    hits = round(found.frequencies[0] * runs)
    holds = found.decision is Decision.HOLDS
    match found.query.question:
        case Threshold(path, at_least, probability):
            relation = ">=" if at_least is holds else "<="
            text = f"{'H0' if holds else 'H1'}: {_operator(path, form)} {relation} {probability:.6g}"
        case ProbabilityComparison():
            text = f"Pr(..)/Pr(..) {'>=' if holds else '<='} 1"
        case _:
            return
    if form is Form.V4:
        yield f"({runs} runs) {text}"
    else:
        yield f"{form.result}({hits}/{runs} runs) {text}"
    yield f"with confidence {settings.confidence:.6g}."


def _mean(found: Mean, form: Form, settings: Settings) -> Iterator[str]:
    question, runs = found.query.question, found.sample.runs
    name = "E(max)" if isinstance(question, ExpectedValue) and question.largest else "E(min)"
    if form is Form.V4:
        yield f"({runs} runs) {name} = {found.mean:.6g}"
        return
    low, high = found.asymptotic
    if not isfinite(high - low) or high == low:
        yield f"{form.result}({runs} runs) {name} = ≈ {found.mean:.6g}"
    else:
        interval = f"{found.mean:.6g} ± {(high - low) / 2:.6g}"
        yield f"{form.result}({runs} runs) {name} = {interval} ({settings.confidence * 100:.6g}% CI)"


def _values(values: NDArray[np.float64], bars: Bars) -> Iterator[str]:
    """The number of values in each bar, those at an edge in the upper one."""
    if not len(values):
        return
    low, high = float(values.min()), float(values.max())
    whole = bool(np.all(values == np.floor(values)))
    if bars.width is not None:
        width = bars.width
        count = max(1, ceil((high - low) / width + 1e-9))
    elif bars.count is None and whole and high - low < 100:
        width, count = 1.0, int(high - low) + 1
    else:
        count = bars.count or max(1, ceil(sqrt(len(values))))
        width = (high - low) / count or 1.0
    places = np.minimum(((values - low) / width).astype(np.int64), count - 1)
    counts = " ".join(map(str, np.bincount(places, minlength=count).tolist()))
    yield f"Values in [{low:.6g},{high:.6g}] mean={float(values.mean()):.6g} steps={width:.6g}: {counts}"


def _trajectories(runs: tuple[Trajectory, ...]) -> Iterator[str]:
    """For each expression a line for each run."""
    names = [line.name for line in runs[0].lines] if runs else []
    for number, name in enumerate(names):
        yield f"{' '.join(name.split())}:"
        for place, run in enumerate(runs):
            line = run.lines[number]
            points = (f"({time:.6g},{value:.6g})" for time, value in zip(line.times, line.values, strict=True))
            yield f"[{place}]: {' '.join(points)}"
