"""Closed sets of symbolic states that meet no goal: what certificates are made of, found by the core."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import replace

from tachk import _core
from tachk.certify.certificate import Block
from tachk.compiler.program import Goal, Program
from tachk.engines.core_search import core_limits, core_options, run_in_slices
from tachk.engines.options import Extrapolation, Limits, Options
from tachk.engines.outcome import Progress
from tachk.engines.program_image import encode
from tachk.records import dataclass

ZONES_IN_A_BLOCK = 4096


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
    """The smaller of two covers, or the reason why there is none: one has as few zones as can be for each discrete
    state, the other no more discrete states than the search stores.

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
            return min(covers, key=lambda cover: cover.zones)
    return reason


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
    groups, zones = search.groups(), search.statistics()[1]

    def blocks() -> Iterator[Block]:
        first = 0
        while first < groups:
            discretes, of_groups, of_zones, places, raws = search.part(first, ZONES_IN_A_BLOCK)
            yield Block(discretes.reshape(len(of_groups), -1), of_groups, of_zones, places, raws)
            first += len(of_groups)

    return Cover(groups, zones, blocks)
