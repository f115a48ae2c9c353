"""A template for drawing, reduced to numbers and sizes, and a drawing of it."""

from __future__ import annotations

from dataclasses import dataclass

from tachk.formats.layout.label_text import (
    Size,
    edge_labels,
    line_broken,
    location_labels,
    stack_size,
    text_height,
    text_width,
)
from tachk.formats.layout.placement.geometry import Box, node_box
from tachk.syntax import ast
from tachk.syntax.picture_layout import EdgeKey, Point, keyed_edges


@dataclass(frozen=True, slots=True)
class SketchNode:
    """A location or branchpoint with the sizes of its name and of its labels, one below the other."""

    name: str
    name_size: Size
    labels_size: Size


@dataclass(frozen=True, slots=True)
class SketchEdge:
    """An edge between numbered nodes with the size of its labels, one below the other."""

    key: EdgeKey
    source: int
    target: int
    labels_size: Size


@dataclass(frozen=True, slots=True)
class Sketch:
    """Attributes:
    root: the node at which the flow begins.
    """

    nodes: tuple[SketchNode, ...]
    edges: tuple[SketchEdge, ...]
    root: int


@dataclass(frozen=True, slots=True)
class TemplateDrawing:
    """Attributes:
    centres: of the nodes.
    names, node_labels: the boxes of the names and of the labels of each node.
    routes: the points of each edge, from the centre of its source to the centre of its target.
    edge_labels: the box of the labels of each edge; None if it has none.
    """

    centres: tuple[Point, ...]
    names: tuple[Box, ...]
    node_labels: tuple[Box | None, ...]
    routes: tuple[tuple[Point, ...], ...]
    edge_labels: tuple[Box | None, ...]

    def boxes(self) -> list[Box]:
        """The boxes of all texts and nodes."""
        texts = (*self.names, *self.node_labels, *self.edge_labels)
        return [*map(node_box, self.centres), *(box for box in texts if box is not None)]


def sketch(template: ast.Template) -> Sketch:
    """The sketch of a template; edges with an unknown end are left out."""
    nodes = [
        SketchNode(
            location.name.name,
            (text_width(location.name.name), text_height(location.name.name)),
            stack_size(line_broken(location_labels(location))),
        )
        for location in template.locations
    ]
    # UPPAAL shows no name at a branchpoint.
    nodes += [SketchNode(point.name.name, (0, 0), (0, 0)) for point in template.branchpoints]
    number = {node.name: at for at, node in enumerate(nodes)}
    edges = tuple(
        SketchEdge(
            key,
            number[key.source],
            number[key.target],
            stack_size(line_broken(edge_labels(edge))),
        )
        for key, edge in keyed_edges(template)
        if key.source in number and key.target in number
    )
    initial = (number[location.name.name] for location in template.locations if location.initial)
    return Sketch(tuple(nodes), edges, next(initial, 0))
