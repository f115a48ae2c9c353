"""Changed machines, and whether an observer can distinguish them from the machine they were made of.

The oracle goes through the runs of the changed machine at whole times, with the set of all places in which the first
one may be after the same events (a subset construction).
"""

from __future__ import annotations

from dataclasses import replace
from random import Random

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

Set = frozenset[Place]


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


def can_be_distinguished(model: Machine, system: Machine) -> bool:
    """Whether the system can do something at a whole time up to the length of a test that the model cannot."""
    start = (Place(), _closed(model, frozenset({Place()})))
    present, now = {start}, 0
    while True:
        pending = list(present)
        while pending:
            place, expected = pending.pop()
            for after, others in _events(model, system, place, expected):
                if not others:
                    return True
                if (after, others) not in present:
                    present.add((after, others))
                    pending.append((after, others))
        if now == LENGTH:
            return False
        following = set()
        for place, expected in present:
            passed = after_a_unit((system,), (place,))
            if passed is None:
                continue
            others = frozenset(after[0] for each in expected if (after := after_a_unit((model,), (each,))) is not None)
            if not others:
                return True
            following.add((passed[0], _closed(model, others)))
        present, now = following, now + 1


def _events(model: Machine, system: Machine, place: Place, expected: Set):  # type: ignore[no-untyped-def]
    for _, after in moves(system, place, ""):
        yield after, expected
    for edge, after in moves(system, place, "out"):
        others = (
            other
            for each in expected
            for same, other in moves(model, each, "out", edge.key)
            if same.number == edge.number
        )
        yield after, _closed(model, frozenset(others))
    for key in range(KEYS):
        received = _closed(model, frozenset(other for each in expected for other in hears(model, each, key)))
        if received:  # else the environment cannot send it
            for after in hears(system, place, key):
                yield after, received


def _closed(machine: Machine, places: Set) -> Set:
    """With what is reached by internal steps in no time."""
    found, pending = set(places), list(places)
    while pending:
        for _, after in moves(machine, pending.pop(), ""):
            if after not in found:
                found.add(after)
                pending.append(after)
    return frozenset(found)
