"""The product of a model with the trace automata of a recording.

The processes of the environment that the recording replaces are left out. Each event stream becomes a process with one
location and a counter of the events that have happened. It receives the outputs of the model: its invariant forbids a
step with any event but the next recorded one. It sends the inputs of the model. A clock that nothing resets is the time
of the recording; the invariant keeps each event in its window, since time cannot pass the latest time of the next event
and is never before the earliest time of the last one.

The runs of this network that reach the end are the runs of the model that the recording shows.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.operators import CONSTANT_HIGH, CONSTANT_LOW
from tachk.base.records import dataclass, replace
from tachk.base.words import Direction
from tachk.model.builder import NetworkBuilder, ProcessBuilder, Term
from tachk.model.expressions import Constant, Expression, Index, Reference, Variable, VariableKind
from tachk.model.network import Edge, Network, Process, Synchronisation
from tachk.model.recording import RecordingMap
from tachk.model.run import Transition
from tachk.model.traversal import process_expressions
from tachk.model.types import ArrayType, ChannelType, IntType, element_type
from tachk.recordings.conformance.event_streams import EventStreams, channel_variable, index_range
from tachk.recordings.conformance.trace_automata import TraceAutomaton, with_any_output, without_deadlines
from tachk.transform.cone_of_influence import mentioned
from tachk.transform.transformation import Exactness, Transformation

_ANYTHING = IntType(CONSTANT_LOW, CONSTANT_HIGH)


@dataclass(frozen=True, slots=True)
class TraceProduct(Transformation):
    """The product of a part of a model with a recording. Its processes are one for hidden events, if there are any, the
    trace automata of what comes from outside, the processes of the model that are left, in their order, and the trace
    automata of what comes from the model: these receive last, so they see what variables hold at the end of a step. The
    search tries the steps of the last processes first.

    Attributes:
        modelled: the numbers in the model of the processes that are left.
        first_modelled: the number of the first of them.
        automata: for each stream the number of its trace automaton.
        now: the clock that nothing resets.
        positions: for each stream, how many of its events have happened.
        tables: the constant arrays that hold the recording.
        done: the condition that all events have happened and the recorded silence is over.
    """

    modelled: tuple[int, ...]
    first_modelled: int
    automata: tuple[int, ...]
    now: Variable
    positions: tuple[Variable, ...]
    tables: frozenset[Variable]
    done: Expression
    progress: Expression

    def lift_transition(self, transition: Transition) -> Transition | None:
        """The part of the transition that processes of the model take; None if none takes part."""
        own = tuple(
            replace(participant, process=self.modelled[participant.process - self.first_modelled])
            for participant in transition.participants
            if participant.process in self.places_of_modelled
        )
        return Transition(own) if own else None

    @property
    def places_of_modelled(self) -> range:
        """The numbers of the processes of the model."""
        return range(self.first_modelled, self.first_modelled + len(self.modelled))

    def _acts(self, process: int) -> bool:
        return process in self.modelled

    def stream_of(self, transition: Transition) -> int | None:
        """The stream whose event the transition is; None if it is an internal transition of the model."""
        for participant in transition.participants:
            if participant.process in self.automata:
                return self.automata.index(participant.process)
        return None

    def lenient(self, streams: EventStreams) -> tuple[Network, tuple[tuple[tuple[str, Variable], ...], ...]]:
        """The network in which the model may produce any event, and for each stream the variables that then hold the
        values of the event."""
        processes = list(self.network.processes)
        variables: list[Variable] = []
        said: list[tuple[tuple[str, Variable], ...]] = []
        for number, stream in enumerate(streams.streams):
            own = tuple(
                (name, Variable(f"said[{number}].{name}", _ANYTHING, VariableKind.GLOBAL, (0,)))
                for name, _ in stream.visible.columns
            )
            said.append(own)
            place = self.automata[number]
            if stream.outputs:
                processes[place] = with_any_output(processes[place], stream, dict(own))
                variables += [variable for _, variable in own]
            else:
                processes[place] = without_deadlines(processes[place], stream, self.positions[number])
        return replace(
            self.network, processes=tuple(processes), variables=(*self.network.variables, *variables)
        ), tuple(said)


def trace_product(
    network: Network, mapping: RecordingMap, streams: EventStreams, modelled: tuple[int, ...], to_the_end: bool = False
) -> TraceProduct:
    """The product of a network with a recording.

    Args:
        modelled: the numbers of the processes that are left.
        to_the_end: the product is done only when no event of the recording can happen any more.

    Raises UsageError for what the model does not allow to be followed.
    """
    if network.has_priorities:
        raise UsageError("a model with priorities cannot be held against a recording", "leave out the priorities")
    processes = tuple(network.processes[n] for n in modelled)
    builder = NetworkBuilder("recording.", VariableKind.GLOBAL)
    now = builder.clock("now")
    positions = [builder.integer(f"happened[{n}]", 0, len(q.events)) for n, q in enumerate(streams.streams)]
    product = [TraceAutomaton(builder, streams, n, now, positions) for n in range(len(streams.streams))]
    hidden = _outsider(builder, mapping, processes)
    released = _released(mapping, streams, processes)
    done = now >= (streams.time_bound - 1 if to_the_end else streams.quiet_until)
    progress: Term | int = 0
    for position, stream, each in zip(positions, streams.streams, product, strict=True):
        done = done & (position == len(stream.events) if each.ended is None else each.ended)
        progress = position + progress
    order, places = _receiving_last(streams, len(hidden), len(processes))
    made = [*hidden, *(each.build() for each in product)]
    unordered = [*hidden, *processes, *made[len(hidden) :]]
    whole = replace(
        network,
        processes=tuple(with_channels(p, released) for p in (unordered[n] for n in order)),
        variables=(*(released.get(v, v) for v in _mentioned(network, processes, streams)), *builder.variables),
        signals=(),
        hidden=(*network.hidden, *(p.name for p in made)),
    )
    variables = tuple(p.expression.variable for p in positions if isinstance(p.expression, Reference))
    total = progress.expression if isinstance(progress, Term) else Constant(0)
    assert isinstance(now.expression, Reference)
    tables = frozenset(v for v in builder.variables if isinstance(v.type, ArrayType))
    return TraceProduct(
        network,
        whole,
        Exactness.NOTHING,
        modelled,
        order.index(len(hidden)) if processes else 0,
        places,
        now.expression.variable,
        variables,
        tables,
        done.expression,
        total,
    )


def _receiving_last(streams: EventStreams, hidden: int, modelled: int) -> tuple[list[int], tuple[int, ...]]:
    """The order of hidden processes, those that are kept and one for each stream, as numbers in that list: the
    receivers of events of the model come last. And the place of the process of each stream in that order."""
    first = hidden + modelled
    outputs = [first + number for number, stream in enumerate(streams.streams) if stream.outputs]
    inputs = [first + number for number, stream in enumerate(streams.streams) if not stream.outputs]
    order = [*range(hidden), *inputs, *range(hidden, first), *outputs]
    return order, tuple(order.index(first + number) for number in range(len(streams.streams)))


def _mentioned(network: Network, processes: Sequence[Process], streams: EventStreams) -> Iterator[Variable]:
    """The variables of the network that these processes and streams mention."""
    columns = [column for stream in streams.streams for _, column in stream.visible.columns]
    channels = [stream.visible.channel for stream in streams.streams]
    _, found = mentioned([*(e for p in processes for e in process_expressions(p)), *columns, *channels])
    return (variable for variable in network.variables if variable in found)


def _synchronisations(channel: Variable, processes: Sequence[Process]) -> Iterator[Synchronisation]:
    for process in processes:
        for edge in process.edges:
            if edge.synchronisation is not None and channel_variable(edge.synchronisation.channel) is channel:
                yield edge.synchronisation


# ---- the environment ------------------------------------------------------------------------------------------------


def _outsider(builder: NetworkBuilder, mapping: RecordingMap, processes: Sequence[Process]) -> list[Process]:
    """A process that synchronises whenever it likes on the hidden channels; none if there are none."""
    if not mapping.hidden:
        return []
    process = ProcessBuilder("outside.", VariableKind.LOCAL, name="outside")
    here = process.location("outside")
    for channel in mapping.hidden:
        variable = channel_variable(channel)
        directions = {s.direction for s in _synchronisations(variable, processes)}
        for each in _elements(channel):
            if Direction.RECEIVE in directions:
                process.edge(here, here, send=Term(each))
            elif Direction.SEND in directions and not _has_no_receiver(channel):
                process.edge(here, here, receive=Term(each))
    return [process.build()]


def _has_no_receiver(channel: Expression) -> bool:
    """True if it can be sent on without a receiver."""
    type_ = element_type(channel.type)
    return isinstance(type_, ChannelType) and type_.broadcast


def _elements(channel: Expression) -> Iterator[Expression]:
    if not isinstance(channel.type, ArrayType):
        yield channel
        return
    for number in index_range(channel.type.index):
        yield from _elements(Index(channel, Constant(number), channel.type.element))


def _released(mapping: RecordingMap, streams: EventStreams, processes: Sequence[Process]) -> dict[Variable, Variable]:
    """Urgent channels on which the outside takes part, and what they are without urgency: it need not be ready."""
    found: dict[Variable, Variable] = {}
    joined = [stream.visible.channel for stream in streams.streams] + list(mapping.hidden)
    for channel in joined:
        variable = channel_variable(channel)
        type_ = element_type(variable.type)
        sends = any(s.direction is Direction.SEND for s in _synchronisations(variable, processes))
        if isinstance(type_, ChannelType) and type_.urgent and not (type_.broadcast and sends):
            found[variable] = replace(variable, type=_calm(variable.type))
    return found


def _calm(type_: object) -> ArrayType | ChannelType:
    if isinstance(type_, ArrayType):
        return replace(type_, element=_calm(type_.element))
    assert isinstance(type_, ChannelType)
    return replace(type_, urgent=False)


def with_channels(process: Process, others: Mapping[Variable, Variable]) -> Process:
    """The process with other variables for some channels, which may be of another kind."""
    if not others:
        return process
    return replace(process, edges=tuple(_edge_with_channels(edge, others) for edge in process.edges))


def _edge_with_channels(edge: Edge, others: Mapping[Variable, Variable]) -> Edge:
    sync = edge.synchronisation
    if sync is None or channel_variable(sync.channel) not in others:
        return edge
    return replace(edge, synchronisation=replace(sync, channel=_renamed(sync.channel, others)))


def _renamed(channel: Expression, others: Mapping[Variable, Variable]) -> Expression:
    match channel:
        case Index(base):
            base = _renamed(base, others)
            assert isinstance(base.type, ArrayType)
            return replace(channel, base=base, type=base.type.element)
        case Reference(variable):
            return replace(channel, variable=others[variable])
        case _:
            return channel
