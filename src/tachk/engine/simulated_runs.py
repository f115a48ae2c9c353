"""Runs that are drawn to find one that reaches the goals of a program: most states need not be searched for it.

Where guards hold at single moments, a run that takes each at its earliest moment is often all that it takes, while the
zones of all runs that have missed one of them are without number. A run proves nothing else than that it exists.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from itertools import cycle

from tachk import _core
from tachk.base.job import current_job
from tachk.base.records import dataclass, replace
from tachk.engine.chances_image import chances_image
from tachk.engine.compiler.program import Chances, Comparison, Computed, Goal, Program, ProgramEdge, Test, Update
from tachk.engine.program_image import encode

_SEED = 1
_POLICIES = (_core.Policy.EARLIEST, _core.Policy.UNIFORM, _core.Policy.LATEST, _core.Policy.STOCHASTIC)
"""In turn. Uniform and stochastic runs differ where weights and rates do, and where invariants allow to wait longer."""
_TRANSITIONS_OF_A_STATE = 8
"""So many transitions take as long as it takes to explore a state."""
_LEAST_STEPS = 500
"""Of a run, however small the budget is: it is a fraction of a millisecond."""
_EDGES_OF_A_TRANSITION = 1000
"""Where more edges than this leave the locations of a state, a transition counts as several."""
_FEW_STEPS = 16
_INSTRUCTIONS_OF_A_TRANSITION = 500
"""So many instructions take as long as a transition without: a goal may ask all processes after each."""


@dataclass(frozen=True, slots=True)
class _FoundRun:
    policy: _core.Policy
    number: int
    transitions: int


class SimulatedRuns:
    """Runs by several policies, in turn, each longer than those before.

    Args:
        goals: without ``deadlock``. Those that decide are looked for, one after the other.
    """

    def __init__(self, program: Program, goals: Sequence[Goal]) -> None:
        edges = tuple(map(_unless_stuttering, program.edges))
        searched = replace(program, interchangeable=(), edges=edges)
        self._core = _core.Simulation(encode(searched, goals), list(chances_image(_equal_chances(program))))
        self._goals = [number for number, goal in enumerate(goals) if goal.decides]
        self._found: dict[int, _FoundRun] = {}
        self._numbers = dict.fromkeys(_POLICIES, 0)
        self._transitions = 0
        self._instructions = 0
        self._weight = max(1, _most_leaving(program) // _EDGES_OF_A_TRANSITION)

    def budgeted(self, work: int, longest: int | None = None) -> _BudgetedRuns:
        """The search for the goals that are left, with as much work as so many states of a small network take.

        Args:
            longest: how many steps a run may take.
        """
        return _BudgetedRuns(self, self._drawn(work * _TRANSITIONS_OF_A_STATE // self._weight, longest))

    def _drawn(self, transitions: int, longest: int | None) -> Iterator[None]:
        """Draws run after run until the budget is used up, each with the larger part of what is left."""
        if self._transitions == 0 and (first := self._open()) is not None:  # how long does a transition take?
            self._draw(first, _POLICIES[0], _FEW_STEPS)
            self._numbers[_POLICIES[0]] = 0
            yield
        end = self._spent + transitions
        for policy in cycle(_POLICIES):
            left, goal = end - self._spent, self._open()
            if left <= 0 or goal is None:
                return
            each = self._spent / self._transitions  # a transition, with its code
            steps = max(int(left * 0.75 / each), int(_LEAST_STEPS / each) // self._weight, 1)
            self._draw(goal, policy, longest or steps)
            yield

    @property
    def _spent(self) -> int:
        """How many transitions without code take as long as what has been drawn."""
        return self._transitions + self._instructions // _INSTRUCTIONS_OF_A_TRANSITION

    def _open(self) -> int | None:
        return next((goal for goal in self._goals if goal not in self._found), None)

    def _draw(self, goal: int, policy: _core.Policy, steps: int) -> None:
        number = self._numbers[policy]
        self._numbers[policy] += 1
        question = _core.RunQuestion()
        question.goal = goal
        trials = _core.trials(
            self._core,
            question,
            policy=policy,
            seed=_SEED,
            first=number,
            runs=1,
            threads=1,
            most_steps=steps,
            check=current_job().check,
        )
        is_reached, taken, instructions = trials.trial(0)
        self._transitions += max(taken, 1)
        self._instructions += instructions
        if is_reached:
            self._found[goal] = _FoundRun(policy, number, taken)

    @property
    def has_all(self) -> bool:
        return self._open() is None

    # ---- the interface of a search of the core ----------------------------------------------------------------------

    def reached(self, goal: int) -> int | None:
        found = self._found.get(goal)
        return None if found is None else found.transitions

    def path_to_goal(self, goal: int) -> list[list[int]]:
        """The actions of the run that was found, by the edges of the program. Raises StoppedError."""
        found = self._found[goal]
        (record,) = self._core.run(
            policy=found.policy,
            seed=_SEED,
            first=found.number,
            runs=1,
            until=_core.latest_end(),
            ticks_per_unit=_core.finest_ticks(),
            steps=found.transitions,
            threads=1,
            actions=True,
            observed=False,
            clocks=False,
            check=current_job().check,
        )
        return record.path()[: found.transitions]

    def failure(self, goal: int) -> None:
        return None

    def any_failure(self) -> bool:
        return False

    def statistics(self) -> tuple[int, int, int, int]:
        """No state is stored."""
        return 0, 0, self._transitions, 0


class _BudgetedRuns:
    """Draws one run a call, and ends with STATE_LIMIT where the budget is used up."""

    def __init__(self, runs: SimulatedRuns, drawn: Iterator[None]) -> None:
        self._runs, self._drawn = runs, drawn

    def run(
        self, expansions: int, seconds: float | None = None, poll: Callable[[], None] | None = None
    ) -> _core.Status:
        if seconds is not None and seconds <= 0:
            return _core.Status.TIME_LIMIT
        more = next(self._drawn, self) is not self
        if self._runs.has_all:
            return _core.Status.FINISHED
        return _core.Status.RUNNING if more else _core.Status.STATE_LIMIT

    def statistics(self) -> tuple[int, int, int, int]:
        return self._runs.statistics()


def _most_leaving(program: Program) -> int:
    """The largest number of edges that leave the locations of a state, at most."""
    leaving = Counter((edge.process, edge.source) for edge in program.edges)
    most: dict[int, int] = {}
    for (process, _), count in leaving.items():
        most[process] = max(most.get(process, 0), count)
    return sum(most.values())


def _unless_stuttering(edge: ProgramEdge) -> ProgramEdge:
    """The edge; one that changes nothing is never taken: it would be taken again and again while time stands still."""
    changes = edge.source != edge.target or edge.update != Update() or edge.channel >= 0
    never = Test(edge.process, Comparison.LESS, 0)
    return edge if changes else replace(edge, guard=replace(edge.guard, tests=(never,)))


def _equal_chances(program: Program) -> Chances:
    """Chances that prefer nothing: a search does not know those of the model."""
    one = Computed(constant=1)
    rates = tuple((one,) * len(locations) for locations in program.locations)
    return Chances(rates, tuple(range(len(program.edges))), (one,) * len(program.edges), ())
