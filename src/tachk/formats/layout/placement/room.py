"""Free places in a picture: beside the thing that a text is about, where nothing else stands and few edges pass."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise

from tachk.formats.layout.label_text import Size
from tachk.formats.layout.placement.geometry import (
    Box,
    BoxIndex,
    node_box,
    segment_meets_box,
    segment_span,
)
from tachk.syntax.picture_layout import Point

_STEP_X, _STEP_Y = 40, 17
_FARTHEST = 12
_CROSSING = 120
_MARGIN = 2


class Room:
    """What stands in a picture already, and what is free.

    Attributes:
        taken: the boxes of texts and nodes.
        lines: the segments of edges.
        right, bottom: the ends of the picture.
    """

    def __init__(self) -> None:
        self.taken: BoxIndex[Box] = BoxIndex()
        self.lines: BoxIndex[tuple[Point, Point]] = BoxIndex()
        self.right = self.bottom = 0.0

    def take(self, box: Box) -> None:
        """Marks the place of a text or node as taken."""
        self.taken.add(box, box)
        self.right, self.bottom = max(self.right, box.right), max(self.bottom, box.bottom)

    def draw(self, route: Sequence[Point]) -> None:
        """Marks the line of an edge."""
        for a, b in pairwise(route):
            span = segment_span(a, b)
            self.lines.add((a, b), span)
            self.right, self.bottom = max(self.right, span.right), max(self.bottom, span.bottom)

    def is_free(self, box: Box, margin: float = _MARGIN) -> bool:
        """True if no text and no node stands in a box, nor closer to it than a margin."""
        wide = box.grown(margin)
        return not any(wide.overlaps(other) for other in self.taken.near(wide))

    def passing(self, box: Box, margin: float = _MARGIN) -> int:
        """The number of segments of edges that pass through a box."""
        wide = box.grown(margin)
        return sum(segment_meets_box(a, b, wide) for a, b in self.lines.near(wide))

    def beside(self, subject: Box, size: Size) -> Box:
        """Takes a free place of a size near its subject, below the picture if there is none."""
        width, height = size
        best, least = Box(subject.left, self.bottom + 8, subject.left + width, self.bottom + 8 + height), float("inf")
        for distance, left, top in _corners(subject, width, height):
            if distance >= least:
                break
            box = Box(left, top, left + width, top + height)
            if not self.is_free(box):
                continue
            cost = distance + _CROSSING * self.passing(box)
            if cost < least:
                best, least = box, cost
        self.take(best)
        return best


def _corners(subject: Box, width: int, height: int) -> Iterator[tuple[float, float, float]]:
    """Top left corners around a subject, each with how bad its distance is, in ascending order."""
    found = []
    for i in range(-_FARTHEST, _FARTHEST + 1):
        for above in (True, False):
            for far in range(_FARTHEST):
                top = subject.top - 2 - height - far * _STEP_Y if above else subject.bottom + 2 + far * _STEP_Y
                left = subject.left + i * _STEP_X
                aside = max(0.0, left - subject.right, subject.left - left - width)
                found.append((far * _STEP_Y + aside + abs(i) * 2 + above, left, top))
        for right in (True, False):
            for far in range(_FARTHEST):
                left = subject.right + 8 + far * _STEP_X if right else subject.left - 8 - width - far * _STEP_X
                top = subject.top + i * _STEP_Y
                aside = max(0.0, top - subject.bottom, subject.top - top - height)
                found.append((far * _STEP_X + 8 + aside + abs(i) * 2, left, top))
    yield from sorted(found)


def hull(boxes: Iterable[Box]) -> Box:
    """The least box around some, of which there is one at least."""
    lefts, tops, rights, bottoms = zip(*boxes, strict=True)
    return Box(min(lefts), min(tops), max(rights), max(bottoms))


def middle_of(route: Sequence[Point]) -> Box:
    """A small box in the middle of the line of an edge."""
    first, second = route[(len(route) - 1) // 2], route[len(route) // 2]
    box = segment_span(first, second) if len(route) < 3 else node_box(first)
    middle = Point(round((box.left + box.right) / 2), round((box.top + box.bottom) / 2))
    return Box(middle.x - 4, middle.y - 4, middle.x + 4, middle.y + 4)
