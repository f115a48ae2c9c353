"""Processes in a circle: all of them can be moved on at the same time, though no two can be exchanged.

Instances of a template in their order, or every second one and so on, are candidates for a rotation. What must be moved
together with them is read off where the texts of neighbours differ; `tachk.engine.symmetry.automorphism` proves that
the rotation maps the network, and what is asked of it, onto itself.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from itertools import combinations
from typing import TypeVar

from tachk.base.records import dataclass
from tachk.engine.symmetry.automorphism import NetworkTerms, Renaming
from tachk.engine.symmetry.correspondence import corresponding
from tachk.engine.symmetry.kinds import AsymmetryReason
from tachk.engine.symmetry.terms import KindedNumber, Shift
from tachk.model.cell_layout import default_cells
from tachk.model.expressions import Variable
from tachk.model.types import IntType, ScalarType

Team = tuple[int, ...]
"""The numbers of processes that are moved together."""

T = TypeVar("T", bound=Hashable)


@dataclass(frozen=True, slots=True)
class Ring:
    """Teams in a circle.

    Attributes:
        members: in the order of the circle.
        rotation: moves each to the place of the next one. Whatever it moves returns after as many rotations as there
            are members, and not before.
    """

    members: tuple[Team, ...]
    rotation: Renaming


def find_ring(reading: NetworkTerms, families: Sequence[Sequence[int]]) -> Ring | AsymmetryReason:
    """The largest ring in which equally many processes of some families stand, or why the whole of them is none."""
    size = len(families[0])
    reason: AsymmetryReason | None = None
    for step in range(1, size // 2 + 1):
        if size % step != 0:
            continue
        rotation = _rotation(reading, families, step)
        if isinstance(rotation, Renaming):
            refusal = reading.objection(rotation)
            if refusal is None:
                teams = [
                    tuple(number for family in families for number in family[at : at + step])
                    for at in range(0, size, step)
                ]
                return Ring(tuple(teams), rotation)
        else:
            refusal = rotation
        reason = reason or refusal
    return reason or AsymmetryReason("there is only one of them")


def _rotation(reading: NetworkTerms, families: Sequence[Sequence[int]], step: int) -> Renaming | AsymmetryReason:
    """What moves each process of a family to the place of the one that comes some steps behind it."""
    processes = {
        number: family[(place + step) % len(family)] for family in families for place, number in enumerate(family)
    }
    variables: dict[Variable, Variable] = {}
    values: dict[int, dict[int, int]] = {}

    def goes_to(node: int, value: int, image: int) -> bool:
        root, shift = reading.kinds.find(node)
        return values.setdefault(root, {}).setdefault(value - shift, image - shift) == image - shift

    for token, another, span in corresponding(reading, processes):
        if isinstance(token, KindedNumber) and isinstance(another, KindedNumber):
            if not goes_to(token.node, token.value, another.value):
                return AsymmetryReason("their numbers do not correspond one to one", span)
        elif isinstance(token, Variable) and isinstance(another, Variable):
            if variables.setdefault(token, another) is not another:
                return AsymmetryReason(f"`{token.name}` and `{another.name}` do not correspond one to one", span)
        elif isinstance(token, Shift) and token != another:
            return AsymmetryReason("they compute with their numbers", span)
    for variable, image in variables.items():
        node = reading.reader.tree_of(variable)
        if isinstance(node, int) and isinstance(variable.type, IntType | ScalarType):
            (before,), (after,) = (each.initial or default_cells(each.type) for each in (variable, image))
            if not goes_to(node, before, after) and reading.is_constant(variable):
                return AsymmetryReason(f"`{variable.name}` and `{image.name}` have different numbers", image.span)
    moved = {one: other for one, other in variables.items() if one is not other}
    moved_values = {root: {one: other for one, other in of.items() if one != other} for root, of in values.items()}
    moved_values = {root: of for root, of in moved_values.items() if of}
    turns = len(families[0]) // step
    if not _returns_after(turns, moved) or not all(_returns_after(turns, of) for of in moved_values.values()):
        return AsymmetryReason("what belongs to them does not go round with them")
    return Renaming(processes, moved, moved_values)


def _returns_after(turns: int, moves: Mapping[T, T]) -> bool:
    """Whether whatever is moved comes back after so many turns, and not before."""
    return set(moves) == set(moves.values()) and all(len(orbit) == turns for orbit in orbits(moves))


def orbits(moves: Mapping[T, T]) -> Iterator[list[T]]:
    """What a permutation moves, each thing followed by its image; things come in the order of the mapping."""
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
    """All of them, then pairs, then single ones."""
    yield tuple(items)
    if len(items) > 2:
        yield from combinations(items, 2)
    if len(items) > 1:
        yield from ((item,) for item in items)
