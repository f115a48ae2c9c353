"""Random trials, drawn by the core: each run ends as soon as its answer to a question is known."""

from __future__ import annotations

from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from tachk import _core
from tachk.base.job import current_job
from tachk.base.records import dataclass
from tachk.base.span import Span
from tachk.engine.chances_image import chances_image
from tachk.engine.compiler.program import Chances, Program
from tachk.engine.core_search import site_of
from tachk.engine.program_image import encode
from tachk.engine.simulation.policy import Policy
from tachk.engine.simulation.simulator import FAULT, TICKS_PER_UNIT, SimulationEnding, counted_endings
from tachk.model.fault import RuntimeErrorKind


class TrialAnswer(IntEnum):
    """The answer of a run about its goal."""

    NO = 0
    YES = 1
    UNKNOWN = 2
    """It ended too early: by a run-time error, too many transitions, a million of them at one instant, or where times
    can no longer be counted."""


@dataclass(frozen=True, slots=True)
class Reach:
    """The bound of runs: a moment in ticks, a number of transitions, or a value of a clock in ticks.

    Attributes:
        ticks_per_unit: see `time_bound`.
    """

    until: int | None = None
    steps: int | None = None
    clock: int = 0
    value: int = 0
    ticks_per_unit: int = TICKS_PER_UNIT


@dataclass(frozen=True, slots=True)
class TrialQuestion:
    """The property evaluated on runs, in numbers of the program.

    Attributes:
        goal: of `Chances.goals`: whether it is reached.
        lost: where this one is reached first, the goal counts no more.
        observed, clock: what is measured, a number of `Chances.observed` or of a clock.
        largest: the largest value on the run is, or the least.
    """

    reach: Reach
    goal: int = -1
    lost: int = -1
    observed: int = -1
    clock: int = 0
    largest: bool = True


@dataclass(frozen=True, slots=True)
class Trials:
    """The answers of some runs, in their order.

    Attributes:
        answers: an `TrialAnswer` each.
        ends: the moment at which the goal is reached, or up to which the run was looked at, in ticks.
        measured: the extreme value of what is measured.
        endings: how many runs end how, before their goal is reached.
        fault: the first run-time error, if there is one.
    """

    answers: NDArray[np.int8]
    ends: NDArray[np.int64]
    transitions: int
    measured: NDArray[np.float64]
    endings: dict[SimulationEnding, int]
    fault: tuple[RuntimeErrorKind, Span] | None


class Trier:
    """Runs of a program."""

    def __init__(self, program: Program, chances: Chances) -> None:
        self.program = program
        self._core = _core.Simulation(encode(program, chances.goals), list(chances_image(chances)))

    def trials(
        self, question: TrialQuestion, seed: int, numbers: range, threads: int, most_steps: int | None
    ) -> Trials:
        """The runs of these numbers. Raises StoppedError."""
        found = _core.trials(
            self._core,
            core_question(question),
            policy=_core.Policy[Policy.STOCHASTIC.name],
            seed=seed,
            first=numbers.start,
            runs=len(numbers),
            threads=threads,
            most_steps=2**63 if most_steps is None else most_steps,
            check=current_job().check,
        )
        answers, endings = found.answers(), found.endings()
        fault = None
        if (endings == FAULT).any():
            kind, position = found.fault(int(np.argmax(endings == FAULT)))
            fault = RuntimeErrorKind[kind.name], site_of(self.program, position)
        return Trials(
            answers,
            found.ends(),
            int(found.transitions().sum()),
            found.measured(),
            counted_endings(endings[answers != TrialAnswer.YES]),
            fault,
        )


def core_question(question: TrialQuestion) -> _core.RunQuestion:
    result = _core.RunQuestion()
    reach = question.reach
    if reach.until is not None:
        result.until = reach.until
    if reach.steps is not None:
        result.steps = reach.steps
    result.ticks_per_unit = reach.ticks_per_unit
    result.bound_clock, result.bound_value = reach.clock, reach.value
    result.goal, result.lost = question.goal, question.lost
    result.observed, result.clock, result.largest = question.observed, question.clock, question.largest
    return result
