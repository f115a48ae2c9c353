"""The symmetry of a certificate: parts of a state that belong to the members of a group, and the image of a state when
members change their places.

`tachk.meaning.judge.automorphism` proves that a permutation maps the model onto itself, which is not decided here.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from tachk.base.records import dataclass


class MalformedGroupError(Exception):
    """No exchanges are described; ``str()`` says why."""


@dataclass(frozen=True, slots=True)
class SymmetryGroup:
    """Members any two of which are exchanged, or (cyclic) all of which are moved on together.

    A *slot* is a number of a discrete state: the locations of the processes come first, then the components of
    variables.

    Attributes:
        slots, clocks, channels: of each member those that belong to it, the corresponding ones in the same order.
        names: the slots that may hold names of members, each with the number of the table that says which.
        tables: each with the name of each member.
    """

    slots: tuple[tuple[int, ...], ...]
    clocks: tuple[tuple[int, ...], ...]
    channels: tuple[tuple[int, ...], ...]
    names: tuple[tuple[int, int], ...]
    tables: tuple[tuple[int, ...], ...]
    cyclic: bool = False

    @property
    def size(self) -> int:
        return len(self.slots)

    def check(self) -> None:
        """Checks that arrangements of the members act on states as a group: each by itself, and the product of two as
        one after the other. Raises MalformedGroupError."""
        for parts in (self.slots, self.clocks, self.channels):
            if len(parts) != self.size or len(set(map(len, parts))) != 1 or not _are_distinct(sum(parts, ())):
                raise MalformedGroupError("something belongs to two members, or members have different parts")
        tables = self.tables_of_slots()
        if any(len(table) != self.size for table in self.tables) or self.size < 2:
            raise MalformedGroupError("a table does not name each member")
        for own in tables.values():
            if not _are_distinct([name for table in own for name in self.tables[table]]):
                raise MalformedGroupError("two members have the same name")
        for role in zip(*self.slots, strict=True):
            if len({frozenset(tables.get(slot, ())) for slot in role}) != 1:
                raise MalformedGroupError("members hold different names")

    def tables_of_slots(self) -> Mapping[int, Sequence[int]]:
        """The slots that may hold names, with the numbers of their tables. Raises MalformedGroupError."""
        found: dict[int, list[int]] = {}
        for slot, table in self.names:
            if not 0 <= table < len(self.tables):
                raise MalformedGroupError("there is no such table")
            found.setdefault(slot, []).append(table)
        return found

    def to_json(self) -> dict[str, Any]:
        return {
            "slots": self.slots,
            "clocks": self.clocks,
            "channels": self.channels,
            "names": self.names,
            "tables": self.tables,
            "cyclic": self.cyclic,
        }

    @classmethod
    def from_json(cls, given: Mapping[str, Any]) -> SymmetryGroup:
        """The inverse of `to_json`. Raises TypeError, KeyError and ValueError for something else."""
        parts = [given[name] for name in ("slots", "clocks", "channels", "names", "tables")]
        slots, clocks, channels, names, tables = (tuple(tuple(map(_whole, own)) for own in part) for part in parts)
        return cls(
            slots, clocks, channels, tuple((slot, table) for slot, table in names), tables, bool(given["cyclic"])
        )

    def generators(self) -> Iterator[Sequence[int]]:
        """The places of the members in arrangements that generate all: the next one each, and two exchanged."""
        yield [*range(1, self.size), 0]
        if not self.cyclic and self.size > 2:
            yield [1, 0, *range(2, self.size)]


@dataclass(frozen=True, slots=True)
class StatePermutation:
    """A permutation of the components of a state. Those that are not mentioned stay.

    Attributes:
        slots, clocks, channels: where each comes.
        values: by slot, what becomes of values in it.
    """

    slots: Mapping[int, int]
    clocks: Mapping[int, int]
    channels: Mapping[int, int]
    values: Mapping[int, Mapping[int, int]]

    def slot(self, slot: int) -> int:
        return self.slots.get(slot, slot)

    def clock(self, clock: int) -> int:
        return self.clocks.get(clock, clock)

    def value(self, slot: int, value: int) -> int:
        """The image of a value that stands in a slot."""
        moved = self.values.get(slot)
        return value if moved is None else moved.get(value, value)


def group_element(group: SymmetryGroup, places: Sequence[int]) -> StatePermutation:
    """The permutation of states that moves each member to a place."""
    slots, clocks, channels = (
        {own: parts[places[member]][role] for member in range(group.size) for role, own in enumerate(parts[member])}
        for parts in (group.slots, group.clocks, group.channels)
    )
    values: dict[int, dict[int, int]] = {}
    for slot, table in group.names:
        names = group.tables[table]
        values.setdefault(slot, {}).update((names[member], names[place]) for member, place in enumerate(places))
    return StatePermutation(slots, clocks, channels, values)


def _whole(number: object) -> int:
    if type(number) is not int or abs(number) >= 1 << 31:
        raise ValueError("a number is none")
    return number


def _are_distinct(numbers: Iterable[int]) -> bool:
    numbers = list(numbers)
    return len(set(numbers)) == len(numbers) and all(number >= 0 for number in numbers)
