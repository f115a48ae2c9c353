"""A plain drawing of a very large sketch: in rows, each location with the labels of its edges beside it.

Texts and locations do not overlap, but edges run straight to their targets, over whatever lies between.
"""

from __future__ import annotations

from collections import defaultdict
from math import sqrt

import networkx as nx

from tachk.formats.layout.placement.geometry import RADIUS, Box
from tachk.formats.layout.placement.sketch import Sketch, TemplateDrawing
from tachk.syntax.picture_layout import Point

_GRID = 8
_GAP = 48
_ABOVE = 40
_LEAST_LABEL = 12
_TO_LABEL = RADIUS + 24


def arrange_in_rows(sketch: Sketch, shape: float) -> TemplateDrawing:
    """Places the locations in the order of a depth-first search, every other row from right to left.

    Args:
        shape: the width of the picture over its height.
    """
    leaving: dict[int, list[int]] = defaultdict(list)
    for at, edge in enumerate(sketch.edges):
        leaving[edge.source].append(at)
    sizes = [_cell(sketch, node, leaving[node]) for node in range(len(sketch.nodes))]
    width = sqrt(shape * sum(w * h for w, h in sizes))
    centres: dict[int, Point] = {}
    top = 0
    row: list[int] = []
    rows = 0
    order = _order(sketch)
    for at, number in enumerate(order):
        row.append(number)
        if at + 1 < len(order) and sum(sizes[other][0] for other in row) < width:
            continue
        x = 0
        for other in row if rows % 2 == 0 else row[::-1]:
            centres[other] = Point(x, top + _ABOVE)
            x += sizes[other][0]
        top += max(sizes[other][1] for other in row)
        rows += 1
        row = []
    names, node_labels = [], []
    edge_labels: list[Box | None] = [None] * len(sketch.edges)
    routes: list[tuple[Point, ...]] = [()] * len(sketch.edges)
    for number, node in enumerate(sketch.nodes):
        x, y = centres[number]
        (w, h), (labels_w, labels_h) = node.name_size, node.labels_size
        names.append(Box(x - 10, y - 17 - h, x - 10 + w, y - 17))
        node_labels.append(Box(x - 10, y + 17, x - 10 + labels_w, y + 17 + labels_h) if labels_h else None)
        below = y - RADIUS if not labels_h else y + 17 + labels_h
        for at in leaving[number]:
            edge = sketch.edges[at]
            w, h = edge.labels_size
            left = x + _TO_LABEL
            nail = Point(left - 4, below + max(h, _LEAST_LABEL))
            if h:
                edge_labels[at] = Box(left, below, left + w, below + h)
            nails = (nail,) if edge.target != number else (Point(nail.x, nail.y - _LEAST_LABEL + 2), nail)
            routes[at] = (centres[number], *nails, centres[edge.target])
            below += max(h, _LEAST_LABEL) + 4
    return TemplateDrawing(
        tuple(centres[number] for number in range(len(sketch.nodes))),
        tuple(names),
        tuple(node_labels),
        tuple(routes),
        tuple(edge_labels),
    )


def _cell(sketch: Sketch, node: int, leaving: list[int]) -> tuple[int, int]:
    """Width and height of what belongs to a node."""
    (name_width, _), (labels_width, labels_height) = sketch.nodes[node].name_size, sketch.nodes[node].labels_size
    sizes = [sketch.edges[at].labels_size for at in leaving]
    width = max(name_width, labels_width, *(_TO_LABEL + 10 + w for w, _ in sizes), 2 * RADIUS) + _GAP
    height = _ABOVE + 17 + labels_height + sum(max(h, _LEAST_LABEL) + 4 for _, h in sizes) + _GAP
    return -(-width // _GRID) * _GRID, -(-height // _GRID) * _GRID


def _order(sketch: Sketch) -> list[int]:
    graph = nx.DiGraph()
    graph.add_node(sketch.root)
    graph.add_nodes_from(range(len(sketch.nodes)))
    graph.add_edges_from((edge.source, edge.target) for edge in sketch.edges)
    return list(nx.dfs_preorder_nodes(graph))
