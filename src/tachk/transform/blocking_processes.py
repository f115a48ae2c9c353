"""Leaving out processes that only block those that count: a cone of influence by over-approximation.

A process that *only blocks* never makes anything possible for the processes that count, but may keep it from happening:
it blocks time by an invariant or an urgent location, or all others by a committed one, or uses up a monotone counter.
Every run of the network is one of the network without it, so what is unreachable there is unreachable. What is
reachable there need not be.

Influence goes through components (`tachk.analysis.components`): ``sent[0]`` is not ``sent[1]``. A variable that has its
initial value whenever a transition begins carries influence only to those that take part in the same one, after the
writer.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from tachk.analysis.components import Component, ComponentSet, mentioned_components, places, written_components
from tachk.analysis.fold import Known, known_values
from tachk.base.records import dataclass, field, replace
from tachk.base.words import Direction
from tachk.model.expressions import Expression, Variable
from tachk.model.network import Edge, Network, Process
from tachk.model.remembered import by_network
from tachk.model.traversal import process_expressions
from tachk.transform.cone_of_influence import every_action_counts, frozen, is_broadcast, outside_cone
from tachk.transform.monotone_counters import monotone_counters
from tachk.transform.transformation import Exactness, Transformation, reduced, unchanged


def without_blocking(network: Network, targets: Sequence[Expression]) -> Transformation:
    """The network with every process frozen in its initial location, where it blocks nothing, that no target needs, and
    without the updates of the others that change nothing a target needs. Run-time errors of what is left out are not
    looked for.

    Processes and variables keep their numbers. The network comes back as it is where a target is about ``deadlock`` or
    processes or channels have priorities, as there every possible action counts; where a target is about nothing, which
    requests the whole state space; and where all that only block are outside the cone of influence, where
    they cost nothing.
    """
    return _without_blocking(network, tuple(targets))


@by_network
def _without_blocking(network: Network, targets: tuple[Expression, ...]) -> Transformation:
    if every_action_counts(network, targets):
        return unchanged(network)
    cone = _cone(network, targets, (), monotone_counters(network, targets))
    if set(range(len(network.processes))) - cone.members <= outside_cone(network, targets):
        return unchanged(network)
    return reduced(network, _trimmed(network, cone), Exactness.UNREACHABLE)


def only_blocking(network: Network, targets: Sequence[Expression], required: Collection[int] = ()) -> set[int]:
    """The processes that make nothing possible for what targets need nor for those that are to be kept, and use up no
    monotone counter of theirs; none where every action counts."""
    if every_action_counts(network, targets):
        return set()
    return set(range(len(network.processes))) - _cone(network, targets, required).members


def trimmed_to(network: Network, targets: Sequence[Expression], required: Collection[int] = ()) -> Network:
    """The network with all processes that only block frozen, where they block nothing, and without the updates of the
    others that change nothing they need."""
    return _trimmed(network, _cone(network, targets, required))


def _trimmed(network: Network, cone: _Cone) -> Network:
    processes = enumerate(network.processes)
    return replace(network, processes=tuple(cone.trimmed(p) if n in cone.members else idle(p) for n, p in processes))


def idle(process: Process) -> Process:
    """The process in its initial location, which it never leaves and where it blocks nothing."""
    at_rest = frozen(process)
    (location,) = at_rest.locations
    return replace(at_rest, locations=(replace(location, invariant=None, urgent=False, committed=False),))


@dataclass(frozen=True, slots=True)
class _ProcessEffects:
    """The influence of a process on others.

    Attributes:
        stops_clocks: in some location.
        writes: components that hold their values from one transition to the next.
        sends, receives: channels.
        commits: channels on which it receives in a committed location, or where it observes.
        passes: of each edge that receives, the channel, and what it gives those that receive after it.
    """

    stops_clocks: bool
    writes: frozenset[Component]
    sends: frozenset[Component]
    receives: frozenset[Component]
    commits: frozenset[Component]
    passes: tuple[tuple[frozenset[Component], frozenset[Component]], ...]


def _effects(network: Network, process: Process, known: Known, ignored: Collection[Variable]) -> _ProcessEffects:
    written = written_components(list(process_expressions(process)), known)
    sends: set[Component] = set()
    receives: set[Component] = set()
    commits: set[Component] = set()
    passes: list[tuple[frozenset[Component], frozenset[Component]]] = []
    for edge in process.edges:
        if edge.synchronisation is None:
            continue
        channels = _channels(edge, known)
        if edge.synchronisation.direction is Direction.SEND:
            sends |= channels
            continue
        receives |= channels
        if process.locations[edge.source].committed or process.locations[edge.source].observes:
            commits |= channels
        passed = frozenset(
            component for component in written_components(edge.updates, known) if network.resets(component[0])
        )
        if passed:
            passes.append((channels, passed))
    return _ProcessEffects(
        any(location.rates for location in process.locations),
        frozenset(
            component for component in written if not network.resets(component[0]) and component[0] not in ignored
        ),
        frozenset(sends),
        frozenset(receives),
        frozenset(commits),
        tuple(passes),
    )


@dataclass(slots=True)
class _Cone:
    """The processes and variables on which the targets depend.

    Attributes:
        known: the constants of the network.
        members: the processes that count.
        processes: those whose locations are tested.
        components: what is read.
        received: channels on which a member receives.
        sent: channels on which one sends to a single partner.
        broadcast: broadcast channels on which one sends.
        admitted: those on which one sends from a location that is not committed.
    """

    known: Known
    processes: set[int] = field(default_factory=set)
    components: ComponentSet = field(default_factory=ComponentSet)
    members: set[int] = field(default_factory=set)
    received: ComponentSet = field(default_factory=ComponentSet)
    sent: ComponentSet = field(default_factory=ComponentSet)
    broadcast: ComponentSet = field(default_factory=ComponentSet)
    admitted: ComponentSet = field(default_factory=ComponentSet)

    def include(self, expressions: Sequence[Expression]) -> None:
        processes, components = mentioned_components(expressions, self.known)
        self.processes |= processes
        self.components.add(components)

    def trimmed(self, process: Process) -> Process:
        """The process without the updates that change nothing in the cone."""
        return replace(
            process,
            edges=tuple(replace(e, updates=tuple(u for u in e.updates if self.changed_by(u))) for e in process.edges),
        )

    def changed_by(self, update: Expression) -> bool:
        return self.components.meets(written_components([update], self.known))

    def needs(self, number: int, effects: _ProcessEffects) -> bool:
        """True if the process can make something possible for the members."""
        return (
            number in self.processes
            or effects.stops_clocks
            or self.components.meets(effects.writes)
            or self.received.meets(effects.sends)
            or self.sent.meets(effects.receives)
            # With a receiver in a committed location a broadcast is possible that another committed location forbids.
            or self.admitted.meets(effects.commits)
            or any(
                self.broadcast.meets(channels) and self.components.meets(written)
                for channels, written in effects.passes
            )
        )

    def add(self, number: int, process: Process) -> None:
        self.members.add(number)
        self.include(list(process_expressions(replace(process, edges=tuple(map(_without_updates, process.edges))))))
        for edge in process.edges:
            if edge.synchronisation is None:
                continue
            channels = _channels(edge, self.known)
            if edge.synchronisation.direction is Direction.RECEIVE:
                self.received.add(channels)
            elif not is_broadcast(edge.synchronisation.channel):
                self.sent.add(channels)
            else:
                self.broadcast.add(channels)
                if not process.locations[edge.source].committed:
                    self.admitted.add(channels)

    @property
    def size(self) -> tuple[int, int, int]:
        return len(self.members), len(self.components), len(self.processes)


def _cone(
    network: Network, targets: Sequence[Expression], required: Collection[int], ignored: Collection[Variable] = ()
) -> _Cone:
    """The dependencies of the targets, where ignored writes make nothing possible."""
    known = known_values(network, targets)
    effects = [_effects(network, process, known, ignored) for process in network.processes]
    cone = _Cone(known)
    cone.include(targets)
    for number in sorted(required):
        cone.add(number, network.processes[number])
    grows = True
    while grows:
        before = cone.size
        for number, process in enumerate(network.processes):
            if number not in cone.members and cone.needs(number, effects[number]):
                cone.add(number, process)
        for number in cone.members:
            updates = [update for edge in network.processes[number].edges for update in edge.updates]
            cone.include([update for update in updates if cone.changed_by(update)])
        grows = before != cone.size
    return cone


def _without_updates(edge: Edge) -> Edge:
    return replace(edge, updates=())


def _channels(edge: Edge, known: Known) -> frozenset[Component]:
    assert edge.synchronisation is not None
    return frozenset(places(edge.synchronisation.channel, known))
