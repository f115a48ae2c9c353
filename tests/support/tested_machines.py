"""Changed machines, and whether an observer can distinguish them from the machine they were made of.

The oracle goes through the runs of the changed machine at whole times, with the set of all places in which the first
one may be after the same events (a subset construction).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from functools import cache, reduce
from operator import or_
from random import Random

import networkx as nx

from tests.unit.recordings.conformance.small_models import (
    KEYS,
    LONGEST,
    Machine,
    Place,
    after_a_unit,
    hears,
    moves,
)

LENGTH = 14
"""Time units of a test."""


def mutated_machine(random: Random, machine: Machine) -> Machine:
    """The machine with one change."""
    place = random.randrange(len(machine.edges))
    edge = machine.edges[place]

    def with_edges(*others: object) -> Machine:
        return replace(machine, edges=(*machine.edges[:place], *others, *machine.edges[place + 1 :]))  # type: ignore[arg-type]

    match random.randrange(9):
        case 0:
            return with_edges(replace(edge, low=max(edge.low + random.choice((-1, 1)), 0)))
        case 1:
            return with_edges(replace(edge, high=max(min(edge.high + random.choice((-1, 1, 2)), LONGEST), edge.low)))
        case 2:
            return with_edges(replace(edge, resets=not edge.resets))
        case 3:
            return with_edges(replace(edge, target=random.randrange(len(machine.invariants))))
        case 4:
            return with_edges(replace(edge, number=(edge.number + 1) % 3, key=edge.key))
        case 5:
            return with_edges(replace(edge, key=(edge.key + 1) % KEYS))
        case 6 if len(machine.edges) > 1:
            return with_edges()
        case 7:
            return with_edges(edge, replace(edge, target=random.randrange(len(machine.invariants)), low=0))
        case _:
            number = random.randrange(len(machine.invariants))
            bound = min(max(machine.invariants[number] + random.choice((-1, 1)), 1), LONGEST)
            return replace(machine, invariants=(*machine.invariants[:number], bound, *machine.invariants[number + 1 :]))


def is_zeno(machine: Machine) -> bool:
    """True if the machine may act without end in no time: round a cycle that resets no clock, or waits nowhere."""
    own = [edge for edge in machine.edges if edge.label in ("", "out")]
    return any(
        not nx.is_directed_acyclic_graph(nx.MultiDiGraph((edge.source, edge.target) for edge in edges))
        for edges in ([e for e in own if not e.resets], [e for e in own if e.low == 0])
    )


def can_be_distinguished(model: Machine, system: Machine) -> bool:
    """Whether the system can do something at a whole time up to the length of a test that the model cannot."""
    expected, actual = _SetsOfPlaces(model), _Successors(system)
    start = (Place(), expected.closed(1))
    seen, present = {start}, [start]
    for now in range(LENGTH + 1):
        reached = []
        while present:
            place, others = present.pop()
            reached.append((place, others))
            for after, possible in _events(expected, actual, place, others):
                if not possible:
                    return True
                if (after, possible) not in seen:
                    seen.add((after, possible))
                    present.append((after, possible))
        if now == LENGTH:
            return False
        for place, others in reached:
            passed = actual.later(place)
            if passed is None:
                continue
            possible = expected.later(others)
            if not possible:
                return True
            if (passed, possible) not in seen:
                seen.add((passed, possible))
                present.append((passed, possible))
    return False


def _events(expected: _SetsOfPlaces, actual: _Successors, place: Place, others: int) -> Iterator[tuple[Place, int]]:
    for after in actual.internal(place):
        yield after, others
    for key, number, after in actual.outputs(place):
        yield after, expected.output(others, key, number)
    for key in range(KEYS):
        received = expected.input(others, key)
        if received:  # else the environment cannot send it
            for after in actual.input(place, key):
                yield after, received


class _Successors:
    """What a machine may do in each place, computed once."""

    def __init__(self, machine: Machine) -> None:
        def later(place: Place) -> Place | None:
            passed = after_a_unit((machine,), (place,))
            return None if passed is None else passed[0]

        self.internal = cache(lambda place: [after for _, after in moves(machine, place, "")])
        self.outputs = cache(lambda place: [(e.key, e.number, after) for e, after in moves(machine, place, "out")])
        self.input = cache(lambda place, key: hears(machine, place, key))
        self.later = cache(later)


class _SetsOfPlaces:
    """The same of sets of places, with what is reached by internal steps in no time. A set is a number, whose bits
    stand for places."""

    def __init__(self, machine: Machine) -> None:
        single = _Successors(machine)

        def joined(places: Iterable[Place]) -> int:
            return reduce(or_, (1 << _number(place) for place in places), 0)

        def of_all(some: int, successors: Callable[[Place], Iterable[Place]]) -> int:
            return closed(reduce(or_, (joined(successors(place)) for place in _places(some)), 0))

        @cache
        def closed(some: int) -> int:
            found = some | reduce(or_, (joined(single.internal(place)) for place in _places(some)), 0)
            return found if found == some else closed(found)

        self.closed = closed
        self.output = cache(
            lambda some, key, number: of_all(
                some, lambda place: [a for k, n, a in single.outputs(place) if (k, n) == (key, number)]
            )
        )
        self.input = cache(lambda some, key: of_all(some, lambda place: single.input(place, key)))
        self.later = cache(
            lambda some: of_all(some, lambda place: [] if (after := single.later(place)) is None else [after])
        )


def _number(place: Place) -> int:
    return place.location * (LONGEST + 1) + place.clock


def _places(some: int) -> Iterator[Place]:
    while some:
        number = (some & -some).bit_length() - 1
        yield Place(*divmod(number, LONGEST + 1))
        some &= some - 1
