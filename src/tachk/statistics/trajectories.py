"""How values go on runs: what ``simulate`` asks for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tachk.compiler.program import Program
from tachk.diagnostics.diagnostic import UsageError
from tachk.engines.simulation.simulator import TICKS_PER_UNIT, Drawing, Ending, Recorded, Simulated
from tachk.model.expressions import Expression
from tachk.model.floating import DOUBLE
from tachk.model.network import Network
from tachk.model.statistical import Scale
from tachk.model.statistical import Trajectories as Asked
from tachk.model.types import ClockType
from tachk.simulation.columns import Column
from tachk.simulation.runs import Runs
from tachk.statistics.sampling import Source, clock_number, reach_of

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Line:
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
    ending: Ending
    end: float
    lines: tuple[Line, ...]


def trajectories(network: Network, asked: Asked, source: Source) -> tuple[Trajectory, ...]:
    """The runs. Raises UnsupportedError for what is not simulated, UsageError for a bound that is a clock."""
    if asked.bound.scale is Scale.CLOCK:
        raise UsageError("simulate takes a bound on time or on the number of transitions", "for example [<=100; 5]")
    discrete = [value for value in asked.values if not isinstance(value.type, ClockType)]
    runs = Runs(network, [Column(value.span.text, value) for value in discrete])
    reach = reach_of(asked.bound, network, runs.program)
    drawing = Drawing(
        source.seed, reach.until or 2**58, steps=source.most_steps if reach.steps is None else reach.steps,
        threads=source.threads,
    )  # fmt: skip
    numbers = range(source.first, source.first + asked.runs)
    recorded = Recorded(observed=True, clocks=len(discrete) < len(asked.values))
    return tuple(
        Trajectory(
            run.number, run.ending, run.end / TICKS_PER_UNIT, tuple(_lines(run, asked.values, network, runs.program))
        )
        for run in runs.draw(drawing, numbers, recorded)
    )


def _lines(run: Simulated, values: tuple[Expression, ...], network: Network, program: Program) -> list[Line]:
    if not len(run.times):
        return [Line(value.span.text, np.empty(0), np.empty(0)) for value in values]
    lines = []
    column = 0
    ends = np.append(run.times[1:], run.end)
    for value in values:
        if isinstance(value.type, ClockType):
            begins = run.clocks[:, clock_number(value, network, program) - 1]
            runs_on = ends - run.times
            if program.has_stopwatches:
                runs_on = np.where(np.append(begins[1:], begins[-1]) == begins, 0, runs_on)
            first, last = begins / TICKS_PER_UNIT, (begins + runs_on) / TICKS_PER_UNIT
        else:
            cells = np.ascontiguousarray(run.observed[:, column])
            first = last = cells.view(np.float64) if value.type == DOUBLE else cells.astype(np.float64)
            column += 1
        times = np.column_stack((run.times, ends)).reshape(-1) / TICKS_PER_UNIT
        lines.append(_settled(value.span.text, times, np.column_stack((first, last)).reshape(-1)))
    return lines


def _settled(name: str, times: Floats, values: Floats) -> Line:
    """Without what lasts no time, but for the last state, and without points between equal neighbours."""
    lasting = np.flatnonzero(np.diff(times)[::2] > 0)
    kept = np.union1d(np.concatenate((2 * lasting, 2 * lasting + 1)), [len(times) - 1])
    times, values = times[kept], values[kept]
    middle = np.ones(len(times), dtype=bool)
    middle[1:-1] = (values[1:-1] != values[:-2]) | (values[1:-1] != values[2:])
    return Line(name, times[middle], values[middle])
