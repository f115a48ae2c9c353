"""Places for what was added to a template whose picture is known: everything that has a place stays there."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from math import hypot

from tachk.base.job import check_job
from tachk.base.records import replace
from tachk.formats.layout.label_text import (
    Size,
    edge_labels,
    label_stack,
    line_broken,
    location_labels,
    stack_size,
    text_size,
)
from tachk.formats.layout.placement.geometry import (
    RADIUS,
    Box,
    box_at,
    node_box,
    segment_meets_box,
    segment_span,
    segments_cross,
)
from tachk.formats.layout.placement.new_routes import Route, free_place, new_route, place_at
from tachk.formats.layout.placement.room import Room, hull, middle_of
from tachk.formats.layout.placement.routing import node_text_places
from tachk.syntax import ast
from tachk.syntax.picture_layout import (
    EdgeKey,
    EdgeLayout,
    LabelLayout,
    NodeLayout,
    Point,
    TemplateLayout,
    keyed_edges,
    nodes_of,
)

Labels = Mapping[str, LabelLayout]

_NAME = Point(-10, -34)
_LABELS = Point(-10, 17)
"""Where UPPAAL writes the name and the labels of a location, seen from its centre."""

_AROUND = 12
_GRID, _STEPS, _STEP = 8, 18, 24
_GAP = 120
_BEST_DISTANCE = 140
_THROUGH, _NEAR = 80, 25
_CLOSE = 32
_LEFT, _ABOVE, _BELOW, _ASLANT = 40, 25, 10, 0.2
"""Places right of others, and level with them, are better."""


def with_additions(template: ast.Template, known: TemplateLayout) -> TemplateLayout:
    """The layout of a template, at least one of whose locations has a place in it, with free places for the rest: texts
    of what is known first, then locations beside their neighbours, then edges, then their texts."""
    return _Additions(template, known).layout()


class _Additions:
    def __init__(self, template: ast.Template, known: TemplateLayout) -> None:
        self.known = known
        self.locations = {location.name.name: location for location in template.locations}
        self.declared = dict(keyed_edges(template))
        self.names = [node.name.name for node in nodes_of(template)]
        self.nodes = {name: known.nodes.get(name, NodeLayout()) for name in self.names}
        self.edges = {key: known.edges.get(key, EdgeLayout()) for key in self.declared}
        self.centres = {name: node.position for name, node in self.nodes.items() if node.position is not None}
        self.top = min(centre.y for centre in self.centres.values())
        self.routes: dict[EdgeKey, Route] = {}
        self.reserved: list[Box] = []
        self.room = Room()

    def layout(self) -> TemplateLayout:
        self._mark_known()
        for name in [*self.centres]:
            self._place_node_texts(name)
        for key in [*self.routes]:
            self._place_edge_labels(key)
        old_nodes, old_edges = set(self.centres), set(self.routes)
        for name in self._new_nodes():
            check_job()
            self._place_node(name)
        for key in sorted(self.edges, key=lambda key: key.source == key.target):  # self-loops fit in anywhere
            check_job()
            if key not in self.routes and key.source in self.centres and key.target in self.centres:
                self._place_edge(key)
        for name in [name for name in self.centres if name not in old_nodes]:
            self._place_node_texts(name)
        for key in [key for key in self.routes if key not in old_edges]:
            self._place_edge_labels(key)
        self._place_comments()
        nodes, edges = {**self.known.nodes, **self.nodes}, {**self.known.edges, **self.edges}
        return replace(self.known, nodes=nodes, edges=edges)

    def _mark_known(self) -> None:
        for name, centre in self.centres.items():
            self.room.take(node_box(centre))
            if self.nodes[name].name is not None:
                self.room.take(box_at(self.nodes[name].name or centre, *self._name_size(name)))
        texts = {name: self._node_texts(name) for name in self.names}
        for labels, known in (
            *((self.nodes[name].labels, texts[name]) for name in self.names),
            *((edge.labels, self._edge_texts(key)) for key, edge in self.edges.items()),
        ):
            for box in _boxes(labels, known):
                self.room.take(box)
        for key, edge in self.edges.items():
            ends = [self.centres[name] for name in (key.source, key.target) if name in self.centres]
            if key in self.known.edges and len(ends) == 2:
                self._draw(key, (ends[0], *edge.nails, ends[1]))

    def _draw(self, key: EdgeKey, route: Route) -> None:
        self.routes[key] = route
        self.room.draw(route)

    # ---- texts ------------------------------------------------------------------------------------------------------

    def _name_size(self, name: str) -> Size:
        """The size of the name in the picture; branchpoints and locations that UPPAAL gave no name show none."""
        written = self.nodes[name].written_name
        shown = name if written is None else written
        return text_size(shown) if name in self.locations and shown else (0, 0)

    def _node_texts(self, name: str) -> dict[str, str]:
        if name not in self.locations:
            return {}
        doc = self.locations[name].doc
        return location_labels(self.locations[name]) | ({"comments": doc} if doc else {})

    def _edge_texts(self, key: EdgeKey) -> dict[str, str]:
        doc = self.declared[key].doc
        return edge_labels(self.declared[key]) | ({"comments": doc} if doc else {})

    def _place_node_texts(self, name: str) -> None:
        """Places for the name and the labels of a location: the usual ones, if they are free."""
        node, centre = self.nodes[name], self.centres[name]
        labels = {} if name not in self.locations else location_labels(self.locations[name])
        missing = _without_place(labels, node.labels)
        name_size = self._name_size(name) if node.name is None else (0, 0)
        size = stack_size(line_broken(missing))
        if name_size == (0, 0) and not missing:
            return
        name_box, labels_box = self._node_boxes(centre, name_size, size)
        if name_size != (0, 0):
            name_box = self._taken(name_box, node_box(centre))
            node = replace(node, name=_corner(name_box))
        if missing:
            known = _boxes(node.labels, labels)
            below = box_at(Point(round(known[-1].left), round(known[-1].bottom)), *size) if known else labels_box
            labels_box = self._taken(below, hull([node_box(centre), *known]))
            node = replace(node, labels=_added(node.labels, missing, _corner(labels_box)))
        self.nodes[name] = node

    def _node_boxes(self, centre: Point, name_size: Size, size: Size) -> tuple[Box, Box]:
        """The best of the usual places of the name and the labels of a location; they may be taken."""
        usual = (
            box_at(Point(centre.x + _NAME.x, centre.y + _NAME.y), *name_size),
            box_at(Point(centre.x + _LABELS.x, centre.y + _LABELS.y), *size),
        )
        for name_box, labels_box in (usual, *node_text_places(centre, name_size, size)):
            boxes = [box for box in (name_box, labels_box) if box is not None and box.left < box.right]
            if all(self.room.is_free(box) and not self.room.passing(box) for box in boxes):
                return name_box, labels_box or usual[1]
        return usual

    def _taken(self, box: Box, subject: Box) -> Box:
        """Takes a box if it is free, else another one near the subject."""
        if not self.room.is_free(box, 0) or self.room.passing(box, 0):
            return self.room.beside(subject, (round(box.right - box.left), round(box.bottom - box.top)))
        self.room.take(box)
        return box

    def _place_edge_labels(self, key: EdgeKey) -> None:
        edge, route, texts = self.edges[key], self.routes[key], edge_labels(self.declared[key])
        missing = _without_place(texts, edge.labels)
        if not missing:
            return
        size = stack_size(line_broken(missing))
        known = _boxes(edge.labels, texts)
        if known:
            below = box_at(Point(round(known[-1].left), round(known[-1].bottom)), *size)
            above = box_at(Point(round(known[0].left), round(known[0].top) - size[1]), *size)
            free = (box for box in (below, above) if self.room.is_free(box, 0) and not self.room.passing(box, 0))
            box = next(free, None) or free_place(self.room, route, size)
            box = self._taken(box or below, known[-1])
        else:
            box = place_at(self.room, route, size)
        self.edges[key] = replace(edge, labels=_added(edge.labels, missing, _corner(box)))

    def _place_comments(self) -> None:
        for name, node in self.nodes.items():
            if (missing := _without_place(self._node_texts(name), node.labels)) and name in self.centres:
                box = self.room.beside(node_box(self.centres[name]), text_size(missing["comments"]))
                self.nodes[name] = replace(node, labels=_added(node.labels, missing, _corner(box)))
        for key, edge in self.edges.items():
            if (missing := _without_place(self._edge_texts(key), edge.labels)) and key in self.routes:
                known = _boxes(edge.labels, self._edge_texts(key))
                subject = hull(known) if known else middle_of(self.routes[key])
                box = self.room.beside(subject, text_size(missing["comments"]))
                self.edges[key] = replace(edge, labels=_added(edge.labels, missing, _corner(box)))

    # ---- new locations and edges ------------------------------------------------------------------------------------

    def _new_nodes(self) -> Iterator[str]:
        """The nodes without a place: next to those that have one first."""
        waiting = [name for name in self.names if name not in self.centres]
        while waiting:
            name = next((name for name in waiting if self._neighbours(name)), waiting[0])
            waiting.remove(name)
            yield name

    def _neighbours(self, name: str) -> list[Point]:
        """The places of those nodes that edges join to one."""
        joined = dict.fromkeys(
            other
            for key in self.declared
            if name in (key.source, key.target)
            for other in (key.source, key.target)
            if other != name
        )
        return [self.centres[other] for other in joined if other in self.centres]

    def _place_node(self, name: str) -> None:
        sizes = self._name_size(name), stack_size(line_broken(self._location_labels(name)))
        neighbours = self._neighbours(name)
        right = max([self.room.right, *(box.right for box in self.reserved)])
        best = Point(_on_grid(right + _GAP), _on_grid(self.top))
        least = float("inf")
        for distance, centre in sorted(_around(neighbours)):
            if distance >= least:
                break
            room = _footprint(centre, *sizes)
            if not self.room.is_free(room) or self.room.passing(room) or any(map(room.overlaps, self.reserved)):
                continue
            cost = (
                distance
                + _NEAR * (not self.room.is_free(room, _CLOSE))
                + sum(self._in_the_way(centre, other) for other in neighbours)
            )
            if cost < least:
                best, least = centre, cost
        self.centres[name] = best
        self.nodes[name] = replace(self.nodes[name], position=best)
        self.room.take(node_box(best))
        self.reserved.append(_footprint(best, *sizes))

    def _location_labels(self, name: str) -> dict[str, str]:
        return location_labels(self.locations[name]) if name in self.locations else {}

    def _in_the_way(self, centre: Point, other: Point) -> float:
        """How much stands between a place and a neighbour, or so close to the line that labels have no room there."""
        own = node_box(other)
        span = segment_span(centre, other)
        cost = 0.0
        for box in self.room.taken.near(span.grown(_CLOSE)):
            if box != own and segment_meets_box(centre, other, box.grown(_CLOSE)):
                cost += _THROUGH if segment_meets_box(centre, other, box.grown(3)) else _NEAR
        for a, b in self.room.lines.near(span):
            cost += _THROUGH * segments_cross(centre, other, a, b)
        return cost

    def _place_edge(self, key: EdgeKey) -> None:
        edge = self.edges[key]
        ends = self.centres[key.source], self.centres[key.target]
        if not edge.nails:
            size = stack_size(line_broken(_without_place(edge_labels(self.declared[key]), edge.labels)))
            nails = new_route(self.room, ends, [*self.routes.values()], size)[1:-1]
            self.edges[key] = edge = replace(edge, nails=nails)
        self._draw(key, (ends[0], *edge.nails, ends[1]))


def _boxes(labels: Labels, texts: Mapping[str, str]) -> list[Box]:
    """The boxes of those labels that have a place, from top to bottom."""
    found = []
    for kind, text in texts.items():
        label = labels.get(kind, LabelLayout())
        if label.position is not None:
            found.append(box_at(label.position, *text_size(text if label.text is None else label.text)))
    return sorted(found, key=lambda box: box.top)


def _without_place(texts: Mapping[str, str], labels: Labels) -> dict[str, str]:
    """Those texts that have no place, as they were written where a layout says so."""
    return {
        kind: text if kind not in labels or labels[kind].text is None else labels[kind].text or ""
        for kind, text in texts.items()
        if kind not in labels or labels[kind].position is None
    }


def _added(labels: Labels, texts: Mapping[str, str], corner: Point) -> dict[str, LabelLayout]:
    """The labels with those that had no place, one below the other."""
    added = dict(labels)
    for kind, label in label_stack(texts, corner).items():
        written = labels[kind].text if kind in labels else None
        added[kind] = label if written is None else replace(label, text=label.text or written)
    return added


def _corner(box: Box) -> Point:
    return Point(round(box.left), round(box.top))


def _footprint(centre: Point, name_size: Size, labels_size: Size) -> Box:
    """The room that a location needs with its name above and its labels below."""
    around = node_box(centre).grown(_AROUND)
    name = box_at(Point(centre.x + _NAME.x, centre.y + _NAME.y), *name_size)
    labels = box_at(Point(centre.x + _LABELS.x, centre.y + _LABELS.y), *labels_size)
    return hull([around, name, labels])


def _around(neighbours: Iterable[Point]) -> Iterator[tuple[float, Point]]:
    """Places around some nodes, each with how far it is from a good distance to each of them."""
    points = list(neighbours)
    if not points:
        return
    x, y = (sum(point[axis] for point in points) / len(points) for axis in (0, 1))
    for column in range(-_STEPS, _STEPS + 1):
        for row in range(-_STEPS, _STEPS + 1):
            centre = Point(_on_grid(x + column * _STEP), _on_grid(y + row * _STEP))
            distances = [hypot(centre.x - point.x, centre.y - point.y) for point in points]
            if min(distances) > 4 * RADIUS:
                far = sum(abs(distance - _BEST_DISTANCE) for distance in distances) / len(points)
                aslant = min(abs(centre.x - x), abs(centre.y - y)) * _ASLANT
                aside = _LEFT * (centre.x < x) + _ABOVE * (centre.y < y) + _BELOW * (centre.y > y)
                yield far + aslant + aside, centre


def _on_grid(coordinate: float) -> int:
    return round(coordinate / _GRID) * _GRID
