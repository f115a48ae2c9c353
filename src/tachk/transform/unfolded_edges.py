"""Networks whose locations remember the edge by which a process has come.

Each location is there once for each edge that leads to it, and the initial one once more. So an edge of this network is
a pair of edges that a process takes one after the other (transition pairs: Offutt, Abdurazik, "Generating tests from
UML specifications", 1999), or the first edge of the process.
"""

from __future__ import annotations

from collections.abc import Iterator

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.records import dataclass, replace
from tachk.model.expressions import LocationTest
from tachk.model.network import Location, Network, Process
from tachk.model.run import Participant, Transition
from tachk.model.traversal import process_expressions, walk
from tachk.transform.transformation import Exactness, Transformation


@dataclass(frozen=True, slots=True)
class EdgePair:
    """``before``: the edge that the process has taken last; None: the process is where it began. By their numbers."""

    before: int | None
    edge: int


@dataclass(frozen=True, slots=True)
class UnfoldedNetwork(Transformation):
    """Attributes:
    pairs: by process and number of an edge of this network, the pair of edges of the original that it stands for.
    """

    pairs: tuple[tuple[EdgePair, ...], ...]

    def lift_transition(self, transition: Transition) -> Transition:
        return Transition(tuple(map(self._original_edge, transition.participants)))

    def _original_edge(self, participant: Participant) -> Participant:
        return replace(participant, edge=self.pairs[participant.process][participant.edge].edge)


def unfolded_by_edges(network: Network) -> UnfoldedNetwork:
    """Raises UsageError for a network in which something depends on where a process is."""
    for process in network.processes:
        for part in process_expressions(process):
            if any(isinstance(node, LocationTest) for node in walk(part)):
                raise UsageError(
                    f"something in `{process.name}` depends on the location of a process",
                    "pairs of edges are covered where guards and updates look at variables only",
                )
    unfolded = [_unfolded(process) for process in network.processes]
    processes = tuple(process for process, _ in unfolded)
    pairs = tuple(pairs for _, pairs in unfolded)
    whole = replace(network, processes=processes, signals=())
    return UnfoldedNetwork(network, whole, Exactness.SAME_ANSWERS, pairs)


def _unfolded(process: Process) -> tuple[Process, tuple[EdgePair, ...]]:
    """The location behind edge n has the number n + 1, the initial one 0."""
    edges, pairs = [], []
    for source, place, before in _places(process):
        for number, edge in enumerate(process.edges):
            if edge.source == place:
                edges.append(replace(edge, source=source, target=number + 1))
                pairs.append(EdgePair(before, number))
    locations = tuple(_named(process.locations[place], before) for _, place, before in _places(process))
    return replace(process, locations=locations, edges=tuple(edges), initial=0), tuple(pairs)


def _places(process: Process) -> Iterator[tuple[int, int, int | None]]:
    yield 0, process.initial, None
    for number, edge in enumerate(process.edges):
        yield number + 1, edge.target, number


def _named(location: Location, before: int | None) -> Location:
    return location if before is None else replace(location, name=f"{location.name} by {before}")
