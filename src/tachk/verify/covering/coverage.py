"""Coverage criteria: what the runs of a test suite are to take or to visit."""

from __future__ import annotations

from collections.abc import Iterable
from enum import StrEnum

from tachk.engine.edge_paths import Place
from tachk.model.network import Network
from tachk.model.run import Transition


class Coverage(StrEnum):
    """The criteria, for each process of a network (Myers, "The Art of Software Testing", 1979, has them of programs:
    branches and statements)."""

    EDGES = "edges"
    """Each edge is taken."""
    LOCATIONS = "locations"
    """Each location is visited."""
    PAIRS = "pairs"
    """Each edge is taken first, and right after each edge before it. These are the edges of the network that
    `tachk.transform.unfolded_edges` makes: it stands for the network in all functions here."""

    def all(self, network: Network) -> frozenset[Place]:
        """All that is to be covered."""
        parts = (
            (number, len(process.locations if self is Coverage.LOCATIONS else process.edges))
            for number, process in enumerate(network.processes)
        )
        return frozenset((number, place) for number, count in parts for place in range(count))

    def at_start(self, network: Network) -> frozenset[Place]:
        """What every run covers."""
        if self is not Coverage.LOCATIONS:
            return frozenset()
        return frozenset((number, process.initial) for number, process in enumerate(network.processes))

    def by_edge(self, network: Network, edge: Place) -> Place:
        """What is covered where an edge is taken."""
        number, place = edge
        return (number, network.processes[number].edges[place].target) if self is Coverage.LOCATIONS else edge

    def by_path(self, network: Network, path: Iterable[Transition]) -> frozenset[Place]:
        """What is covered by a run with these transitions."""
        taken = ((each.process, each.edge) for transition in path for each in transition.participants)
        return self.at_start(network) | {self.by_edge(network, edge) for edge in taken}
