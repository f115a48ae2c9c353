"""Symbolic states with the members of groups in other places: for many of them at once.

A set that holds states up to exchanges covers what exchanges lead into it. Which exchanges are tried is a guess:
members are sorted by what is known of them, as the search for certificates does; those of a cyclic orbit come to every
place. Each try is sound, because each permutation maps the model onto itself.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from tachk.base.records import dataclass
from tachk.meaning.judge.certificate import Numbers
from tachk.meaning.judge.transpositions import SymmetryGroup
from tachk.meaning.judge.zone_arrays import Pieces, joined

_LARGEST = 1 << 40
"""Larger bounds count as this one where they are added up."""
_BEHIND = 1 << 40
"""Larger than all numbers in states."""

_WAYS = 2
"""In so many ways members are sorted."""

Find = Callable[[Numbers], Numbers]
"""The numbers of discrete states, -1 for those that there are not."""
Without = Callable[[Pieces, Numbers], Pieces]
"""The parts of pieces that a set does not cover, whose origins are places in an array of the sources."""


@dataclass(frozen=True, slots=True)
class Arranged:
    """Symbolic states: discrete states as rows, their zones, and what they come from."""

    states: Numbers
    zones: Numbers
    origin: Numbers

    def placed(self, group: SymmetryGroup, order: Numbers) -> Arranged:
        """With the members of a group in an order, which is given for each state."""
        count, size = order.shape
        every = np.arange(count)[:, None, None]
        slots, clocks = (np.array(parts, np.int64).reshape(size, -1) for parts in (group.slots, group.clocks))
        states, zones = self.states.copy(), self.zones
        states[every, slots] = self.states[every, slots[order]]
        places = np.argsort(order, axis=1)
        for slot, table in group.names:
            some, member = _named(group, states, slot, table)
            states[some, slot] = np.array(group.tables[table])[places[some, member]]
        if clocks.size:
            source = np.tile(np.arange(zones.shape[1]), (count, 1))
            source[every, clocks] = clocks[order]
            zones = zones[every, source[:, :, None], source[:, None, :]]
        return Arranged(states, zones, self.origin)

    def turned(self, group: SymmetryGroup) -> Arranged:
        """With the members of a cyclic orbit moved on by one place."""
        return self.placed(group, np.tile(np.roll(np.arange(group.size), 1), (len(self.states), 1)))

    def sorted(self, group: SymmetryGroup, way: int) -> Arranged:
        """With the members of a group in an order that does not depend on where they were, as far as it is known what
        distinguishes them: in one of the `_WAYS`."""
        own = [*_contents(group, self.states), *_sums(group, self.zones, way)]
        return self.placed(group, np.lexsort(own[::-1], axis=-1))

    def pieces(self, find: Find) -> Pieces:
        """These, with their places as origins."""
        places = np.arange(len(self.origin))
        return joined([Pieces(self.zones, places, find(self.states), places)])

    def of(self, places: Numbers) -> Arranged:
        """Some of them."""
        return Arranged(self.states[places], self.zones[places], self.origin[places])


def uncovered(groups: Sequence[SymmetryGroup], states: Numbers, pieces: Pieces, find: Find, without: Without) -> Pieces:
    """The pieces that a set does not cover, whose discrete states are rows, nor what exchanges make of them."""
    left = Arranged(states, pieces.table[pieces.zone], pieces.origin)
    rings = [group for group in groups if group.cyclic]
    turns = [0] * len(rings)
    while len(left.origin):
        for way in range(_WAYS if len(rings) < len(groups) else 1):
            for group in groups:
                left = left if group.cyclic else left.sorted(group, way)
            left = left.of(np.unique(without(left.pieces(find), left.origin).origin))
        for number, group in enumerate(rings):
            left, turns[number] = left.turned(group), (turns[number] + 1) % group.size
            if turns[number]:
                break
        if not any(turns):
            break
    places = np.arange(len(left.origin))
    return Pieces(left.zones, places, places * 0 - 1, left.origin)


def _named(group: SymmetryGroup, states: Numbers, slot: int, table: int) -> tuple[NDArray[np.bool_], Numbers]:
    """In which states a slot holds a name of a table, and whose."""
    names = states[:, slot, None] == np.array(group.tables[table])
    some = names.any(axis=1)
    return some, names[some].argmax(axis=1)


def _contents(group: SymmetryGroup, states: Numbers) -> Iterator[Numbers]:
    """The keys by which members are compared: the contents of their slots, the first slot outside that names a member,
    and the member that each one names: itself, another one, none."""
    tables = group.tables_of_slots()
    roles = list(zip(*group.slots, strict=True))
    yield from (states[:, role] for role in roles if role[0] not in tables)
    first = np.full((len(states), group.size), _BEHIND)
    own = {slot for role in roles for slot in role}
    shared = [(slot, table) for slot, table in group.names if slot not in own]
    for place in range(len(shared) - 1, -1, -1):
        some, named = _named(group, states, *shared[place])
        first[np.flatnonzero(some), named] = place
    yield first
    for role in reversed(roles):
        if role[0] in tables:
            held = states[:, role].astype(np.int64)
            for table in tables[role[0]]:
                for member, slot in enumerate(role):
                    some, named = _named(group, states, slot, table)
                    held[some, member] = np.where(np.equal(named, member), -_BEHIND, _BEHIND)
            yield held


def _sums(group: SymmetryGroup, zones: Numbers, way: int) -> Iterator[Numbers]:
    """The sums of the bounds of clocks against the others, and of the others against them: either may come first, for
    an abstraction may leave a difference in one of them only."""
    bounds = np.clip(zones, -_LARGEST, _LARGEST)
    sums = bounds.sum(axis=2), bounds.sum(axis=1)
    for role in zip(*group.clocks, strict=True):
        yield sums[way][:, role]
        yield sums[1 - way][:, role]
