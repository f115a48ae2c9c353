"""Automatic layout: where UPPAAL shows everything of a document that says nothing about that itself.

Each template is drawn in layers from its initial location, to the right or downwards, whichever looks better; see
`placement_layers` (the layers), `placement_coordinates` and `placement_arrangement` (a drawing without overlaps),
`placement_routing` and `placement_polish` (fewer nails). Very large templates are set out in rows (`placement_grid`).
The same document always gets the same layout.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise

from tachk.formats.layout.label_text import edge_labels, line_broken, location_labels, text_height
from tachk.formats.layout.placement.arrangement import FlowDirection, arrange
from tachk.formats.layout.placement.comments import CommentPlacer
from tachk.formats.layout.placement.geometry import Box, segments_cross
from tachk.formats.layout.placement.grid import arrange_in_rows
from tachk.formats.layout.placement.layers import Traversal
from tachk.formats.layout.placement.polish import redraw_edges, redraw_loops
from tachk.formats.layout.placement.routing import clear_texts, straighten
from tachk.formats.layout.placement.sketch import Sketch, TemplateDrawing, sketch
from tachk.syntax import ast
from tachk.syntax.picture_layout import EdgeLayout, LabelLayout, NodeLayout, Point, TemplateLayout, keyed_edges

_WIDE_ENOUGH = 1.4
"""The width of a picture over its height that suits a screen."""

_FEW = 150
"""Templates with more edges than this get a simpler drawing."""

_MANY = 1000
"""Templates with more locations and edges than this are only set out in rows."""

_DOWNWARDS = 1.3
"""How much smaller a drawing downwards must be to be preferred."""

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
    if len(outline.nodes) > _LONG and _stretch(drawing) > _TOO_STRETCHED:
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


def _stretch(drawing: TemplateDrawing) -> float:
    """How many times longer one side of the picture is than the other."""
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
        labels = _stack(texts, moved(box.left, box.top)) if box is not None else {}
        if node.name in locations and (doc := locations[node.name].doc):
            room = comments.beside_node(at, doc)
            labels["comments"] = LabelLayout(moved(room.left, room.top))
        nodes[node.name] = NodeLayout(moved(*drawing.centres[at]), moved(name.left, name.top), labels)
    declared = dict(keyed_edges(template))
    edges = {}
    for at, edge in enumerate(outline.edges):
        box = drawing.edge_labels[at]
        labels = _stack(edge_labels(declared[edge.key]), moved(box.left, box.top)) if box is not None else {}
        if (doc := declared[edge.key].doc) and "comments" not in labels:
            room = comments.beside_edge(at, doc)
            labels["comments"] = LabelLayout(moved(room.left, room.top))
        edges[edge.key] = EdgeLayout(tuple(moved(*nail) for nail in drawing.routes[at][1:-1]), labels)
    return TemplateLayout(nodes=nodes, edges=edges)


def _stack(texts: Mapping[str, str], corner: Point) -> dict[str, LabelLayout]:
    """Labels one below the other; a text that is broken into lines is kept with its breaks."""
    stack = {}
    top = corner.y
    for kind, wrapped in line_broken(texts).items():
        stack[kind] = LabelLayout(Point(corner.x, top), wrapped if wrapped != texts[kind] else None)
        top += text_height(wrapped)
    return stack
