"""Coverage: the edges of a model that the runs of recordings have taken."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from tachk.base.records import dataclass
from tachk.model.network import Network
from tachk.recordings.conformance.conform import Conformance


@dataclass(frozen=True, slots=True)
class Covered:
    """Attributes:
    process: its name.
    template: the name of its template.
    source, target: the names of the locations.
    doc: what the edge does, in the words of the model.
    times: how often it was taken.
    """

    process: str
    template: str
    source: str
    target: str
    doc: str
    times: int


def coverage(network: Network, found: Iterable[Conformance]) -> tuple[Covered, ...]:
    """Each edge of the processes that no recording replaces. One run is counted for each accepted recording."""
    taken: Counter[tuple[int, int]] = Counter()
    modelled: set[int] = set()
    for run in (run for each in found for run in each.runs):
        modelled.update(run.modelled)
        taken.update(run.taken)
    return tuple(
        Covered(
            network.processes[number].name,
            network.processes[number].template,
            network.processes[number].locations[edge.source].name,
            network.processes[number].locations[edge.target].name,
            edge.doc,
            taken[number, place],
        )
        for number in sorted(modelled)
        for place, edge in enumerate(network.processes[number].edges)
    )
