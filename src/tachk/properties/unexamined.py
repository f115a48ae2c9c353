"""What was left out of a search and could have met a run-time error there."""

from __future__ import annotations

from collections.abc import Iterator

from tachk.compiler.failures import edge_can_fail, location_can_fail
from tachk.compiler.fold import Known, known_values
from tachk.model.network import Network, Process
from tachk.model.traversal import written_variables


def unexamined(network: Network, reduced: Network) -> tuple[str, ...]:
    """The processes that were held still, and the variables whose updates were left out, in a network that stands for
    another: those of them of which something can be a run-time error, by name. What plainly cannot is not named."""
    if network == reduced:
        return ()
    known = known_values(network, [])
    pairs = zip(network.processes, reduced.processes, strict=True)
    return tuple(dict.fromkeys(name for whole, part in pairs for name in _of_process(whole, part, known)))


def _of_process(whole: Process, part: Process, known: Known) -> Iterator[str]:
    if len(whole.edges) != len(part.edges):
        fails = any(location_can_fail(location, known) for location in whole.locations)
        if fails or any(edge_can_fail(edge, known) for edge in whole.edges):
            yield whole.name
        return
    for edge, kept in zip(whole.edges, part.edges, strict=True):
        for update in edge.updates:
            if update not in kept.updates and edge_can_fail(edge, known, [update]):
                yield from sorted(variable.name for variable in written_variables([update]))
