"""The cone of influence of some targets, on the level of processes: those outside are frozen.

A process *outside the cone of influence* only receives broadcasts or moves on its own, never forbids a delay (no
invariant, no urgent or committed location, no rate) and writes nothing that a process inside reads: every run of the
others is possible with it and without it. Its own run-time errors are not looked for.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from tachk.base.records import replace
from tachk.base.words import Direction
from tachk.model.expressions import Expression, LocationTest, Reference, Variable
from tachk.model.network import Location, Network, Process
from tachk.model.remembered import by_network, by_part
from tachk.model.traversal import (
    asks_deadlock,
    process_expressions,
    walk,
    with_bodies,
    written_variables,
)
from tachk.model.types import ChannelType
from tachk.transform.transformation import Exactness, Transformation, reduced


def cone_of_influence(network: Network, targets: Sequence[Expression]) -> Transformation:
    """The network with every process frozen in its initial location that cannot influence whether a target is
    reachable.

    Processes and variables keep their numbers. Nothing is frozen where a target is about ``deadlock`` or where
    processes or channels have priorities: there every possible action counts. Nor is it where a target is about
    nothing, as that is how the whole state space is requested.
    """
    return _cone_of_influence(network, tuple(targets))


@by_network
def _cone_of_influence(network: Network, targets: tuple[Expression, ...]) -> Transformation:
    outside = outside_cone(network, targets)
    processes = enumerate(network.processes)
    inside = replace(network, processes=tuple(frozen(p) if number in outside else p for number, p in processes))
    return reduced(network, inside, Exactness.SAME_STATES)


def every_action_counts(network: Network, targets: Sequence[Expression]) -> bool:
    """True if what any process can do matters: for priorities, or for a target about ``deadlock`` or about nothing."""
    return network.has_priorities or any(map(asks_deadlock, targets)) or any(map(speaks_of_nothing, targets))


def speaks_of_nothing(target: Expression) -> bool:
    """True if no location, no variable and no ``deadlock`` occurs in a target: ``E<> false``, ``A[] true``."""
    return not any(mentioned([target])) and not asks_deadlock(target)


def outside_cone(network: Network, targets: Sequence[Expression]) -> set[int]:
    """The processes that cannot influence whether a target is reachable; none where every action counts."""
    if every_action_counts(network, targets):
        return set()
    candidates = {number for number, process in enumerate(network.processes) if _only_watches(process)}
    processes, variables = mentioned(targets)
    for number, process in enumerate(network.processes):
        if number not in candidates:
            seen_processes, seen_variables = mentioned(list(process_expressions(process)))
            processes |= seen_processes
            variables |= seen_variables
    relevant = True
    while relevant:
        relevant = False
        for number in sorted(candidates):
            process = network.processes[number]
            expressions = list(process_expressions(process))
            if number in processes or not variables.isdisjoint(written_variables(expressions)):
                candidates.remove(number)
                seen_processes, seen_variables = mentioned(expressions)
                processes |= seen_processes
                variables |= seen_variables
                relevant = True
    return candidates


def frozen(process: Process) -> Process:
    """The process in its initial location, which it never leaves."""
    return replace(process, locations=(process.locations[process.initial],), edges=(), initial=0)


def _only_watches(process: Process) -> bool:
    return not any(map(_forbids_delay, process.locations)) and all(
        edge.synchronisation is None
        or (edge.synchronisation.direction is Direction.RECEIVE and is_broadcast(edge.synchronisation.channel))
        for edge in process.edges
    )


def _forbids_delay(location: Location) -> bool:
    return location.urgent or location.committed or location.invariant is not None or bool(location.rates)


def is_broadcast(channel: Expression) -> bool:
    return isinstance(channel.type, ChannelType) and channel.type.broadcast


def mentioned(expressions: Iterable[Expression]) -> tuple[set[int], set[Variable]]:
    """The processes whose locations are tested and the variables that occur, functions included."""
    processes: set[int] = set()
    variables: set[Variable] = set()
    for expression in expressions:
        its_processes, its_variables = _mentioned(expression)
        processes |= its_processes
        variables |= its_variables
    return processes, variables


@by_part
def _mentioned(expression: Expression) -> tuple[frozenset[int], frozenset[Variable]]:
    nodes = [node for outer in with_bodies([expression]) for node in walk(outer)]
    processes = frozenset(node.process for node in nodes if isinstance(node, LocationTest))
    return processes, frozenset(node.variable for node in nodes if isinstance(node, Reference))
