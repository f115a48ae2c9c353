"""Searches of the core that may answer in the place of the ordinary one, which explores all states.

A portfolio as that of whole queries (`tachk.verify.strategies`): each row says how a search is begun, what can be
believed of its outcome, and how long it may take. The loop is `tachk.engine.taking_turns`. A row has its turn once the
ordinary search has done so much work, and that search goes on if the row decides nothing. A row that grows has its
turn again each time the ordinary search has done twice as much, with a budget in proportion. Work is counted in states
of a small network (`Explorer::effort`), not in seconds, so that the same run is found each time.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from tachk import _core
from tachk.base.job import OutOfMemoryError
from tachk.base.records import dataclass, replace
from tachk.engine.compiler.program import Goal, Program
from tachk.engine.core_search import MeasuredSearch, core_limits, core_options, run_in_slices
from tachk.engine.options import Limits, LocalTimes, Options, SearchOrder
from tachk.engine.program_image import encode
from tachk.transform.transformation import Exactness

if TYPE_CHECKING:
    from tachk.engine.simulated_runs import SimulatedRuns

    GoalSearch = _core.Explorer | _core.LocalExplorer | SimulatedRuns

_STEP = 256
_HUNDREDTHS_OF_A_SECOND, _WORK_BEFORE_AN_EDGE = 5_000, 75
"""The work of some, and how much of it for each edge of a program: turns after that are so small, and begin so soon,
that they are not noticed."""
_EARLY, _LARGE_ZONE = 500, 10_000
_TENTH_OF_A_SECOND = 20_000
"""The work of about so long. Where less is enough the search answers by itself: others find longer runs."""
BESIDE_FROM = _TENTH_OF_A_SECOND
"""From so much work on, turns are taken beside the search where there are cores: a thread is begun for them."""
_STATES_OF_A_RUN, _ZONES_OF_A_RUN = 16, 3
"""What a run depth first may take: states for each process, and zones for each pair of processes. In TChecker's leader
election it takes 12 and 2.3."""
_ENTRIES_AS_LONG = 1024
"""To compute so many entries of a zone takes as long as a state of a small network."""
_LONG = 2_000_000
"""A search that has done so much work has taken some ten seconds, and is likely to take many more."""


@dataclass(frozen=True, slots=True)
class SearchProblem:
    """Goals of a program.

    Attributes:
        ordinary: the search that explores all states. It may have explored some.
    """

    program: Program
    goals: Sequence[Goal]
    options: Options
    limits: Limits
    ordinary: _core.Explorer


@dataclass(frozen=True, slots=True)
class SearchStrategy:
    """A row of the table.

    Attributes:
        name: one word, for `--without`.
        meaning: what it does, in a sentence.
        begin: the search; None where it is not sound, or would hardly pay.
        exactness: what can be believed of its outcome.
        after: how much work the ordinary search does before.
        explored: the budget of its first turn, in states that are explored. Where it is hit, the search has decided
            nothing.
        work: its budget as work.
        fitted: the row for a problem, where that decides when the row begins and how much work it may do.
        share: of the work of the ordinary search, its budgets behind the first one; 0: it has one turn.
        long_share: the same where the ordinary search takes long.
        sample: after how many explored states it is looked at whether the search pays.
        pays: whether it goes on after the sample.
        early_work: the budget of a turn before the first one, after hundredths of a second; 0: there is none.
        short_work: the budget of a turn that looks for short runs before there is a search beside it; 0: there is none.
        longest: how many steps a run that is drawn may take; None: as many as its part of the budget allows.
        next_turn: that behind this one, if it is not one with a budget in proportion.
    """

    name: str
    meaning: str
    begin: Callable[[SearchProblem], GoalSearch | None]
    exactness: Exactness
    after: int
    explored: int | None = None
    work: int | None = None
    fitted: Callable[[SearchStrategy, SearchProblem], SearchStrategy] = lambda row, problem: row
    share: float = 0.0
    long_share: float = 0.0
    sample: int = 0
    pays: Callable[[GoalSearch, int], bool] = lambda search, explored: True
    early_work: int = 0
    short_work: int = 0
    longest: int | None = None
    next_turn: SearchStrategy | None = None

    @property
    def is_bounded(self) -> bool:
        """True if it has a budget."""
        return self.explored is not None or self.work is not None

    def is_allowed(self, options: Options, limits: Limits) -> bool:
        if self.name in options.without:
            return False
        if not self.is_bounded:
            return True
        of_use = limits.states is None or limits.states > self.after
        free = options.order is SearchOrder.AUTO and not options.shortest
        return of_use and free and "attempts" not in options.without

    def from_the_start(self, program: Program) -> SearchStrategy:
        """The row for its first turn of all."""
        after = max(_HUNDREDTHS_OF_A_SECOND, _WORK_BEFORE_AN_EDGE * len(program.edges))
        if not self.early_work or after >= self.after:
            return self
        return replace(self, after=after, work=self.early_work, explored=None, next_turn=self)

    def later(self) -> SearchStrategy:
        """The row for its next turn."""
        if self.next_turn is not None:
            return self.next_turn
        assert self.work is not None
        after = max(2 * self.after, int(2 * self.work / self._share_at(self.after)))
        return replace(self, after=after, work=int(after * self._share_at(after)), explored=None)

    def _share_at(self, effort: int) -> float:
        return self.share if effort < _LONG else self.long_share

    def run(self, search: _core.Explorer | SimulatedRuns) -> tuple[_core.Status, str]:
        """Runs the search within its budget: its last status, and why that is not FINISHED."""
        begun = time.perf_counter()
        if not isinstance(search, _core.Explorer):
            return run_in_slices(search.budgeted(self.work or 0, self.longest), begun)
        if self.work is not None:
            part = BudgetedSearch(search, effort=search.effort() + self.work, explored=self.explored)
            return run_in_slices(part, begun)
        assert self.explored is not None
        status, reason = run_in_slices(BudgetedSearch(search, explored=self.sample), begun)
        if status is _core.Status.STATE_LIMIT and self.pays(search, self.sample):
            rest = BudgetedSearch(search, explored=self.explored - self.sample)
            status, reason = run_in_slices(rest, time.perf_counter())
        return status, reason

    def decides(self, problem: SearchProblem, search: GoalSearch, status: _core.Status) -> bool:
        """True if the outcome of the search is that of the problem."""
        if isinstance(search, _core.LocalExplorer):
            failed = status in (_core.Status.FAULT, _core.Status.CONSTANT_LIMIT)
            return not failed or Exactness.ERRORS in self.exactness
        if status is _core.Status.FINISHED and Exactness.UNREACHABLE in self.exactness:
            return not search.any_failure()
        return all(search.reached(number) is not None for number, goal in enumerate(problem.goals) if goal.decides)

    @staticmethod
    def is_stopped(status: _core.Status, reason: str) -> bool:
        """True if the search was ended from outside; its memory is free again once it has ended."""
        outside = status in (_core.Status.RUNNING, _core.Status.TIME_LIMIT)
        return outside and bool(reason) and reason != OutOfMemoryError.reason


class BudgetedSearch:
    """A part of a search, which ends with the status STATE_LIMIT once it has done so much work, or explored so many."""

    def __init__(self, search: MeasuredSearch, *, effort: int | None = None, explored: int | None = None) -> None:
        self._search, self._effort, self._left = search, effort, explored
        self._until_check = 0
        self._step = 1
        self.is_used_up = False
        """Whether the budget has ended it, and not a limit of the search."""

    def run(
        self, expansions: int, seconds: float | None = None, poll: Callable[[], None] | None = None
    ) -> _core.Status:
        end = None if seconds is None else time.perf_counter() + seconds
        while expansions > 0:
            if self._left == 0 or self._is_full():
                self.is_used_up = True
                return _core.Status.STATE_LIMIT
            step = min(self._until_check, expansions, *(() if self._left is None else (self._left,)))
            status = self._search.run(step, None if end is None else max(end - time.perf_counter(), 0.0), poll)
            if status is not _core.Status.RUNNING:
                return status
            if poll is not None:
                poll()
            expansions -= step
            self._until_check -= step
            if self._left is not None:
                self._left -= step
        return _core.Status.RUNNING

    def _is_full(self) -> bool:
        """Looked at after 1, 2, 4 ... states, then after every so many, however the search is divided into calls."""
        if self._until_check > 0:
            return False
        self._until_check, self._step = self._step, min(2 * self._step, _STEP)
        return self._effort is not None and self._search.effort() >= self._effort

    def statistics(self) -> tuple[int, int, int, int]:
        return self._search.statistics()


def _once_a_sample_is_little(row: SearchStrategy, problem: SearchProblem) -> SearchStrategy:
    """The sample that decides whether local times pay takes long with many clocks: a run may be found before."""
    if problem.options.local_times is not LocalTimes.AUTO:
        return replace(row, after=0)
    entries = (problem.program.clocks + len(problem.program.locations)) ** 2
    return row if entries < _LARGE_ZONE else replace(row, after=_TENTH_OF_A_SECOND + 1)


def _with_many_processes(row: SearchStrategy, problem: SearchProblem) -> SearchStrategy:
    """A run in which each process takes some steps passes so many states in proportion to their number, and in each as
    many processes may have a successor: a budget for small networks would end far before the goal."""
    assert row.work is not None
    processes, clocks = len(problem.program.locations), problem.program.clocks
    zones = _ZONES_OF_A_RUN * processes**2
    work = zones + zones * (clocks + 1) ** 2 // _ENTRIES_AS_LONG
    if work <= row.work:
        return row
    return replace(row, after=max(row.after, 2 * work), work=work, explored=_STATES_OF_A_RUN * processes)


def _over_local_times(problem: SearchProblem) -> _core.LocalExplorer | None:
    from tachk.engine import local_times

    return local_times.begin(problem.program, problem.goals, problem.ordinary, problem.options, problem.limits)


def _in_one_order(problem: SearchProblem) -> _core.Explorer | None:
    deadlocks = any(goal.asks_deadlock for goal in problem.goals)
    if deadlocks or problem.program.interchangeable or problem.options.partial_order:
        return None
    if problem.limits.depth is not None:
        return None
    return _explorer(problem, problem.program, replace(problem.options, partial_order=True))


def _saves_many(search: GoalSearch, explored: int) -> bool:
    """True if one order of actions was enough in a quarter of the states."""
    return isinstance(search, _core.Explorer) and 4 * search.reduced_states() >= explored


def _depth_first(problem: SearchProblem) -> _core.Explorer | None:
    """All processes keep their places in it: a state that stands for others would go on with other processes than those
    that have just come near to a goal."""
    if not all(goal.disjuncts for goal in problem.goals if goal.decides):
        return None
    without_symmetry = replace(problem.program, interchangeable=())
    return _explorer(problem, without_symmetry, replace(problem.options, order=SearchOrder.DFS))


def _best_first(problem: SearchProblem) -> _core.Explorer | None:
    """With one goal only: the way to the nearest of several is seldom that to the others."""
    if problem.limits.depth is not None or sum(goal.decides for goal in problem.goals) != 1:
        return None
    without_symmetry = replace(problem.program, interchangeable=())
    return _explorer(problem, without_symmetry, replace(problem.options, order=SearchOrder.BEST_FIRST))


def _simulated(problem: SearchProblem) -> SimulatedRuns | None:
    """Not where clocks stop: what is found has to be found by zones as well, which are not exact there."""
    if problem.limits.depth is not None or problem.program.has_stopwatches:
        return None
    if any(goal.asks_deadlock or not goal.disjuncts for goal in problem.goals if goal.decides):
        return None
    from tachk.engine.simulated_runs import SimulatedRuns

    return SimulatedRuns(problem.program, problem.goals)


def _explorer(problem: SearchProblem, program: Program, options: Options) -> _core.Explorer:
    return _core.Explorer(encode(program, problem.goals), core_options(options), core_limits(problem.limits))


PORTFOLIO = (
    SearchStrategy(
        "simulated",
        "draw runs by several policies of choosing moments",
        _simulated,
        Exactness.REACHABLE,
        after=_TENTH_OF_A_SECOND,
        work=2_500,
        early_work=150,
        short_work=16,
        share=1 / 64,
        long_share=3 / 64,
    ),
    SearchStrategy(
        "local-times",
        "let each process have a time of its own, where that is sound and seems to save states",
        _over_local_times,
        Exactness.SAME_STATES,
        after=_EARLY,
        fitted=_once_a_sample_is_little,
    ),
    SearchStrategy(
        "best-first",
        "explore the states first that are nearest to the goal",
        _best_first,
        Exactness.REACHABLE,
        after=_TENTH_OF_A_SECOND,
        work=500,
        early_work=100,
        short_work=100,
        share=1 / 64,
        long_share=1 / 64,
    ),
    SearchStrategy(
        "one-order",
        "explore some states with one order of independent actions where time cannot pass",
        _in_one_order,
        Exactness.SAME_STATES,
        after=2 * _TENTH_OF_A_SECOND,
        explored=5_000,
        sample=256,
        pays=_saves_many,
    ),
    SearchStrategy(
        "probe",
        "explore few states depth first, with processes that keep their places",
        _depth_first,
        Exactness.REACHABLE,
        after=2 * _TENTH_OF_A_SECOND,
        work=5_000,
        early_work=400,
        fitted=_with_many_processes,
        share=1 / 64,
        long_share=1 / 64,
    ),
)
"""What is explored within the budgets is little beside the work that has been done."""
