"""A run of a network with every number replaced by the name it stands for.

Text, JSON and every later form of a trace are made from this one view.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction

from tachk.diagnostics.span import Span
from tachk.model.evaluate import Environment, channel_number, execute
from tachk.model.expressions import Constant, Index
from tachk.model.layout import CellLayout, cell_layout
from tachk.model.network import Direction, Edge, Network
from tachk.model.types import BoolType, ChannelType, ClockType
from tachk.records import dataclass
from tachk.semantics.trace import DiscreteState, Participant, TimedState, TimedTrace, Transition


@dataclass(frozen=True, slots=True)
class Snapshot:
    """A state by names.

    Attributes:
        locations: process and location, in the order of the processes.
        variables: every cell of every stored variable with its value; meta variables are left out.
        clocks: every clock with its value; None where the run is known without its times.
        time: time since the start; None likewise.
    """

    locations: tuple[tuple[str, str], ...]
    variables: tuple[tuple[str, int | bool], ...]
    clocks: tuple[tuple[str, Fraction], ...] | None = None
    time: Fraction | None = None


@dataclass(frozen=True, slots=True)
class Move:
    """What one process does in a transition.

    Attributes:
        direction: None for an internal edge.
        selects: the chosen values of the edge's select variables.
        doc: the documentation of the edge.
        arrival: the documentation of the location it leads to.
    """

    process: str
    source: str
    target: str
    direction: Direction | None
    selects: tuple[tuple[str, int], ...]
    doc: str
    arrival: str
    spans: tuple[Span, ...]


@dataclass(frozen=True, slots=True)
class Event:
    """A transition: the channel (empty for an internal edge) and its moves, the sender's first."""

    channel: str
    moves: tuple[Move, ...]


@dataclass(frozen=True, slots=True)
class ViewStep:
    """First ``delay`` passes, then ``event`` happens (None: the run ends after the delay); ``state`` is after it."""

    delay: Fraction | None
    event: Event | None
    state: Snapshot


@dataclass(frozen=True, slots=True)
class TraceView:
    initial: Snapshot
    steps: tuple[ViewStep, ...]


def view_trace(network: Network, trace: TimedTrace) -> TraceView:
    """The view of a timed trace of the network."""
    layout = cell_layout(network)
    steps = []
    before = trace.initial.discrete
    for step in trace.steps:
        event = None if step.transition is None else _event(network, layout, before, step.transition)
        steps.append(ViewStep(step.delay, event, _timed_snapshot(network, layout, step.state)))
        before = step.state.discrete
    return TraceView(_timed_snapshot(network, layout, trace.initial), tuple(steps))


def view_path(network: Network, path: Sequence[Transition]) -> TraceView:
    """The view of a path that is known without times: locations and variables follow from the updates."""
    layout = cell_layout(network)
    state = DiscreteState(tuple(p.initial for p in network.processes), layout.initial)
    initial = _snapshot(network, layout, state)
    steps = []
    for transition in path:
        event = _event(network, layout, state, transition)
        state = _fire(network, layout, state, transition)
        steps.append(ViewStep(None, event, _snapshot(network, layout, state)))
    return TraceView(initial, tuple(steps))


def view_event(network: Network, path: Sequence[Transition], transition: Transition) -> Event:
    """The view of a transition that is tried after a path."""
    layout = cell_layout(network)
    state = DiscreteState(tuple(p.initial for p in network.processes), layout.initial)
    for fired in path:
        state = _fire(network, layout, state, fired)
    return _event(network, layout, state, transition)


def _edge(network: Network, participant: Participant) -> Edge:
    return network.processes[participant.process].edges[participant.edge]


def _fire(network: Network, layout: CellLayout, state: DiscreteState, transition: Transition) -> DiscreteState:
    values = [
        initial if meta else value
        for value, initial, meta in zip(state.values, layout.initial, layout.meta, strict=True)
    ]
    locations = list(state.locations)
    for participant in transition.participants:
        edge = _edge(network, participant)
        environment = _environment(layout, values, state.locations, edge, participant)
        execute(edge.updates, environment)
        locations[participant.process] = edge.target
    return DiscreteState(tuple(locations), tuple(values))


def _environment(
    layout: CellLayout, values: list[int], locations: Sequence[int], edge: Edge, participant: Participant
) -> Environment:
    environment = Environment(layout, values, locations)
    for variable, value in zip(edge.selects, participant.selects, strict=True):
        environment.bind(variable, value)
    return environment


def _event(network: Network, layout: CellLayout, before: DiscreteState, transition: Transition) -> Event:
    moves = tuple(_move(network, participant) for participant in transition.participants)
    channel = ""
    first = transition.participants[0]
    edge = _edge(network, first)
    if edge.synchronisation is not None:
        environment = _environment(layout, list(before.values), before.locations, edge, first)
        number = channel_number(edge.synchronisation.channel, environment)
        edges = [_edge(network, participant) for participant in transition.participants]
        channel = _in_words(network, layout.names[layout.channel_cells[number]], edges)
    return Event(channel, moves)


def _in_words(network: Network, channel: str, edges: Sequence[Edge]) -> str:
    """The name of a channel, with the constants of the model as indices where one of the edges writes them."""
    constants = {name for name, _ in network.constants}
    name, *indices = channel.replace("]", "").split("[")
    for edge in edges:
        place = edge.synchronisation.channel if edge.synchronisation is not None else None
        position = len(indices)
        while isinstance(place, Index):
            position -= 1
            if isinstance(place.index, Constant) and place.index.span.text in constants:
                indices[position] = place.index.span.text
            place = place.base
    return name + "".join(f"[{index}]" for index in indices)


def _move(network: Network, participant: Participant) -> Move:
    process = network.processes[participant.process]
    edge = process.edges[participant.edge]
    return Move(
        process.name,
        process.locations[edge.source].name,
        process.locations[edge.target].name,
        None if edge.synchronisation is None else edge.synchronisation.direction,
        tuple((v.name, value) for v, value in zip(edge.selects, participant.selects, strict=True)),
        edge.doc,
        process.locations[edge.target].doc if edge.target != edge.source else "",
        edge.spans,
    )


def _snapshot(network: Network, layout: CellLayout, state: DiscreteState) -> Snapshot:
    locations = tuple(
        (process.name, process.locations[number].name)
        for process, number in zip(network.processes, state.locations, strict=True)
    )
    return Snapshot(locations, tuple(_variables(layout, state.values)))


def _variables(layout: CellLayout, values: Iterable[int]) -> Iterable[tuple[str, int | bool]]:
    for name, leaf, meta, value in zip(layout.names, layout.types, layout.meta, values, strict=True):
        if not meta and not isinstance(leaf, ClockType | ChannelType):
            yield name, bool(value) if isinstance(leaf, BoolType) else value


def _timed_snapshot(network: Network, layout: CellLayout, state: TimedState) -> Snapshot:
    discrete = _snapshot(network, layout, state.discrete)
    names = (layout.names[cell] for cell in layout.clock_cells)
    return Snapshot(discrete.locations, discrete.variables, tuple(zip(names, state.clocks, strict=True)), state.time)
