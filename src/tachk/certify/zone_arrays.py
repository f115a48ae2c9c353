"""Many zones as one array: entry ``[k, i, j]`` is the raw bound of zone k on ``x_i - x_j``, as in
`tachk.semantics.dbm`. All zones are canonical."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
from numpy.typing import NDArray

from tachk.certify.certificate import MalformedCertificateError, Numbers
from tachk.semantics.dbm import INFINITY, LESS_EQUAL_ZERO, Constraint, Zone, raw_bound


def zones_of(constraints: Numbers, places: Numbers, bounds: Numbers, dimension: int) -> Numbers:
    """The zones of the constraints of blocks. Raises MalformedCertificateError if one is empty."""
    entries = np.full((len(constraints), dimension, dimension), INFINITY, np.int64)
    entries[:, 0, :] = LESS_EQUAL_ZERO
    entries[:, np.arange(dimension), np.arange(dimension)] = LESS_EQUAL_ZERO
    flat = entries.reshape(-1, dimension * dimension)
    np.minimum.at(flat, (np.repeat(np.arange(len(flat)), constraints), places), bounds)
    zones = flat.reshape(-1, dimension, dimension)
    for k in range(dimension):
        zones = np.minimum(zones, added(zones[:, :, k, None], zones[:, k, None, :]))
    if (np.einsum("kii->ki", zones) < LESS_EQUAL_ZERO).any():
        raise MalformedCertificateError("a zone is empty")
    return zones


def added(left: Numbers, right: Numbers) -> Numbers:
    """Sums of raw bounds."""
    sums = left + right - ((left | right) & 1)
    return np.where(sums > INFINITY // 2, INFINITY, sums)


def upper_bounds(conjunctions: Iterable[Iterable[Constraint]], dimension: int) -> Numbers:
    """Of each conjunction of constraints the raw bounds, as zones have them, but not canonical."""
    matrices = []
    for constraints in conjunctions:
        matrix = np.full((dimension, dimension), INFINITY, np.int64)
        for i, j, raw in constraints:
            matrix[i, j] = min(matrix[i, j], raw)
        matrices.append(matrix)
    return np.array(matrices, np.int64).reshape(-1, dimension, dimension)


def reached_from(
    zones: Numbers, guard: Iterable[Constraint], resets: Mapping[int, int], limits: Numbers, waits: NDArray[np.bool_]
) -> tuple[Numbers, Numbers]:
    """What is reached from the part of each zone within a guard by resets and, within limits, by waiting.

    Args:
        limits: for each zone, as by `upper_bounds`.
        waits: for each zone whether time passes.

    Returns:
        What is not empty of it, with the number of the zone it comes from.
    """
    left, zones = within(zones, guard)
    for clock, value in resets.items():
        zones = _reset(zones, clock, value)
    places = np.argwhere((limits < INFINITY).any(axis=0)).tolist()
    for waited in (False, True):
        if waited and waits.any():
            zones = zones.copy()
            zones[waits[left], 1:, 0] = INFINITY
        for i, j in places:
            some, zones = _cut(zones, i, j, limits[left, i, j])
            left = left[some]
    return left, zones


def within(zones: Numbers, constraints: Iterable[Constraint]) -> tuple[Numbers, Numbers]:
    """The parts of zones that satisfy constraints, as far as they are not empty, each with the number of its zone."""
    left = np.arange(len(zones))
    for i, j, raw in constraints:
        some, zones = _cut(zones, i, j, np.full(len(zones), raw))
        left = left[some]
    return left, zones


def _cut(zones: Numbers, i: int, j: int, raw: Numbers) -> tuple[Numbers | slice, Numbers]:
    """The parts with ``x_i - x_j`` below a bound for each zone, and which zones have one."""
    if (zones[:, i, j] <= raw).all():
        return slice(None), zones
    some = np.flatnonzero(added(zones[:, j, i], raw) >= LESS_EQUAL_ZERO)
    zones, raw = zones[some], raw[some]
    over = added(added(zones[:, :, i], raw[:, None])[:, :, None], zones[:, j, None, :])
    return some, np.minimum(zones, over)


def _reset(zones: Numbers, clock: int, value: int) -> Numbers:
    result = zones.copy()
    result[:, clock, :] = added(zones[:, 0, :], np.array(raw_bound(value, False)))
    result[:, :, clock] = added(zones[:, :, 0], np.array(raw_bound(-value, False)))
    result[:, clock, clock] = LESS_EQUAL_ZERO
    return result


def including(outer: Numbers, of_outer: Numbers, inner: Numbers, of_inner: Numbers) -> NDArray[np.bool_]:
    """For each pair of places whether the outer zone includes the inner one."""
    keys, inverse = np.unique(of_outer * max(len(inner), 1) + of_inner, return_inverse=True)
    outers, inners = keys // max(len(inner), 1), keys % max(len(inner), 1)
    found: NDArray[np.bool_] = (inner[inners] <= outer[outers]).all(axis=(1, 2))[inverse]
    return found


def as_zones(zones: Numbers) -> list[Zone]:
    return [Zone(zone.shape[0], tuple(zone.ravel().tolist())) for zone in zones]
