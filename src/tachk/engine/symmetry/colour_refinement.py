"""Colour refinement: colours of processes are divided by the things that they mention until nothing changes.

Processes and the things that they mention begin with colours. In each round a thing is divided by the places where it
is mentioned, then a process by the colours of the things it mentions (one-dimensional Weisfeiler-Leman refinement;
McKay, Piperno, "Practical graph isomorphism, II", J. Symbolic Computation 60, 2014).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from typing import TypeVar

Thing = TypeVar("Thing", bound=Hashable)

Line = tuple[Hashable, Sequence[tuple[Hashable, Thing]]]
"""The shape of a line in the text of a process, and the things that it mentions, each with its place."""


def refined(
    lines: Sequence[Sequence[Line[Thing]]],
    processes: list[int],
    colours: Mapping[Thing, int],
    process_of: Callable[[Thing], int | None],
) -> list[int]:
    """The stable colours of processes: all of them differ, or another round divides nothing.

    Args:
        lines: of each process.
        processes: the colours of processes at the beginning.
        colours: those of all things.
        process_of: the number of the process if the thing is a process.
    """
    while len(set(processes)) < len(processes):
        places: dict[Thing, Counter[Hashable]] = {thing: Counter() for thing in colours}
        for process, own in zip(processes, lines, strict=True):
            for shape, mentions in own:
                for where, thing in mentions:
                    places[thing][process, shape, where] += 1
        divided = numbered(
            (colours[thing], None if (number := process_of(thing)) is None else processes[number], _set(counted))
            for thing, counted in places.items()
        )
        before = len(set(processes)), len(set(colours.values()))
        colours = dict(zip(colours, divided, strict=True))
        seen = (
            _set(Counter((shape, _set(Counter((w, colours[t]) for w, t in mentions))) for shape, mentions in own))
            for own in lines
        )
        processes = numbered(zip(processes, seen, strict=True))
        if before == (len(set(processes)), len(set(divided))):
            break
    return processes


def numbered(things: Iterable[Hashable]) -> list[int]:
    """Numbers for things: equal things have the same one."""
    found: dict[Hashable, int] = {}
    return [found.setdefault(thing, len(found)) for thing in things]


def _set(counted: Counter[Hashable]) -> Hashable:
    return frozenset(counted.items())
