"""The simulator of the core: a program with its chances goes there, runs come back as arrays."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from enum import StrEnum
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tachk import _core
from tachk.base.job import check_job, current_job
from tachk.base.records import dataclass
from tachk.base.seeds import DEFAULT_SEED
from tachk.base.span import Span
from tachk.engine.chances_image import chances_image
from tachk.engine.compiler.program import Chances, Program
from tachk.engine.core_search import site_of, transition_of
from tachk.engine.program_image import encode
from tachk.engine.simulation.policy import Policy
from tachk.model.fault import RuntimeErrorKind
from tachk.model.run import Transition

TICKS_PER_UNIT = _core.finest_ticks()
"""The resolution of simulated time, unless a run is too long for it."""
LATEST_TICK = _core.latest_end()
"""Runs end there, however long a tick is."""
LATEST_END = Fraction(LATEST_TICK, _core.coarsest_ticks())
"""The longest run, in units of time."""

MonitoredFormula = _core.MonitoredFormula
"""A formula that the core evaluates on runs: a program of monitors, the observed values that are its columns (their
number, whether they are bits of floating point numbers, and what 0, 1, ... stand for, if not for themselves), and the
ticks of the program in a tick of the runs."""
RecordedRows = _core.RecordedRows
"""The runs of which all rows stay."""
MonitoredRuns = _core.MonitoredRuns
"""Runs with the truth of each formula on them: arrays in their order."""

Numbers = NDArray[np.int64]
_NONE: Numbers = np.empty(0, dtype=np.int64)
_BETWEEN_CHECKS = 1 << 10
"""So many transitions of a record are read between two looks at the limits."""


class SimulationEnding(StrEnum):
    """The reason why a run ends."""

    HORIZON = "horizon"
    """The run has its full length."""
    DEADLOCK = "deadlock"
    """Nothing can happen, and time cannot pass."""
    TIME_LOCK = "time-lock"
    """An invariant ends, and nothing can happen."""
    ZENO = "no time passes"
    STEPS = "steps"
    """It has as many transitions as it may have."""
    FAULT = "run-time error"
    INITIAL = "no initial state"
    """The initial state violates an invariant."""
    END_OF_TIME = "end of time"
    """It has no bound on time, and lasts longer than can be counted."""

    @property
    def what_happened(self) -> str:
        """What a run did that ended so, behind its number or the number of such runs."""
        return _WHAT_HAPPENED[self]


_WHAT_HAPPENED = {
    SimulationEnding.HORIZON: "reached the time limit",
    SimulationEnding.DEADLOCK: "ended in a deadlock",
    SimulationEnding.TIME_LOCK: "ended in a time-lock",
    SimulationEnding.ZENO: "ended at an instant after which no time passes",
    SimulationEnding.STEPS: "reached the limit of steps",
    SimulationEnding.FAULT: "ended with a run-time error",
    SimulationEnding.INITIAL: "had no initial state",
    SimulationEnding.END_OF_TIME: "reached the end of the time that can be counted",
}

_ENDINGS = {ending: SimulationEnding[ending.name] for ending in _core.Ending}
_NUMBERED = list(_ENDINGS.values())
FAULT = _NUMBERED.index(SimulationEnding.FAULT)
"""The number of this ending in arrays."""


def counted_endings(endings: NDArray[np.int8]) -> dict[SimulationEnding, int]:
    """How many runs end how, of an array with the number of the ending of each."""
    counts = np.bincount(endings, minlength=len(_NUMBERED)).tolist()
    return {ending: count for ending, count in zip(_NUMBERED, counts, strict=True) if count}


@dataclass(frozen=True, slots=True)
class TimeBound:
    """A time up to which runs go on.

    Attributes:
        ticks_per_unit: as many as fit, a power of ten: times are exact multiples of a tick.
    """

    ticks: int
    ticks_per_unit: int


def time_bound(units: Fraction) -> TimeBound:
    """A time in the finest ticks in which it can be counted; it is at most `LATEST_END`."""
    per_unit = TICKS_PER_UNIT
    while units * per_unit > LATEST_TICK:
        per_unit //= 10
    return TimeBound(int(units * per_unit), per_unit)


@dataclass(frozen=True, slots=True)
class Simulated:
    """A run.

    Attributes:
        number: of the run; with the seed it determines the run.
        ticks_per_unit: how finely its times are counted.
        end: in ticks.
        times: of the initial state and of the states after each transition, in ticks; empty if nothing was recorded.
        observed: a row for each of these states; floating point numbers as their bits.
        clocks: the same of the values of the clocks, in ticks.
        actions: how each state after the first was reached; None where time passed, which is recorded of runs with
            hybrid clocks.
        fault: what went wrong and where, in a run that ends with a run-time error.
        lasts: whether time can pass in the last state.
    """

    number: int
    ticks_per_unit: int
    ending: SimulationEnding
    end: int
    transitions: int
    times: Numbers
    observed: Numbers
    clocks: Numbers
    actions: tuple[Transition | None, ...] = ()
    fault: tuple[RuntimeErrorKind, Span] | None = None
    lasts: bool = False


@dataclass(frozen=True, slots=True)
class RecordedChanges:
    """The changes that are recorded of runs beside how they end."""

    actions: bool = False
    observed: bool = False
    clocks: bool = False


@dataclass(frozen=True, slots=True)
class SimulationOptions:
    """The runs to draw.

    Attributes:
        until: their end, in ticks.
        ticks_per_unit: the resolution of time, see `time_bound`.
        steps: the limit on their transitions; None: any number.
        threads: they make no difference to the runs.
    """

    seed: int = DEFAULT_SEED
    until: int = 100 * TICKS_PER_UNIT
    policy: Policy = Policy.STOCHASTIC
    steps: int | None = None
    threads: int = 1
    ticks_per_unit: int = TICKS_PER_UNIT


def _request(drawing: SimulationOptions, numbers: range) -> dict[str, Any]:
    """The arguments by which the core draws the runs of these numbers."""
    return {
        "policy": _core.Policy[drawing.policy.name],
        "seed": drawing.seed,
        "first": numbers.start,
        "runs": len(numbers),
        "until": drawing.until,
        "ticks_per_unit": drawing.ticks_per_unit,
        "steps": 2**63 if drawing.steps is None else drawing.steps,
        "threads": drawing.threads,
        "check": current_job().check,
    }


class Simulator:
    """Runs of a program."""

    def __init__(self, program: Program, chances: Chances) -> None:
        self._program = program
        self._observed = len(chances.observed)
        self._core = _core.Simulation(encode(program, ()), list(chances_image(chances)))

    def runs(self, drawing: SimulationOptions, numbers: range, recorded: RecordedChanges) -> Iterator[Simulated]:
        """The runs of these numbers, which follow one another. Raises StoppedError."""
        found = self._core.run(
            actions=recorded.actions,
            observed=recorded.observed,
            clocks=recorded.clocks,
            **_request(drawing, numbers),
        )
        for number, record in zip(numbers, found, strict=True):
            yield self.simulated(number, drawing.ticks_per_unit, record, recorded)

    def monitored(
        self,
        drawing: SimulationOptions,
        numbers: range,
        formulas: Sequence[MonitoredFormula],
        rows: RecordedRows = RecordedRows.NONE,
        actions: bool = False,
        until_decided: bool = False,
    ) -> MonitoredRuns:
        """The runs of these numbers, on which the core evaluates formulas while it draws them. Raises StoppedError.

        Args:
            rows: the runs of which all rows stay; of others the last row does.
            until_decided: a run ends soon after all formulas are decided.
        """
        return _core.monitored_runs(
            self._core,
            formulas,
            rows=rows,
            until_decided=until_decided,
            actions=actions,
            **_request(drawing, numbers),
        )

    def first_fault(self, drawn: MonitoredRuns) -> tuple[RuntimeErrorKind, Span] | None:
        """The first run-time error, if there is one."""
        faults = np.flatnonzero(drawn.endings() == FAULT)
        return self._fault(drawn.record(int(faults[0]))) if len(faults) else None

    def _fault(self, record: _core.RunRecord) -> tuple[RuntimeErrorKind, Span]:
        kind, position = record.fault
        return RuntimeErrorKind[kind.name], site_of(self._program, position)

    def simulated(self, number: int, per_unit: int, record: _core.RunRecord, recorded: RecordedChanges) -> Simulated:
        """The run of a record."""
        ending = _ENDINGS[record.ending]
        fault = self._fault(record) if ending is SimulationEnding.FAULT else None
        if not (recorded.actions or recorded.observed or recorded.clocks):
            none = (_NONE, _NONE, _NONE)
            return Simulated(number, per_unit, ending, record.end, record.transitions, *none, (), fault, record.lasts)
        times = record.times()
        return Simulated(
            number,
            per_unit,
            ending,
            record.end,
            record.transitions,
            times,
            record.observed().reshape(len(times), self._observed if recorded.observed else 0),
            record.clocks().reshape(len(times), self._program.clocks if recorded.clocks else 0),
            tuple(self._actions(record)) if recorded.actions else (),
            fault,
            record.lasts,
        )

    def _actions(self, record: _core.RunRecord) -> Iterator[Transition | None]:
        edges = record.edges().tolist()
        first = 0
        for number, size in enumerate(record.sizes()[1:].tolist()):
            if number % _BETWEEN_CHECKS == 0:
                check_job()
            yield transition_of(self._program, edges[first : first + size]) if size else None
            first += size
