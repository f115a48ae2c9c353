"""Coordinates for everything that a template shows: those of its layout where there are any, else new ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from tachk.base.records import replace
from tachk.formats.layout.placement.additions import with_additions
from tachk.formats.layout.placement.template import place_template
from tachk.syntax import ast
from tachk.syntax.picture_layout import (
    EDGE_LABELS,
    LOCATION_LABELS,
    EdgeLayout,
    LabelLayout,
    NodeLayout,
    Point,
    TemplateLayout,
    keyed_edges,
    nodes_of,
)

_TITLE = Point(5, 5)
_NAME_OFFSET = Point(-10, -34)
_BELOW = Point(-10, 17)
_LINE = 17


def complete(template: ast.Template, known: TemplateLayout | None) -> TemplateLayout:
    """The layout with a position for every location, name and label that may be written.

    A template without any position is placed as a whole; in others, new locations, edges and labels get free places.
    """
    names = [node.name.name for node in nodes_of(template)]
    layout = known or TemplateLayout()
    placed = {name for name in names if name in layout.nodes and layout.nodes[name].position is not None}
    if not placed:
        layout = _merged(place_template(template), layout)
    else:
        layout = with_additions(template, layout)
    nodes = {name: _node(layout.nodes.get(name, NodeLayout())) for name in names}
    edges = {}
    for key, _ in keyed_edges(template):
        ends = [nodes[name].position for name in (key.source, key.target) if name in nodes]
        edges[key] = _edge(layout.edges.get(key, EdgeLayout()), [end for end in ends if end is not None])
    return replace(layout, name=layout.name or _TITLE, nodes=nodes, edges=edges)


def _merged(new: TemplateLayout, old: TemplateLayout) -> TemplateLayout:
    """A new picture with what an old layout without positions says about colours and the like."""
    nodes = {
        name: replace(
            node,
            labels=_with_texts(node.labels, old.nodes[name].labels),
            colour=old.nodes[name].colour,
            id=old.nodes[name].id,
            written_name=old.nodes[name].written_name,
        )
        if name in old.nodes
        else node
        for name, node in new.nodes.items()
    }
    edges = {
        key: replace(
            edge,
            labels=_with_texts(edge.labels, old.edges[key].labels),
            colour=old.edges[key].colour,
            attributes=old.edges[key].attributes,
        )
        if key in old.edges
        else edge
        for key, edge in new.edges.items()
    }
    return replace(old, nodes=nodes, edges=edges)


def _with_texts(new: Mapping[str, LabelLayout], old: Mapping[str, LabelLayout]) -> dict[str, LabelLayout]:
    merged = dict(new)
    for kind, label in old.items():
        if label.text is not None:
            merged[kind] = replace(merged.get(kind, LabelLayout()), text=label.text)
    return merged


def _node(node: NodeLayout) -> NodeLayout:
    at = node.position or Point(0, 0)
    free = at.y + _BELOW.y
    labels = {}
    for kind in (*LOCATION_LABELS, *(kind for kind in node.labels if kind not in LOCATION_LABELS)):
        label = node.labels.get(kind, LabelLayout())
        labels[kind] = replace(label, position=label.position or Point(at.x + _BELOW.x, free))
        free += _LINE
    name = node.name or Point(at.x + _NAME_OFFSET.x, at.y + _NAME_OFFSET.y)
    return replace(node, position=at, name=name, labels=labels)


def _edge(edge: EdgeLayout, ends: Sequence[Point]) -> EdgeLayout:
    path = [*ends[:1], *edge.nails, *ends[1:]] or [Point(0, 0)]
    first, second = path[(len(path) - 1) // 2], path[len(path) // 2]
    x, free = (first.x + second.x) // 2, (first.y + second.y) // 2 - 2 * _LINE
    labels = {}
    for kind in (*EDGE_LABELS, *(kind for kind in edge.labels if kind not in EDGE_LABELS)):
        label = edge.labels.get(kind, LabelLayout())
        labels[kind] = replace(label, position=label.position or Point(x, free))
        free += _LINE
    return replace(edge, labels=labels)
