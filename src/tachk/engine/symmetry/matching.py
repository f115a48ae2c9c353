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
from dataclasses import field

from tachk.base.records import dataclass
from tachk.base.span import Span
from tachk.engine.symmetry.automorphism import Atom, NetworkTerms, Renaming
from tachk.engine.symmetry.terms import IndexValue, ProcessNumber, Token
from tachk.engine.symmetry.units import TermUnit
from tachk.model.expressions import Variable

Alike = tuple[Sequence[TermUnit], Sequence[TermUnit]]
"""Units and the candidates that they are matched with in some order: equally many of each outline."""


def corresponding(terms: NetworkTerms, processes: Mapping[int, int]) -> Iterator[tuple[Token, Token, Span]]:
    """The pairs of tokens at matched places of each process and of its image, and of their declared variables."""
    matching = _Matching(terms, processes)
    left: list[Alike] = []
    for one, other in processes.items():
        first, second = (terms.network.processes[number] for number in (one, other))
        for variable, its_image in zip(first.variables, second.variables, strict=True):
            matching.note(variable, its_image)
            yield variable, its_image, its_image.span
        for unit, image in zip(terms.locations[one], terms.locations[other], strict=True):
            left.append(([unit], [image]))
        left.append((terms.edges[one], terms.edges[other]))
    while left:
        divided = [part for similar in left for part in matching.divided_classes(*similar)]
        left = [part for part in divided if len(part[0]) > 1]
        found = [(unit, image) for (unit, *more), (image, *_) in divided if not more]
        if not found:
            partners = matching.partners(left)
            left += partners
            if not partners:
                found = matching.guessed(*left.pop(0))
        for unit, image in found:
            for token, its_token in zip(unit.tokens, image.tokens, strict=True):
                matching.note(token, its_token)
                yield token, its_token, image.span
            left += zip(unit.loose, image.loose, strict=True)
        if not left:
            left = matching.partners(left)


@dataclass(slots=True)
class _Matching:
    """The pairs that are matched so far.

    Attributes:
        images, sources: of variables and numbers.
        symmetrised: the edges of fixed processes that have been matched.
    """

    terms: NetworkTerms
    processes: Mapping[int, int]
    images: dict[Atom, Atom] = field(default_factory=dict)
    sources: dict[Atom, Atom] = field(default_factory=dict)
    symmetrised: set[tuple[int, int]] = field(default_factory=set)

    def note(self, token: Token, image: Token) -> None:
        one, other = self._atom(token), self._atom(image)
        if one is not None and other is not None:
            self.images.setdefault(one, other)
            self.sources.setdefault(other, one)

    def divided_classes(self, units: Sequence[TermUnit], images: Sequence[TermUnit]) -> Iterable[Alike]:
        """Units that correspond to each other in some order, as far as that is decided; those without a counterpart
        correspond to one of the same outline."""
        if len(units) <= 1:
            return [(units, images)] if units else []
        classes: dict[Hashable, tuple[list[TermUnit], list[TermUnit]]] = {}
        for unit in units:
            classes.setdefault(unit.text(self._image_outline), ([], []))[0].append(unit)
        for image in images:
            classes.setdefault(image.text(self._outline), ([], []))[1].append(image)
        similar = [each for each in classes.values() if len(each[0]) == len(each[1])]
        lonely: dict[Hashable, tuple[list[TermUnit], list[TermUnit]]] = {}
        for own, its_images in classes.values():
            if len(own) != len(its_images):
                for side, one in (*((0, unit) for unit in own), *((1, image) for image in its_images)):
                    lonely.setdefault(one.outline, ([], []))[side].append(one)
        return [*similar, *(([unit], [image]) for each in lonely.values() for unit, image in zip(*each, strict=True))]

    def partners(self, left: Iterable[Alike]) -> list[Alike]:
        """Edges of processes that stay and mention something that moves, or that what is left mentions and of which
        nothing is known. Edges of one process become each other."""
        atoms = {one for one, other in self.images.items() if one != other}
        tokens = (token for units, _ in left for unit in units for token in unit.every_token)
        atoms |= {atom for atom in map(self._atom, tokens) if atom is not None and atom not in self.images}
        found: dict[int, list[TermUnit]] = {}
        for process, number in sorted(self.terms.edges_with(atoms) - self.symmetrised):
            if process not in self.processes:
                self.symmetrised.add((process, number))
                found.setdefault(process, []).append(self.terms.edges[process][number])
        return [(units, units) for units in found.values()]

    def guessed(self, units: Sequence[TermUnit], images: Sequence[TermUnit]) -> list[tuple[TermUnit, TermUnit]]:
        """Pairs of units with the same text: those that map to each other if everything stays that is not known to
        move, for a transposition or a process that stays; all of them in their order if there are none."""
        if self.processes.get(images[0].process, images[0].process) == units[0].process:
            known = Renaming({**self.processes}, *self._moves())
            places: dict[Hashable, list[TermUnit]] = {}
            for image in images:
                places.setdefault(self.terms.text(image, Renaming()), []).append(image)
            found = []
            for unit in units:
                similar = places.get(self.terms.text(unit, known))
                if similar:
                    found.append((unit, similar.pop(0)))
            if len(found) == len(units):
                return found
        return list(zip(units, images, strict=True))

    def _moves(self) -> tuple[dict[Variable, Variable], dict[int, dict[int, int]]]:
        variables: dict[Variable, Variable] = {}
        values: dict[int, dict[int, int]] = {}
        for one, other in self.images.items():
            if isinstance(one, Variable) and isinstance(other, Variable):
                variables[one] = other
            elif not isinstance(one, Variable | ProcessNumber) and not isinstance(other, Variable | ProcessNumber):
                values.setdefault(one[0], {})[one[1]] = other[1]
        return variables, values

    def _image_outline(self, token: Token) -> Hashable:
        """The image of a token as far as it is known."""
        if isinstance(token, ProcessNumber):
            return ProcessNumber(self.processes.get(token.process, token.process))
        atom = self._atom(token)
        return self.terms.outline(token) if atom is None else self.images.get(atom) or self.terms.outline(token)

    def _outline(self, token: Token) -> Hashable:
        """The same of a token that is an image."""
        if isinstance(token, ProcessNumber):
            return token
        atom = self._atom(token)
        return atom if atom in self.sources else self.terms.outline(token)

    def _atom(self, token: Token) -> Atom | None:
        """A variable, or a number that is a name."""
        if isinstance(token, Variable):
            return token
        if not isinstance(token, IndexValue):
            return None
        index_types = self.terms.index_types
        root, shift = index_types.find(token.node)
        return (root, token.value - shift) if index_types.plain(root) is None else None
