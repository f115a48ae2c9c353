"""By which numbers processes with the same text otherwise are told apart."""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable
from itertools import chain
from operator import itemgetter

from tachk.engine.symmetry.alone import numbers_alone
from tachk.engine.symmetry.sketch import sketch_of
from tachk.model.network import Network, Process


def most_alike(network: Network) -> int:
    """No more processes than that have the same text otherwise."""
    return max(_of_kinds(network).values(), default=0)


def numbers_of_processes(network: Network, fewest: int = 2) -> set[frozenset[int]]:
    """A set for each place in the texts of such processes, where each of them has a number of its own.

    Args:
        fewest: fewer processes are not asked for.
    """
    kinds = _of_kinds(network)
    sketch = sketch_of(network)
    ranks: dict[Hashable, int] = {}
    alike: dict[Hashable, list[list[int]]] = {}
    for number, process in enumerate(network.processes):
        if kinds[_kind(process)] < fewest:
            continue
        locations, edges = numbers_alone(process, sketch.edges_taken(network, number), sketch.known)
        ranked = sorted(((ranks.setdefault(outline, len(ranks)), own) for outline, own in edges), key=itemgetter(0))
        shape = (
            process.initial,
            len(process.variables),
            tuple(outline for outline, _ in locations),
            tuple(rank for rank, _ in ranked),
        )
        text = chain.from_iterable(own for _, own in (*locations, *ranked))
        alike.setdefault(shape, []).append(list(text))
    columns = (column for texts in alike.values() if len(texts) >= fewest for column in zip(*texts, strict=True))
    return {frozenset(column) for column in columns if len(set(column)) == len(column)}


def _of_kinds(network: Network) -> Counter[Hashable]:
    return Counter(_kind(process) for process in network.processes if process.edges)


def _kind(process: Process) -> Hashable:
    """What is seen at once."""
    return process.initial, len(process.locations), len(process.variables)
