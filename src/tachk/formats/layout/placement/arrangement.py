"""A first drawing of a sketch in layers: without overlaps, but with more nails than it needs.

Labels of edges stand on layers of their own between the layers of the nodes, as if each were a node in the middle of
its edge (E. R. Gansner and others, A technique for drawing directed graphs, IEEE Trans. Software Eng. 19, 1993). So
there is room for every label, and edges with common ends or against the flow lie apart.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum, auto
from math import hypot

import networkx as nx

from tachk.formats.layout.label_text import Size
from tachk.formats.layout.placement.coordinates import Extent, across
from tachk.formats.layout.placement.geometry import RADIUS, Box
from tachk.formats.layout.placement.layers import Layering, Traversal, flow, ranks
from tachk.formats.layout.placement.sketch import Sketch, SketchEdge, SketchNode, TemplateDrawing
from tachk.syntax.picture_layout import Point

GRID = 8
_MARGIN = RADIUS + 4
_LABEL_TO_LINE = 2
_GAP = 14
_LEAST_STEP, _MOST_STEP = 3 * GRID, 15 * GRID
_STEEPNESS = 0.3
_MOST_STOPS = 6000


class FlowDirection(Enum):
    """The direction of the flow."""

    RIGHT = auto()
    DOWN = auto()


@dataclass(frozen=True, slots=True)
class LayerStop:
    """The place at which an edge passes a layer.

    Attributes:
        rank: the layer.
        labels_size: of the labels that stand here; None if none do.
        loop: 0 where the edge goes on; 1 where it comes from the layer before and turns back, -1 from the layer after.
    """

    rank: int
    labels_size: Size | None = None
    loop: int = 0


def arrange(sketch: Sketch, direction: FlowDirection, traversal: Traversal) -> TemplateDrawing | None:
    """Places everything; None if that would take too long, because edges are very many or very long."""
    plan = _LayerPlan(sketch, direction, traversal)
    if not plan.layers:
        return None
    layering = Layering(plan.layers, plan.links)
    effort = len(plan.extents)
    layering.reduce_crossings(24 if effort < 400 else 8 if effort < 4000 else 2)
    cross = across(layering, plan.extents, plan.weight, _GAP, 60 if effort < 1000 else 12)
    return _LayerCanvas(plan, layering, cross).drawing()


class _LayerPlan:
    """Everything that stands on a layer: the nodes of the sketch by their numbers, then the stops of the edges.

    Attributes:
        stops: for each edge its stops with their numbers, along the flow.
        against: the edges that run against the flow.
        layers: empty if there are too many stops.
    """

    def __init__(self, sketch: Sketch, direction: FlowDirection, traversal: Traversal) -> None:
        self.sketch = sketch
        self.direction = direction
        arcs = [(edge.source, edge.target) for edge in sketch.edges]
        turned = flow(len(sketch.nodes), arcs, sketch.root, traversal)
        self.rank = [2 * rank for rank in ranks(len(sketch.nodes), turned, sketch.root)]
        self.side = _loop_sides(turned)
        if any(self.side[at] < 0 and self.rank[a] == 0 for at, (a, b) in enumerate(turned) if a == b):
            self.rank = [rank + 1 for rank in self.rank]
        self.against = {at for at, (arc, turn) in enumerate(zip(arcs, turned, strict=True)) if arc != turn}
        self.extents: dict[int, Extent] = {at: _node_extent(node, direction) for at, node in enumerate(sketch.nodes)}
        self.links: list[tuple[int, int]] = []
        self.stops: list[list[tuple[int, LayerStop]]] = []
        self.stop_of: dict[int, LayerStop] = {}
        load: dict[int, float] = defaultdict(float)
        self.edge_of: dict[int, int] = {}
        for at, (edge, (start, end)) in enumerate(zip(sketch.edges, turned, strict=True)):
            chain = []
            previous = start
            for stop in self._stops(edge, start, end, self.side[at], load):
                number = len(self.extents)
                self.extents[number] = extent = _stop_extent(stop, direction)
                self.stop_of[number] = stop
                self.edge_of[number] = at
                load[stop.rank] += sum(extent)
                self.links.append((number, previous) if stop.loop < 0 else (previous, number))
                chain.append((number, stop))
                previous = number
            if start != end:
                self.links.append((previous, end))
            self.stops.append(chain)
        self.layers = self._first_order() if len(self.extents) < _MOST_STOPS else []

    def _stops(self, edge: SketchEdge, start: int, end: int, side: int, load: dict[int, float]) -> list[LayerStop]:
        size = edge.labels_size if edge.labels_size != (0, 0) else None
        first, last = self.rank[start] + 1, self.rank[end] - 1
        if start == end:
            return [LayerStop(self.rank[start] + side, size, loop=side)]
        middle = min(range(first, last + 1, 2), key=lambda rank: (load[rank], abs(2 * rank - first - last)))
        return [LayerStop(rank, size if rank == middle else None) for rank in range(first, last + 1)]

    def _first_order(self) -> list[list[int]]:
        graph = nx.Graph()
        graph.add_node(self.sketch.root)
        graph.add_nodes_from(self.extents)
        graph.add_edges_from(self.links)
        rank = {**dict(enumerate(self.rank)), **{number: stop.rank for number, stop in self.stop_of.items()}}
        layers: list[list[int]] = [[] for _ in range(max(rank.values(), default=0) + 1)]
        for number in nx.dfs_preorder_nodes(graph):
            layers[rank[number]].append(number)
        reached = {number for layer in layers for number in layer}
        for number in self.extents:
            if number not in reached:
                layers[rank[number]].append(number)
        return layers

    def weight(self, a: int, b: int) -> float:
        """The weight of the wish that two linked numbers stand level: most for lines inside long edges, then for edges
        along the flow."""
        if a in self.stop_of and b in self.stop_of:
            return 8
        edge = self.edge_of[max(a, b)]
        return 1 if edge in self.against else 2 if self.stop_of[max(a, b)].loop else 3


def _loop_sides(arcs: Sequence[tuple[int, int]]) -> list[int]:
    """For each arc from a node to itself the side of the node that has less: 1 along the flow, -1 against it."""
    balance: dict[int, int] = defaultdict(int)
    for a, b in arcs:
        balance[a] += 1
        balance[b] -= 1
    sides = []
    for a, b in arcs:
        sides.append(-1 if balance[a] > 0 else 1)
        if a == b:
            balance[a] += 2 * sides[-1]
    return sides


def _node_extent(node: SketchNode, direction: FlowDirection) -> Extent:
    (name_width, name_height), (labels_width, labels_height) = node.name_size, node.labels_size
    if direction is FlowDirection.RIGHT:
        return _MARGIN + name_height + 4, _MARGIN + labels_height + (4 if labels_height else 0)
    return _MARGIN, _MARGIN + max(name_width, labels_width)


def _stop_extent(stop: LayerStop, direction: FlowDirection) -> Extent:
    if stop.labels_size is None:
        return (10, 10) if stop.loop else (2, 2)
    width, height = stop.labels_size
    if stop.loop:
        return (
            (max(10, height / 2), max(10, height / 2)) if direction is FlowDirection.RIGHT else (10, max(10, width - 8))
        )
    if direction is FlowDirection.RIGHT:
        return height + _LABEL_TO_LINE, 2
    return 2, width + 2 * _LABEL_TO_LINE


class _LayerCanvas:
    """The layers set out along the flow; along the flow a place is (along, across)."""

    def __init__(self, plan: _LayerPlan, layering: Layering, cross: dict[int, float]) -> None:
        self.plan = plan
        self.cross = _snapped(layering, plan, cross)
        self.start: list[int] = []
        self.end: list[int] = []
        self.middle: list[int] = []
        steps = self._steps()
        at = 0
        for rank, layer in enumerate(layering.layers):
            before, after = self._thickness(layer)
            at += steps[rank]
            self.start.append(at)
            self.middle.append(at + _up(before))
            at += _up(before) + _up(after)
            self.end.append(at)

    def _steps(self) -> list[int]:
        """The distance of each layer from the one before: more where lines would be steep."""
        farthest = [0.0] * (len(self.plan.layers) + 1)
        rank = [*self.plan.rank, *(self.plan.stop_of[number].rank for number in sorted(self.plan.stop_of))]
        for a, b in self.plan.links:
            farthest[rank[b]] = max(farthest[rank[b]], abs(self.cross[a] - self.cross[b]))
        return [_up(min(_MOST_STEP, max(_LEAST_STEP, _STEEPNESS * distance))) for distance in farthest]

    def _thickness(self, layer: Sequence[int]) -> Extent:
        """The room that a layer needs before and after its middle, along the flow."""
        before = after = 0.0
        for number in layer:
            stop = self.plan.stop_of.get(number)
            if stop is not None and stop.labels_size is not None:
                half = self._along(stop.labels_size) / 2 + (4 if stop.loop else 0)
                before, after = max(before, half), max(after, half)
            elif stop is None:
                node = self.plan.sketch.nodes[number]
                if self.plan.direction is FlowDirection.RIGHT:
                    half = max(RADIUS, node.name_size[0] / 2, node.labels_size[0] / 2)
                    before, after = max(before, half), max(after, half)
                else:
                    before = max(before, RADIUS, node.name_size[1])
                    after = max(after, RADIUS, node.labels_size[1])
        return before, after

    def _along(self, size: Size) -> int:
        return size[0] if self.plan.direction is FlowDirection.RIGHT else size[1]

    def _point(self, along: float, across: float) -> Point:
        if self.plan.direction is FlowDirection.RIGHT:
            return Point(round(along), round(across))
        return Point(round(across), round(along))

    def drawing(self) -> TemplateDrawing:
        nodes = self.plan.sketch.nodes
        centres = tuple(self._point(self.middle[self.plan.rank[at]], self.cross[at]) for at in range(len(nodes)))
        routes, labels = [], []
        for at, edge in enumerate(self.plan.sketch.edges):
            stops = self.plan.stops[at]
            if edge.source == edge.target:
                points = self._loop(edge.source, *stops[0])
            else:
                points = [point for number, stop in stops for point in self._passage(number, stop)]
            if at in self.plan.against:
                points.reverse()
            routes.append((centres[edge.source], *points, centres[edge.target]))
            boxes = [self._label(number, stop.labels_size, stop) for number, stop in stops if stop.labels_size]
            labels.append(boxes[0] if boxes else None)
        names, node_labels = zip(*map(self._texts, nodes, centres), strict=True)
        return TemplateDrawing(centres, names, node_labels, tuple(routes), tuple(labels))

    def _passage(self, number: int, stop: LayerStop) -> list[Point]:
        across = self.cross[number]
        ends = self._point(self.start[stop.rank], across), self._point(self.end[stop.rank], across)
        return list(dict.fromkeys(ends))

    def _loop(self, node: int, number: int, stop: LayerStop) -> list[Point]:
        """The two nails of a self-loop, beside its tip across the direction in which it points."""
        tip = self.start[stop.rank] - GRID if stop.loop > 0 else self.end[stop.rank] + GRID
        along, across = tip - self.middle[self.plan.rank[node]], self.cross[number] - self.cross[node]
        length = hypot(along, across)
        aside = -GRID * across / length, GRID * along / length
        return [self._point(tip + side * aside[0], self.cross[number] + side * aside[1]) for side in (-1, 1)]

    def _label(self, number: int, size: Size, stop: LayerStop) -> Box:
        across = self.cross[number]
        width, height = size
        middle = self.middle[stop.rank]
        along = self._along(size)
        if stop.loop:
            start = self.start[stop.rank] + 4 if stop.loop > 0 else self.end[stop.rank] - 4 - along
        else:
            start = round(middle - along / 2)
        if self.plan.direction is FlowDirection.RIGHT:
            corner = self._point(start, across - (height / 2 if stop.loop else height + _LABEL_TO_LINE))
        else:
            corner = self._point(start, across - 8 if stop.loop else across + 2 * _LABEL_TO_LINE)
        return Box(corner.x, corner.y, corner.x + width, corner.y + height)

    def _texts(self, node: SketchNode, centre: Point) -> tuple[Box, Box | None]:
        (width, height), (labels_width, labels_height) = node.name_size, node.labels_size
        x, y = centre
        if self.plan.direction is FlowDirection.RIGHT:
            name = Box(x - width // 2, y - RADIUS - 5 - height, x + (width + 1) // 2, y - RADIUS - 5)
            left, top = x - labels_width // 2, y + RADIUS + 5
        else:
            name = Box(x + _MARGIN, y - height, x + _MARGIN + width, y)
            left, top = x + _MARGIN, y
        return name, Box(left, top, left + labels_width, top + labels_height) if labels_height else None


def _snapped(layering: Layering, plan: _LayerPlan, cross: dict[int, float]) -> dict[int, int]:
    """The coordinates on the grid, still without overlap."""
    snapped: dict[int, int] = {}
    for layer in layering.layers:
        for at, number in enumerate(layer):
            least = -float("inf")
            if at > 0:
                before = layer[at - 1]
                least = snapped[before] + plan.extents[before][1] + plan.extents[number][0] + _GAP - GRID
            place = round(cross[number] / GRID) * GRID
            snapped[number] = place if place >= least else _up(least)
    return snapped


def _up(length: float) -> int:
    """The least multiple of the grid that is not less."""
    return int(-(-length // GRID) * GRID)
