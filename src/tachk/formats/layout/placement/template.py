"""Automatic layout: where UPPAAL shows everything of a document that says nothing about that itself.

Each template is drawn in layers from its initial location, to the right or downwards, whichever looks better; see
`placement_layers` (the layers), `placement_coordinates` and `placement_arrangement` (a drawing without overlaps),
`placement_routing` and `placement_polish` (fewer nails). Very large templates are set out in rows (`placement_grid`).
The same document always gets the same layout.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from itertools import pairwise
from math import sqrt

import networkx as nx

from tachk.formats.layout.label_text import edge_labels, label_stack, location_labels, text_size
from tachk.formats.layout.placement.arrangement import FlowDirection, arrange
from tachk.formats.layout.placement.geometry import RADIUS, Box, node_box, segments_cross
from tachk.formats.layout.placement.layers import Traversal
from tachk.formats.layout.placement.polish import redraw_edges, redraw_loops
from tachk.formats.layout.placement.room import Room, hull, middle_of
from tachk.formats.layout.placement.routing import clear_texts, straighten
from tachk.formats.layout.placement.sketch import Sketch, TemplateDrawing, sketch
from tachk.syntax import ast
from tachk.syntax.picture_layout import EdgeLayout, LabelLayout, NodeLayout, Point, TemplateLayout, keyed_edges


class CommentPlacer:
    """Finds room for one comment after the other, near its subject."""

    def __init__(self, sketch: Sketch, drawing: TemplateDrawing) -> None:
        self.sketch = sketch
        self.drawing = drawing
        self.room = Room()
        for box in drawing.boxes():
            self.room.take(box)
        for route in drawing.routes:
            self.room.draw(route)

    def beside_node(self, node: int, text: str) -> Box:
        around = [box for box in (self.drawing.names[node], self.drawing.node_labels[node]) if box is not None]
        return self.room.beside(hull([node_box(self.drawing.centres[node]), *around]), text_size(text))

    def beside_edge(self, edge: int, text: str) -> Box:
        label = self.drawing.edge_labels[edge]
        if label is None:
            label = middle_of(self.drawing.routes[edge])
        return self.room.beside(label, text_size(text))


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
    """Width and height of a node with its labels."""
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


_WIDE_ENOUGH = 1.4
"""The width of a picture over its height that suits a screen."""

_FEW = 150
"""Templates with more edges than this get a simpler drawing."""

_MANY = 1000
"""Templates with more locations and edges than this are only set out in rows."""

_DOWNWARDS = 1.3
"""The ratio by which a drawing downwards must be smaller to be preferred."""

_LONG, _TOO_STRETCHED = 50, 12
"""Chains of more locations, in a picture so many times as long as wide, are set out in rows too."""


def place_template(template: ast.Template) -> TemplateLayout:
    outline = sketch(template)
    if not outline.nodes:
        return TemplateLayout()
    drawings = [(way[0], found) for way in _ways(outline) if (found := _drawn(outline, *way)) is not None]
    if not drawings:
        return _layout(template, outline, arrange_in_rows(outline, _WIDE_ENOUGH))
    _, drawing = min(drawings, key=lambda found: _ugliness(outline, *found))
    if len(outline.nodes) > _LONG and _aspect_ratio(drawing) > _TOO_STRETCHED:
        return _layout(template, outline, arrange_in_rows(outline, _WIDE_ENOUGH))
    if len(outline.edges) <= _FEW:
        drawing = clear_texts(outline, redraw_loops(outline, drawing))
        drawing = redraw_edges(outline, redraw_loops(outline, drawing))
    return _layout(template, outline, clear_texts(outline, drawing))


def _ways(outline: Sketch) -> Iterator[tuple[FlowDirection, Traversal]]:
    """The ways of drawing that are tried: the larger the template, the fewer."""
    size = len(outline.nodes) + len(outline.edges)
    if size > _MANY:
        return
    for direction in FlowDirection if size < 400 else (FlowDirection.RIGHT,):
        for traversal in Traversal if size < 70 else (Traversal.DEPTH,):
            yield direction, traversal


def _drawn(outline: Sketch, direction: FlowDirection, traversal: Traversal) -> TemplateDrawing | None:
    drawing = arrange(outline, direction, traversal)
    return drawing and straighten(outline, drawing)


def _ugliness(outline: Sketch, direction: FlowDirection, drawing: TemplateDrawing) -> float:
    """A number that is smaller for better drawings: small, of a shape that fits a screen, with few crossings and nails,
    and to the right, where labels lie along their edges."""
    extent = _extent(drawing)
    width, height = extent.right - extent.left + 40, extent.bottom - extent.top + 40
    shape = width / height / _WIDE_ENOUGH
    size = max(width / _WIDE_ENOUGH, height) + 0.3 * (width + height) * max(shape, 1 / shape, 1.5) / 1.5
    if direction is FlowDirection.DOWN:
        size *= _DOWNWARDS
    if len(outline.edges) > _FEW:
        return size
    crossings = 0
    lines = [list(pairwise(route)) for route in drawing.routes]
    for at, line in enumerate(lines):
        crossings += sum(segments_cross(a, b, c, d) for a, b in line for other in lines[at + 1 :] for c, d in other)
    nails = sum(len(route) - 2 for route in drawing.routes)
    return size + 90 * crossings + 8 * nails


def _aspect_ratio(drawing: TemplateDrawing) -> float:
    """The ratio of the longer side of the picture to the other."""
    extent = _extent(drawing)
    width, height = extent.right - extent.left, extent.bottom - extent.top
    return max(width / height, height / width)


def _extent(drawing: TemplateDrawing) -> Box:
    boxes = drawing.boxes()
    points = [point for route in drawing.routes for point in route]
    return Box(
        min([0, *(box.left for box in boxes), *(point.x for point in points)]),
        min([0, *(box.top for box in boxes), *(point.y for point in points)]),
        max([0, *(box.right for box in boxes), *(point.x for point in points)]),
        max([0, *(box.bottom for box in boxes), *(point.y for point in points)]),
    )


def _layout(template: ast.Template, outline: Sketch, drawing: TemplateDrawing) -> TemplateLayout:
    """The layout of a drawing, moved so that the initial location stands at the origin."""
    origin = drawing.centres[outline.root]

    def moved(x: float, y: float) -> Point:
        return Point(round(x) - origin.x, round(y) - origin.y)

    locations = {location.name.name: location for location in template.locations}
    comments = CommentPlacer(outline, drawing)
    nodes = {}
    for at, node in enumerate(outline.nodes):
        name, box = drawing.names[at], drawing.node_labels[at]
        texts = location_labels(locations[node.name]) if node.name in locations else {}
        labels = label_stack(texts, moved(box.left, box.top)) if box is not None else {}
        if node.name in locations and (doc := locations[node.name].doc):
            room = comments.beside_node(at, doc)
            labels["comments"] = LabelLayout(moved(room.left, room.top))
        nodes[node.name] = NodeLayout(moved(*drawing.centres[at]), moved(name.left, name.top), labels)
    declared = dict(keyed_edges(template))
    edges = {}
    for at, edge in enumerate(outline.edges):
        box = drawing.edge_labels[at]
        labels = label_stack(edge_labels(declared[edge.key]), moved(box.left, box.top)) if box is not None else {}
        if (doc := declared[edge.key].doc) and "comments" not in labels:
            room = comments.beside_edge(at, doc)
            labels["comments"] = LabelLayout(moved(room.left, room.top))
        edges[edge.key] = EdgeLayout(tuple(moved(*nail) for nail in drawing.routes[at][1:-1]), labels)
    return TemplateLayout(nodes=nodes, edges=edges)
