"""Sets of clock values for many discrete states at once.

Zones are in arrays: entry ``[k, i, j]`` is the raw bound of zone k on ``x_i - x_j``, as in `tachk.meaning.dbm`. All
are canonical. A *change* takes zones and as many matrices; it gives what becomes of the zones, each with the number of
the zone that it comes from, in ascending order.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tachk.base.job import check_job
from tachk.base.records import dataclass, replace
from tachk.meaning.dbm import INFINITY, LESS_EQUAL_ZERO, ClockValues, Constraint
from tachk.meaning.judge.certificate import Numbers

Truths = NDArray[np.bool_]
Change = Callable[[Numbers, Any], tuple[Numbers, Numbers]]


def bounds_of(constraints: Iterable[Constraint], dimension: int) -> Numbers:
    """A conjunction of constraints as a matrix of bounds."""
    matrix = np.full((dimension, dimension), INFINITY)
    for i, j, raw in constraints:
        matrix[i, j] = min(matrix[i, j], raw)
    return matrix


def added(left: Numbers, right: Numbers) -> Numbers:
    """Sums of raw bounds."""
    sums = left + right - ((left | right) & 1)
    return np.where(sums > INFINITY // 2, INFINITY, sums)


def canonical(matrices: Numbers) -> Numbers:
    """By Floyd and Warshall. No clock is negative."""
    count = matrices.shape[1]
    least = [(i, j, LESS_EQUAL_ZERO) for j in range(count) for i in (0, j)]
    zones = np.minimum(matrices, bounds_of(least, count))
    for k in range(zones.shape[1]):
        zones = np.minimum(zones, added(zones[:, :, k, None], zones[:, k, None, :]))
    return zones


def inside(zones: Numbers, bounds: Numbers) -> tuple[Numbers, Numbers]:
    """The parts within the bounds."""
    origin = np.arange(len(zones))
    for i, j in np.argwhere((bounds < INFINITY).any(axis=0)).tolist():
        some, zones = _cut(zones, i, j, bounds[origin, i, j])
        origin = origin[some]
    return origin, zones


def outside(zones: Numbers, bounds: Numbers) -> tuple[Numbers, Numbers]:
    """The parts outside of the bounds: what is beyond one bound, of the rest what is beyond the next one, and so on. A
    zone of which nothing is within the bounds stays whole."""
    origin = np.flatnonzero((zones > bounds).any(axis=(1, 2)))
    met = np.isin(origin, origin[inside(zones[origin], bounds[origin])[0]])
    origins, parts = [origin[~met]], [zones[origin[~met]]]
    origin, rest = origin[met], zones[origin[met]]
    for i, j in np.argwhere((rest > bounds[origin]).any(axis=0)).tolist():
        raw = bounds[origin, i, j]
        beyond = np.flatnonzero(rest[:, i, j] > raw)
        some, part = _cut(rest[beyond], j, i, 1 - raw[beyond])
        origins.append(origin[beyond][some])
        parts.append(part)
        rest = _cut(rest, i, j, raw)[1]
    order = np.argsort(np.concatenate(origins), kind="stable")
    return np.concatenate(origins)[order], np.concatenate(parts)[order]


def released(zones: Numbers, entries: Truths) -> tuple[Numbers, Numbers]:
    """The zones without some of their bounds. Where time passes for all clocks, these are the upper bounds of clocks;
    from where zones are reached by that, the lower ones."""
    zones = np.where(entries, INFINITY, zones)
    return np.arange(len(zones)), canonical(zones) if entries[:, :, 1:].any() else zones


def assigned(zones: Numbers, values: ClockValues) -> Numbers:
    """The zones after clocks are set."""
    source, more = _become(values, zones.shape[1])
    after = added(zones[:, source[:, None], source[None, :]], 2 * (more[:, None] - more[None, :]) + LESS_EQUAL_ZERO)
    every = range(len(source))
    after[:, every, every] = LESS_EQUAL_ZERO
    return after


def before_assigning(values: ClockValues, bounds: Numbers) -> Numbers:
    """The constraints on clocks before they are set, for matrices of bounds that must hold afterwards."""
    source, more = _become(values, bounds.shape[1])
    shifted = added(bounds, 2 * (more[None, :] - more[:, None]) + LESS_EQUAL_ZERO)
    before = np.full_like(bounds, INFINITY)
    for i, j in np.argwhere((shifted < INFINITY).any(axis=0)).tolist():
        before[:, source[i], source[j]] = np.minimum(before[:, source[i], source[j]], shifted[:, i, j])
    return before


def _become(values: ClockValues, dimension: int) -> tuple[Numbers, Numbers]:
    """The new value of every clock, if only itself: a clock, and an offset."""
    source, more = np.arange(dimension), np.zeros(dimension, np.int64)
    for clock, of, by in values:
        source[clock], more[clock] = of, by
    return source, more


def _cut(zones: Numbers, i: int, j: int, raw: Numbers) -> tuple[Numbers | slice, Numbers]:
    """The parts with ``x_i - x_j`` below a bound for each zone, and which zones have one."""
    if (zones[:, i, j] <= raw).all():
        return slice(None), zones
    some = np.flatnonzero(added(zones[:, j, i], raw) >= LESS_EQUAL_ZERO)
    zones, raw = zones[some], raw[some]
    over = added(added(zones[:, :, i], raw[:, None])[:, :, None], zones[:, j, None, :])
    return some, np.minimum(zones, over)


@dataclass(frozen=True, slots=True)
class Pieces:
    """Sets of clock values: of each the number of its zone in a table, the number of its discrete state, and its
    origin, which its maker defines."""

    table: Numbers
    zone: Numbers
    row: Numbers
    origin: Numbers

    def take(self, chosen: Truths | Numbers | slice) -> Pieces:
        return Pieces(self.table, self.zone[chosen], self.row[chosen], self.origin[chosen])

    def at(self, rows: Numbers) -> Pieces:
        """The pieces of some discrete states; these pieces are in the order of discrete states."""
        return self.take(self._pairs(rows)[1])

    def _pairs(self, rows: Numbers) -> tuple[Numbers, Numbers]:
        """For each piece of each of the discrete states the place of the state, and of the piece, likewise."""
        low, high = np.searchsorted(self.row, rows), np.searchsorted(self.row, rows, "right")
        place = np.repeat(np.arange(len(rows)), high - low)
        return place, np.arange(len(place)) - np.repeat(np.cumsum(high - low) - high, high - low)

    def become(self, change: Change, matrices: Numbers | Truths, number: Numbers | int = 0) -> Pieces:
        """The result of a change of each, with the matrix of that number; equal pairs are computed once."""
        check_job()
        keys, inverse = np.unique(self.zone * len(matrices) + number, return_inverse=True)
        origin, table = change(self.table[keys // max(len(matrices), 1)], matrices[keys % max(len(matrices), 1)])
        made = Pieces(table, np.arange(len(table)), origin, origin)
        piece, zone = made._pairs(inverse)
        return Pieces(table, zone, self.row[piece], self.origin[piece])

    def within(self, constraints: Iterable[Constraint]) -> Pieces:
        """The parts within some constraints."""
        return self.become(inside, bounds_of(constraints, self.table.shape[1])[None])

    def assign(self, values: ClockValues) -> Pieces:
        """The zones after clocks are set."""
        return replace(self, table=assigned(self.table, values))

    def meeting(self, others: Pieces) -> Pieces:
        """The intersections with others of their discrete states, which are in the order of these."""
        piece, other = others._pairs(self.row)
        return self.take(piece).become(inside, others.table, others.zone[other])

    def beyond(self, others: Pieces, counts: Callable[[Numbers, Numbers], Truths] | None = None) -> Pieces:
        """The pieces that lie within no single one of the others; for the arguments see `without`."""

        def left_of(pieces: Pieces, used: Truths, zone: Numbers) -> Pieces:
            within = (pieces.table[pieces.zone] <= others.table[zone]).all(axis=(1, 2))
            return pieces.take(~(used & within))

        return self._compared(others, counts, left_of)

    def without(self, others: Pieces, counts: Callable[[Numbers, Numbers], Truths] | None = None) -> Pieces:
        """The parts of the pieces outside of all others of their discrete states, which are in the order of these; only
        the others count that ``counts`` names for the origin of a piece."""

        def left_of(pieces: Pieces, used: Truths, zone: Numbers) -> Pieces:
            parts = pieces.take(used).become(outside, others.table, zone[used])
            return joined([pieces.take(~used), parts])

        return self._compared(others, counts, left_of)

    def _compared(
        self,
        others: Pieces,
        counts: Callable[[Numbers, Numbers], Truths] | None,
        left_of: Callable[[Pieces, Truths, Numbers], Pieces],
    ) -> Pieces:
        """The remainder after all others of their discrete states, one after the other. `left_of` gives the remainder
        of pieces, of which some are compared with another zone each."""
        left, done, number = self, [self.take(slice(0))], 0
        while len(left.row):
            check_job()
            other = np.searchsorted(others.row, left.row) + number
            some = other < np.searchsorted(others.row, left.row, "right")
            done.append(left.take(~some))
            left, other, number = left.take(some), other[some], number + 1
            used = np.ones(len(other), bool) if counts is None else counts(other, left.origin)
            left = left_of(left, used, others.zone[other])
        return joined(done)


def joined(parts: Sequence[Pieces]) -> Pieces:
    """All of them, in the order of discrete states; there is at least one part, perhaps without pieces."""
    parts = [part for part in parts if len(part.row)] or parts[:1]
    before = np.cumsum([0, *(len(part.table) for part in parts)])
    whole = Pieces(
        np.concatenate([part.table for part in parts]),
        np.concatenate([part.zone + tables for part, tables in zip(parts, before, strict=False)]),
        np.concatenate([part.row for part in parts]),
        np.concatenate([part.origin for part in parts]),
    )
    return whole if (np.diff(whole.row) >= 0).all() else whole.take(np.argsort(whole.row, kind="stable"))
