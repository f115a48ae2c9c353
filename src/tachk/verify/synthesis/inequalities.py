"""A set of cells in words: linear inequalities with small integer coefficients.

The inequalities agree with every given cell, and say nothing about others.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product
from math import gcd

import numpy as np
from numpy.typing import NDArray

from tachk.base.job import check_job
from tachk.base.records import dataclass

_LARGEST = {1: 12, 2: 12, 3: 6, 4: 3}
"""The largest coefficient that is tried, by the number of parameters; beyond that 1."""
_MOST_INEQUALITIES = 3
_MOST_POINTS = 100_000
_FIRST_CHOICES = 40
_AT_ONCE = 256
"""The number of left sides that are computed in one go."""

Points = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Inequality:
    """``sum of coefficients * values <= constant``, or ``<``."""

    coefficients: tuple[int, ...]
    constant: int
    strict: bool

    def text(self, names: Sequence[str]) -> str:
        """As one writes it, with nothing negative on either side: ``SLEEP + 2*HBA < DEAD``."""
        left = [_term(c, n) for c, n in zip(self.coefficients, names, strict=True) if c > 0]
        right = [_term(-c, n) for c, n in zip(self.coefficients, names, strict=True) if c < 0]
        sign = "<" if self.strict else "<="
        if not left:
            return f"{' + '.join(right)} {sign.replace('<', '>')} {-self.constant}"
        if self.constant > 0 or not right:
            right = [*right, str(self.constant)]
        elif self.constant < 0:
            left = [*left, str(-self.constant)]
        return f"{' + '.join(left)} {sign} {' + '.join(right)}"

    def holds(self, points: Points) -> NDArray[np.bool_]:
        """For each point whether it satisfies the inequality."""
        sums = points @ np.array(self.coefficients, dtype=np.int64)
        return np.asarray(sums < self.constant if self.strict else sums <= self.constant)


def _term(coefficient: int, name: str) -> str:
    return name if coefficient == 1 else f"{coefficient}*{name}"


@dataclass(frozen=True, slots=True)
class Description:
    """All inequalities together, or, as a ``complement``, everything else."""

    inequalities: tuple[Inequality, ...]
    complement: bool = False

    def text(self, names: Sequence[str]) -> str:
        joined = " and ".join(inequality.text(names) for inequality in self.inequalities)
        return f"not ({joined})" if self.complement else joined

    def holds(self, points: Points) -> NDArray[np.bool_]:
        inside = np.ones(len(points), dtype=bool)
        for inequality in self.inequalities:
            inside &= inequality.holds(points)
        return ~inside if self.complement else inside


def describe(inside: Points, outside: Points) -> Description | None:
    """Inequalities that every point inside satisfies and none outside does; None if few small ones do not suffice.

    Those with the smallest coefficients come first.
    """
    if not len(inside) or not len(outside) or len(inside) + len(outside) > _MOST_POINTS:
        return None
    found: list[Description] = []
    for complement, inequalities in ((False, _separating(inside, outside)), (True, _separating(outside, inside))):
        if inequalities is not None:
            found.append(Description(inequalities, complement))
    best = min(found, key=lambda description: len(description.inequalities), default=None)
    if best is None or not best.holds(inside).all() or best.holds(outside).any():
        return None
    return best


def _separating(inside: Points, outside: Points) -> tuple[Inequality, ...] | None:
    """Inequalities that hold inside, of which each point outside violates one; the fewest with small coefficients."""
    best: tuple[Inequality, ...] | None = None
    sides = _Sides(inside, outside)
    for group in _by_size(inside.shape[1]):
        sides.add(group)
        chosen = sides.cover(_MOST_INEQUALITIES if best is None else len(best) - 1)
        if chosen is not None:
            best = chosen
            if len(best) == 1:
                break
    return best


def _by_size(dimension: int) -> Iterator[list[tuple[int, ...]]]:
    """Coefficients without a common factor, those of one sum of magnitudes together, ascending."""
    largest = _LARGEST.get(dimension, 1)
    groups: dict[int, list[tuple[int, ...]]] = {}
    for vector in product(range(-largest, largest + 1), repeat=dimension):
        if gcd(*vector) == 1:
            groups.setdefault(sum(map(abs, vector)), []).append(vector)
    for size in sorted(groups):
        yield sorted(groups[size], reverse=True)


class _Sides:
    """The left sides that exclude some point outside while all points inside stay."""

    def __init__(self, inside: Points, outside: Points) -> None:
        self._inside, self._outside = inside, outside
        self._known: list[tuple[tuple[int, ...], int, NDArray[np.bool_]]] = []

    def add(self, vectors: Sequence[tuple[int, ...]]) -> None:
        for first in range(0, len(vectors), _AT_ONCE):
            check_job()
            some = vectors[first : first + _AT_ONCE]
            matrix = np.array(some, dtype=np.int64).T
            most = (self._inside @ matrix).max(axis=0)
            excluded = (self._outside @ matrix) > most
            for number in np.flatnonzero(excluded.any(axis=0)).tolist():
                self._known.append((some[number], int(most[number]), excluded[:, number].copy()))

    def cover(self, limit: int) -> tuple[Inequality, ...] | None:
        """At most so many inequalities that exclude all points outside, as few as are found.

        Greedy, begun with each of the sides in turn: the one that excludes most need not be among the fewest.
        """
        best: list[int] | None = None
        choices = min(len(self._known), _FIRST_CHOICES) if limit > 1 else 0
        for first in [None, *range(choices)]:
            check_job()
            chosen = self._greedy(first, limit if best is None else len(best) - 1)
            best = best if chosen is None else chosen
        if best is None:
            return None
        for number in tuple(best):
            others = [other for other in best if other != number]
            if others and np.any([self._known[other][2] for other in others], axis=0).all():
                best = others
        return tuple(self._inequality(number, [other for other in best if other != number]) for number in best)

    def _greedy(self, first: int | None, limit: int) -> list[int] | None:
        left = np.ones(len(self._outside), dtype=bool)
        chosen: list[int] = []
        while left.any() and len(chosen) < limit:
            if first is not None and not chosen:
                number = first
            else:
                counts = [int((excluded & left).sum()) for _, _, excluded in self._known]
                number = counts.index(max(counts)) if counts else 0
                if not counts or not counts[number]:
                    return None
            chosen.append(number)
            left &= ~self._known[number][2]
        return None if left.any() else chosen

    def _inequality(self, number: int, others: Sequence[int]) -> Inequality:
        """An inequality with this side that excludes what those with the other sides do not."""
        vector, most, excluded = self._known[number]
        needed = excluded.copy()
        for other in others:
            needed &= ~self._known[other][2]
        sums = self._outside[needed] @ np.array(vector, dtype=np.int64)
        return _simplest(vector, most, int(sums.min()))


def _simplest(vector: tuple[int, ...], most: int, least: int) -> Inequality:
    """The inequality between what must hold and what must not whose constant is nearest to 0."""
    weak = min(max(most, 0), least - 1)
    strict = min(max(most + 1, 0), least)
    if abs(strict) < abs(weak):
        return Inequality(vector, strict, True)
    return Inequality(vector, weak, False)
