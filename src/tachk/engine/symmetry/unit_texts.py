"""The texts of locations and edges, divided into the names that renamings move and the rest.

Texts are read once, when the index types are known. The rest of a text is a number, so that two texts are compared by
their numbers and their few names.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Iterable, Mapping

from tachk.base.records import dataclass, field
from tachk.base.span import Span
from tachk.engine.symmetry.index_types import IndexTypes
from tachk.engine.symmetry.terms import IndexValue, ProcessNumber, Token
from tachk.engine.symmetry.units import TermUnit
from tachk.model.expressions import Variable

Atom = Variable | ProcessNumber | tuple[int, int]
"""An atom that a renaming may move: a variable, a process, or a number of an index type."""


@dataclass(frozen=True, slots=True, eq=False)
class UnitText:
    """A location, an edge or an update.

    Attributes:
        pattern: the text up to names: equal numbers for equal texts.
        same: the text itself: equal numbers for equal texts.
        atoms: the names at the places where renamings may move something, in the order of the text.
        names: all atoms, those of updates in any order too.
        tokens: the tokens of `atoms`.
        frame: the text without names and numbers, as a number.
        items: names and numbers in the order of the text.
        places: for each of `atoms` its place in `items`, and the shift of its index type.
        loose: sets of updates that may come in any order.
    """

    unit: TermUnit
    pattern: int
    same: int
    atoms: tuple[Atom, ...]
    names: frozenset[Atom]
    tokens: tuple[Token, ...]
    frame: int
    items: tuple[Hashable, ...]
    places: tuple[tuple[int, int], ...]
    loose: tuple[tuple[UnitText, ...], ...]

    @property
    def span(self) -> Span:
        return self.unit.span

    @property
    def every_token(self) -> Iterable[Token]:
        return self.unit.every_token

    def known(self, images: Mapping[Atom, Atom]) -> Hashable:
        """The text as far as the images of names are known; updates in any order have none."""
        own = (self.pattern, *map(images.get, self.atoms))
        return (
            (own, *(_counted(update.known(images) for update in updates) for updates in self.loose))
            if (self.loose)
            else own
        )


@dataclass(slots=True)
class UnitTexts:
    """The numbers of texts."""

    index_types: IndexTypes
    _words: dict[Token, int] = field(default_factory=dict)
    _types: dict[Hashable, int] = field(default_factory=dict)
    _variables: dict[Variable, int] = field(default_factory=dict)
    _frames: dict[Hashable, int] = field(default_factory=dict)
    _patterns: dict[Hashable, int] = field(default_factory=dict)
    _texts: dict[Hashable, int] = field(default_factory=dict)

    def read(self, unit: TermUnit) -> UnitText:
        find, plain, words = self.index_types.find, self.index_types.plain, self._words
        frame: list[int] = []
        items: list[Hashable] = []
        outline: list[Hashable] = []
        atoms: list[Atom] = []
        tokens: list[Token] = []
        places: list[tuple[int, int]] = []
        for token in unit.tokens:
            if isinstance(token, IndexValue):
                root, shift = find(token.node)
                if plain(root) is not None:
                    outline.append(token.value)
                else:
                    outline.append("a name")
                    atoms.append((root, token.value - shift))
                    tokens.append(token)
                    places.append((len(items), shift))
                items.append(token.value)
                frame.append(-1)
            elif isinstance(token, Variable | ProcessNumber):
                outline.append(("a variable", self._type(token)) if isinstance(token, Variable) else "a process")
                atoms.append(token)
                tokens.append(token)
                places.append((len(items), 0))
                items.append(token)
                frame.append(-1)
            else:
                frame.append(words.setdefault(token, len(words)))
        loose = tuple(tuple(map(self.read, updates)) for updates in unit.loose)
        of_frame = _number(self._frames, tuple(frame))
        patterns = (_counted(update.pattern for update in updates) for updates in loose)
        texts = (_counted(update.same for update in updates) for updates in loose)
        return UnitText(
            unit,
            _number(self._patterns, (of_frame, tuple(outline), *patterns)),
            _number(self._texts, (of_frame, tuple(items), *texts)),
            tuple(atoms),
            frozenset(atoms).union(*(update.names for updates in loose for update in updates)),
            tuple(tokens),
            of_frame,
            tuple(items),
            tuple(places),
            loose,
        )

    def renamed(self, text: UnitText, moved: Mapping[Atom, Atom]) -> int | None:
        """The number of the renamed text; None if no location, edge or update has this text."""
        if text.names.isdisjoint(moved):
            return text.same
        items = list(text.items)
        for atom, (place, shift) in zip(text.atoms, text.places, strict=True):
            image = moved.get(atom)
            if image is not None:
                items[place] = image if isinstance(image, Variable | ProcessNumber) else image[1] + shift
        loose = (_counted(self.renamed(update, moved) for update in updates) for updates in text.loose)
        return self._texts.get((text.frame, tuple(items), *loose))

    def _type(self, variable: Variable) -> int:
        number = self._variables.get(variable)
        if number is None:
            number = self._variables[variable] = _number(self._types, variable.type)
        return number


def _number(numbers: dict[Hashable, int], thing: Hashable) -> int:
    return numbers.setdefault(thing, len(numbers))


def _counted(things: Iterable[Hashable]) -> Hashable:
    return frozenset(Counter(things).items())
