"""Importance splitting by the core: levels from the zone graph, and replications."""

from __future__ import annotations

from collections.abc import Sequence

from tachk import _core
from tachk.base.job import current_job
from tachk.base.records import dataclass
from tachk.engine.chances_image import chances_image
from tachk.engine.compiler.program import Chances, Program
from tachk.engine.program_image import encode
from tachk.engine.simulation.trials import TrialQuestion, core_question


@dataclass(frozen=True, slots=True)
class ImportanceLevels:
    """Distances from the goal.

    Attributes:
        top: how many transitions the initial state is away from it, at least.
        states: discrete ones that were seen; ``whole``: there are no others.
        reached: the goal is among them.
    """

    top: int
    states: int
    whole: bool
    reached: bool


class Splitter:
    """Estimates of how probable it is that the first goal of a program is reached."""

    def __init__(self, program: Program, chances: Chances, zones: int) -> None:
        """Explores at most so many zones. Raises StoppedError."""
        image = encode(program, chances.goals)
        self._core = _core.Simulation(image, list(chances_image(chances)))
        self._levels = _core.Levels(image, zones)
        self.levels = ImportanceLevels(self._levels.top, self._levels.states, self._levels.whole, self._levels.reached)

    def replications(
        self, question: TrialQuestion, seed: int, numbers: range, effort: int, threads: int, most_steps: int | None
    ) -> Sequence[tuple[float, int, int]]:
        """The replications of these numbers, in order: the estimate, the transitions, and the runs that are unknown.
        Raises StoppedError."""
        return _core.split(
            self._core,
            self._levels,
            core_question(question),
            seed=seed,
            first=numbers.start,
            replications=len(numbers),
            effort=effort,
            threads=threads,
            most_steps=2**63 if most_steps is None else most_steps,
            check=current_job().check,
        )
