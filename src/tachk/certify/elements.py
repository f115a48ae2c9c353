"""The elements of a certificate in memory, found by discrete state."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from tachk.certify.certificate import Columns, MalformedCertificateError, Numbers, starts
from tachk.certify.zone_arrays import zones_of
from tachk.semantics.discrete import PreparedNetwork

States = NDArray[np.signedinteger]
_AT_ONCE = 4096


class Elements:
    """Those of the rank 0, or those with ranks.

    Attributes:
        states: the discrete states, as rows of locations and cells.
        first: where the elements of each begin among all, and where those of the last one end.
        shapes: of each element its zone, as a place in ``zones``.
        ranks: of each element.
    """

    def __init__(self, states: States, counts: Numbers, shapes: Numbers, ranks: Numbers, zones: Numbers) -> None:
        self.states, self.first, self.shapes, self.ranks, self.zones = states, starts(counts), shapes, ranks, zones
        # A number for each state, so that most of the states need not be looked at to find one.
        self._factors = np.random.default_rng(0).integers(1, 1 << 62, states.shape[1], dtype=np.int64)
        hashes = self._hashed(states)
        self._order = np.argsort(hashes, kind="stable")
        self._hashes = hashes[self._order]
        same = np.flatnonzero(np.diff(self._hashes) == 0)
        if (states[self._order[same]] == states[self._order[same + 1]]).all(axis=1).any():
            raise MalformedCertificateError("a discrete state occurs twice")

    def _hashed(self, states: States) -> Numbers:
        pieces = (states[first : first + _AT_ONCE] for first in range(0, len(states), _AT_ONCE))
        return np.concatenate([np.zeros(0, np.int64), *(piece @ self._factors for piece in pieces)])

    def find(self, states: States) -> Numbers:
        """The rows of some discrete states, -1 for those that are not here."""
        if not len(self.states):
            return np.full(len(states), -1, np.int64)
        places = np.minimum(np.searchsorted(self._hashes, self._hashed(states)), len(self._order) - 1)
        rows = self._order[places]
        return np.where((self.states[rows] == states).all(axis=1), rows, -1)


def read_elements(model: PreparedNetwork, width: int, blocks: Iterable[Columns]) -> tuple[Elements, Elements]:
    """The elements of the rank 0, and those with ranks. Raises MalformedCertificateError."""
    read = list(blocks)
    ranges = [(0, len(p.locations) - 1) for p in model.network.processes] + list(model.layout.ranges)
    low, high = np.array(ranges, np.int64).T
    small = np.result_type(np.min_scalar_type(low.min()), np.min_scalar_type(high.max()))
    states = [np.zeros((0, width), small)]
    for block in read:
        changed = np.zeros((len(block.zones), width), np.int64)
        changed[np.repeat(np.arange(len(changed)), block.changes), block.positions] = block.differences
        np.cumsum(changed, axis=0, out=changed)
        if (changed < low).any() or (changed > high).any():
            raise MalformedCertificateError("a discrete state has a value out of its range")
        states.append(changed.astype(small))

    def joined(name: str) -> Numbers:
        return np.concatenate([np.zeros(0, np.int64), *(getattr(block, name) for block in read)])

    zones = zones_of(joined("constraints"), joined("places"), joined("bounds"), model.dimension)
    all_states, counts, shapes, ranks = np.concatenate(states), joined("zones"), joined("shapes"), joined("ranks")
    row = np.repeat(np.arange(len(all_states)), counts)
    ranked = np.zeros(len(all_states), bool)
    ranked[row[ranks > 0]] = True
    if ((ranks > 0) != ranked[row]).any():
        raise MalformedCertificateError("a discrete state has a zone of the rank 0 among others")
    # A discrete state without zones counts as one that is not there.
    none, some = (
        Elements(
            all_states if chosen.all() else all_states[chosen],
            counts[chosen],
            shapes[chosen[row]],
            ranks[chosen[row]],
            zones,
        )
        for chosen in (~ranked & (counts > 0), ranked)
    )
    return none, some
