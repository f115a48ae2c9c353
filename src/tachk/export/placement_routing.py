"""Fewer nails, and names where no edge passes: what makes a first drawing in layers look drawn by hand."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise

from tachk.export.placement_geometry import (
    RADIUS,
    Box,
    box_at,
    distance_to_segment,
    node_box,
    segment_meets_box,
    segments_cross,
)
from tachk.export.placement_sketch import Drawing, Sketch
from tachk.syntax.layout import Point

_CLEARANCE = 6
_FARTHEST_FROM_LABEL = 14
_CELL = 128

Segment = tuple[Point, Point]


class _Index:
    """Things by the cells of a coarse grid that their boxes touch."""

    def __init__(self) -> None:
        self.cells: dict[tuple[int, int], list[tuple[int, Box]]] = defaultdict(list)

    def add(self, owner: int, box: Box) -> None:
        for cell in _cells(box):
            self.cells[cell].append((owner, box))

    def near(self, box: Box) -> set[tuple[int, Box]]:
        return {found for cell in _cells(box) for found in self.cells.get(cell, ())}


def _cells(box: Box) -> Iterator[tuple[int, int]]:
    for column in range(int(box.left // _CELL), int(box.right // _CELL) + 1):
        for row in range(int(box.top // _CELL), int(box.bottom // _CELL) + 1):
            yield column, row


def _span(a: Point, b: Point) -> Box:
    return Box(min(a.x, b.x), min(a.y, b.y), max(a.x, b.x), max(a.y, b.y)).grown(1)


def straighten(sketch: Sketch, drawing: Drawing) -> Drawing:
    """Takes out each nail whose edge is as well off without it: it meets no text and no node then, crosses no more edges
    than before and stays with its labels and away from edges between the same nodes."""
    obstacles = _Index()
    for at, centre in enumerate(drawing.centres):
        obstacles.add(at, node_box(centre).grown(_CLEARANCE))
    for at, boxes in enumerate(zip(drawing.names, drawing.node_labels, strict=True)):
        for box in boxes:
            if box is not None:
                obstacles.add(at, box)
    for label in drawing.edge_labels:
        if label is not None:
            obstacles.add(-1, label.grown(1))
    routes = [list(route) for route in drawing.routes]
    together: dict[frozenset[int], list[int]] = defaultdict(list)
    for at, edge in enumerate(sketch.edges):
        together[frozenset((edge.source, edge.target))].append(at)
    careful = len(routes) <= 150
    for at, edge in enumerate(sketch.edges):
        if edge.source == edge.target:
            continue
        ends = {edge.source, edge.target}
        rivals = [other for other in together[frozenset(ends)] if other != at]
        label = drawing.edge_labels[at]
        others = [other for other in range(len(routes)) if other != at] if careful else []

        def free(a: Point, b: Point, ends: set[int] = ends) -> bool:
            return not any(
                owner not in ends and segment_meets_box(a, b, box) for owner, box in obstacles.near(_span(a, b))
            )

        routes[at] = _shortened(routes[at], label, free, [routes[r] for r in rivals], [routes[o] for o in others])
    return replace(drawing, routes=tuple(map(tuple, routes)))


def _shortened(
    route: list[Point],
    label: Box | None,
    free: object,
    rivals: Sequence[Sequence[Point]],
    others: Sequence[Sequence[Point]],
) -> list[Point]:
    assert callable(free)
    start = 0
    while start < len(route) - 2:
        for end in range(len(route) - 1, start + 1, -1):
            a, b = route[start], route[end]
            shorter = [*route[: start + 1], *route[end:]]
            if (
                free(a, b)
                and _keeps_to_label(route, shorter, label)
                and all(_apart(shorter, rival) for rival in rivals)
                and _crossings(((a, b),), others) <= _crossings(tuple(pairwise(route[start : end + 1])), others)
            ):
                route = shorter
                break
        start += 1
    return route


def _keeps_to_label(route: Sequence[Point], shorter: Sequence[Point], label: Box | None) -> bool:
    if label is None:
        return True
    limit = max(_FARTHEST_FROM_LABEL, _to_label(route, label) + 2)
    return _to_label(shorter, label) <= limit


def _to_label(route: Sequence[Point], label: Box) -> float:
    """How far the nearest of a few points on the rim of a label is from a line, at most, along its nearest side."""
    middle_x, middle_y = (label.left + label.right) / 2, (label.top + label.bottom) / 2
    corners = ((middle_x, label.bottom), (middle_x, label.top), (label.left, middle_y), (label.right, middle_y))
    return min(
        distance_to_segment(Point(round(x), round(y)), a, b) for x, y in corners for a, b in pairwise(route)
    )


def _apart(route: Sequence[Point], rival: Sequence[Point]) -> bool:
    """Whether two edges between the same nodes can be told apart: one has a nail off the other's line."""
    inner = [(point, rival) for point in route[1:-1]] + [(point, route) for point in rival[1:-1]]
    return any(min(distance_to_segment(point, a, b) for a, b in pairwise(line)) >= 2 * _CLEARANCE for point, line in inner)


