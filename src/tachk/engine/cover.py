"""Closed sets of symbolic states that meet no goal: what certificates are made of, found by the core."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Sequence

from tachk import _core
from tachk.base.job import check_job, current_job
from tachk.base.records import dataclass, replace
from tachk.engine.compiler.program import Goal, Program
from tachk.engine.core_search import core_limits, core_options, run_in_slices
from tachk.engine.options import LARGEST_SEED, NEVER, Extrapolation, Limits, Options
from tachk.engine.program_image import encode
from tachk.engine.traps import image_of_trap
from tachk.meaning.judge.certificate import StateBlock
from tachk.meaning.judge.trap import Trap

ZONES_IN_A_BLOCK = 4096

_TURN = 256
"""The number of states that a search explores before it is the turn of the other one."""
_AGAIN = 2
"""After one search has ended, the other one may go on until it has explored this many times as many states, or stores
this many times as many zones as the cover that was found."""
_SHORT = 10_000
"""So many states a search may explore in any case."""
_SEVERAL = 1.5
"""From so many zones for a discrete state on it pays to look for one each."""
_STEPS_FOR_A_ZONE = 20


@dataclass(frozen=True, slots=True)
class Cover:
    """A set that covers all reachable states, except for dropped ones, and none that satisfies the goal, according to
    the core.

    Attributes:
        groups: how many discrete states it has.
        zones: how many zones.
        blocks: a function that goes through it.
    """

    groups: int
    zones: int
    blocks: Callable[[], Iterator[StateBlock]]


@dataclass(frozen=True, slots=True)
class Dropped:
    """The states that need not be covered: those that lie in one trap of each clause, if there are clauses.

    Attributes:
        clauses: numbers of traps.
    """

    traps: tuple[Trap, ...] = ()
    clauses: tuple[tuple[int, ...], ...] = ()

    def search(
        self, image: Sequence[int], options: _core.Options, limits: _core.Limits, hulls: bool
    ) -> _core.CoverSearch:
        traps = list(map(image_of_trap, self.traps))
        return _core.CoverSearch(image, options, limits, hulls=hulls, traps=traps, clauses=self.clauses)


def find_cover(program: Program, goal: Goal, options: Options, limits: Limits, dropped: Dropped) -> Cover | str:
    """The smallest of some covers, or the reason why there is none: `_TwoSearches` finds two, `_single` one.

    With the bounds of LU a goal that asks for deadlock may seem reachable that is not; the maximum bounds are tried
    then.
    """
    for bounds in dict.fromkeys((options.extrapolation, Extrapolation.MAX)):
        chosen = replace(options, extrapolation=bounds)
        searches = _TwoSearches(program, goal, chosen, replace(limits, depth=None), dropped)
        status, reason = run_in_slices(searches, time.perf_counter())
        best = searches.best()
        if best is not None:
            single = _single(program, goal, options, best, searches.statistics()[0], dropped)
            return best if single is None or single.zones >= best.zones else single
        if status is not _core.Status.FINISHED:
            return reason
    return "a state that satisfies the goal is reachable, or seems to be"


class _TwoSearches:
    """Two searches for a cover that take turns. One keeps a single zone for each discrete state, as far as it can; this
    may take it long, as it begins anew where that zone meets the goal. The other one keeps all zones, as the search for
    the answer does.

    Hulls may reach discrete states that are not reachable, so that either cover may be the smaller one. Each search
    bounds the other: neither costs much more than the one that ends first. Turns are counted in states, so that the
    same cover comes out each time.
    """

    def __init__(self, program: Program, goal: Goal, options: Options, limits: Limits, dropped: Dropped) -> None:
        image, taken, self._limits = encode(program, [goal]), core_options(options), limits
        self._all = [dropped.search(image, taken, core_limits(limits), hulls) for hulls in (False, True)]
        self._running = list(self._all)
        self._covers: list[Cover] = []
        self._most: float = math.inf

    def run(
        self, expansions: int, seconds: float | None = None, poll: Callable[[], None] | None = None
    ) -> _core.Status:
        """Explores so many states or some more, as far as there are any. FINISHED also if a goal is reached;
        then there is no cover."""
        end = None if seconds is None else time.perf_counter() + seconds
        for _ in range(expansions // _TURN + 1):
            for search in tuple(self._all):
                left = None if end is None else max(end - time.perf_counter(), 0.0)
                status = search.run(_TURN, left, poll) if search in self._running else _core.Status.RUNNING
                if status is _core.Status.TIME_LIMIT:
                    return status
                if status is not _core.Status.RUNNING and self._ends(search, status):
                    return status
            self._running = [search for search in self._running if self._is_hopeful(search)]
            if not self._running:
                return _core.Status.FINISHED
            self._save_memory()
        return _core.Status.RUNNING

    def _ends(self, search: _core.CoverSearch, status: _core.Status) -> bool:
        """True if all is said when one search has ended."""
        self._running.remove(search)
        if status is not _core.Status.FINISHED:
            return not self._running and not self._covers
        if search.reached():
            self._running.clear()
            return True
        self._covers.append(_cover_of(search.cover()))
        self._most = _AGAIN * search.statistics()[0]
        if search is self._all[0] and self._covers[-1].zones == self._covers[-1].groups:
            self._running.clear()
        return False

    def _is_hopeful(self, search: _core.CoverSearch) -> bool:
        """True if a search may go on. Stored zones are covered by others now and then, but hardly most of them."""
        best = self.best()
        explored, stored, *_ = search.statistics()
        return explored < _SHORT or best is None or (explored < self._most and stored <= _AGAIN * best.zones)

    def _save_memory(self) -> None:
        limit = self._limits.memory_bytes
        if limit is not None and len(self._running) > 1 and self.statistics()[3] > limit:
            self._all.remove(self._running.pop())

    def best(self) -> Cover | None:
        """The cover with the fewest zones."""
        return min(self._covers, key=lambda cover: cover.zones, default=None)

    def statistics(self) -> tuple[int, int, int, int]:
        """The sums over both searches: states explored and stored, transitions, bytes."""
        explored, stored, transitions, size = (
            sum(numbers) for numbers in zip(*(search.statistics() for search in self._all), strict=True)
        )
        return explored, stored, transitions, size


def _single(
    program: Program, goal: Goal, options: Options, best: Cover, explored: int, dropped: Dropped
) -> Cover | None:
    """A cover with the smallest zone for each discrete state, if several have more than one zone and a short search
    ends with one.

    Bounds that an abstraction has dropped can be those that keep one zone from meeting the goal. Without abstraction a
    search need not end, so that it may only explore some times as many states as the best cover known has zones, and
    not many more than have been explored to find that one.
    """
    if best.zones <= _SEVERAL * best.groups:
        return None
    exact = replace(options, extrapolation=Extrapolation.NONE)
    search = dropped.search(encode(program, [goal]), core_options(exact), core_limits(Limits()), True)
    for _ in range(min(_STEPS_FOR_A_ZONE * best.zones, max(_SHORT, explored)) // _TURN + 1):
        check_job()
        status = search.run(_TURN, current_job().seconds_left, current_job().check_memory)
        if status is not _core.Status.RUNNING:
            return _cover_of(search.cover()) if status is _core.Status.FINISHED and not search.reached() else None
    return None


def find_descent(program: Program, goals: Sequence[Goal], options: Options, limits: Limits) -> Cover | str:
    """A ranked cover that proves that no run avoids the first goal, from the initial state or from each reachable state
    of the second one; or the reason why there is none.

    It consists of the states that a search has explored, each with a rank that is larger than those of the states that
    an action leads to; where there is a second goal, all reachable states come with the rank 0. The clock bounds of
    the program must be as for `tachk.engine.liveness.find_avoiding_run`.
    """
    for bounds in dict.fromkeys((options.extrapolation, Extrapolation.MAX)):
        plain = replace(
            options,
            extrapolation=bounds,
            reclaim=False,
            pack_clocks=LARGEST_SEED,
            subsumption=True,
            proof_after=NEVER,
        )
        search = _core.LivenessSearch(encode(program, goals), core_options(plain), core_limits(limits))
        status, reason = run_in_slices(search, time.perf_counter())
        if status is not _core.Status.FINISHED:
            return reason
        if search.violation() is None:
            return _cover_of(search.cover())
    return "there is a run that avoids it, or seems to be"


def _cover_of(parts: _core.CoverParts) -> Cover:
    groups = parts.groups()

    def blocks() -> Iterator[StateBlock]:
        first = 0
        while first < groups:
            discretes, of_groups, *columns = parts.part(first, ZONES_IN_A_BLOCK)
            yield StateBlock(discretes.reshape(len(of_groups), -1), of_groups, *columns)
            first += len(of_groups)

    return Cover(groups, parts.zones(), blocks)
