"""The line of one edge that is added to a picture in which everything else stays."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise
from math import cos, hypot, pi, sin

from tachk.formats.layout.label_text import Size
from tachk.formats.layout.placement.geometry import (
    RADIUS,
    Box,
    distance_to_segment,
    node_box,
    segment_meets_box,
    segment_span,
)
from tachk.formats.layout.placement.polish import beside_line, beyond_loop, loop_nails
from tachk.formats.layout.placement.room import Room, middle_of
from tachk.formats.layout.placement.routing import are_disjoint, crossings, spread
from tachk.syntax.picture_layout import Point

Route = tuple[Point, ...]

_BEND = 24
_BENDS = 9
_LONG = 110
_TIP_WIDTH = 9
_NAILS = ((0.5,), (0.3, 0.7), (0.3,), (0.7,))
"""The places of nails along the straight line; short edges get one in the middle."""

_LOOP_LENGTHS = (44, 60, 76, 92, 124, 156)
_LOOP_DIRECTIONS = 16

_TOGETHER, _NODE, _TEXT = 10_000, 1000, 250
"""The cost of a line that cannot be told from another one between the same nodes, and of each node and text in its way.
The distance from a straight line counts as it is."""

_TOUCHED, _MERGED, _TIPS, _CROSSED, _NO_LABEL, _NAIL = 200, 150, 40, 50, 100, 10
"""The cost of each line between the same nodes that it touches, of one that merges with others at a node, of each arrow
tip that lies in another, of each crossing, of labels without a place at the line, and of a nail."""


def new_route(room: Room, ends: tuple[Point, Point], routes: Sequence[Route], labels_size: Size) -> Route:
    """The best line between two nodes: short, through nothing, with a place for its labels, and apart from others.

    Args:
        routes: of all edges that are there.
        labels_size: of the labels of the edge; (0, 0) if it has none.
    """
    rivals = [route for route in routes if {route[0], route[-1]} == set(ends)]
    best: Route = ends
    least = float("inf")
    for bend, route in sorted(_candidates(ends, len(rivals)), key=lambda found: found[0]):
        if bend >= least:
            break
        cost = bend + _cost(room, route, routes, rivals)
        if cost < least and labels_size != (0, 0) and free_place(room, route, labels_size) is None:
            cost += _NO_LABEL
        if cost < least:
            best, least = route, cost
    return best


def free_place(room: Room, route: Route, size: Size) -> Box | None:
    """A free box of a size at the line of an edge; None if there is none."""
    boxes: Iterable[Box] = beside_line(route, size)
    if route[0] == route[-1] and len(route) == 4:
        tip_x, tip_y = (route[1].x + route[2].x) / 2, (route[1].y + route[2].y) / 2
        length = hypot(tip_x - route[0].x, tip_y - route[0].y) or 1.0
        boxes = (beyond_loop(route[1:3], ((tip_x - route[0].x) / length, (tip_y - route[0].y) / length), size),)
    for box in boxes:
        if (
            room.is_free(box)
            and not room.passing(box)
            and not any(segment_meets_box(a, b, box) for a, b in pairwise(route))
        ):
            return box
    return None


def place_at(room: Room, route: Route, size: Size) -> Box:
    """Takes a place for labels at the line of an edge, or near it. The line has been drawn."""
    box = free_place(room, route, size)
    if box is None:
        return room.beside(middle_of(route), size)
    room.take(box)
    return box


def _candidates(ends: tuple[Point, Point], rivals: int) -> Iterator[tuple[float, Route]]:
    """Lines between two nodes, each with how far it is from a straight one, plus its nails."""
    start, end = ends
    if start == end:
        for number in range(_LOOP_DIRECTIONS):
            turn = 2 * pi * number / _LOOP_DIRECTIONS
            for length in _LOOP_LENGTHS:
                nails = loop_nails(start, (cos(turn), sin(turn)), length)
                # Level and upright loops come first.
                yield length - _LOOP_LENGTHS[0] + number % 4, (start, *nails, end)
        return
    yield 0.0, (start, end)
    distance = hypot(end.x - start.x, end.y - start.y)
    x, y = (start.y - end.y) / distance, (end.x - start.x) / distance
    for number in range(1, _BENDS + rivals):
        for bend in (number * _BEND, -number * _BEND):
            for parts in _NAILS if distance > _LONG else _NAILS[:1]:
                nails_of = (
                    Point(
                        round(start.x + part * (end.x - start.x) + bend * x),
                        round(start.y + part * (end.y - start.y) + bend * y),
                    )
                    for part in parts
                )
                yield abs(bend) + _NAIL * len(parts), (start, *nails_of, end)


def _cost(room: Room, route: Route, routes: Sequence[Route], rivals: Sequence[Route]) -> float:
    own = {node_box(route[0]), node_box(route[-1])}
    met = 0
    for a, b in pairwise(route):
        for box in room.taken.near(segment_span(a, b).grown(3)):
            if box not in own and segment_meets_box(a, b, box.grown(3)):
                met += _NODE if box.bottom - box.top == 2 * RADIUS == box.right - box.left else _TEXT
    together = any(not are_disjoint(route, rival) for rival in rivals)
    merged = not (spread(route[0], route[1], routes) and spread(route[-1], route[-2], routes))
    touched = sum(_touch(route, rival) for rival in rivals)
    crossed = crossings(tuple(pairwise(route)), routes)
    close = sum(
        _rims_are_close(here, there)
        for other in routes
        for there in (other[:2], other[:-3:-1])
        for here in (route[:2], route[:-3:-1])
        if here[0] == there[0]
    )
    return _TOGETHER * together + met + _TOUCHED * touched + _MERGED * merged + _TIPS * close + _CROSSED * crossed


def _touch(one: Route, other: Route) -> bool:
    """True if a nail of one line lies at the other."""
    nails = [(nail, other) for nail in one[1:-1]] + [(nail, one) for nail in other[1:-1]]
    return any(distance_to_segment(nail, a, b) < RADIUS for nail, line in nails for a, b in pairwise(line))


def _rims_are_close(one: Sequence[Point], other: Sequence[Point]) -> bool:
    """True if two lines from the centre of a node leave its circle so close together that arrow tips would overlap."""
    (ax, ay), (bx, by) = (_direction(*line) for line in (one, other))
    return hypot(ax - bx, ay - by) * RADIUS < _TIP_WIDTH


def _direction(start: Point, end: Point) -> tuple[float, float]:
    length = hypot(end.x - start.x, end.y - start.y) or 1.0
    return (end.x - start.x) / length, (end.y - start.y) / length
