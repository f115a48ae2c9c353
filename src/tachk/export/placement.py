"""Automatic layout: where UPPAAL shows everything of a document that says nothing about that itself.

Each template is drawn in layers from its initial location, to the right or downwards, whichever looks better; see
`placement_layers` (the layers), `placement_coordinates` and `placement_arrangement` (a drawing without overlaps) and
`placement_routing` (fewer nails). The same document always gets the same layout.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise

from tachk.export.label_text import edge_labels, location_labels, text_height, wrap
from tachk.export.placement_arrangement import Direction, arrange
from tachk.export.placement_geometry import Box, segments_cross
from tachk.export.placement_layers import Traversal
from tachk.export.placement_polish import polish
from tachk.export.placement_routing import clear_texts, straighten
from tachk.export.placement_sketch import Drawing, Sketch, sketch
from tachk.syntax import ast
from tachk.syntax.layout import EdgeLayout, LabelLayout, Layout, NodeLayout, Point, TemplateLayout, keyed_edges

_WIDE_ENOUGH = 1.4
"""The width of a picture over its height that suits a screen."""

_FEW = 150
"""Templates with more edges than this get a simpler drawing."""


def place(document: ast.Document) -> Layout:
    """The layout of all templates of a document, as if it had none."""
    return Layout({item.name.name: place_template(item) for item in document.items if isinstance(item, ast.Template)})


def place_template(template: ast.Template) -> TemplateLayout:
    outline = sketch(template)
    drawing = min((_drawn(outline, *way) for way in _ways(outline)), key=lambda found: _ugliness(outline, found))
    if len(outline.edges) <= _FEW:
        drawing = clear_texts(outline, polish(outline, drawing))
    return _layout(template, outline, drawing)


def _ways(outline: Sketch) -> Iterator[tuple[Direction, Traversal]]:
    """The ways of drawing that are tried: the larger the template, the fewer."""
    size = len(outline.nodes) + len(outline.edges)
    for direction in Direction if size < 500 else (Direction.RIGHT,):
        for traversal in Traversal if size < 120 else (Traversal.DEPTH,):
            yield direction, traversal


def _drawn(outline: Sketch, direction: Direction, traversal: Traversal) -> Drawing:
    return clear_texts(outline, straighten(outline, arrange(outline, direction, traversal)))


def _ugliness(outline: Sketch, drawing: Drawing) -> float:
    """A number that is smaller for better drawings: small, of a shape that fits a screen, with few crossings and nails
    and short edges."""
    extent = _extent(drawing)
    width, height = extent.right - extent.left + 40, extent.bottom - extent.top + 40
    shape = width / height / _WIDE_ENOUGH
    size = max(width / _WIDE_ENOUGH, height) + 0.3 * (width + height) * max(shape, 1 / shape, 1.5) / 1.5
    if len(outline.edges) > _FEW:
        return size
    crossings = 0
    lines = [list(pairwise(route)) for route in drawing.routes]
    for at, line in enumerate(lines):
        crossings += sum(segments_cross(a, b, c, d) for a, b in line for other in lines[at + 1 :] for c, d in other)
    nails = sum(len(route) - 2 for route in drawing.routes)
    return size + 90 * crossings + 8 * nails


def _extent(drawing: Drawing) -> Box:
    boxes = drawing.boxes()
    points = [point for route in drawing.routes for point in route]
    return Box(
        min([0, *(box.left for box in boxes), *(point.x for point in points)]),
        min([0, *(box.top for box in boxes), *(point.y for point in points)]),
        max([0, *(box.right for box in boxes), *(point.x for point in points)]),
        max([0, *(box.bottom for box in boxes), *(point.y for point in points)]),
    )


def _layout(template: ast.Template, outline: Sketch, drawing: Drawing) -> TemplateLayout:
    """The layout of a drawing, moved so that the initial location stands at the origin."""
    origin = drawing.centres[outline.root] if drawing.centres else Point(0, 0)

    def moved(x: float, y: float) -> Point:
        return Point(round(x) - origin.x, round(y) - origin.y)

    locations = {location.name.name: location for location in template.locations}
    nodes = {}
    for at, node in enumerate(outline.nodes):
        name, box = drawing.names[at], drawing.node_labels[at]
        texts = location_labels(locations[node.name]) if node.name in locations else {}
        nodes[node.name] = NodeLayout(
            position=moved(*drawing.centres[at]),
            name=moved(name.left, name.top),
            labels=_stack(texts, moved(box.left, box.top)) if box is not None else {},
        )
    declared = dict(keyed_edges(template))
    edges = {}
    for at, edge in enumerate(outline.edges):
        box = drawing.edge_labels[at]
        edges[edge.key] = EdgeLayout(
            nails=tuple(moved(*nail) for nail in drawing.routes[at][1:-1]),
            labels=_stack(edge_labels(declared[edge.key]), moved(box.left, box.top)) if box is not None else {},
        )
    return TemplateLayout(nodes=nodes, edges=edges)


def _stack(texts: Mapping[str, str], corner: Point) -> dict[str, LabelLayout]:
    """Labels one below the other; a text that is broken into lines is kept with its breaks."""
    stack = {}
    top = corner.y
    for kind, text in texts.items():
        wrapped = wrap(text)
        stack[kind] = LabelLayout(Point(corner.x, top), wrapped if wrapped != text else None)
        top += text_height(wrapped)
    return stack
