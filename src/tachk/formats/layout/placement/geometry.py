"""Boxes, points and lines of a picture; y grows downwards."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator
from math import hypot
from typing import Generic, NamedTuple, TypeVar

from tachk.syntax.picture_layout import Point

RADIUS = 12
"""The radius of the circle of a location, in UPPAAL's coordinates."""


_CELL = 128

Thing = TypeVar("Thing")


class Box(NamedTuple):
    """A rectangle with its sides parallel to the axes."""

    left: float
    top: float
    right: float
    bottom: float

    def grown(self, margin: float) -> Box:
        return Box(self.left - margin, self.top - margin, self.right + margin, self.bottom + margin)

    def overlaps(self, other: Box) -> bool:
        """True if the insides have a point in common."""
        return (
            self.left < other.right and other.left < self.right and self.top < other.bottom and other.top < self.bottom
        )


def box_at(position: Point, width: float, height: float) -> Box:
    """The box with this top left corner."""
    return Box(position.x, position.y, position.x + width, position.y + height)


def node_box(centre: Point) -> Box:
    return Box(centre.x - RADIUS, centre.y - RADIUS, centre.x + RADIUS, centre.y + RADIUS)


def segment_meets_box(a: Point, b: Point, box: Box) -> bool:
    """True if a segment has a point inside a box (clipping of Liang and Barsky, 1984)."""
    low, high = 0.0, 1.0
    for start, step, least, most in (
        (a.x, b.x - a.x, box.left, box.right),
        (a.y, b.y - a.y, box.top, box.bottom),
    ):
        if step == 0:
            if not least < start < most:
                return False
            continue
        enter, leave = (least - start) / step, (most - start) / step
        if enter > leave:
            enter, leave = leave, enter
        low, high = max(low, enter), min(high, leave)
        if low >= high:
            return False
    return True


def segments_cross(a: Point, b: Point, c: Point, d: Point) -> bool:
    """True if two segments cross in one point that is an end of neither."""
    if max(a.x, b.x) < min(c.x, d.x) or max(c.x, d.x) < min(a.x, b.x):
        return False
    if max(a.y, b.y) < min(c.y, d.y) or max(c.y, d.y) < min(a.y, b.y):
        return False
    return _side(a, b, c) * _side(a, b, d) < 0 and _side(c, d, a) * _side(c, d, b) < 0


def _side(a: Point, b: Point, p: Point) -> int:
    turn = (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x)
    return (turn > 0) - (turn < 0)


def distance_to_segment(p: Point, a: Point, b: Point) -> float:
    dx, dy = b.x - a.x, b.y - a.y
    length = dx * dx + dy * dy
    if length == 0:
        return hypot(p.x - a.x, p.y - a.y)
    along = max(0.0, min(1.0, ((p.x - a.x) * dx + (p.y - a.y) * dy) / length))
    return hypot(p.x - a.x - along * dx, p.y - a.y - along * dy)


class BoxIndex(Generic[Thing]):
    """Things by the cells of a coarse grid that their boxes touch."""

    def __init__(self) -> None:
        self.cells: dict[tuple[int, int], dict[Thing, None]] = defaultdict(dict)

    def add(self, thing: Thing, box: Box) -> None:
        for cell in _cells(box):
            self.cells[cell][thing] = None

    def near(self, box: Box) -> Iterable[Thing]:
        return dict.fromkeys(thing for cell in _cells(box) for thing in self.cells.get(cell, ()))


def _cells(box: Box) -> Iterator[tuple[int, int]]:
    for column in range(int(box.left // _CELL), int(box.right // _CELL) + 1):
        for row in range(int(box.top // _CELL), int(box.bottom // _CELL) + 1):
            yield column, row


def segment_span(a: Point, b: Point) -> Box:
    return Box(min(a.x, b.x), min(a.y, b.y), max(a.x, b.x), max(a.y, b.y)).grown(1)
