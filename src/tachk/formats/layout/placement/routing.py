"""Fewer nails, and names where no edge passes: what makes a first drawing in layers look drawn by hand."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import pairwise
from math import hypot

from tachk.base.job import check_job
from tachk.base.records import replace
from tachk.formats.layout.placement.geometry import (
    RADIUS,
    Box,
    BoxIndex,
    box_at,
    distance_to_segment,
    node_box,
    segment_meets_box,
    segment_span,
    segments_cross,
)
from tachk.formats.layout.placement.sketch import Sketch, TemplateDrawing
from tachk.syntax.picture_layout import Point

_CLEARANCE = 6
_FARTHEST_FROM_LABEL = 14
_FAN = 60
_MANY = 150
"""With more edges than this, crossings are not counted."""

Segment = tuple[Point, Point]


def straighten(sketch: Sketch, drawing: TemplateDrawing) -> TemplateDrawing:
    """Takes out each nail whose edge is as well off without it: it meets no text and no node then, crosses no more
    edges than before and stays with its labels and away from edges between the same nodes."""
    obstacles: BoxIndex[tuple[int, Box]] = BoxIndex()
    for at, boxes in enumerate(zip(map(node_box, drawing.centres), drawing.names, drawing.node_labels, strict=True)):
        for margin, box in zip((_CLEARANCE, 0, 0), boxes, strict=True):
            if box is not None:
                wide = box.grown(margin)
                obstacles.add((at, wide), wide)
    for label in drawing.edge_labels:
        if label is not None:
            wide = label.grown(1)
            obstacles.add((-1, wide), wide)
    routes = list(drawing.routes)
    for at, edge in enumerate(sketch.edges):
        check_job()
        if edge.source != edge.target:
            ends = {edge.source, edge.target}

            def free(a: Point, b: Point, ends: set[int] = ends) -> bool:
                near = obstacles.near(segment_span(a, b))
                return not any(owner not in ends and segment_meets_box(a, b, box) for owner, box in near)

            routes[at] = shortened(sketch, routes, at, free, drawing.edge_labels[at])
    return replace(drawing, routes=tuple(routes))


def shortened(
    sketch: Sketch,
    routes: Sequence[Sequence[Point]],
    at: int,
    free: Callable[[Point, Point], bool],
    label: Box | None,
) -> tuple[Point, ...]:
    """An edge without the nails that it can do without.

    Args:
        at: the number of the edge.
        free: whether a line meets nothing that it must not meet.
        label: with which the edge must stay; None if there is no need.
    """
    edge = sketch.edges[at]
    route = list(routes[at])
    others = [routes[other] for other in range(len(routes)) if other != at] if len(routes) <= _MANY else []
    rivals = [
        routes[number]
        for number, other in enumerate(sketch.edges)
        if number != at and {other.source, other.target} == {edge.source, edge.target}
    ]
    start = 0
    while start < len(route) - 2:
        for end in range(len(route) - 1, start + 1, -1):
            a, b = route[start], route[end]
            shorter = [*route[: start + 1], *route[end:]]
            if (
                free(a, b)
                and _keeps_to_label(route, shorter, label)
                and all(are_disjoint(shorter, rival) for rival in rivals)
                and (start > 0 or spread(a, b, others))
                and (end < len(route) - 1 or spread(b, a, others))
                and crossings(((a, b),), others) <= crossings(tuple(pairwise(route[start : end + 1])), others)
            ):
                route = shorter
                break
        start += 1
    return tuple(route)


def _keeps_to_label(route: Sequence[Point], shorter: Sequence[Point], label: Box | None) -> bool:
    if label is None:
        return True
    limit = max(_FARTHEST_FROM_LABEL, _to_label(route, label) + 2)
    return _to_label(shorter, label) <= limit


def _to_label(route: Sequence[Point], label: Box) -> float:
    """The least distance of a few points on the rim of a label from a line, an upper bound along its nearest side."""
    middle_x, middle_y = (label.left + label.right) / 2, (label.top + label.bottom) / 2
    corners = ((middle_x, label.bottom), (middle_x, label.top), (label.left, middle_y), (label.right, middle_y))
    return min(distance_to_segment(Point(round(x), round(y)), a, b) for x, y in corners for a, b in pairwise(route))


def are_disjoint(route: Sequence[Point], rival: Sequence[Point]) -> bool:
    """True if two edges between the same nodes are distinct in the drawing: one has a nail off the other's line."""
    inner = [(point, rival) for point in route[1:-1]] + [(point, route) for point in rival[1:-1]]
    return any(
        min(distance_to_segment(point, a, b) for a, b in pairwise(line)) >= 2 * _CLEARANCE for point, line in inner
    )


