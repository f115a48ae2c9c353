"""Parts that were left out of a search and could have had a run-time error."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain

from tachk.analysis.components import ComponentSet, mentioned_components, written_components
from tachk.analysis.failures import edge_can_fail, location_can_fail
from tachk.analysis.fold import Known, known_values
from tachk.model.network import Network, Process
from tachk.model.traversal import process_expressions, written_variables


def unexamined(network: Network, reduced: Network) -> tuple[str, ...]:
    """The processes that were frozen, and the variables whose updates were left out, in a network that stands for
    another: those of them of which something can be a run-time error, by name. What plainly cannot is not named.

    A monotone counter (`tachk.transform.monotone_counters`) that a process that was frozen raises, too, is named with
    them: an update of another process that raises it may go beyond its range only then.
    """
    if network == reduced:
        return ()
    known = known_values(network, [])
    pairs = list(zip(network.processes, reduced.processes, strict=True))
    names = (name for whole, part in pairs for name in _of_process(whole, part, known))
    return tuple(dict.fromkeys(chain(names, _raised_by_both(network, pairs, known))))


def _raised_by_both(network: Network, pairs: list[tuple[Process, Process]], known: Known) -> Iterator[str]:
    taken = ComponentSet(
        component
        for whole, part in pairs
        if len(whole.edges) != len(part.edges)
        for component in written_components(list(process_expressions(whole)), known)
        if not network.resets(component[0])
    )
    for _, part in pairs:
        for edge in part.edges:
            for update in edge.updates:
                if taken.meets(mentioned_components([update], known)[1]) and edge_can_fail(edge, known, [update]):
                    yield from sorted(variable.name for variable in written_variables([update]))


def _of_process(whole: Process, part: Process, known: Known) -> Iterator[str]:
    if len(whole.edges) != len(part.edges):
        fails = any(location_can_fail(location, known) for location in whole.locations)
        if fails or any(edge_can_fail(edge, known) for edge in whole.edges):
            yield whole.name
        return
    for edge, remaining in zip(whole.edges, part.edges, strict=True):
        for update in edge.updates:
            if update not in remaining.updates and edge_can_fail(edge, known, [update]):
                yield from sorted(variable.name for variable in written_variables([update]))
