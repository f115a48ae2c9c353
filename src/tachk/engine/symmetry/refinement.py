"""Which processes may become each other, by what they mention: colours that are divided until nothing changes.

Processes begin with colours, and so do the things that they mention. A thing gets the colour of the places where it is
mentioned, then a process that of what it mentions, and so on (one-dimensional Weisfeiler-Leman refinement; McKay,
Piperno, "Practical graph isomorphism, II", J. Symbolic Computation 60, 2014).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from typing import TypeVar

Thing = TypeVar("Thing", bound=Hashable)

Line = tuple[Hashable, Sequence[tuple[Hashable, Thing]]]
"""What a line of the text of a process is like, and the things that it mentions, each with where it does."""


def refined(
    lines: Sequence[Sequence[Line[Thing]]],
    processes: list[int],
    colours: Mapping[Thing, int],
    process_of: Callable[[Thing], int | None],
) -> list[int]:
    """The colours of processes at the end; all of them are different, or further division changes nothing.

    Args:
        lines: of each process.
        processes: the colours of processes at the beginning.
        colours: those of all things.
        process_of: the process that a thing is, if it is one.
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
    """The same number for those that are equal."""
    found: dict[Hashable, int] = {}
    return [found.setdefault(thing, len(found)) for thing in things]


def _set(counted: Counter[Hashable]) -> Hashable:
    return frozenset(counted.items())
