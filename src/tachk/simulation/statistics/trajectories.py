"""Trajectories of values on runs: the query ``simulate``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from tachk.base.job import check_job
from tachk.base.operators import BinaryOperator
from tachk.engine.compiler.program import Program
from tachk.engine.simulation.simulator import (
    LATEST_TICK,
    TICKS_PER_UNIT,
    RecordedChanges,
    Simulated,
    SimulationEnding,
    SimulationOptions,
    TimeBound,
)
from tachk.engine.simulation.trials import TrialAnswer
from tachk.model.connectives import any_of, both
from tachk.model.expressions import BOOL, Binary, Constant, Expression, LocationTest
from tachk.model.floating import DOUBLE
from tachk.model.network import Network
from tachk.model.statistical import Path, RunBound, Scale
from tachk.model.statistical import Trajectories as TrajectoriesQuery
from tachk.model.types import ClockType
from tachk.simulation.columns import Column
from tachk.simulation.runs import Runs
from tachk.simulation.statistics.sampling import (
    RunSource,
    SampledRuns,
    clock_number,
    path_sampler,
    place_name,
    reach_of,
)

Floats = NDArray[np.float64]
_BATCH = 4096
"""The number of runs that are drawn at once for a condition."""
_BYTES_A_STATE = 128
"""The memory that the points of a value take for each state of a run while they are computed."""


@dataclass(frozen=True, slots=True)
class Polyline:
    """The values of an expression on a run: points to be joined. Where it jumps, two points have the same time."""

    name: str
    times: Floats
    values: Floats


@dataclass(frozen=True, slots=True)
class Trajectory:
    """A run.

    Attributes:
        number: of the run; with the seed it determines the run.
        end: in units of time.
    """

    number: int
    ending: SimulationEnding
    end: float
    lines: tuple[Polyline, ...]


def picked(
    network: Network, question: TrajectoriesQuery, source: RunSource
) -> tuple[SampledRuns | None, Sequence[int]]:
    """The sample of the condition, if one picks runs; and the numbers of the runs to show."""
    numbers = range(source.first, source.first + question.runs)
    if question.condition is None:
        return None, numbers
    sampler = path_sampler(network, Path(question.bound, None, False, question.condition), source)
    found: list[int] = []
    while sampler.sample.runs < question.runs:
        first = source.first + sampler.sample.runs
        answers = sampler.draw(min(_BATCH, question.runs - sampler.sample.runs)).answers
        found += (first + np.flatnonzero(answers == TrialAnswer.YES)).tolist()
    return sampler.sample, found[: question.most]


def trajectories(
    network: Network, question: TrajectoriesQuery, source: RunSource, numbers: Sequence[int]
) -> tuple[Trajectory, ...]:
    """The runs of these numbers. Raises UnsupportedError for what is not simulated."""
    clocks = any(isinstance(value.type, ClockType) for value in question.values)
    observed = [_standing(network, v) if isinstance(v.type, ClockType) else v for v in question.values]
    runs = Runs(network, [Column(v.span.text, seen) for v, seen in zip(question.values, observed, strict=True)])
    recorded = RecordedChanges(observed=True, clocks=clocks)
    return tuple(
        Trajectory(
            run.number,
            run.ending,
            run.end / run.ticks_per_unit,
            tuple(_lines(run, question.values, network, runs.program)),
        )
        for drawing, first, last in _drawings(network, question, source, numbers, runs.program)
        for run in runs.draw(drawing, range(first, last), recorded)
    )


def _drawings(
    network: Network, question: TrajectoriesQuery, source: RunSource, numbers: Sequence[int], program: Program
) -> Iterator[tuple[SimulationOptions, int, int]]:
    """The ranges of runs to draw: those with consecutive numbers and the same end together."""
    if question.bound.scale is Scale.CLOCK:
        for number in numbers:
            end = _end(network, question, replace(source, first=number))
            drawing = SimulationOptions(
                source.seed, end.ticks, steps=source.most_steps, ticks_per_unit=end.ticks_per_unit
            )
            yield drawing, number, number + 1
        return
    reach = reach_of(question.bound, network, program)
    steps = source.most_steps if reach.steps is None else reach.steps
    until = LATEST_TICK if reach.until is None else reach.until
    drawing = SimulationOptions(
        source.seed, until, steps=steps, threads=source.threads, ticks_per_unit=reach.ticks_per_unit
    )
    for first, last in _stretches(numbers):
        yield drawing, first, last


def _stretches(numbers: Sequence[int]) -> Iterator[tuple[int, int]]:
    """The ranges, each without its end, that rising numbers consist of."""
    if isinstance(numbers, range):
        yield numbers.start, numbers.stop
        return
    first = 0
    for place in range(1, len(numbers) + 1):
        if place == len(numbers) or numbers[place] != numbers[place - 1] + 1:
            yield numbers[first], numbers[place - 1] + 1
            first = place


def _end(network: Network, question: TrajectoriesQuery, source: RunSource) -> TimeBound:
    """The time at which the run with the first number reaches a bound that is a clock."""
    beyond, latest = question.bound.beyond, RunBound(Scale.TIME, Fraction(LATEST_TICK, TICKS_PER_UNIT))
    path = Path(question.bound, None, False, Constant(0)) if beyond is None else Path(latest, None, False, beyond)
    sampler = path_sampler(network, path, source)
    return TimeBound(int(sampler.draw(1).ends[0]), sampler.sample.ticks_per_unit)


def _standing(network: Network, clock: Expression) -> Expression:
    """The condition that a clock stands still."""
    name = place_name(clock, network)
    return any_of(
        [
            both(LocationTest(number, place), Binary(BinaryOperator.EQUAL, rate, Constant(0), BOOL))
            for number, process in enumerate(network.processes)
            for place, location in enumerate(process.locations)
            for stopped, rate in location.rates
            if place_name(stopped, network) == name
        ]
        or [Constant(0, BOOL)]
    )


def _lines(run: Simulated, values: tuple[Expression, ...], network: Network, program: Program) -> list[Polyline]:
    if not len(run.times):
        return [Polyline(value.span.text, np.empty(0), np.empty(0)) for value in values]
    lines = []
    ends = np.append(run.times[1:], run.end)
    for column, value in enumerate(values):
        check_job(_BYTES_A_STATE * len(ends))
        slots = np.ascontiguousarray(run.observed[:, column])
        if isinstance(value.type, ClockType):
            begins = run.clocks[:, clock_number(value, network, program) - 1]
            runs_on = np.where(slots != 0, 0, ends - run.times)
            first, last = begins / run.ticks_per_unit, (begins + runs_on) / run.ticks_per_unit
        else:
            first = last = slots.view(np.float64) if value.type == DOUBLE else slots.astype(np.float64)
        times = np.column_stack((run.times, ends)).reshape(-1) / run.ticks_per_unit
        lines.append(_settled(value.span.text, times, np.column_stack((first, last)).reshape(-1)))
    return lines


def _settled(name: str, times: Floats, values: Floats) -> Polyline:
    """Without what lasts no time, but for the last state, and without points between equal neighbours."""
    lasting = np.repeat(np.diff(times)[::2] > 0, 2)
    lasting[-1] = True
    times, values = times[lasting], values[lasting]
    middle = np.ones(len(times), dtype=bool)
    middle[1:-1] = (values[1:-1] != values[:-2]) | (values[1:-1] != values[2:])
    return Polyline(name, times[middle], values[middle])
