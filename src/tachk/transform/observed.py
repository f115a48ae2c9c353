"""Networks with an observer beside them, and the steps of the observer on a run."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from tachk.base.diagnostics.diagnostic import Diagnostic, UnsupportedError
from tachk.base.operators import BinaryOperator
from tachk.base.records import dataclass, field, replace
from tachk.base.words import Direction
from tachk.model.connectives import both, negation
from tachk.model.expressions import BOOL, INT, Assign, Binary, Constant, Expression, Index, Reference
from tachk.model.network import Edge, Network, Process
from tachk.model.query import JoinedChannel, Observer, Query
from tachk.model.run import Participant, TimedTrace, Transition
from tachk.model.traversal import roots
from tachk.model.types import ArrayType
from tachk.transform.extension import Extension, with_process
from tachk.transform.transformation import Exactness


@dataclass(frozen=True, slots=True)
class ObserverMove:
    """``time``: since the start of the run; ``location``: where the observer is from then on."""

    time: Fraction
    location: str


@dataclass(frozen=True, slots=True)
class ObservedNetwork(Extension):
    """A network with an observer as its last process, or as it is.

    Attributes:
        copies: for edges of which there are two, one that the observer hears and one that it does not: by process and
            number of the second the number of the first.
    """

    copies: Mapping[tuple[int, int], int] = field(default_factory=dict)

    def lift_transition(self, transition: Transition) -> Transition | None:
        count = len(self.original.processes)
        own = tuple(self._original(each) for each in transition.participants if each.process < count)
        return Transition(own) if own else None

    def _original(self, participant: Participant) -> Participant:
        first = self.copies.get((participant.process, participant.edge))
        return participant if first is None else replace(participant, edge=first)

    def moves(self, run: TimedTrace) -> tuple[ObserverMove, ...]:
        """The steps of the observer on a run of the network, without locations that it leaves at once."""
        if self.network is self.original:
            return ()
        observer = len(self.original.processes)
        locations = self.network.processes[observer].locations
        moves = (
            ObserverMove(step.state.time, locations[step.state.discrete.locations[observer]].name)
            for step in run.steps
            if step.transition is not None
            and self.lift_transition(step.transition) is None
            and not locations[step.state.discrete.locations[observer]].committed
        )
        return tuple(moves)


def observed(network: Network, observer: Observer | None) -> ObservedNetwork:
    """The network with the observer, if there is one."""
    if observer is None:
        return ObservedNetwork(network, network, Exactness.SAME_ANSWERS)
    copies: dict[tuple[int, int], int] = {}
    processes = list(network.processes)
    for channel in observer.joined:
        for number, process in enumerate(processes):
            processes[number] = _noting(process, number, channel, copies)
    watched = with_process(replace(network, processes=tuple(processes)), observer.process)
    return ObservedNetwork(network, watched, Exactness.SAME_ANSWERS, copies)


def _noting(process: Process, number: int, channel: JoinedChannel, copies: dict[tuple[int, int], int]) -> Process:
    """The process whose edges over a channel note what happens: the sender which channel, before its updates may change
    the index, and the receiver the rest, behind all updates."""
    edges: list[Edge] = list(process.edges)
    for position, edge in enumerate(process.edges):
        if edge.synchronisation is None or channel.channel not in roots(edge.synchronisation.channel):
            continue
        place = _place_of(edge.synchronisation.channel)
        numbers = channel.numbers.initial
        possible = numbers if not isinstance(place, Constant) else numbers[place.value : place.value + 1]
        if max(possible) < 0:
            continue
        element = Reference(channel.element)
        found = Index(Reference(channel.numbers), place, channel.element.type)
        if edge.synchronisation.direction is Direction.SEND:
            edges[position] = replace(edge, updates=(Assign(element, found, element.type), *edge.updates))
        elif min(possible) >= 0:
            edges[position] = replace(edge, updates=(*edge.updates, *channel.updates))
        else:
            is_observed = Binary(BinaryOperator.GREATER_EQUAL, found, Constant(0), BOOL)
            guard, updates = both(edge.guard, is_observed), (*edge.updates, *channel.updates)
            edges[position] = replace(edge, guard=guard, updates=updates)
            copies[number, len(edges)] = copies.get((number, position), position)
            guard, updates = both(edge.guard, negation(is_observed)), (*edge.updates, channel.forgets)
            edges.append(replace(edge, guard=guard, updates=updates))
    return replace(process, edges=tuple(edges))


def _place_of(channel: Expression) -> Expression:
    """The place of a channel among those of its array, as a number."""
    if not isinstance(channel, Index):
        return Constant(0)
    assert isinstance(channel.base.type, ArrayType)
    above, low = _place_of(channel.base), channel.base.type.low
    if isinstance(above, Constant) and isinstance(channel.index, Constant):
        return Constant(above.value * channel.base.type.size + channel.index.value - low)
    whole = Binary(BinaryOperator.MULTIPLY, above, Constant(channel.base.type.size), INT)
    own = Binary(BinaryOperator.SUBTRACT, channel.index, Constant(low), INT)
    return Binary(BinaryOperator.ADD, whole, own, INT)


def check_observable(network: Network, query: Query) -> None:
    """Raises UnsupportedError if an observer would keep the network from acting, which priorities make it do."""
    if query.observer is not None and network.has_priorities:
        raise UnsupportedError(
            Diagnostic(
                "E0732",
                "temporal properties and scenarios are not checked in models with priorities of channels or processes",
                query.span,
                "let a location of the model mark what is asked for, and ask with A[] or E<> whether it is reached",
            )
        )
