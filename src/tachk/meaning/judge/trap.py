"""Traps: sets of states that no run leaves, each about one slot and one clock, and the points of time of that clock."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from tachk.base.records import dataclass
from tachk.meaning.dbm import INFINITY, Constraint, raw_bound

FOR_EVER = 1 << 62
"""Behind all points of time."""

Interval = tuple[int, int]
Times = tuple[Interval, ...]
"""Points of time, as disjoint intervals in ascending order. Number 2c is the point c, and 2c + 1 is what lies between c
and c + 1. Both ends belong to an interval; `FOR_EVER` is its end if it has none."""

ALWAYS: Times = ((0, FOR_EVER),)


@dataclass(frozen=True, slots=True)
class Trap:
    """A set of states that no run leaves, given by what lies outside of it.

    Attributes:
        slot: a number of a discrete state: the location of a process, or a component of a variable.
        clock: 0: the trap is about the slot alone.
        outside: (value, first, last): the slot has the value, and the clock lies in an interval of `Times`.
    """

    slot: int
    clock: int
    outside: tuple[tuple[int, int, int], ...]

    def outside_at(self, value: int) -> Times:
        return union(((first, last),) for each, first, last in self.outside if each == value)

    def constraints(self, interval: Interval) -> list[Constraint]:
        """The constraints that say that the clock lies in an interval."""
        first, last = interval
        found = [(0, self.clock, raw_bound(-(first // 2), bool(first % 2)))] if first > 0 else []
        return found + ([(self.clock, 0, raw_bound((last + 1) // 2, bool(last % 2)))] if last < FOR_EVER else [])

    def to_json(self) -> dict[str, Any]:
        outside = [[value, first, None if last == FOR_EVER else last] for value, first, last in self.outside]
        return {"slot": self.slot, "clock": self.clock, "outside": outside}

    @classmethod
    def from_json(cls, given: Mapping[str, Any]) -> Trap:
        """The inverse of `to_json`. Raises TypeError, KeyError and ValueError for something else."""
        slot, clock = _number(given["slot"], 0), _number(given["clock"], 0)
        outside = tuple(
            (_number(value, -(1 << 31)), _number(first, 0), FOR_EVER if last is None else _number(last, first))
            for value, first, last in given["outside"]
        )
        return cls(slot, clock, outside)


def _number(given: object, least: int) -> int:
    if type(given) is not int or not least <= given < 1 << 42:
        raise ValueError("a number of a trap is none")
    return given


# ---- points of time -------------------------------------------------------------------------------------------------


def times_of(condition: Iterable[Iterable[Constraint]], clock: int) -> Times:
    """The values of one clock under a disjunction of constraints; what they say of others does not count."""
    if clock == 0:
        return ALWAYS if any(True for _ in condition) else ()
    found = []
    for conjunction in condition:
        first, last = 0, FOR_EVER
        for left, right, raw in conjunction:
            bound, strict = raw >> 1, not raw & 1
            if (left, right) == (clock, 0) and raw < INFINITY:
                last = min(last, 2 * bound - strict)
            if (left, right) == (0, clock) and raw < INFINITY:
                first = max(first, -2 * bound + strict)
        if first <= last:
            found.append(((first, last),))
    return union(found)


def union(parts: Iterable[Times]) -> Times:
    found: list[Interval] = []
    for first, last in sorted(interval for part in parts for interval in part):
        if found and first <= found[-1][1] + 1:
            found[-1] = found[-1][0], max(found[-1][1], last)
        else:
            found.append((first, last))
    return tuple(found)


def common(one: Times, other: Times) -> Times:
    pairs = ((max(a, c), min(b, d)) for a, b in one for c, d in other)
    return tuple(sorted(pair for pair in pairs if pair[0] <= pair[1]))


def complement(times: Times) -> Times:
    found, first = [], 0
    for start, end in times:
        if first < start:
            found.append((first, start - 1))
        first = end + 1
    if first <= FOR_EVER:
        found.append((first, FOR_EVER))
    return tuple(found)
