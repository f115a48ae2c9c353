"""The numbers in which processes with otherwise equal texts differ."""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable
from itertools import chain
from operator import itemgetter

from tachk.engine.symmetry.coarse_partition import coarse_partition
from tachk.model.network import Network, Process


def most_alike(network: Network) -> int:
    """An upper bound of the number of processes with the same text up to numbers."""
    return max(_equal_shapes(network).values(), default=0)


def numbers_of_processes(network: Network, fewest: int = 2) -> set[frozenset[int]]:
    """For each place in the texts of such processes where all their numbers differ, the set of these numbers.

    Args:
        fewest: the least number of processes of a set.
    """
    from tachk.engine.symmetry.alone import numbers_alone

    index_types = _equal_shapes(network)
    partition = coarse_partition(network)
    ranks: dict[Hashable, int] = {}
    similar: dict[Hashable, list[list[int]]] = {}
    for number, process in enumerate(network.processes):
        if index_types[_shape(process)] < fewest:
            continue
        locations, edges = numbers_alone(process, partition.edges_taken(network, number), partition.known)
        ranked = sorted(((ranks.setdefault(outline, len(ranks)), own) for outline, own in edges), key=itemgetter(0))
        shape = (
            process.initial,
            len(process.variables),
            tuple(outline for outline, _ in locations),
            tuple(rank for rank, _ in ranked),
        )
        text = chain.from_iterable(own for _, own in (*locations, *ranked))
        similar.setdefault(shape, []).append(list(text))
    columns = (column for texts in similar.values() if len(texts) >= fewest for column in zip(*texts, strict=True))
    return {frozenset(column) for column in columns if len(set(column)) == len(column)}


def _equal_shapes(network: Network) -> Counter[Hashable]:
    return Counter(_shape(process) for process in network.processes if process.edges)


def _shape(process: Process) -> Hashable:
    """The sizes of a process: a cheap necessary condition of equal texts."""
    return process.initial, len(process.locations), len(process.variables)
