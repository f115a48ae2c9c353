"""A matching of the tokens of processes with those of the processes that a renaming is to map them to.

Edges of a process, and updates of an edge that may come in any order, are matched step by step: an edge whose text, up
to unmatched tokens, equals that of only one candidate is matched with it, and so are their tokens. This is repeated
until no new pair is found, as in the colour refinement of graphs (McKay, Piperno, "Practical graph isomorphism, II", J.
Symbolic Computation 60, 2014). Processes that are mapped to themselves, such as a controller with an edge for each of
the others, are matched too. Candidates that are still equal are matched in their order. The result is a guess;
`tachk.engine.symmetry.automorphism` proves the renaming.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from itertools import repeat

from tachk.base.span import Span
from tachk.engine.symmetry.automorphism import NetworkTerms
from tachk.engine.symmetry.terms import ProcessNumber, Token
from tachk.engine.symmetry.unit_texts import Atom, UnitText

Alike = tuple[Sequence[UnitText], Sequence[UnitText]]
"""Texts and the candidates that they are matched with in some order: equally many of each outline."""


def corresponding(terms: NetworkTerms, processes: Mapping[int, int]) -> Iterator[tuple[Token, Token, Span]]:
    """The pairs of tokens at matched places of each process and of its image, and of their declared variables.

    Tokens that are equal and not names may be left out.
    """
    matching = _Matching(terms, processes)
    left: list[Alike] = []
    for one, other in processes.items():
        first, second = (terms.network.processes[number] for number in (one, other))
        for variable, its_image in zip(first.variables, second.variables, strict=True):
            matching.note(variable, its_image)
            yield variable, its_image, its_image.span
        for text, image in zip(terms.location_texts[one], terms.location_texts[other], strict=True):
            left.append(([text], [image]))
        left.append((terms.edge_texts[one], terms.edge_texts[other]))
    while left:
        divided = [part for similar in left for part in matching.divided_classes(*similar)]
        left = [part for part in divided if len(part[0]) > 1]
        found = [(text, image) for (text, *more), (image, *_) in divided if not more]
        if not found:
            partners = matching.partners(left)
            left += partners
            if not partners:
                found = matching.guessed(*left.pop(0))
        for text, image in found:
            yield from matching.note_all(text, image)
            left += zip(text.loose, image.loose, strict=True)
        if not left:
            left = matching.partners(left)


class _Matching:
    """The pairs that are matched so far."""

    def __init__(self, terms: NetworkTerms, processes: Mapping[int, int]) -> None:
        self._terms = terms
        self._processes = processes
        self._images: dict[Atom, Atom] = {}
        self._reached: dict[Atom, Atom] = {}  # images, each with itself
        self._moved: dict[Atom, None] = {}  # those that are not their own image
        self._followed: set[Atom] = set()
        self._symmetrised: set[tuple[int, int]] = set()
        for atom in terms.tested:
            self._images[atom] = ProcessNumber(processes.get(atom.process, atom.process))
            self._reached[atom] = atom

    def note(self, atom: Atom, image: Atom) -> None:
        if isinstance(atom, ProcessNumber):
            return
        if self._images.setdefault(atom, image) != atom:
            self._moved[atom] = None
        self._reached.setdefault(image, image)

    def note_all(self, text: UnitText, image: UnitText) -> Iterator[tuple[Token, Token, Span]]:
        """Notes that the names of a text become those of its image; the pairs of tokens."""
        if text.pattern == image.pattern:
            for atom, its_image in zip(text.atoms, image.atoms, strict=True):
                self.note(atom, its_image)
            return zip(text.tokens, image.tokens, repeat(image.span))
        pairs = list(zip(text.unit.tokens, image.unit.tokens, strict=True))
        names, its_names = (dict(zip(each.tokens, each.atoms, strict=True)) for each in (text, image))
        for token, its_token in pairs:
            if token in names and its_token in its_names:
                self.note(names[token], its_names[its_token])
        return ((token, its_token, image.span) for token, its_token in pairs)

    def divided_classes(self, texts: Sequence[UnitText], images: Sequence[UnitText]) -> Iterable[Alike]:
        """Texts that correspond to each other in some order, as far as that is decided; those without a counterpart
        correspond to one of the same outline."""
        if len(texts) <= 1:
            return [(texts, images)] if texts else []
        classes: dict[Hashable, tuple[list[UnitText], list[UnitText]]] = {}
        for text in texts:
            classes.setdefault(text.known(self._images), ([], []))[0].append(text)
        for image in images:
            classes.setdefault(image.known(self._reached), ([], []))[1].append(image)
        similar = [each for each in classes.values() if len(each[0]) == len(each[1])]
        if len(similar) == len(classes):
            return similar
        lonely: dict[Hashable, tuple[list[UnitText], list[UnitText]]] = {}
        for own, its_images in classes.values():
            if len(own) != len(its_images):
                for side, one in (*((0, text) for text in own), *((1, image) for image in its_images)):
                    lonely.setdefault(one.unit.outline, ([], []))[side].append(one)
        return [*similar, *(([text], [image]) for each in lonely.values() for text, image in zip(*each, strict=True))]

    def partners(self, left: Iterable[Alike]) -> list[Alike]:
        """Edges of processes that stay and mention something that moves, or that what is left mentions and of which
        nothing is known. Edges of one process become each other."""
        atoms = {*self._moved}
        atoms.update(atom for texts, _ in left for text in texts for atom in text.names if atom not in self._images)
        atoms -= self._followed
        self._followed |= atoms
        found: dict[int, list[UnitText]] = {}
        for process, number in sorted(self._terms.edges_with(atoms) - self._symmetrised):
            if process not in self._processes:
                self._symmetrised.add((process, number))
                found.setdefault(process, []).append(self._terms.edge_texts[process][number])
        return [(texts, texts) for texts in found.values()]

    def guessed(self, texts: Sequence[UnitText], images: Sequence[UnitText]) -> list[tuple[UnitText, UnitText]]:
        """Pairs with the same text: those that map to each other if everything stays that is not known to move, for a
        transposition or a process that stays; all of them in their order if there are none."""
        process, its_image = texts[0].unit.process, images[0].unit.process
        if self._processes.get(its_image, its_image) == process:
            places: dict[int | None, list[UnitText]] = {}
            for image in images:
                places.setdefault(image.same, []).append(image)
            found = []
            for text in texts:
                similar = places.get(self._terms.texts.renamed(text, self._images))
                if similar:
                    found.append((text, similar.pop(0)))
            if len(found) == len(texts):
                return found
        return list(zip(texts, images, strict=True))
