"""What is wrong with a picture: texts that overlap, edges through locations or through labels."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations, pairwise

from tachk.formats.layout.label_text import edge_labels, location_labels, text_height, text_width
from tachk.formats.layout.placement.geometry import Box, node_box, segment_meets_box
from tachk.formats.layout.placement.routing import are_disjoint
from tachk.syntax import ast
from tachk.syntax.picture_layout import Point, TemplateLayout, keyed_edges


def faults(template: ast.Template, layout: TemplateLayout) -> list[str]:
    texts = list(_texts(template, layout))
    circles = {name: node_box(_given(node.position)) for name, node in layout.nodes.items()}
    found = [f"{a} overlaps {b}" for (a, box), (b, other) in combinations(texts, 2) if box.overlaps(other)]
    found += [f"{a} and {b} overlap" for a, b in combinations(circles, 2) if circles[a].overlaps(circles[b])]
    found += [f"{a} covers {b}" for a, box in texts for b, circle in circles.items() if box.overlaps(circle)]
    for key, edge in layout.edges.items():
        ends = [_given(layout.nodes[name].position) for name in (key.source, key.target)]
        route = [ends[0], *edge.nails, ends[1]]
        for a, b in pairwise(route):
            found += [
                f"{key} passes through {name}"
                for name, circle in circles.items()
                if name not in (key.source, key.target) and segment_meets_box(a, b, circle)
            ]
            found += [
                f"{key} passes through {text}"
                for text, box in texts
                if text.startswith("label of EdgeKey")
                and not text.endswith("comments")
                and segment_meets_box(a, b, box)
            ]
    return found


def lying_together(layout: TemplateLayout) -> list[str]:
    """The pairs of edges between the same two locations whose lines cannot be told apart."""
    routes = {
        key: (_given(layout.nodes[key.source].position), *edge.nails, _given(layout.nodes[key.target].position))
        for key, edge in layout.edges.items()
    }
    return [
        f"{a} and {b} lie together"
        for a, b in combinations(routes, 2)
        if {a.source, a.target} == {b.source, b.target} and not are_disjoint(routes[a], routes[b])
    ]


def missing(template: ast.Template, layout: TemplateLayout) -> list[str]:
    """What the layout says nothing about."""
    names = [node.name.name for node in (*template.locations, *template.branchpoints)]
    found = [name for name in names if name not in layout.nodes or layout.nodes[name].position is None]
    for location in template.locations:
        node = layout.nodes[location.name.name]
        kinds = {**location_labels(location), **commented(location.doc)}
        found += [] if node.name is not None else [f"name of {location.name.name}"]
        found += [f"{kind} of {location.name.name}" for kind in kinds if kind not in node.labels]
    for key, edge in keyed_edges(template):
        kinds = {**edge_labels(edge), **commented(edge.doc)}
        labels = layout.edges[key].labels if key in layout.edges else {}
        found += [str(key)] if key not in layout.edges else []
        found += [f"{kind} of {key}" for kind in kinds if kind not in labels]
    return found


def _texts(template: ast.Template, layout: TemplateLayout) -> Iterator[tuple[str, Box]]:
    for location in template.locations:
        node = layout.nodes[location.name.name]
        yield f"name {location.name.name}", _box(node.name, location.name.name)
        for kind, text in {**location_labels(location), **commented(location.doc)}.items():
            label = node.labels[kind]
            yield f"{kind} of {location.name.name}", _box(label.position, label.text or text)
    for key, edge in keyed_edges(template):
        for kind, text in {**edge_labels(edge), **commented(edge.doc)}.items():
            label = layout.edges[key].labels[kind]
            yield f"label of {key}: {kind}", _box(label.position, label.text or text)


def commented(doc: str) -> dict[str, str]:
    return {"comments": doc} if doc else {}


def _box(position: Point | None, text: str) -> Box:
    x, y = _given(position)
    return Box(x, y, x + text_width(text), y + text_height(text))


def _given(position: Point | None) -> Point:
    assert position is not None
    return position
