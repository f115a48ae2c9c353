"""Fewer different zones in a set of symbolic states that is a proof: constraints that the proof can do without are left
out, so that zones become equal, and each is listed once.

Nothing here need be believed: a set with fewer constraints counts only if a checker accepts it as well. First all
constraints that follow are written out, and few differences of clocks are looked for with whose constraints alone the
set is a proof. If too many zones are different then, the checker tries the set without a constraint: in all zones
together that bound the same difference of clocks; in those with the same bound; in zones that are alike but for the
names of clocks; and in each zone by itself. At last two zones that differ in little become the smallest one that
contains both.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from tachk.base.job import check_job
from tachk.base.records import replace
from tachk.meaning.dbm import INFINITY, LESS_EQUAL_ZERO
from tachk.meaning.judge.certificate import Columns, Numbers, Shapes, StateBlock, ragged, starts
from tachk.meaning.judge.zone_arrays import canonical

MOST_WORK = 400_000_000
"""The limit on the work of the checker in each part: the number of its runs, times the zones, times the cube of the
number of clocks."""

MOST_TOGETHER = 200
"""The number of zones of one discrete state, times clocks, up to which all constraints are written out: with many
constraints the check that zones cover another one together takes too long."""

_TOGETHER = (("places",), ("places", "bounds"), ("role", "form"), ("places", "zone"))


class _BoundedChecker:
    """A checker that may run until it has done `MOST_WORK`. Raises StoppedError."""

    def __init__(self, accepts: Callable[[Columns], bool], zones: int, dimension: int) -> None:
        self._accepts = accepts
        self._left = MOST_WORK // max(zones * dimension**3, 1)

    def is_tired(self) -> bool:
        return self._left <= 0

    def accepts(self, columns: Columns) -> bool:
        check_job()
        self._left -= 1
        return self._left >= 0 and self._accepts(columns)


def widened(
    blocks: Iterable[StateBlock], width: int, dimension: int, enough: int, accepts: Callable[[Columns], bool]
) -> StateBlock:
    """A proof with fewer different zones; the same one if they are few enough. Raises StoppedError.

    Args:
        enough: so many different zones need not become fewer.
        width: how many numbers a discrete state has.
        dimension: how many clocks there are, the reference clock included.
        accepts: whether a checker takes a set for a proof.
    """
    given = list(blocks)
    names = ("discretes", "zones", "ranks", "constraints", "places", "bounds")
    block = StateBlock(*(np.concatenate([getattr(each, name) for each in given]) for name in names))
    is_wide = int(block.zones.max(initial=0)) * dimension > MOST_TOGETHER
    few = block if is_wide else _after((_with_few_places,), block, width, dimension, enough, accepts)
    groups = _after([partial(_without_groups, each) for each in 2 * _TOGETHER], few, width, dimension, enough, accepts)
    if is_wide or _different(groups) <= enough:
        return groups
    hulls = [_after((_with_hulls,), each, width, dimension, enough, accepts) for each in (groups, few)]
    return min(hulls, key=_different)


def _after(
    steps: Iterable[Callable[[Columns, int, int, _BoundedChecker], Columns]],
    block: StateBlock,
    width: int,
    dimension: int,
    enough: int,
    accepts: Callable[[Columns], bool],
) -> StateBlock:
    """The result of steps that do not make more zones different, until these are few enough."""
    checker = _BoundedChecker(accepts, len(block.constraints), dimension)
    for step in steps:
        different = _different(block)
        if different > enough:
            made = _distinct(step(Shapes().columns(block), dimension, enough, checker), width)
            if _different(made) <= different:
                block = made
    return block


def _different(block: StateBlock) -> int:
    return len(Shapes().columns(block).constraints)


def _with_few_places(columns: Columns, dimension: int, enough: int, checker: _BoundedChecker) -> Columns:
    """With the constraints on few differences of clocks: a least set of these, in which those that tell fewest zones
    apart are preferred (U. Junker, QuickXplain, AAAI 2004)."""
    zones = canonical(columns.matrices(dimension))
    explicit = _all_constraints(columns, zones)
    places, number = np.unique(explicit.places, return_inverse=True)
    distinct = [len(np.unique(explicit.bounds[number == each])) for each in range(len(places))]
    order = np.argsort(distinct, kind="stable")

    def only(chosen: NDArray[np.int64]) -> Columns:
        return _with(explicit, np.isin(number, chosen))

    def least(base: Numbers, is_new: bool, others: Numbers) -> Numbers:
        """The others that are needed beside those in the base; with all of them it is a proof."""
        if checker.is_tired() or (is_new and checker.accepts(only(base))):
            return others if checker.is_tired() else others[:0]
        if len(others) == 1:
            return others
        first, second = np.split(others, [len(others) // 2])
        needed = least(np.concatenate((base, first)), True, second)
        return np.concatenate((least(np.concatenate((base, needed)), len(needed) > 0, first), needed))

    return only(least(order[:0], True, order))


def _without_groups(
    together: tuple[str, ...], columns: Columns, dimension: int, enough: int, checker: _BoundedChecker
) -> Columns:
    """Without the constraints that are not needed, of those that agree in what is named."""
    retained = np.ones(len(columns.places), bool)
    for constraints in _groups(columns, together, dimension):
        if checker.is_tired():
            break
        fewer = retained.copy()
        fewer[constraints] = False
        if checker.accepts(_with(columns, fewer)):
            retained = fewer
    return _with(columns, retained)


def _with_hulls(columns: Columns, dimension: int, enough: int, checker: _BoundedChecker) -> Columns:
    """With the smallest zones that contain two of the given ones, which differ in few bounds, in place of these."""
    zones = canonical(columns.matrices(dimension))
    number = np.arange(len(zones))  # of each zone, what it has become
    rejected: set[bytes] = set()
    found = True
    while found and len(np.unique(number)) > enough:
        found = False
        for one, other in _alike(zones, np.unique(number)):
            hull = np.maximum(zones[one], zones[other])
            pair = zones[[one, other]].tobytes()
            if checker.is_tired():
                break
            if pair in rejected:
                continue
            merged = np.where(number == other, one, number)
            widest = zones.copy()
            widest[one] = hull
            if checker.accepts(_all_constraints(columns, widest[merged])):
                zones, number, found = widest, merged, True
                break
            rejected.add(pair)
    return _all_constraints(columns, zones[number])


def _alike(zones: Numbers, chosen: Numbers) -> list[tuple[int, int]]:
    """The pairs of some zones, those first that differ in fewest bounds."""
    first, second = np.triu_indices(len(chosen), 1)
    rows = zones[chosen].reshape(len(chosen), -1)
    differences = np.concatenate([np.count_nonzero(rows[k] != rows[k + 1 :], axis=1) for k in range(len(chosen))])
    order = np.argsort(differences, kind="stable")
    return list(zip(chosen[first[order]].tolist(), chosen[second[order]].tolist(), strict=True))


def _all_constraints(columns: Columns, zones: Numbers) -> Columns:
    """The columns with all constraints of these zones in place of the listed ones, except trivial ones."""
    dimension = zones.shape[1]
    trivial = np.full((dimension, dimension), INFINITY)
    trivial[0] = LESS_EQUAL_ZERO
    np.fill_diagonal(trivial, LESS_EQUAL_ZERO)
    zone, places = np.nonzero((zones < trivial).reshape(len(zones), -1))
    constraints = np.bincount(zone, minlength=len(zones))
    return replace(columns, constraints=constraints, places=places, bounds=zones.reshape(len(zones), -1)[zone, places])


def _groups(columns: Columns, together: tuple[str, ...], dimension: int) -> list[Numbers]:
    """The numbers of the constraints that agree in what is named, most of them first."""
    zone = np.repeat(np.arange(len(columns.constraints)), columns.constraints)
    clocks = np.stack(np.divmod(columns.places, dimension))
    role = np.column_stack((*(clocks > 0), columns.bounds))
    forms = [tuple(sorted(map(tuple, part))) for part in np.split(role, np.cumsum(columns.constraints)[:-1])]
    numbers = {form: number for number, form in enumerate(dict.fromkeys(forms))}
    form = np.array([numbers[each] for each in forms], np.int64)[zone]
    explicit = {"places": columns.places, "bounds": columns.bounds, "zone": zone, "role": role, "form": form}
    _, kind = np.unique(np.column_stack([explicit[name] for name in together]), axis=0, return_inverse=True)
    order = np.argsort(kind.ravel(), kind="stable")
    groups = np.split(order, np.flatnonzero(np.diff(kind.ravel()[order])) + 1)
    return sorted(groups, key=len, reverse=True)


def _with(columns: Columns, retained: NDArray[np.bool_]) -> Columns:
    """With some of the constraints only."""
    zone = np.repeat(np.arange(len(columns.constraints)), columns.constraints)
    constraints = np.bincount(zone[retained], minlength=len(columns.constraints))
    return replace(columns, constraints=constraints, places=columns.places[retained], bounds=columns.bounds[retained])


def _distinct(columns: Columns, width: int) -> StateBlock:
    """With each zone of a discrete state once, for each rank."""
    block = Shapes().block(columns, width)
    shapes = Shapes().columns(block).shapes
    state = np.repeat(np.arange(len(block.zones)), block.zones)
    _, chosen = np.unique(np.column_stack((state, block.ranks, shapes)), axis=0, return_index=True)
    chosen.sort()
    constraints = ragged(starts(block.constraints), chosen)
    return StateBlock(
        block.discretes,
        np.bincount(state[chosen], minlength=len(block.zones)),
        block.ranks[chosen],
        block.constraints[chosen],
        block.places[constraints],
        block.bounds[constraints],
    )
