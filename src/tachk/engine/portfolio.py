"""Searches of the core that may answer in the place of the ordinary one, which explores all states.

A portfolio as that of whole queries (`tachk.verify.strategies`): each row says how a search is begun, what can be
believed of its outcome, and how long it may take. The loop is `tachk.engine.zone.explore`. The rows without a budget
are tried first; the others once the ordinary search has stored many states, which it goes on with if they fail.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace

from tachk import _core
from tachk.base.job import OutOfMemoryError
from tachk.base.records import dataclass
from tachk.engine import local_times
from tachk.engine.compiler.program import Goal, Program
from tachk.engine.core_search import RunningSearch, core_limits, core_options, run_in_slices
from tachk.engine.options import Limits, Options, SearchOrder
from tachk.engine.program_image import encode
from tachk.transform.transformation import Exactness

ZoneSearch = _core.Explorer | _core.LocalExplorer

_STEP = 64


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
        after: how many states the ordinary search stores before; None: it comes before that.
        explored: its budget, in states that are explored. Where it is hit, the search has decided nothing.
        sample: after how many of them it is looked at whether the search pays.
        pays: whether it goes on after the sample.
    """

    name: str
    meaning: str
    begin: Callable[[SearchProblem], ZoneSearch | None]
    exactness: Exactness
    after: int | None = None
    explored: int | None = None
    sample: int = 0
    pays: Callable[[ZoneSearch, int], bool] = lambda search, explored: True

    def is_allowed(self, options: Options, limits: Limits) -> bool:
        if self.name in options.without:
            return False
        if self.after is None:
            return True
        of_use = limits.states is None or limits.states > self.after
        free = options.order is SearchOrder.AUTO and not options.shortest
        return of_use and free and "attempts" not in options.without

    def run(self, search: ZoneSearch) -> tuple[_core.Status, str]:
        """Runs the search within its budget: its last status, and why that is not FINISHED."""
        if self.explored is None:
            return run_in_slices(search, time.perf_counter())
        status, reason = run_in_slices(BudgetedSearch(search, explored=self.sample), time.perf_counter())
        if status is _core.Status.STATE_LIMIT and self.pays(search, self.sample):
            rest = BudgetedSearch(search, explored=self.explored - self.sample)
            status, reason = run_in_slices(rest, time.perf_counter())
        return status, reason

    def decides(self, problem: SearchProblem, search: ZoneSearch, status: _core.Status) -> bool:
        """True if the outcome of the search is that of the problem."""
        if isinstance(search, _core.LocalExplorer):
            failed = status in (_core.Status.FAULT, _core.Status.CONSTANT_LIMIT)
            return not failed or Exactness.ERRORS in self.exactness
        if status is _core.Status.FINISHED and Exactness.UNREACHABLE in self.exactness:
            return not search.any_failure()
        return all(search.reached(number) is not None for number, goal in enumerate(problem.goals) if goal.decides)

    def is_stopped(self, status: _core.Status, reason: str) -> bool:
        """True if the search was ended from outside; its memory is free again once it has ended."""
        outside = status in (_core.Status.RUNNING, _core.Status.TIME_LIMIT)
        return outside and bool(reason) and reason != OutOfMemoryError.reason


class BudgetedSearch:
    """A part of a search, which ends with the status STATE_LIMIT once so many states are stored, or explored."""

    def __init__(self, search: RunningSearch, *, stored: int | None = None, explored: int | None = None) -> None:
        self._search, self._stored, self._left = search, stored, explored
        self._until_check = 0

    def run(
        self, expansions: int, seconds: float | None = None, poll: Callable[[], None] | None = None
    ) -> _core.Status:
        end = None if seconds is None else time.perf_counter() + seconds
        while expansions > 0:
            if self._left == 0 or self._is_full():
                return _core.Status.STATE_LIMIT
            step = min(self._until_check, expansions, *(() if self._left is None else (self._left,)))
            status = self._search.run(step, None if end is None else max(end - time.perf_counter(), 0.0), poll)
            if status is not _core.Status.RUNNING:
                return status
            expansions -= step
            self._until_check -= step
            if self._left is not None:
                self._left -= step
        return _core.Status.RUNNING

    def _is_full(self) -> bool:
        """Looked at after every so many states, however the search is divided into calls."""
        if self._until_check > 0:
            return False
        self._until_check = _STEP
        return self._stored is not None and self.statistics()[1] >= self._stored

    def statistics(self) -> tuple[int, int, int, int]:
        return self._search.statistics()


def _over_local_times(problem: SearchProblem) -> _core.LocalExplorer | None:
    return local_times.begin(problem.program, problem.goals, problem.ordinary, problem.options, problem.limits)


def _in_one_order(problem: SearchProblem) -> _core.Explorer | None:
    deadlocks = any(goal.asks_deadlock for goal in problem.goals)
    if deadlocks or problem.program.interchangeable or problem.options.partial_order:
        return None
    if problem.limits.depth is not None:
        return None
    return _explorer(problem, problem.program, replace(problem.options, partial_order=True))


def _saves_many(search: ZoneSearch, explored: int) -> bool:
    """True if one order of actions was enough in a quarter of the states."""
    return isinstance(search, _core.Explorer) and 4 * search.reduced_states() >= explored


def _depth_first(problem: SearchProblem) -> _core.Explorer | None:
    """All processes keep their places in it: a state that stands for others would go on with other processes than those
    that have just come near to a goal."""
    if not all(goal.disjuncts for goal in problem.goals if goal.decides):
        return None
    without_symmetry = replace(problem.program, interchangeable=())
    return _explorer(problem, without_symmetry, replace(problem.options, order=SearchOrder.DFS))


def _explorer(problem: SearchProblem, program: Program, options: Options) -> _core.Explorer:
    return _core.Explorer(encode(program, problem.goals), core_options(options), core_limits(problem.limits))


PORTFOLIO = (
    SearchStrategy(
        "local-times",
        "let each process have a time of its own, where that is sound and seems to save states",
        _over_local_times,
        Exactness.SAME_STATES,
    ),
    SearchStrategy(
        "one-order",
        "explore some states with one order of independent actions where time cannot pass",
        _in_one_order,
        Exactness.SAME_STATES,
        after=20_000,
        explored=5_000,
        sample=256,
        pays=_saves_many,
    ),
    # Where fewer states are enough nothing is explored depth first: the runs that are found so are longer.
    SearchStrategy(
        "probe",
        "explore few states depth first, with processes that keep their places",
        _depth_first,
        Exactness.REACHABLE,
        after=20_000,
        explored=1_500,
    ),
)
"""The states that are explored within a budget are few beside those that have been stored."""