def spread(node: Point, nail: Point, others: Sequence[Sequence[Point]]) -> bool:
    """True if a line from a node is distinct from the other lines there, a little way from it."""
    length = hypot(nail.x - node.x, nail.y - node.y)
    along = min(1.0, _FAN / length) if length else 0.0
    point = Point(round(node.x + along * (nail.x - node.x)), round(node.y + along * (nail.y - node.y)))
    for other in others:
        for start, end in ((other[0], other[1]), (other[-1], other[-2])):
            if start == node and distance_to_segment(point, start, end) < _CLEARANCE:
                return False
    return True


def crossings(segments: Iterable[Segment], others: Sequence[Sequence[Point]]) -> int:
    return sum(segments_cross(a, b, c, d) for a, b in segments for other in others for c, d in pairwise(other))


def clear_texts(sketch: Sketch, drawing: TemplateDrawing) -> TemplateDrawing:
    """Moves the name and the labels of each node to where the fewest edges pass."""
    segments: BoxIndex[Segment] = BoxIndex()
    for route in drawing.routes:
        for a, b in pairwise(route):
            segments.add((a, b), segment_span(a, b))
    taken: BoxIndex[Box] = BoxIndex()
    for text in drawing.boxes():
        taken.add(text, text)
    names, labels = list(drawing.names), list(drawing.node_labels)
    for at, centre in enumerate(drawing.centres):
        check_job()
        own: tuple[Box, Box | None] = names[at], labels[at]
        best = float("inf")
        node = sketch.nodes[at]
        candidates = (own, *node_text_places(centre, node.name_size, node.labels_size))
        for preference, (name, label) in enumerate(candidates):
            cost = 0.2 * preference
            if cost >= best:
                break
            if label is not None and name.overlaps(label):
                continue
            for box in (name, label):
                if box is not None:
                    wide = box.grown(2)
                    cost += 10 * sum(segment_meets_box(a, b, wide) for a, b in segments.near(wide))
                    if preference:
                        cost += 1000 * any(other not in own and wide.overlaps(other) for other in taken.near(wide))
            if cost < best:
                best = cost
                names[at], labels[at] = name, label
        for chosen in (names[at], labels[at]):
            if chosen is not None:
                taken.add(chosen, chosen)
    return replace(drawing, names=tuple(names), node_labels=tuple(labels))


def node_text_places(
    centre: Point, name_size: tuple[int, int], labels_size: tuple[int, int]
) -> Iterator[tuple[Box, Box | None]]:
    """Places of the name and the labels of a node: UPPAAL's habits first."""
    (width, height), (labels_width, labels_height) = name_size, labels_size
    x, y = centre
    near = RADIUS + 4

    def boxes(left: float, top: float, labels_left: float, labels_top: float) -> tuple[Box, Box | None]:
        name = box_at(Point(round(left), round(top)), width, height)
        if not labels_height:
            return name, None
        return name, box_at(Point(round(labels_left), round(labels_top)), labels_width, labels_height)

    stacked = height + labels_height
    for far in (0, 14, 28):
        above, below = y - 17 - far - height, y + 17 + far
        for left, labels_left in (
            (x - 10, x - 10),
            (x - width / 2, x - labels_width / 2),
            (x + 10 - width, x + 10 - labels_width),
        ):
            if far == 0:
                yield boxes(left, above, labels_left, below)
            yield boxes(left, below, labels_left, below + height)
            yield boxes(left, above - labels_height, labels_left, above)
        for shift in (-near, near, 0, -2 * near, 2 * near):
            top = y - stacked / 2 + shift
            yield boxes(x + near + far, top, x + near + far, top + height)
            yield boxes(x - near - far - width, top, x - near - far - labels_width, top + height)
    if not labels_height:
        return
    for left in (x - 10, x - width / 2, x + 10 - width):
        for labels_left in (x + near, x - near - labels_width):
            for labels_top in (y - labels_height / 2, y - labels_height - 4, y + 4):
                yield boxes(left, y - 17 - height, labels_left, labels_top)
                yield boxes(left, y + 17, labels_left, labels_top)
