"""Which processes may become each other at all: colours by all that is written about them.

Processes begin with the colour of their text up to what renamings move, and are divided by what they mention
(`tachk.engine.symmetry.refinement`). A renaming that maps the network onto itself keeps all colours. So it is enough
to try processes that have the same, of which there are few where all differ.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Iterable, Iterator, Sequence

from tachk.engine.symmetry.automorphism import Atom, NetworkTerms
from tachk.engine.symmetry.refinement import numbered, refined
from tachk.engine.symmetry.terms import KindedNumber, ProcessNumber, Token
from tachk.engine.symmetry.units import TermUnit

_Mention = tuple[Hashable, Atom]
"""Where in a location or an edge something is mentioned, and what."""


def colours_of_processes(reading: NetworkTerms) -> Sequence[int]:
    """A number for each process; those of different numbers never become each other."""
    if reading.colours is None:
        reading.colours = _refined(reading)
    return reading.colours


def _refined(reading: NetworkTerms) -> Sequence[int]:
    told = reading.outline
    texts = [
        [
            *((("location", place, unit.text(told)), _mentions(reading, unit)) for place, unit in enumerate(here)),
            *((unit.text(told), _mentions(reading, unit)) for unit in edges),
        ]
        for here, edges in zip(reading.locations, reading.edges, strict=True)
    ]
    shapes = numbered(text for own in texts for text, _ in own)
    shaped = iter(shapes)
    lines = [[(next(shaped), mentions) for _, mentions in own] for own in texts]
    atoms = list(dict.fromkeys(atom for own in lines for _, mentions in own for _, atom in mentions))
    processes = numbered(frozenset(Counter(shape for shape, _ in own).items()) for own in lines)
    colours = dict(zip(atoms, numbered(map(_kind, atoms)), strict=True))
    return refined(lines, processes, colours, lambda atom: atom.process if isinstance(atom, ProcessNumber) else None)


def _kind(atom: Atom) -> Hashable:
    match atom:
        case ProcessNumber():
            return "a process"
        case (root, _):
            return root
        case _:
            return atom.type


def _mentions(reading: NetworkTerms, unit: TermUnit) -> list[_Mention]:
    found = list(_mentioned(reading, unit.tokens, ()))
    for number, updates in enumerate(unit.loose):
        for update in updates:
            found += _mentioned(reading, update.tokens, (number, tuple(map(reading.outline, update.tokens))))
    return found


def _mentioned(reading: NetworkTerms, tokens: Iterable[Token], where: Hashable) -> Iterator[_Mention]:
    for place, token in enumerate(tokens):
        if isinstance(token, KindedNumber):
            root, shift = reading.kinds.find(token.node)
            if reading.kinds.plain(root) is None:
                yield (where, place), (root, token.value - shift)
        elif isinstance(token, ProcessNumber) or not isinstance(token, str | tuple):
            yield (where, place), token
