"""Edges that are never taken, as is seen at once: a constant switches them off, or they would be taken with another one
on a channel on which no other process has a part for it."""

from __future__ import annotations

from tachk.analysis.failures import edge_can_fail
from tachk.analysis.fold import fold, known_values
from tachk.base.words import Direction
from tachk.model.expressions import BOOL, Constant, Variable
from tachk.model.network import Edge, Network
from tachk.model.remembered import by_network
from tachk.model.traversal import roots
from tachk.model.types import ChannelType


@by_network
def never_taken(network: Network) -> frozenset[tuple[int, int]]:
    """The edges that are never taken, by process and number. None of them can meet a run-time error."""
    known = known_values(network, ())
    off: set[tuple[int, int]] = set()
    waiting: list[tuple[int, int, Edge]] = []
    users: dict[tuple[Variable, Direction], set[int]] = {}
    for number, process in enumerate(network.processes):
        for place, edge in enumerate(process.edges):
            if edge.guard is not None and fold(edge.guard, known) == Constant(0, BOOL):
                off.add((number, place))
                continue
            if edge.synchronisation is None:
                continue
            channel, direction = edge.synchronisation.channel, edge.synchronisation.direction
            for variable in roots(channel):
                users.setdefault((variable, direction), set()).add(number)
            assert isinstance(channel.type, ChannelType)
            if direction is Direction.RECEIVE or not channel.type.broadcast:
                waiting.append((number, place, edge))
    for number, place, edge in waiting:
        assert edge.synchronisation is not None
        needed = edge.synchronisation.direction.opposite
        partners = set().union(*(users.get((each, needed), ()) for each in roots(edge.synchronisation.channel)))
        if partners <= {number} and not edge_can_fail(edge, known):
            off.add((number, place))
    return frozenset(off)
