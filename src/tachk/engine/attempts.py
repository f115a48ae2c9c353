"""Short searches beside one that has stored many states.

One looks depth first: a run that nothing hinders is found fast, however many states there are. What it does not find is
no answer. The other one takes one order of independent actions where time cannot pass: it answers if few states remain.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace

from tachk import _core
from tachk.base.job import OutOfMemoryError
from tachk.engine.compiler.program import Goal, Program
from tachk.engine.core_search import RunningSearch, core_limits, core_options, run_in_slices
from tachk.engine.options import Limits, Options, SearchOrder
from tachk.engine.program_image import encode

STORED = 20_000
"""Where fewer states are enough nothing else is tried: the runs that are found depth first are longer."""
EXPLORED = 1_500
"""So many states are explored depth first, which is little beside what has been stored."""
EXPLORED_IN_ONE_ORDER = 5_000
"""So many states are explored with one order of actions at most."""
FIRST_IN_ONE_ORDER = 256
"""After so many states it is looked at whether one order of actions was enough in a quarter of them."""
_STEP = 64
_ENDED_FROM_OUTSIDE = (_core.Status.RUNNING, _core.Status.TIME_LIMIT)


class BudgetedSearch:
    """A part of a search, which ends with the status STATE_LIMIT once so many states are stored, or explored."""

    def __init__(self, search: RunningSearch, *, stored: int | None = None, explored: int | None = None) -> None:
        self._search, self._stored, self._left = search, stored, explored
        self._to_look = 0

    def run(
        self, expansions: int, seconds: float | None = None, look: Callable[[], None] | None = None
    ) -> _core.Status:
        end = None if seconds is None else time.perf_counter() + seconds
        while expansions > 0:
            if self._left == 0 or self._is_full():
                return _core.Status.STATE_LIMIT
            step = min(self._to_look, expansions, *(() if self._left is None else (self._left,)))
            status = self._search.run(step, None if end is None else max(end - time.perf_counter(), 0.0), look)
            if status is not _core.Status.RUNNING:
                return status
            expansions -= step
            self._to_look -= step
            if self._left is not None:
                self._left -= step
        return _core.Status.RUNNING

    def _is_full(self) -> bool:
        """Looked at after every so many states, however the search is divided into calls."""
        if self._to_look > 0:
            return False
        self._to_look = _STEP
        return self._stored is not None and self.statistics()[1] >= self._stored

    def statistics(self) -> tuple[int, int, int, int]:
        return self._search.statistics()


def are_made(options: Options, limits: Limits) -> bool:
    """Whether other searches may answer for all goals."""
    return (
        "attempts" not in options.without
        and options.order is SearchOrder.AUTO
        and not options.shortest
        and (limits.states is None or limits.states > STORED)
    )


def in_one_order(
    program: Program, goals: Sequence[Goal], options: Options, limits: Limits
) -> tuple[_core.Explorer | None, str]:
    """A search that has decided all goals, or None; and why it was ended from outside, if it was."""
    deadlocks = any(goal.asks_deadlock for goal in goals)
    if deadlocks or program.interchangeable or options.partial_order or limits.depth is not None:
        return None, ""
    one = replace(options, partial_order=True)
    explorer = _core.Explorer(encode(program, goals), core_options(one), core_limits(limits))
    start = time.perf_counter()
    status, reason = run_in_slices(BudgetedSearch(explorer, explored=FIRST_IN_ONE_ORDER), start)
    if status is _core.Status.STATE_LIMIT and 4 * explorer.reduced_states() >= FIRST_IN_ONE_ORDER:
        stretch = BudgetedSearch(explorer, explored=EXPLORED_IN_ONE_ORDER - FIRST_IN_ONE_ORDER)
        status, reason = run_in_slices(stretch, time.perf_counter())
    decided = status is _core.Status.FINISHED and not explorer.any_failure()
    return explorer if decided else None, _ended_from_outside(status, reason)


def depth_first(
    program: Program, goals: Sequence[Goal], options: Options, limits: Limits
) -> tuple[_core.Explorer | None, str]:
    """A search that has reached all goals that decide, or None; and why it was ended from outside, if it was.

    All processes keep their places in it: a state that stands for others would go on with other processes than those
    that have just come near to a goal.
    """
    if not all(goal.disjuncts for goal in goals if goal.decides):
        return None, ""
    deep = replace(options, order=SearchOrder.DFS)
    apart = replace(program, interchangeable=())
    explorer = _core.Explorer(encode(apart, goals), core_options(deep), core_limits(limits))
    status, reason = run_in_slices(BudgetedSearch(explorer, explored=EXPLORED), time.perf_counter())
    reached = all(explorer.reached(number) is not None for number, goal in enumerate(goals) if goal.decides)
    return explorer if reached else None, _ended_from_outside(status, reason)


def _ended_from_outside(status: _core.Status, reason: str) -> str:
    """Why an attempt was ended from outside; not where its memory is free again when it has ended."""
    return reason if status in _ENDED_FROM_OUTSIDE and reason != OutOfMemoryError.reason else ""
