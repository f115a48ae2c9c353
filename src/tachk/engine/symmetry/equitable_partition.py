"""The equitable partition of the processes of a network: automorphisms map processes to processes of their colour.

Processes begin with the colour of their text up to renamings; colour refinement divides them by the variables and
processes that they mention (`tachk.engine.symmetry.colour_refinement`). As automorphisms keep all colours, only
processes of one colour need be tried.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Sequence

from tachk.engine.symmetry.automorphism import NetworkTerms
from tachk.engine.symmetry.colour_refinement import Line, numbered, refined
from tachk.engine.symmetry.terms import ProcessNumber
from tachk.engine.symmetry.unit_texts import Atom, UnitText

_Mention = tuple[Hashable, Atom]
"""The place of a mention in a location or an edge, and the atom that is mentioned there."""


def equitable_partition(terms: NetworkTerms) -> Sequence[int]:
    """The colour of each process; no automorphism maps a process to one of another colour."""
    if terms.colours is None:
        terms.colours = _refined(terms)
    return terms.colours


def _refined(terms: NetworkTerms) -> Sequence[int]:
    lines: list[list[Line[Atom]]] = [
        [
            *((("location", place, text.pattern), _mentions(text)) for place, text in enumerate(here)),
            *((text.pattern, _mentions(text)) for text in edges),
        ]
        for here, edges in zip(terms.location_texts, terms.edge_texts, strict=True)
    ]
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


def _mentions(text: UnitText) -> list[_Mention]:
    found: list[_Mention] = list(enumerate(text.atoms))
    for number, updates in enumerate(text.loose):
        for update in updates:
            found += (((number, update.pattern, place), atom) for place, atom in enumerate(update.atoms))
    return found
