"""Fewer different zones in a set of symbolic states that is a proof: constraints that the proof can do without are left
out, so that zones become equal, and each is told once.

Nothing here need be believed: a set with fewer constraints counts only if a checker accepts it as well. Whether a
constraint is needed is asked of all zones together that bound the same difference of clocks; if too many zones are
different then, of those with the same bound; of zones that are alike but for the names of clocks; and at last of each
zone by itself.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tachk.certify.certificate import Block, Columns, Numbers, Shapes, ragged, starts
from tachk.time_limit import check_time

MOST_WORK = 50_000_000
"""How many bounds of zones a checker may be given altogether."""

_TOGETHER = (("places",), ("places", "bounds"), ("role", "form"), ("places", "zone"))


def widened(
    blocks: Iterable[Block], width: int, dimension: int, enough: int, accepts: Callable[[Columns], bool]
) -> Block:
    """A proof with fewer different zones; the same one if they are few enough. Raises OutOfTimeError.

    Args:
        enough: so many different zones need not become fewer.
        width: how many numbers a discrete state has.
        dimension: how many clocks there are, the reference clock included.
        accepts: whether a checker takes a set for a proof.
    """
    given = list(blocks)
    names = ("discretes", "zones", "ranks", "constraints", "places", "bounds")
    block = Block(*(np.concatenate([getattr(each, name) for each in given]) for name in names))
    asked, work = len(block.constraints) * dimension * dimension, MOST_WORK
    for together in 2 * _TOGETHER:
        columns = Shapes().columns(block)
        if len(columns.constraints) <= enough:
            break
        kept = np.ones(len(columns.places), bool)
        for constraints in _groups(columns, together, dimension):
            check_time()
            work -= asked
            if work < 0:
                break
            fewer = kept.copy()
            fewer[constraints] = False
            if accepts(_with(columns, fewer)):
                kept = fewer
        block = _distinct(_with(columns, kept), width)
    return block


def _groups(columns: Columns, together: tuple[str, ...], dimension: int) -> list[Numbers]:
    """The numbers of the constraints that agree in what is named, most of them first."""
    zone = np.repeat(np.arange(len(columns.constraints)), columns.constraints)
    clocks = np.stack(np.divmod(columns.places, dimension))
    role = np.column_stack((*(clocks > 0), columns.bounds))
    forms = [tuple(sorted(map(tuple, part))) for part in np.split(role, np.cumsum(columns.constraints)[:-1])]
    numbers = {form: number for number, form in enumerate(dict.fromkeys(forms))}
    form = np.array([numbers[each] for each in forms], np.int64)[zone]
    told = {"places": columns.places, "bounds": columns.bounds, "zone": zone, "role": role, "form": form}
    _, kind = np.unique(np.column_stack([told[name] for name in together]), axis=0, return_inverse=True)
    order = np.argsort(kind.ravel(), kind="stable")
    groups = np.split(order, np.flatnonzero(np.diff(kind.ravel()[order])) + 1)
    return sorted(groups, key=len, reverse=True)


def _with(columns: Columns, kept: NDArray[np.bool_]) -> Columns:
    """With some of the constraints only."""
    zone = np.repeat(np.arange(len(columns.constraints)), columns.constraints)
    constraints = np.bincount(zone[kept], minlength=len(columns.constraints))
    return replace(columns, constraints=constraints, places=columns.places[kept], bounds=columns.bounds[kept])


def _distinct(columns: Columns, width: int) -> Block:
    """With each zone of a discrete state once, for each rank."""
    block = Shapes().block(columns, width)
    shapes = Shapes().columns(block).shapes
    state = np.repeat(np.arange(len(block.zones)), block.zones)
    _, chosen = np.unique(np.column_stack((state, block.ranks, shapes)), axis=0, return_index=True)
    chosen.sort()
    constraints = ragged(starts(block.constraints), chosen)
    return Block(
        block.discretes,
        np.bincount(state[chosen], minlength=len(block.zones)),
        block.ranks[chosen],
        block.constraints[chosen],
        block.places[constraints],
        block.bounds[constraints],
    )
