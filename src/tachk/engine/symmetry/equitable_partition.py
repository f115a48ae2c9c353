"""The equitable partition of the processes of a network: automorphisms map processes to processes of their colour.

Processes begin with the colour of their text up to renamings; colour refinement divides them by the variables and
processes that they mention (`tachk.engine.symmetry.colour_refinement`). As automorphisms keep all colours, only
processes of one colour need be tried.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Iterable, Iterator, Sequence

from tachk.engine.symmetry.automorphism import Atom, NetworkTerms
from tachk.engine.symmetry.colour_refinement import numbered, refined
from tachk.engine.symmetry.terms import IndexValue, ProcessNumber, Token
from tachk.engine.symmetry.units import TermUnit

_Mention = tuple[Hashable, Atom]
"""The place of a mention in a location or an edge, and the atom that is mentioned there."""


def equitable_partition(terms: NetworkTerms) -> Sequence[int]:
    """The colour of each process; no automorphism maps a process to one of another colour."""
    if terms.colours is None:
        terms.colours = _refined(terms)
    return terms.colours


def _refined(terms: NetworkTerms) -> Sequence[int]:
    outline = terms.outline
    texts = [
        [
            *((("location", place, unit.text(outline)), _mentions(terms, unit)) for place, unit in enumerate(here)),
            *((unit.text(outline), _mentions(terms, unit)) for unit in edges),
        ]
        for here, edges in zip(terms.locations, terms.edges, strict=True)
    ]
    shapes = numbered(text for own in texts for text, _ in own)
    shaped = iter(shapes)
    lines = [[(next(shaped), mentions) for _, mentions in own] for own in texts]
    atoms = list(dict.fromkeys(atom for own in lines for _, mentions in own for _, atom in mentions))
    processes = numbered(frozenset(Counter(shape for shape, _ in own).items()) for own in lines)
    colours = dict(zip(atoms, numbered(map(_shape, atoms)), strict=True))
    return refined(lines, processes, colours, lambda atom: atom.process if isinstance(atom, ProcessNumber) else None)


def _shape(atom: Atom) -> Hashable:
    match atom:
        case ProcessNumber():
            return "a process"
        case (root, _):
            return root
        case _:
            return atom.type


def _mentions(terms: NetworkTerms, unit: TermUnit) -> list[_Mention]:
    found = list(_mentioned(terms, unit.tokens, ()))
    for number, updates in enumerate(unit.loose):
        for update in updates:
            found += _mentioned(terms, update.tokens, (number, tuple(map(terms.outline, update.tokens))))
    return found


def _mentioned(terms: NetworkTerms, tokens: Iterable[Token], where: Hashable) -> Iterator[_Mention]:
    for place, token in enumerate(tokens):
        if isinstance(token, IndexValue):
            root, shift = terms.index_types.find(token.node)
            if terms.index_types.plain(root) is None:
                yield (where, place), (root, token.value - shift)
        elif isinstance(token, ProcessNumber) or not isinstance(token, str | tuple):
            yield (where, place), token
