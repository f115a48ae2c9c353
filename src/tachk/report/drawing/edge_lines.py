"""The lines of edges: round where they lead back to their location, and ending where no other arrow ends."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import atan2, cos, hypot, pi, sin
from typing import TypeVar

from tachk.syntax.picture_layout import Point

ARROW_LENGTH, ARROW_WIDTH = 11, 4.5
_HEAD_ANGLE = 0.62
"""The angle between two arrow heads at a circle of a location: they do not overlap then."""

_FAR, _WIDE = 1.25, 1.6
"""How far out the control points of a loop are: of the distance of its nails, and of the width between them."""

_ROUNDS = 12
"""Of moving ends apart; what is still too close then stays so."""

Key = TypeVar("Key")
Place = tuple[float, float]


@dataclass(frozen=True, slots=True)
class RouteEnds:
    """The points of an edge from centre to centre, with the radii of its two nodes."""

    points: tuple[Point, ...]
    radii: tuple[float, float]

    @property
    def is_loop(self) -> bool:
        return self.points[0] == self.points[-1] and len(self.points) == 4


def ends_on_rims(routes: Mapping[Key, RouteEnds]) -> dict[Key, tuple[Place, Place]]:
    """Where edges leave the rims of their nodes, moved a little where two arrow heads would lie in each other."""
    around: dict[Point, list[tuple[Key, int]]] = defaultdict(list)
    angles: dict[tuple[Key, int], float] = {}
    for key, route in routes.items():
        for end in (0, 1):
            here, there = (route.points[:2], route.points[:-3:-1])[end]
            angles[key, end] = atan2(there.y - here.y, there.x - here.x)
            around[here].append((key, end))
    for ends in around.values():
        heads = [end for end in ends if end[1] == 1 and not routes[end[0]].is_loop]
        _spread(heads, angles)
    return {key: (_at(route, 0, angles[key, 0]), _at(route, 1, angles[key, 1])) for key, route in routes.items()}


def _spread(ends: Sequence[tuple[Key, int]], angles: dict[tuple[Key, int], float]) -> None:
    """Moves ends at one node apart from each other, each as little as needed."""
    if not 1 < len(ends) <= 2 * pi / _HEAD_ANGLE:
        return
    for _ in range(_ROUNDS):
        order = sorted(ends, key=lambda end: angles[end] % (2 * pi))
        for one, other in zip(order, (*order[1:], order[0]), strict=True):
            between = (angles[other] - angles[one]) % (2 * pi)
            if between < _HEAD_ANGLE - 1e-6:
                angles[one] -= (_HEAD_ANGLE - between) / 2
                angles[other] += (_HEAD_ANGLE - between) / 2


def _at(route: RouteEnds, end: int, angle: float) -> Place:
    centre, radius = route.points[-1 if end else 0], route.radii[end]
    return round(centre.x + radius * cos(angle), 1), round(centre.y + radius * sin(angle), 1)


def path_of(route: RouteEnds, ends: tuple[Place, Place]) -> tuple[str, Place]:
    """The ``d`` of the line up to the neck of its arrow head, and the point from which the line comes to its end."""
    start, end = ends
    if not route.is_loop:
        *others, last = [start, *((float(nail.x), float(nail.y)) for nail in route.points[1:-1]), end]
        return _lines([*others, neck(others[-1], last)]), others[-1]
    first, second = _controls(route)
    corners = " ".join(f"{x:g},{y:g}" for x, y in (first, second, neck(second, end)))
    return f"M{start[0]:g},{start[1]:g} C{corners}", second


def _lines(points: Sequence[Place]) -> str:
    return "M" + " L".join(f"{x:g},{y:g}" for x, y in points)


def _controls(route: RouteEnds) -> Iterator[Place]:
    """The control points of a loop that reaches as far as its nails, and is about as wide as they are apart."""
    centre, one, other, _ = route.points
    for nail, across in ((one, other), (other, one)):
        middle_x, middle_y = (nail.x + across.x) / 2, (nail.y + across.y) / 2
        yield (
            round(centre.x + (middle_x - centre.x) * _FAR + (nail.x - across.x) * _WIDE, 1),
            round(centre.y + (middle_y - centre.y) * _FAR + (nail.y - across.y) * _WIDE, 1),
        )


def neck(before: Place, end: Place) -> Place:
    """The end of a line, drawn back so that it does not show beside the point of the arrow head."""
    dx, dy = _direction(before, end)
    return round(end[0] - dx * ARROW_LENGTH / 2, 1), round(end[1] - dy * ARROW_LENGTH / 2, 1)


def head(before: Place, end: Place) -> Iterator[Place]:
    """The corners of the arrow head at the end of a line that comes from a point."""
    (x, y), (dx, dy) = end, _direction(before, end)
    yield x, y
    for side in (1, -1):
        yield (
            round(x - dx * ARROW_LENGTH - side * dy * ARROW_WIDTH, 1),
            round(y - dy * ARROW_LENGTH + side * dx * ARROW_WIDTH, 1),
        )


def _direction(before: Place, end: Place) -> Place:
    length = hypot(end[0] - before[0], end[1] - before[1]) or 1.0
    return (end[0] - before[0]) / length, (end[1] - before[1]) / length
