"""What stands at corresponding places of processes and of those that a renaming is to map them to.

Edges of a process, and updates of an edge that may come in any order, correspond as what is known so far allows: where
only one of the others has the same text up to what is not known yet, the two correspond, and whatever stands in them
does too. This is repeated until nothing new is told apart, as in the refinement of colours by which graphs are compared
(McKay, Piperno, "Practical graph isomorphism, II", J. Symbolic Computation 60, 2014). Processes that stay where they
are, such as a controller with an edge for each of the others, are asked too: each of their edges becomes another one of
them. What is still alike then corresponds in its order. Whether the renaming that comes out is right is for others to
prove.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import field

from tachk.base.records import dataclass
from tachk.base.span import Span
from tachk.engine.symmetry.automorphism import Atom, NetworkTerms, Renaming
from tachk.engine.symmetry.terms import KindedNumber, ProcessNumber, Token
from tachk.engine.symmetry.units import TermUnit
from tachk.model.expressions import Variable

Alike = tuple[Sequence[TermUnit], Sequence[TermUnit]]
"""Units, and others to which they correspond in some order: equally many of each outline."""


def corresponding(reading: NetworkTerms, processes: Mapping[int, int]) -> Iterator[tuple[Token, Token, Span]]:
    """What stands at corresponding places of each process and of its image, and what they declare."""
    matching = _Matching(reading, processes)
    left: list[Alike] = []
    for one, other in processes.items():
        first, second = (reading.network.processes[number] for number in (one, other))
        for variable, its_image in zip(first.variables, second.variables, strict=True):
            matching.note(variable, its_image)
            yield variable, its_image, its_image.span
        for unit, image in zip(reading.locations[one], reading.locations[other], strict=True):
            left.append(([unit], [image]))
        left.append((reading.edges[one], reading.edges[other]))
    while left:
        apart = [part for alike in left for part in matching.told_apart(*alike)]
        left = [part for part in apart if len(part[0]) > 1]
        found = [(unit, image) for (unit, *more), (image, *_) in apart if not more]
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
    """What is known to be mapped to what.

    Attributes:
        images, sources: of variables and numbers.
        asked: the edges of processes that stay that have been looked at.
    """

    reading: NetworkTerms
    processes: Mapping[int, int]
    images: dict[Atom, Atom] = field(default_factory=dict)
    sources: dict[Atom, Atom] = field(default_factory=dict)
    asked: set[tuple[int, int]] = field(default_factory=set)

    def note(self, token: Token, image: Token) -> None:
        one, other = self._atom(token), self._atom(image)
        if one is not None and other is not None:
            self.images.setdefault(one, other)
            self.sources.setdefault(other, one)

    def told_apart(self, units: Sequence[TermUnit], images: Sequence[TermUnit]) -> Iterable[Alike]:
        """Units that correspond to each other in some order, as far as can be told; those without a counterpart
        correspond to one of the same outline."""
        if len(units) <= 1:
            return [(units, images)] if units else []
        classes: dict[Hashable, tuple[list[TermUnit], list[TermUnit]]] = {}
        for unit in units:
            classes.setdefault(unit.text(self._told_image), ([], []))[0].append(unit)
        for image in images:
            classes.setdefault(image.text(self._told), ([], []))[1].append(image)
        alike = [each for each in classes.values() if len(each[0]) == len(each[1])]
        lonely: dict[Hashable, tuple[list[TermUnit], list[TermUnit]]] = {}
        for own, its_images in classes.values():
            if len(own) != len(its_images):
                for side, one in (*((0, unit) for unit in own), *((1, image) for image in its_images)):
                    lonely.setdefault(one.outline, ([], []))[side].append(one)
        return [*alike, *(([unit], [image]) for each in lonely.values() for unit, image in zip(*each, strict=True))]

    def partners(self, left: Iterable[Alike]) -> list[Alike]:
        """Edges of processes that stay and mention something that moves, or that what is left mentions and of which
        nothing is known. Edges of one process become each other."""
        atoms = {one for one, other in self.images.items() if one != other}
        tokens = (token for units, _ in left for unit in units for token in unit.every_token)
        atoms |= {atom for atom in map(self._atom, tokens) if atom is not None and atom not in self.images}
        found: dict[int, list[TermUnit]] = {}
        for process, number in sorted(self.reading.edges_with(atoms) - self.asked):
            if process not in self.processes:
                self.asked.add((process, number))
                found.setdefault(process, []).append(self.reading.edges[process][number])
        return [(units, units) for units in found.values()]

    def guessed(self, units: Sequence[TermUnit], images: Sequence[TermUnit]) -> list[tuple[TermUnit, TermUnit]]:
        """Of units that nothing tells apart: those that become each other if what is not known to move stays, where
        two processes are exchanged or one stays; all of them in their order if there are none."""
        if self.processes.get(images[0].process, images[0].process) == units[0].process:
            known = Renaming({**self.processes}, *self._moves())
            places: dict[Hashable, list[TermUnit]] = {}
            for image in images:
                places.setdefault(self.reading.text(image, Renaming()), []).append(image)
            found = []
            for unit in units:
                alike = places.get(self.reading.text(unit, known))
                if alike:
                    found.append((unit, alike.pop(0)))
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

    def _told_image(self, token: Token) -> Hashable:
        """What is known of the image of a token."""
        if isinstance(token, ProcessNumber):
            return ProcessNumber(self.processes.get(token.process, token.process))
        atom = self._atom(token)
        return self.reading.outline(token) if atom is None else self.images.get(atom) or self.reading.outline(token)

    def _told(self, token: Token) -> Hashable:
        """The same of a token that is an image."""
        if isinstance(token, ProcessNumber):
            return token
        atom = self._atom(token)
        return atom if atom in self.sources else self.reading.outline(token)

    def _atom(self, token: Token) -> Atom | None:
        """A variable, or a number that is a name."""
        if isinstance(token, Variable):
            return token
        if not isinstance(token, KindedNumber):
            return None
        root, shift = self.reading.kinds.find(token.node)
        return (root, token.value - shift) if self.reading.kinds.plain(root) is None else None
