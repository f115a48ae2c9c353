"""Short self-loops and straight edges, where their labels find another place beside them.

The drawing in layers keeps a place for every label, which can be far from where a person would put it. Here each edge
is drawn anew where that leaves everything free of overlaps and adds no crossing.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from math import hypot

from tachk.base.job import check_job
from tachk.base.records import replace
from tachk.formats.layout.label_text import Size
from tachk.formats.layout.placement.geometry import Box, node_box, segment_meets_box
from tachk.formats.layout.placement.routing import crossings, shortened, spread
from tachk.formats.layout.placement.sketch import Sketch, TemplateDrawing
from tachk.syntax.picture_layout import Point

_LOOP_LENGTH, _LOOP_HALF_WIDTH = 44, 10
_LABEL_GAP = 3
_MARGIN = 3
_STEEP = 0.3

_DIAGONAL = 0.7071
_DIRECTIONS = (
    (1.0, 0.0),
    (-1.0, 0.0),
    (0.0, -1.0),
    (0.0, 1.0),
    (_DIAGONAL, -_DIAGONAL),
    (_DIAGONAL, _DIAGONAL),
    (-_DIAGONAL, -_DIAGONAL),
    (-_DIAGONAL, _DIAGONAL),
)


def redraw_loops(sketch: Sketch, drawing: TemplateDrawing) -> TemplateDrawing:
    """The drawing with short self-loops, where possible."""
    scene = _Scene(sketch, drawing)
    for at, edge in enumerate(sketch.edges):
        check_job()
        if edge.source == edge.target:
            scene.redraw_loop(at)
    return replace(drawing, routes=tuple(scene.routes), edge_labels=tuple(scene.labels))


def redraw_edges(sketch: Sketch, drawing: TemplateDrawing) -> TemplateDrawing:
    """The drawing with straighter edges, where possible."""
    scene = _Scene(sketch, drawing)
    for at, edge in enumerate(sketch.edges):
        check_job()
        if edge.source != edge.target:
            scene.redraw_edge(at)
    return replace(drawing, routes=tuple(scene.routes), edge_labels=tuple(scene.labels))


class _Scene:
    """A drawing whose edges are redrawn one after the other."""

    def __init__(self, sketch: Sketch, drawing: TemplateDrawing) -> None:
        self.sketch = sketch
        self.centres = drawing.centres
        self.routes = list(drawing.routes)
        self.labels = list(drawing.edge_labels)
        self.texts = [box for box in (*drawing.names, *drawing.node_labels) if box is not None and box.left < box.right]
        self.circles = [node_box(centre).grown(4) for centre in drawing.centres]

    def redraw_loop(self, at: int) -> None:
        edge = self.sketch.edges[at]
        centre = self.centres[edge.source]
        nail = self.routes[at][1]
        if hypot(nail.x - centre.x, nail.y - centre.y) < _LOOP_LENGTH + _LOOP_HALF_WIDTH:
            return
        others = [route for number, route in enumerate(self.routes) if number != at]
        boxes = self._boxes(at, {edge.source})
        for x, y in _DIRECTIONS:
            nails = loop_nails(centre, (x, y), _LOOP_LENGTH)
            route = (centre, *nails, centre)
            if (
                any(segment_meets_box(a, b, box) for a, b in pairwise(route) for box in boxes)
                or crossings(tuple(pairwise(route)), others)
                or not all(spread(centre, nail, others) for nail in nails)
            ):
                continue
            label = beyond_loop(nails, (x, y), edge.labels_size) if self.labels[at] is not None else None
            if label is None or self._has_room(label, at, route):
                self.routes[at], self.labels[at] = route, label
                return

    def redraw_edge(self, at: int) -> None:
        edge = self.sketch.edges[at]
        boxes = self._boxes(at, {edge.source, edge.target})

        def free(a: Point, b: Point) -> bool:
            return not any(segment_meets_box(a, b, box) for box in boxes)

        route = shortened(self.sketch, self.routes, at, free, None)
        # Two nails hold a level line under its labels, which is tidier than one nail.
        if len(route) == len(self.routes[at]) or (len(route) > 2 and len(self.routes[at]) == 4):
            return
        if self.labels[at] is None:
            self.routes[at] = route
            return
        for label in beside_line(route, edge.labels_size):
            if self._has_room(label, at, route):
                self.routes[at], self.labels[at] = route, label
                return

    def _boxes(self, at: int, ends: set[int]) -> list[Box]:
        """The shapes that an edge must not meet."""
        labels = [box.grown(1) for number, box in enumerate(self.labels) if box is not None and number != at]
        return [*self.texts, *labels, *(circle for node, circle in enumerate(self.circles) if node not in ends)]

    def _has_room(self, label: Box, at: int, route: Sequence[Point]) -> bool:
        """True if a label of an edge that is drawn like this overlaps nothing."""
        wide = label.grown(_MARGIN)
        if any(wide.overlaps(box) for box in (*self.texts, *self.circles)):
            return False
        if any(wide.overlaps(box) for number, box in enumerate(self.labels) if box is not None and number != at):
            return False
        if any(segment_meets_box(a, b, label) for a, b in pairwise(route)):
            return False
        others = (line for number, line in enumerate(self.routes) if number != at)
        # Further from other edges than from its own, so that one sees whose label it is.
        wide = label.grown(3 * _MARGIN)
        return not any(segment_meets_box(a, b, wide) for line in others for a, b in pairwise(line))


def loop_nails(centre: Point, direction: tuple[float, float], length: float) -> tuple[Point, Point]:
    """The nails of a self-loop of this length that points into a direction, given as a unit vector."""
    x, y = direction
    tip_x, tip_y = centre.x + length * x, centre.y + length * y
    aside_x, aside_y = _LOOP_HALF_WIDTH * y, _LOOP_HALF_WIDTH * x
    return Point(round(tip_x - aside_x), round(tip_y + aside_y)), Point(round(tip_x + aside_x), round(tip_y - aside_y))


def beyond_loop(nails: Sequence[Point], direction: tuple[float, float], size: Size) -> Box:
    """The box of this size behind the tip of a loop that points into a direction."""
    x, y = direction
    width, height = size
    left, right = min(nail.x for nail in nails), max(nail.x for nail in nails)
    top, bottom = min(nail.y for nail in nails), max(nail.y for nail in nails)
    corner_x: float
    if abs(x) > 0.1:
        corner_x = right + _LABEL_GAP if x > 0 else left - _LABEL_GAP - width
        corner_y = (top + bottom) / 2 - height / 2 + (0 if abs(y) < 0.1 else height / 3 if y > 0 else -height / 3)
    else:
        corner_x = (left + right) / 2 - width / 2
        corner_y = bottom + _LABEL_GAP if y > 0 else top - _LABEL_GAP - height
    return Box(round(corner_x), round(corner_y), round(corner_x) + width, round(corner_y) + height)


def beside_line(route: Sequence[Point], size: Size) -> Iterator[Box]:
    """Boxes of this size that touch a line: first in its middle, right of it or above."""
    width, height = size
    length = sum(hypot(b.x - a.x, b.y - a.y) for a, b in pairwise(route))
    for part in (0.5, 0.42, 0.58, 0.34, 0.66, 0.26, 0.74):
        rest = part * length
        for a, b in pairwise(route):
            step = hypot(b.x - a.x, b.y - a.y)
            if rest <= step:
                break
            rest -= step
        along = rest / step if step else 0.0
        x, y = a.x + along * (b.x - a.x), a.y + along * (b.y - a.y)
        across_x, across_y = (b.y - a.y) / (step or 1.0), (a.x - b.x) / (step or 1.0)
        if across_x < -_STEEP or (across_x < _STEEP and across_y > 0):
            across_x, across_y = -across_x, -across_y
        reach = abs(across_x) * width / 2 + abs(across_y) * height / 2 + _LABEL_GAP
        for side in (1, -1):
            left, top = round(x + side * reach * across_x - width / 2), round(y + side * reach * across_y - height / 2)
            yield Box(left, top, left + width, top + height)
