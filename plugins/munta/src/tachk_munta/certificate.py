"""The sets of states of certificates in Munta's binary form: big-endian words of 64 bits.

A file is 42, the numbers of processes, of clocks (the reference clock included) and of variables, and how many discrete
states follow. Each is the location of each process, the variables, how many zones it has, and the bounds of each, row
by row: 2v for ``< v``, 2v + 1 for ``<= v``, the largest number for no bound. Source: ``ML/Muntac.sml`` and the
deserialiser of MLunta.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import product

import numpy as np
import numpy.typing as npt

from tachk.api.plugin import INFINITY, LESS_EQUAL_ZERO
from tachk.api.proofs import StateBlock
from tachk_munta.network import MuntaNetwork

_Matrices = npt.NDArray[np.int64]

_MAGIC = 42
_NO_BOUND = (1 << 63) - 1


def certificate_of(munta: MuntaNetwork, blocks: Iterable[StateBlock], clocks: int) -> bytes:
    """A set of states of the network that the model was made of.

    Args:
        blocks: without ranks; all zones are there, none is left to be computed.
        clocks: how many there are in the network.
    """
    states: dict[tuple[int, ...], dict[bytes, None]] = {}
    dimension = clocks + 1
    own_clocks = [0, *munta.variables.clocks]
    for block in blocks:
        zones = _canonical(_with_invariants(munta, block, dimension))[:, own_clocks][:, :, own_clocks]
        zones[zones >= INFINITY] = _NO_BOUND
        zone = 0
        for row, count in zip(block.discretes.tolist(), block.zones.tolist(), strict=True):
            bounds = dict.fromkeys(zones[n].astype(">i8").tobytes() for n in range(zone, zone + count))
            for state in _states(munta, row):
                states.setdefault(state, {}).update(bounds)
            zone += count
    header = _words([_MAGIC, len(munta.processes), len(own_clocks), len(munta.variables.slots), len(states)])
    return header + b"".join(_words([*state, len(zones)]) + b"".join(zones) for state, zones in states.items())


def _words(numbers: Iterable[int]) -> bytes:
    return np.array(list(numbers), ">i8").tobytes()


def _states(munta: MuntaNetwork, row: list[int]) -> Iterator[tuple[int, ...]]:
    """Munta's numbers for a discrete state: locations of the network's processes, then its slots. There are several
    where an added process may be in several locations."""
    own = sum(1 for process in munta.processes if not process.added)
    variables = munta.variables
    contents = [(row[own + slot] if slot >= 0 else row[-1 - slot]) - variables.starts[slot] for slot in variables.slots]
    choices = (
        [places.index(place) for place in (process.added or (row[number],))]
        for number, (process, places) in enumerate(zip(munta.processes, munta.places, strict=True))
    )
    for locations in product(*choices):
        yield (*locations, *contents)


def _with_invariants(munta: MuntaNetwork, block: StateBlock, dimension: int) -> _Matrices:
    """The zones of a block as matrices, without what the invariants exclude: they may be larger, but then Munta would
    find deadlocks outside the invariants."""
    zones = np.full((len(block.constraints), dimension * dimension), INFINITY, np.int64)
    zones[:, :dimension] = LESS_EQUAL_ZERO
    zones[:, :: dimension + 1] = LESS_EQUAL_ZERO
    owners = np.repeat(np.arange(len(block.constraints)), block.constraints)
    np.minimum.at(zones, (owners, block.places), block.bounds)
    matrices = zones.reshape(-1, dimension, dimension)
    of_zones = np.repeat(block.discretes, block.zones, axis=0)
    for number, process in enumerate(p for p in munta.processes if not p.added):
        for place, invariant in enumerate(process.invariants):
            there = of_zones[:, number] == place
            for i, j, raw in invariant:
                matrices[there, i, j] = np.minimum(matrices[there, i, j], raw)
    return matrices


def _canonical(matrices: _Matrices) -> _Matrices:
    """Zones whose bounds cannot be tightened."""
    for k in range(matrices.shape[1]):
        left, right = matrices[:, :, k, None], matrices[:, None, k, :]
        sums = left + right - ((left | right) & 1)
        sums[(left >= INFINITY) | (right >= INFINITY)] = INFINITY
        np.minimum(matrices, sums, out=matrices)
    return matrices
