"""Leaving out processes that can only hinder what counts: a cone of influence by over-approximation.

A *bystander* never makes anything possible for the processes that count, but may keep it from happening: it blocks time
by an invariant or an urgent location, or all others by a committed one. Every run of the network is one of the network
without bystanders, so what is unreachable there is unreachable. What is reachable there need not be.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import field, replace

from tachk.model.expressions import Expression, Variable
from tachk.model.network import Edge, Network, Process
from tachk.model.traversal import process_expressions, roots, written_variables
from tachk.records import dataclass
from tachk.reduction.spectators import every_action_counts, held_still, is_broadcast, mentioned, spectators
from tachk.words import Direction


def without_bystanders(network: Network, targets: Sequence[Expression]) -> Network:
    """The network with every process held in its initial location, unhindering, that no target needs, and without the
    updates of the others that change nothing a target needs. Run-time errors of what is left out are not looked for.

    Processes and variables keep their numbers. The network comes back as it is where a target speaks of ``deadlock`` or
    processes or channels have priorities, as there every possible action counts; where a target speaks of nothing, as
    that is how to ask for the whole state space; and where all bystanders are spectators, which cost nothing.
    """
    if bystanders(network, targets) <= spectators(network, targets):
        return network
    return only_with(network, targets)


def bystanders(network: Network, targets: Sequence[Expression], kept: Collection[int] = ()) -> set[int]:
    """The processes that make nothing possible for what targets need nor for those that are to be kept; none where
    every action counts."""
    if every_action_counts(network, targets):
        return set()
    return set(range(len(network.processes))) - _cone(network, targets, kept).members


def only_with(network: Network, targets: Sequence[Expression], kept: Collection[int] = ()) -> Network:
    """The network with all bystanders held in their initial locations, unhindering, and without the updates of the
    others that change nothing they need."""
    cone = _cone(network, targets, kept)
    processes = enumerate(network.processes)
    return replace(network, processes=tuple(cone.trimmed(p) if n in cone.members else _idle(p) for n, p in processes))


def _idle(process: Process) -> Process:
    still = held_still(process)
    (location,) = still.locations
    return replace(still, locations=(replace(location, invariant=None, urgent=False, committed=False),))


@dataclass(slots=True)
class _Cone:
    """What the targets depend on. Arrays of variables and of channels count as a whole.

    Attributes:
        members: the processes that count.
        processes: those whose locations are tested.
        heard: channels on which a member receives.
        offered: channels on which one sends to a single partner.
        announced: broadcast channels on which one sends.
    """

    processes: set[int]
    variables: set[Variable]
    members: set[int] = field(default_factory=set)
    heard: set[Variable] = field(default_factory=set)
    offered: set[Variable] = field(default_factory=set)
    announced: set[Variable] = field(default_factory=set)

    def include(self, expressions: Sequence[Expression]) -> None:
        processes, variables = mentioned(expressions)
        self.processes |= processes
        self.variables |= variables

    def trimmed(self, process: Process) -> Process:
        """The process without the updates that change nothing in the cone."""
        return replace(
            process,
            edges=tuple(replace(e, updates=tuple(u for u in e.updates if self.changed_by(u))) for e in process.edges),
        )

    def changed_by(self, update: Expression) -> bool:
        return not self.variables.isdisjoint(written_variables([update]))

    def needs(self, number: int, process: Process) -> bool:
        """Whether the process can make something possible for the members."""
        return (
            number in self.processes
            or any(location.rates for location in process.locations)
            or not self.variables.isdisjoint(written_variables(list(process_expressions(process))))
            or any(self._is_helped_by(process, edge) for edge in process.edges)
        )

    def _is_helped_by(self, process: Process, edge: Edge) -> bool:
        if edge.synchronisation is None:
            return False
        channels = _channels(edge)
        if edge.synchronisation.direction is Direction.SEND:
            return not channels.isdisjoint(self.heard)
        # With a receiver in a committed location a broadcast is possible that another committed location forbids.
        from_committed = process.locations[edge.source].committed
        return not channels.isdisjoint(self.offered) or (from_committed and not channels.isdisjoint(self.announced))

    def add(self, number: int, process: Process) -> None:
        self.members.add(number)
        self.include(list(process_expressions(replace(process, edges=tuple(map(_without_updates, process.edges))))))
        for edge in process.edges:
            if edge.synchronisation is None:
                continue
            if edge.synchronisation.direction is Direction.RECEIVE:
                self.heard |= _channels(edge)
            elif is_broadcast(edge.synchronisation.channel):
                self.announced |= _channels(edge)
            else:
                self.offered |= _channels(edge)


def _cone(network: Network, targets: Sequence[Expression], kept: Collection[int]) -> _Cone:
    cone = _Cone(*mentioned(targets))
    for number in sorted(kept):
        cone.add(number, network.processes[number])
    grows = True
    while grows:
        before = len(cone.members), len(cone.variables), len(cone.processes)
        for number, process in enumerate(network.processes):
            if number not in cone.members and cone.needs(number, process):
                cone.add(number, process)
        for number in cone.members:
            updates = [update for edge in network.processes[number].edges for update in edge.updates]
            cone.include([update for update in updates if cone.changed_by(update)])
        grows = before != (len(cone.members), len(cone.variables), len(cone.processes))
    return cone


def _without_updates(edge: Edge) -> Edge:
    return replace(edge, updates=())


def _channels(edge: Edge) -> set[Variable]:
    assert edge.synchronisation is not None
    return set(roots(edge.synchronisation.channel))
