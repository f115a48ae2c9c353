"""Room for comments on locations and long ones on edges, which UPPAAL shows too: where a finished drawing leaves it."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from tachk.formats.layout.label_text import text_height, text_width
from tachk.formats.layout.placement.geometry import Box, BoxIndex, node_box, segment_meets_box, segment_span
from tachk.formats.layout.placement.sketch import Sketch, TemplateDrawing
from tachk.syntax.picture_layout import Point

_STEP_X, _STEP_Y = 40, 17
_FARTHEST = 12
_CROSSING = 120
_MARGIN = 2


class CommentPlacer:
    """Finds room for one comment after the other, near what it is about."""

    def __init__(self, sketch: Sketch, drawing: TemplateDrawing) -> None:
        self.sketch = sketch
        self.drawing = drawing
        self.taken: BoxIndex[Box] = BoxIndex()
        self.lines: BoxIndex[tuple[Point, Point]] = BoxIndex()
        self.bottom = 0.0
        for box in drawing.boxes():
            self._take(box)
        for route in drawing.routes:
            for a, b in pairwise(route):
                self.lines.add((a, b), segment_span(a, b))

    def beside_node(self, node: int, text: str) -> Box:
        around = [box for box in (self.drawing.names[node], self.drawing.node_labels[node]) if box is not None]
        return self._place(_hull([node_box(self.drawing.centres[node]), *around]), text)

    def beside_edge(self, edge: int, text: str) -> Box:
        label = self.drawing.edge_labels[edge]
        if label is None:
            route = self.drawing.routes[edge]
            first, second = route[(len(route) - 1) // 2], route[len(route) // 2]
            label = segment_span(first, second) if len(route) < 3 else node_box(first)
            middle = Point(round((label.left + label.right) / 2), round((label.top + label.bottom) / 2))
            label = Box(middle.x - 4, middle.y - 4, middle.x + 4, middle.y + 4)
        return self._place(label, text)

    def _take(self, box: Box) -> None:
        self.taken.add(box, box)
        self.bottom = max(self.bottom, box.bottom)

    def _place(self, subject: Box, text: str) -> Box:
        width, height = text_width(text), text_height(text)
        best, least = Box(subject.left, self.bottom + 8, subject.left + width, self.bottom + 8 + height), float("inf")
        for distance, left, top in _corners(subject, width, height):
            if distance >= least:
                break
            box = Box(left, top, left + width, top + height)
            wide = box.grown(_MARGIN)
            if any(wide.overlaps(other) for other in self.taken.near(wide)):
                continue
            crossed = sum(segment_meets_box(a, b, wide) for a, b in self.lines.near(wide))
            if distance + _CROSSING * crossed < least:
                best, least = box, distance + _CROSSING * crossed
        self._take(best)
        return best


def _hull(boxes: list[Box]) -> Box:
    return Box(
        min(box.left for box in boxes),
        min(box.top for box in boxes),
        max(box.right for box in boxes),
        max(box.bottom for box in boxes),
    )


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
