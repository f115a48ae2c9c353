"""The text of a process on its own: the same in each network that has this process."""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Sequence
from functools import partial

from tachk.analysis.fold import Known
from tachk.base.records import dataclass
from tachk.engine.symmetry.index_types import IndexTypes
from tachk.engine.symmetry.terms import IndexValue, TermReader
from tachk.engine.symmetry.units import TermUnit, read_edge, read_location, without_names
from tachk.model.network import Edge, Process
from tachk.model.remembered import by_part


@dataclass(frozen=True, slots=True)
class _Alone:
    index_types: IndexTypes
    locations: Sequence[TermUnit]
    edges: Sequence[TermUnit]


@by_part
def _read(process: Process, edges: tuple[Edge, ...], known: Known) -> _Alone:
    reader = TermReader(known)
    locations = [read_location(reader, 0, location) for location in process.locations]
    return _Alone(reader.index_types, locations, [read_edge(reader, 0, edge, rank=lambda _: 0) for edge in edges])


@by_part
def text_alone(process: Process, edges: tuple[Edge, ...], known: Known) -> Hashable:
    """The common part of the texts of a process and of all processes that it may be mapped to.

    A number that the text compares by its order, or computes with, is more than a name in each network: what two
    processes do differently with such numbers distinguishes them.

    Args:
        edges: those of the process that are taken.
    """
    alone = _read(process, edges, known)
    outline = partial(without_names, alone.index_types)
    counted = Counter(unit.text(outline) for unit in alone.edges)
    return tuple(location.text(outline) for location in alone.locations), frozenset(counted.items())


@by_part
def numbers_alone(
    process: Process, edges: tuple[Edge, ...], known: Known
) -> tuple[Sequence[tuple[Hashable, tuple[int, ...]]], Sequence[tuple[Hashable, tuple[int, ...]]]]:
    """The outlines of locations and of edges, each with the numbers in it. Arguments as for `text_alone`."""
    alone = _read(process, edges, known)
    return [_numbers(unit) for unit in alone.locations], [_numbers(unit) for unit in alone.edges]


def _numbers(unit: TermUnit) -> tuple[Hashable, tuple[int, ...]]:
    return unit.outline, tuple(token.value for token in unit.every_token if isinstance(token, IndexValue))
