"""Cyclic symmetry: a rotation moves each process to the place of the next one, though no two can be exchanged.

Instances of a template in their order, or every second one and so on, are candidates for a rotation. The variables and
numbers that move with them are those in which the texts of neighbours differ; `tachk.engine.symmetry.automorphism`
proves that the rotation maps the network and its predicates onto themselves.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from itertools import combinations
from typing import TypeVar

from tachk.base.records import dataclass
from tachk.engine.symmetry.automorphism import NetworkTerms
from tachk.engine.symmetry.index_types import AsymmetryReason
from tachk.engine.symmetry.matching import corresponding
from tachk.engine.symmetry.renaming import Block, Renaming
from tachk.engine.symmetry.terms import IndexValue, Shift
from tachk.model.expressions import Variable
from tachk.model.types import IntType, ScalarType
from tachk.model.variable_layout import default_values

T = TypeVar("T", bound=Hashable)


@dataclass(frozen=True, slots=True)
class CyclicOrbit:
    """Blocks that a cyclic group of automorphisms rotates.

    Attributes:
        members: the blocks in the order of the rotation.
        rotation: moves each to the place of the next one. Whatever it moves returns after as many rotations as there
            are members, and not before.
    """

    members: tuple[Block, ...]
    rotation: Renaming


def find_cyclic_orbit(terms: NetworkTerms, families: Sequence[Sequence[int]]) -> CyclicOrbit | AsymmetryReason:
    """The largest cyclic orbit with equally many processes of each family, or the reason why there is none."""
    size = len(families[0])
    reason: AsymmetryReason | None = None
    for step in range(1, size // 2 + 1):
        if size % step != 0:
            continue
        rotation = _proved_rotation(terms, families, step)
        if isinstance(rotation, Renaming):
            blocks = [
                tuple(number for family in families for number in family[at : at + step]) for at in range(0, size, step)
            ]
            return CyclicOrbit(tuple(blocks), rotation)
        reason = reason or rotation
    return reason or AsymmetryReason("there is only one of them")


def _proved_rotation(terms: NetworkTerms, families: Sequence[Sequence[int]], step: int) -> Renaming | AsymmetryReason:
    """The renaming that moves each process of a family to the place of the process `step` places later, if it is an
    automorphism; or the reason why it is not."""
    processes = {
        number: family[(place + step) % len(family)] for family in families for place, number in enumerate(family)
    }
    objection = terms.objection_of_tests(processes)
    if objection is not None:
        return objection
    network, key = terms.of_network, (tuple(map(tuple, families)), step)
    found = terms.shared.rotations.get(key)
    if found is None:
        found = _rotation(network, processes, len(families[0]) // step)
        if isinstance(found, Renaming):
            found = network.objection(found) or found
        terms.shared.rotations[key] = found
    return found if isinstance(found, AsymmetryReason) else terms.objection_of_predicates(found) or found


def _rotation(terms: NetworkTerms, processes: Mapping[int, int], turns: int) -> Renaming | AsymmetryReason:
    """A renaming that moves the processes so and returns after so many turns; it is not proved yet."""
    variables: dict[Variable, Variable] = {}
    values: dict[int, dict[int, int]] = {}

    def goes_to(node: int, value: int, image: int) -> bool:
        root, shift = terms.index_types.find(node)
        return values.setdefault(root, {}).setdefault(value - shift, image - shift) == image - shift

    for token, another, span in corresponding(terms, processes):
        if isinstance(token, IndexValue) and isinstance(another, IndexValue):
            if not goes_to(token.node, token.value, another.value):
                return AsymmetryReason("their numbers do not correspond one to one", span)
        elif isinstance(token, Variable) and isinstance(another, Variable):
            if variables.setdefault(token, another) is not another:
                return AsymmetryReason(f"`{token.name}` and `{another.name}` do not correspond one to one", span)
        elif isinstance(token, Shift) and token != another:
            return AsymmetryReason("they compute with their numbers", span)
    for variable, image in variables.items():
        node = terms.reader.tree_of(variable)
        if isinstance(node, int) and isinstance(variable.type, IntType | ScalarType):
            (before,), (after,) = (each.initial or default_values(each.type) for each in (variable, image))
            if not goes_to(node, before, after) and terms.is_constant(variable):
                return AsymmetryReason(f"`{variable.name}` and `{image.name}` have different numbers", image.span)
    moved = {one: other for one, other in variables.items() if one is not other}
    moved_values = {root: {one: other for one, other in of.items() if one != other} for root, of in values.items()}
    moved_values = {root: of for root, of in moved_values.items() if of}
    if not _returns_after(turns, moved) or not all(_returns_after(turns, of) for of in moved_values.values()):
        return AsymmetryReason("what belongs to them does not go round with them")
    return Renaming(processes, moved, moved_values)


def _returns_after(turns: int, moves: Mapping[T, T]) -> bool:
    """True if every orbit of the permutation has exactly `turns` elements."""
    return set(moves) == set(moves.values()) and all(len(orbit) == turns for orbit in orbits(moves))


def orbits(moves: Mapping[T, T]) -> Iterator[list[T]]:
    """The orbits of a permutation, each element followed by its image, in the order of the mapping."""
    seen: set[T] = set()
    for first in moves:
        if first in seen:
            continue
        orbit = [first]
        while moves[orbit[-1]] != first:
            orbit.append(moves[orbit[-1]])
        seen.update(orbit)
        yield orbit


def subsets(items: Sequence[T]) -> Iterator[tuple[T, ...]]:
    """The subsets that are tried as families: all items, then pairs, then single items."""
    yield tuple(items)
    if len(items) > 2:
        yield from combinations(items, 2)
    if len(items) > 1:
        yield from ((item,) for item in items)
