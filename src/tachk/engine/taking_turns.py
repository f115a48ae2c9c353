"""The searches of the portfolio in turns: the main one, which explores all states, and those that may answer before.

With more than one core the turns behind the first tenth of a second are taken beside the main search, in a second
thread, and it goes on meanwhile. The order of the turns decides and not the clock: a turn counts as if the main search
had waited for it. So the answer, its run and its numbers are those of one core.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import TYPE_CHECKING

from tachk import _core
from tachk.base.job import StoppedError, note_interruption, stopped_if
from tachk.base.records import dataclass, replace
from tachk.engine.core_search import run_in_slices, statistics_of, user_seconds
from tachk.engine.options import Options
from tachk.engine.outcome import INTERRUPTED, Statistics
from tachk.engine.portfolio import BESIDE_FROM, PORTFOLIO, BudgetedSearch, SearchProblem, SearchStrategy

if TYPE_CHECKING:
    from threading import Event

    from tachk.engine.beside import WorkBeside
    from tachk.engine.portfolio import GoalSearch
    from tachk.engine.simulated_runs import SimulatedRuns

Begun = tuple[float, float]
"""The time, and the time in user mode, when a search began."""


@dataclass(frozen=True, slots=True)
class EndedSearch:
    """A search that has ended, with its last status and why that is not FINISHED.

    Attributes:
        name: of the row of the portfolio, if it has a budget.
    """

    search: GoalSearch
    status: _core.Status
    reason: str
    statistics: Statistics
    name: str = ""


def measured(search: GoalSearch, begun: Begun) -> Statistics:
    found = replace(statistics_of(search, begun[0]), user_seconds=user_seconds() - begun[1])
    lost = search.lost() if isinstance(search, _core.Explorer) else 0
    return replace(found, local_times=isinstance(search, _core.LocalExplorer), lost=lost)


def from_portfolio(problem: SearchProblem, begun: Begun, stands: Callable[[GoalSearch], bool]) -> EndedSearch:
    """How the first search ended that decides, or that is stopped.

    Raises MemoryError and OutOfMemoryError.

    Args:
        stands: whether what a search has reached is no mere appearance.
    """
    turns = _Turns(problem, begun, stands)
    try:
        return turns.ended()
    except KeyboardInterrupt:  # between two searches
        note_interruption()
        ordinary = problem.ordinary
        return EndedSearch(ordinary, _core.Status.RUNNING, INTERRUPTED, measured(ordinary, begun))
    finally:
        turns.stop()


class _Turn:
    """A turn of a row."""

    def __init__(self, search: _core.Explorer | SimulatedRuns) -> None:
        self.search = search
        self.done: Event | None = None
        """Set at its end; None if it was taken at once."""
        self.status = _core.Status.RUNNING
        """The last one of the search."""


class _Turns:
    def __init__(self, problem: SearchProblem, begun: Begun, stands: Callable[[GoalSearch], bool]) -> None:
        self._problem, self._begun, self._stands = problem, begun, stands
        self._main = _MainSearch(problem, begun)
        self._has_cores = _has_cores(problem.options)
        self._beside: WorkBeside | None = None
        self._taken: dict[str, _Turn] = {}
        self._last_beside: Event | None = None
        self._found: EndedSearch | None = None
        self._stopped: tuple[_core.Status, str] | None = None

    def ended(self) -> EndedSearch:
        options, limits = self._problem.options, self._problem.limits
        fitted = (row.fitted(row, self._problem).from_the_start(self._problem.program) for row in PORTFOLIO)
        rows = [row for row in fitted if row.is_allowed(options, limits)]
        while rows:
            row = min(rows, key=lambda row: row.after)
            if row.after > 0 and (ended := self._main.run(self._is_over, row.after)) is not None:
                return self._first_of(ended)
            rows.remove(row)
            search = self._search_of(row)
            if isinstance(search, _core.LocalExplorer):
                self._main.continue_with(row, search)
            elif search is not None:
                if (ended := self._take(row, search)) is not None:
                    return ended
                if row.share > 0 and (later := row.later()).is_allowed(options, limits):
                    rows.append(later)
        return self._first_of(self._main.to_the_end(self._is_over))

    def _search_of(self, row: SearchStrategy) -> GoalSearch | None:
        """The search of a row, from where its last turn has left it; None if it has nothing to do."""
        before = self._taken.pop(row.name, None)
        if before is None:
            return row.begin(self._problem)
        if before.done is not None:
            self._wait(before.done)
        return before.search if before.status is _core.Status.STATE_LIMIT else None

    def _take(self, row: SearchStrategy, search: _core.Explorer | SimulatedRuns) -> EndedSearch | None:
        """A turn: how the search ended, if it is known at once that this is the end."""
        turn = self._taken[row.name] = _Turn(search)
        before = self._main.statistics()

        def is_last() -> bool:
            turn.status, reason = row.run(search)
            if row.decides(self._problem, search, turn.status) and self._stands(search):
                of_both = before.then(measured(search, self._begun))
                self._found = EndedSearch(search, _core.Status.FINISHED, "", of_both, row.name)
                return True
            if row.is_stopped(turn.status, reason):
                self._stopped = turn.status, reason
                return True
            return False

        if self._has_cores and row.after >= BESIDE_FROM:
            turn.done = self._last_beside = self._add_beside(is_last)
            return None
        return self._first() if is_last() else None

    def _add_beside(self, work: Callable[[], bool]) -> Event:
        if self._beside is None:
            from tachk.engine.beside import WorkBeside

            self._beside = WorkBeside()
        return self._beside.add(work)

    def _wait(self, done: Event) -> None:
        assert self._beside is not None
        self._beside.wait(done)

    def _is_over(self) -> bool:
        return self._beside is not None and self._beside.is_over

    def stop(self) -> None:
        """Ends what is done beside."""
        if self._beside is not None:
            self._beside.stop()

    def _first_of(self, main: EndedSearch) -> EndedSearch:
        """The end that counts: that of the main search, or of a turn that was taken before it."""
        is_stopped = SearchStrategy.is_stopped(main.status, main.reason)
        if self._last_beside is not None and (self._is_over() or not is_stopped):
            try:
                self._wait(self._last_beside)
            except KeyboardInterrupt:
                note_interruption()
                return self._found or main
        return self._first() if main.reason == StoppedError.reason else self._found or main

    def _first(self) -> EndedSearch:
        """The end where a turn was the last."""
        if self._found is not None:
            return self._found
        assert self._stopped is not None
        return self._main.stopped_by(self._stopped)


class _MainSearch:
    """The search that explores all states: the ordinary one, or that over local times as long as nothing stops it."""

    def __init__(self, problem: SearchProblem, begun: Begun) -> None:
        self._problem, self._begun = problem, begun
        self._search: _core.Explorer | _core.LocalExplorer = problem.ordinary
        self._row: SearchStrategy | None = None

    def continue_with(self, row: SearchStrategy, search: _core.LocalExplorer) -> None:
        """From now on this search of a row of the portfolio is the main one, and its states are those that count."""
        self._row, self._search = row, search

    def run(self, is_unneeded: Callable[[], bool], effort: int | None = None) -> EndedSearch | None:
        """Goes on until so much work is done: how the search ended, if it did.

        Args:
            is_unneeded: tells if something else has decided: the search is stopped soon after.
        """
        while True:
            part = BudgetedSearch(self._search, effort=effort)
            with stopped_if(is_unneeded):
                status, reason = run_in_slices(part, self._begun[0])
            if part.is_used_up:
                return None
            if (ended := self._ended(status, reason)) is not None:
                return ended

    def to_the_end(self, is_unneeded: Callable[[], bool]) -> EndedSearch:
        ended = self.run(is_unneeded)
        assert ended is not None
        return ended

    def _ended(self, status: _core.Status, reason: str) -> EndedSearch | None:
        """The end of the search; None where the ordinary one has to go on in its place."""
        if self._row is None or self._row.decides(self._problem, self._search, status):
            return EndedSearch(self._search, status, reason, measured(self._search, self._begun))
        self._row, self._search = None, self._problem.ordinary
        return self.stopped_by((status, reason)) if SearchStrategy.is_stopped(status, reason) else None

    def stopped_by(self, stopped: tuple[_core.Status, str]) -> EndedSearch:
        """The end of the ordinary search where another one was stopped from outside."""
        ordinary = self._problem.ordinary
        return EndedSearch(ordinary, *stopped, measured(ordinary, self._begun))

    def statistics(self) -> Statistics:
        """The work that was done, for another search that has the same clock."""
        return replace(measured(self._search, self._begun), seconds=0.0, user_seconds=0.0)


def _has_cores(options: Options) -> bool:
    return options.processes > 1 or (options.processes == 0 and (os.cpu_count() or 1) > 1)
