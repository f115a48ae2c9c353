"""Which processes may become each other at all: a refinement of colours over processes, variables and numbers.

Processes begin with the colour of their text up to what renamings move. A variable or a number gets the colour of the
places where it is mentioned, then a process that of what it mentions, and so on until no colour is divided any more
(one-dimensional Weisfeiler-Leman refinement; McKay, Piperno, "Practical graph isomorphism, II", J. Symbolic Computation
60, 2014). A renaming that maps the network onto itself keeps all colours. So it is enough to try processes that have
the same, of which there are few where all differ.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Iterable, Iterator, Sequence

from tachk.reduction.symmetry.automorphism import Atom, Reading
from tachk.reduction.symmetry.terms import Number, Place, Token
from tachk.reduction.symmetry.units import Unit

_Mention = tuple[Hashable, Atom]
"""Where in a location or an edge something is mentioned, and what."""


def colours_of_processes(reading: Reading) -> Sequence[int]:
    """A number for each process; those of different numbers never become each other."""
    if reading.colours is None:
        reading.colours = _refined(reading)
    return reading.colours


def _refined(reading: Reading) -> Sequence[int]:
    lines = [
        [
            *((("location", place, _text(reading, unit)), _mentions(reading, unit)) for place, unit in enumerate(here)),
            *((_text(reading, unit), _mentions(reading, unit)) for unit in edges),
        ]
        for here, edges in zip(reading.locations, reading.edges, strict=True)
    ]
    shapes = _numbers(text for own in lines for text, _ in own)
    shaped = iter(shapes)
    own_shapes = [[next(shaped) for _ in own] for own in lines]
    atoms = list(dict.fromkeys(atom for own in lines for _, mentions in own for _, atom in mentions))
    processes = _numbers(frozenset(Counter(own).items()) for own in own_shapes)
    colours = dict(zip(atoms, _numbers(map(_kind, atoms)), strict=True))
    while True:
        places: dict[Atom, Counter[Hashable]] = {atom: Counter() for atom in atoms}
        for process, own, its_shapes in zip(processes, lines, own_shapes, strict=True):
            for shape, (_, mentions) in zip(its_shapes, own, strict=True):
                for place, atom in mentions:
                    places[atom][process, shape, place] += 1
        divided = _numbers(
            (colours[atom], processes[atom.process] if isinstance(atom, Place) else None, frozenset(counted.items()))
            for atom, counted in places.items()
        )
        before, colours = colours, dict(zip(atoms, divided, strict=True))
        known, processes = (
            processes,
            _numbers(
                (
                    process,
                    frozenset(
                        Counter(
                            (shape, frozenset(Counter((place, colours[atom]) for place, atom in mentions).items()))
                            for shape, (_, mentions) in zip(its_shapes, own, strict=True)
                        ).items()
                    ),
                )
                for process, own, its_shapes in zip(processes, lines, own_shapes, strict=True)
            ),
        )
        if (max(known), max(before.values(), default=0)) == (max(processes), max(colours.values(), default=0)):
            return processes


def _numbers(things: Iterable[Hashable]) -> list[int]:
    """The same number for those that are equal."""
    found: dict[Hashable, int] = {}
    return [found.setdefault(thing, len(found)) for thing in things]


def _kind(atom: Atom) -> Hashable:
    match atom:
        case Place():
            return "a process"
        case (root, _):
            return root
        case _:
            return atom.type


def _text(reading: Reading, unit: Unit) -> Hashable:
    """Up to what renamings may move."""
    loose = (Counter(tuple(map(reading.outline, update.tokens)) for update in each) for each in unit.loose)
    return (tuple(map(reading.outline, unit.tokens)), *(frozenset(counted.items()) for counted in loose))


def _mentions(reading: Reading, unit: Unit) -> list[_Mention]:
    found = list(_mentioned(reading, unit.tokens, ()))
    for number, updates in enumerate(unit.loose):
        for update in updates:
            found += _mentioned(reading, update.tokens, (number, tuple(map(reading.outline, update.tokens))))
    return found


def _mentioned(reading: Reading, tokens: Iterable[Token], where: Hashable) -> Iterator[_Mention]:
    for place, token in enumerate(tokens):
        if isinstance(token, Number):
            root, shift = reading.kinds.find(token.node)
            if reading.kinds.plain(root) is None:
                yield (where, place), (root, token.value - shift)
        elif isinstance(token, Place) or not isinstance(token, str | tuple):
            yield (where, place), token
