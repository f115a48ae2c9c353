"""Closed sets of symbolic states that meet no goal: what certificates are made of, found by the core."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from tachk import _core
from tachk.certify.certificate import Block
from tachk.compiler.program import Goal, Program
from tachk.engines.core_search import core_limits, core_options, run_in_slices
from tachk.engines.options import LARGEST_SEED, NEVER, Extrapolation, Limits, Options
from tachk.engines.outcome import Progress
from tachk.engines.program_image import encode
from tachk.records import dataclass
from tachk.time_limit import check_time

ZONES_IN_A_BLOCK = 4096

_SLICE = 256
_SEVERAL = 1.5
"""From so many zones for a discrete state on it pays to look for one each."""
_STEPS_FOR_A_ZONE = 20


@dataclass(frozen=True, slots=True)
class Cover:
    """A set that covers all reachable states and none that satisfies the goal, as the core claims.

    Attributes:
        groups: how many discrete states it has.
        zones: how many zones.
        blocks: a function that goes through it.
    """

    groups: int
    zones: int
    blocks: Callable[[], Iterator[Block]]


def find_cover(
    program: Program, goal: Goal, options: Options, limits: Limits, progress: Progress | None = None
) -> Cover | str:
    """The smallest of some covers, or the reason why there is none: one has as few zones as can be for each discrete
    state, another no more discrete states than the search stores; see `_single` for the third.

    Hulls may reach discrete states that are not reachable, so that either may be the smaller one. With the bounds of LU
    a goal that asks for deadlock may seem reachable that is not; the maximum bounds are tried then.
    """
    started = time.perf_counter()
    reason = "a state that satisfies the goal is reachable, or seems to be"
    for bounds in dict.fromkeys((options.extrapolation, Extrapolation.MAX)):
        covers = []
        for hulls in (True, False):
            left = limits.after(time.perf_counter() - started)
            found = _search(program, goal, replace(options, extrapolation=bounds), left, hulls, progress)
            if isinstance(found, Cover):
                covers.append(found)
            elif found:
                return min(covers, key=lambda cover: cover.zones) if covers else found
        if covers:
            best = min(covers, key=lambda cover: cover.zones)
            single = _single(program, goal, options, best) if best.zones > _SEVERAL * best.groups else None
            return best if single is None or single.zones >= best.zones else single
    return reason


def _single(program: Program, goal: Goal, options: Options, best: Cover) -> Cover | None:
    """A cover with the smallest zone for each discrete state, if a short search ends with one.

    Bounds that an abstraction has dropped can be those that keep one zone from meeting the goal. Without abstraction a
    search need not end, so that it may only explore some times as many states as the best cover known has zones.
    """
    exact = replace(options, extrapolation=Extrapolation.NONE)
    search = _core.CoverSearch(encode(program, [goal]), core_options(exact), core_limits(Limits()), hulls=True)
    for _ in range(_STEPS_FOR_A_ZONE * best.zones // _SLICE + 1):
        check_time()
        status = search.run(_SLICE)
        if status is not _core.Status.RUNNING:
            return _told(search.cover()) if status is _core.Status.FINISHED and not search.reached() else None
    return None


def _search(
    program: Program, goal: Goal, options: Options, limits: Limits, hulls: bool, progress: Progress | None
) -> Cover | str:
    """A cover; or why the search ended, empty where it has reached the goal."""
    search = _core.CoverSearch(
        encode(program, [goal]), core_options(options), core_limits(replace(limits, depth=None)), hulls=hulls
    )
    status, reason = run_in_slices(search, time.perf_counter(), limits, progress)
    if status is not _core.Status.FINISHED:
        return reason
    if search.reached():
        return ""
    return _told(search.cover())


def find_descent(
    program: Program, goals: Sequence[Goal], options: Options, limits: Limits, progress: Progress | None = None
) -> Cover | str:
    """What shows that no run avoids the first goal, from the initial state or from each reachable state of the second
    one; or the reason why there is none.

    It consists of the states that a search has gone through, each with a rank that is larger than those of the states
    that an action leads to; where there is a second goal, all reachable states come with the rank 0. The clock bounds
    of the program must be as for `tachk.engines.liveness.find_avoiding_run`.
    """
    started = time.perf_counter()
    for bounds in dict.fromkeys((options.extrapolation, Extrapolation.MAX)):
        plain = replace(
            options,
            extrapolation=bounds,
            reclaim=False,
            pack_clocks=LARGEST_SEED,
            passing=0,
            subsumption=True,
            proof_after=NEVER,
        )
        search = _core.LivenessSearch(encode(program, goals), core_options(plain), core_limits(limits))
        left = limits.after(time.perf_counter() - started)
        status, reason = run_in_slices(search, time.perf_counter(), left, progress)
        if status is not _core.Status.FINISHED:
            return reason
        if search.violation() is None:
            return _told(search.cover())
    return "there is a run that avoids it, or seems to be"


def _told(parts: _core.CoverParts) -> Cover:
    groups = parts.groups()

    def blocks() -> Iterator[Block]:
        first = 0
        while first < groups:
            discretes, of_groups, *columns = parts.part(first, ZONES_IN_A_BLOCK)
            yield Block(discretes.reshape(len(of_groups), -1), of_groups, *columns)
            first += len(of_groups)

    return Cover(groups, parts.zones(), blocks)