def _crossings(segments: Iterable[Segment], others: Sequence[Sequence[Point]]) -> int:
    return sum(
        segments_cross(a, b, c, d)
        for a, b in segments
        for other in others
        for c, d in pairwise(other)
    )


def place_texts(sketch: Sketch, drawing: Drawing) -> Drawing:
    """Moves the name and the labels of each node to where the fewest edges pass."""
    segments = _Index()
    for at, route in enumerate(drawing.routes):
        for a, b in pairwise(route):
            segments.add(at, _span(a, b))
    lines = {(at, _span(a, b)): (a, b) for at, route in enumerate(drawing.routes) for a, b in pairwise(route)}
    taken = _Index()
    boxes = drawing.boxes()
    for number, box in enumerate(boxes):
        taken.add(number, box)
    count = len(drawing.centres)
    places: dict[int, Box] = dict(enumerate(boxes))
    names, labels = list(drawing.names), list(drawing.node_labels)
    for at, centre in enumerate(drawing.centres):
        own = {id(names[at]), id(labels[at])}
        best: tuple[float, int, Box, Box | None] | None = None
        now = (names[at], labels[at])
        candidates = [now, *_candidates(centre, sketch.nodes[at].name_size, sketch.nodes[at].labels_size)]
        for preference, (name, label) in enumerate(candidates):
            cost = 0.0 if preference else 0.5
            for box in (name, label):
                if box is None:
                    continue
                if preference and any(
                    box.grown(2).overlaps(other)
                    for other in _others(taken, box, boxes, own, names, labels, at)
                ):
                    cost += 1000
                cost += 10 * sum(
                    segment_meets_box(*lines[found], box.grown(1)) for found in segments.near(box.grown(1))
                )
            if best is None or cost + 0.2 * preference < best[0]:
                best = cost + 0.2 * preference, preference, name, label
        assert best is not None
        names[at], labels[at] = best[2], best[3]
        for box in (best[2], best[3]):
            if box is not None and best[1]:
                taken.add(-1 - at, box)
    del count, places
    return replace(drawing, names=tuple(names), node_labels=tuple(labels))


def _others(
    taken: _Index,
    box: Box,
    boxes: Sequence[Box],
    own: set[int],
    names: Sequence[Box],
    labels: Sequence[Box | None],
    at: int,
) -> Iterator[Box]:
    for _, other in taken.near(box.grown(2)):
        if other not in (names[at], labels[at]):
            yield other


def _candidates(
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

    above, below = y - 17 - height, y + 17
    stacked = height + labels_height
    lefts = ((x - 10, x - 10), (x - width / 2, x - labels_width / 2), (x + 10 - width, x + 10 - labels_width))
    for left, labels_left in lefts:
        yield boxes(left, above, labels_left, below)
    for left, labels_left in lefts:
        yield boxes(left, below, labels_left, below + height)
        yield boxes(left, above - labels_height, labels_left, above)
    for shift in (near, 0):
        yield boxes(x + near, y - stacked / 2 - shift, x + near, y - stacked / 2 - shift + height)
        yield boxes(x + near, y - stacked / 2 + shift, x + near, y - stacked / 2 + shift + height)
        yield boxes(x - near - width, y - stacked / 2 - shift, x - near - labels_width, y - stacked / 2 - shift + height)
        yield boxes(x - near - width, y - stacked / 2 + shift, x - near - labels_width, y - stacked / 2 + shift + height)
    for left, _ in lefts:
        for labels_left in (x + near, x - near - labels_width):
            for labels_top in (y - labels_height / 2, y - labels_height - 4, y + 4):
                yield boxes(left, above, labels_left, labels_top)
                yield boxes(left, below, labels_left, labels_top)
