"""Layers of a directed graph: which way its arcs run, on which layer each node stands, and in what order.

The three first steps of the method of K. Sugiyama, S. Tagawa, M. Toda, Methods for visual understanding of hierarchical
system structures, IEEE Trans. SMC 11, 1981. Nodes are numbers from 0; the flow begins at the root.
"""

from __future__ import annotations

from bisect import bisect_left, insort
from collections.abc import Mapping, Sequence
from enum import Enum, auto

import networkx as nx

from tachk.base.job import check_job

Arc = tuple[int, int]


class Traversal(Enum):
    """The traversals that find the direction of the flow: an arc against it leads to a node that was met before."""

    DEPTH = auto()
    DEPTH_LAST_FIRST = auto()
    BREADTH = auto()


def flow(count: int, arcs: Sequence[Arc], root: int, traversal: Traversal) -> list[Arc]:
    """The arcs turned so that they have no cycle, in the same order; arcs from a node to itself stay."""
    position = _order(count, arcs, root, traversal)
    return [(a, b) if position[a] <= position[b] else (b, a) for a, b in arcs]


def _order(count: int, arcs: Sequence[Arc], root: int, traversal: Traversal) -> list[int]:
    """A number for each node, along which the flow runs.

    Breadth first: the order in which nodes are met. Depth first: the reverse of the order in which they are left, so
    that exactly the arcs back to a node whose visit is under way run against it.
    """
    ordered = arcs if traversal is not Traversal.DEPTH_LAST_FIRST else tuple(reversed(arcs))
    entered = {b for a, b in arcs if a != b}
    graph = nx.DiGraph()
    graph.add_node(root)
    graph.add_nodes_from(node for node in range(count) if node not in entered)
    graph.add_nodes_from(range(count))
    graph.add_edges_from(ordered)
    if traversal is Traversal.BREADTH:
        sequence: dict[int, None] = {}
        for start in graph:
            if start not in sequence:
                sequence.update(
                    dict.fromkeys((start, *(b for _, b in nx.bfs_edges(graph, start) if b not in sequence)))
                )
    else:
        sequence = dict.fromkeys(reversed(list(nx.dfs_postorder_nodes(graph))))
    position = [0] * count
    for at, node in enumerate(sequence):
        position[node] = at
    return position


def ranks(count: int, arcs: Sequence[Arc], root: int) -> list[int]:
    """The layer of each node, so that each arc leads at least one further and few lead much further.

    Args:
        arcs: without a cycle, except for arcs from a node to itself.
    """
    graph = nx.DiGraph()
    graph.add_nodes_from(range(count))
    graph.add_edges_from(arc for arc in arcs if arc[0] != arc[1])
    sequence = list(nx.topological_sort(graph))
    rank = [0] * count
    for node in sequence:
        for other in graph.successors(node):
            rank[other] = max(rank[other], rank[node] + 1)
    into = [0] * count
    out = [0] * count
    for a, b in arcs:
        if a != b:
            out[a] += 1
            into[b] += 1
    for _ in range(3):
        for node in reversed(sequence):
            if node != root and out[node] > into[node]:
                rank[node] = min(rank[other] for other in graph.successors(node)) - 1
        for node in sequence:
            if node != root and into[node] > out[node]:
                rank[node] = max(rank[other] for other in graph.predecessors(node)) + 1
    lowest = min(rank, default=0)
    return [each - lowest for each in rank]


class Layering:
    """Nodes on layers with links between neighbouring layers, in an order with few crossings.

    Attributes:
        layers: the nodes of each layer in their order.
        above, below: the neighbours of each node on the layer before and after its own.
    """

    def __init__(self, layers: list[list[int]], links: Sequence[Arc]) -> None:
        self.layers = layers
        self.above: dict[int, list[int]] = {node: [] for layer in layers for node in layer}
        self.below: dict[int, list[int]] = {node: [] for layer in layers for node in layer}
        for a, b in links:
            self.below[a].append(b)
            self.above[b].append(a)

    def crossings(self) -> int:
        """The number of pairs of links that cross."""
        total = 0
        place = self._places()
        for layer in self.layers[1:]:
            ends: list[int] = []
            for node in layer:
                neighbours = [place[other] for other in self.above[node]]
                total += sum(len(ends) - bisect_left(ends, end + 1) for end in neighbours)
                for end in neighbours:
                    insort(ends, end)
        return total

    def reduce_crossings(self, sweeps: int) -> None:
        """Sorts each layer by the barycentres of neighbours, down and up by turns, and swaps neighbours where that
        helps; keeps the best order met."""
        best, fewest = [list(layer) for layer in self.layers], self.crossings()
        for sweep in range(sweeps):
            if fewest == 0:
                break
            self._sweep(downwards=sweep % 2 == 0)
            self._swap()
            now = self.crossings()
            if now < fewest:
                best, fewest = [list(layer) for layer in self.layers], now
        self.layers = best

    def _places(self) -> dict[int, int]:
        return {node: at for layer in self.layers for at, node in enumerate(layer)}

    def _sweep(self, downwards: bool) -> None:
        place = self._places()
        neighbours = self.above if downwards else self.below
        for layer in self.layers if downwards else self.layers[::-1]:
            weight = {node: _barycentre(neighbours[node], place, place[node]) for node in layer}
            layer.sort(key=weight.__getitem__)
            place.update((node, at) for at, node in enumerate(layer))

    def _swap(self) -> None:
        place = self._places()
        for layer in self.layers:
            check_job()
            for at in range(len(layer) - 1):
                a, b = layer[at], layer[at + 1]
                now = after = 0
                for neighbours in (self.above, self.below):
                    ends_of_b = [place[d] for d in neighbours[b]]
                    for c in neighbours[a]:
                        end = place[c]
                        now += sum(end > d for d in ends_of_b)
                        after += sum(d > end for d in ends_of_b)
                if after < now:
                    layer[at], layer[at + 1] = b, a
                    place[a], place[b] = at + 1, at


def _barycentre(neighbours: Sequence[int], place: Mapping[int, int], default: int) -> float:
    if not neighbours:
        return default
    return sum(place[node] for node in neighbours) / len(neighbours)
