"""What processes that stay where they are say of those that are moved: a controller with an edge for each of them.

Where a renaming moves a channel or a variable that such a process uses, each of its edges has to become another one of
its edges. If only one has the same text up to numbers, their numbers correspond.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator

from tachk.diagnostics.span import Span
from tachk.reduction.symmetry.automorphism import Reading, Renaming, Unit
from tachk.reduction.symmetry.terms import Number


def numbers_of_partners(reading: Reading, renaming: Renaming) -> Iterator[tuple[Number, Number, Span]]:
    """Numbers in processes that are not moved, each with the one that it has to become."""
    for process, numbers in sorted(reading.edges_with(renaming).items()):
        units = reading.edges[process]
        alike: dict[Hashable, list[Unit]] = {}
        for unit in units:
            alike.setdefault(_outline(reading, unit, Renaming()), []).append(unit)
        for number in numbers:
            images = alike.get(_outline(reading, units[number], renaming), [])
            if len(images) == 1:
                yield from _pairs(units[number], images[0])


def _outline(reading: Reading, unit: Unit, renaming: Renaming) -> Hashable:
    """The renamed text without its numbers."""
    return reading.image((token if not isinstance(token, Number) else "number" for token in unit.tokens), renaming)


def _pairs(unit: Unit, image: Unit) -> Iterable[tuple[Number, Number, Span]]:
    for token, another in zip(unit.tokens, image.tokens, strict=True):
        if isinstance(token, Number) and isinstance(another, Number):
            yield token, another, image.span
