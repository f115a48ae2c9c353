"""A run of a network with every number replaced by the name it stands for.

Text, JSON and every later form of a trace are made from this one view.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import compress
from operator import ne

from tachk.base.records import dataclass, replace
from tachk.base.span import Span
from tachk.base.words import Direction
from tachk.meaning.discrete import (
    bind_selects,
    environment,
    execute_updates,
    initial_discrete,
    meta_values,
    prepare,
)
from tachk.meaning.memory import Memory
from tachk.model.evaluate import channel_number
from tachk.model.expressions import Constant, Expression, Index, Reference, Variable
from tachk.model.fault import EvaluationFault
from tachk.model.floating import contains_double
from tachk.model.network import Edge, Network
from tachk.model.run import DiscreteState, Ending, Participant, TimedState, TimedTrace, Transition
from tachk.model.types import BoolType, ChannelType, ClockType, slot_count


@dataclass(frozen=True, slots=True)
class Snapshot:
    """A state by names.

    Attributes:
        locations: process and location, in the order of the processes.
        variables: every slot of every stored variable with its value; meta variables are left out.
        clocks: every clock with its value; None where the run is known without its times.
        time: time since the start; None likewise.
    """

    locations: tuple[tuple[str, str], ...]
    variables: tuple[tuple[str, int | bool], ...]
    clocks: tuple[tuple[str, Fraction], ...] | None = None
    time: Fraction | None = None

    def __repr__(self) -> str:
        places = ", ".join(f"{process}.{location}" for process, location in self.locations)
        return f"<State {places}>" if self.time is None else f"<State at {self.time}: {places}>"


_NamedValues = tuple[tuple[str, int | bool], ...]


@dataclass(frozen=True, slots=True)
class ProcessMove:
    """The part of one process in a transition.

    Attributes:
        direction: None for an internal edge.
        selects: the chosen values of the edge's select variables.
        named_by_channel: the select variables whose values the name of the channel shows.
        doc: the documentation of the edge.
        news: whether the documentation marks the move as news: ``! lost``.
        arrival: the documentation of the location it leads to.
        hidden: whether the model hides the process.
    """

    process: str
    source: str
    target: str
    direction: Direction | None
    selects: tuple[tuple[str, int], ...]
    doc: str
    arrival: str
    spans: tuple[Span, ...]
    named_by_channel: frozenset[str] = frozenset()
    news: bool = False
    hidden: bool = False


@dataclass(frozen=True, slots=True)
class TransitionView:
    """A transition.

    Attributes:
        channel: empty for an internal edge.
        moves: the sender's first.
        payload: the values that a synchronisation passes in meta variables.
    """

    channel: str
    moves: tuple[ProcessMove, ...]
    payload: tuple[tuple[str, int], ...] = ()

    def __str__(self) -> str:
        """``c!  P: a → b, Q: x → y``"""
        moves = ", ".join(f"{move.process}: {move.source} → {move.target}" for move in self.moves)
        return f"{self.channel}!  {moves}" if self.channel else moves


@dataclass(frozen=True, slots=True)
class ViewStep:
    """First ``delay`` passes, then ``event`` happens (None: the run ends after the delay); ``state`` is after it."""

    delay: Fraction | None
    event: TransitionView | None
    state: Snapshot

    def __repr__(self) -> str:
        delay = "" if self.delay is None else f" after {self.delay}"
        return f"<Step{delay}: {'time passes' if self.event is None else self.event}>"


@dataclass(frozen=True, slots=True)
class TraceView:
    """Attributes:
    hidden_processes, hidden_variables: the names that printed runs leave out.
    ending, loop_start: what comes after the last step, as in `TimedTrace`.
    """

    initial: Snapshot
    steps: tuple[ViewStep, ...]
    hidden_processes: frozenset[str] = frozenset()
    hidden_variables: frozenset[str] = frozenset()
    ending: Ending = Ending.OPEN
    loop_start: int | None = None

    def without_hidden(self) -> TraceView:
        """The run without the hidden processes where others act, or where they bring no news, and without their
        variables."""
        if not self.hidden_processes:
            return self
        places = [process not in self.hidden_processes for process, _ in self.initial.locations]
        slots = [variable not in self.hidden_variables for variable, _ in self.initial.variables]
        before: _NamedValues | None = None
        variables: _NamedValues = ()

        def shown(state: Snapshot) -> Snapshot:
            nonlocal before, variables
            if state.variables is not before:  # many states in a row share the tuple of their variables
                before, variables = state.variables, tuple(compress(state.variables, slots))
            return Snapshot(tuple(compress(state.locations, places)), variables, state.clocks, state.time)

        steps = (
            ViewStep(step.delay, None if step.event is None else _shown_event(step.event), shown(step.state))
            for step in self.steps
        )
        return TraceView(shown(self.initial), tuple(steps), ending=self.ending, loop_start=self.loop_start)


def _shown_event(event: TransitionView) -> TransitionView:
    shown = tuple(move for move in event.moves if not move.hidden or move.news)
    return replace(event, moves=shown or event.moves)


def rows_of_run(view: TraceView) -> list[dict[str, object]]:
    """A row for the start and for each step, as data frames have them: times and clocks are floating-point numbers."""
    events = ["", *("time passes" if step.event is None else str(step.event) for step in view.steps)]
    states = (view.initial, *(step.state for step in view.steps))
    return [
        {
            "step": number,
            "time": None if state.time is None else float(state.time),
            "transition": event,
            **dict(state.locations),
            **dict(state.variables),
            **{name: float(value) for name, value in state.clocks or ()},
        }
        for number, (state, event) in enumerate(zip(states, events, strict=True))
    ]


def view_trace(network: Network, trace: TimedTrace) -> TraceView:
    """The view of a timed trace of the network."""
    names = RunNames(network)
    steps = []
    before = trace.initial.discrete
    for step in trace.steps:
        event = None if step.transition is None else names.event(before, step.transition)
        steps.append(ViewStep(step.delay, event, names.timed_snapshot(step.state)))
        before = step.state.discrete
    view = names.view(names.timed_snapshot(trace.initial), steps)
    return replace(view, ending=trace.ending, loop_start=trace.loop_start)


def view_path(network: Network, path: Sequence[Transition]) -> TraceView:
    """The view of a path that is known without times: locations and variables follow from the updates."""
    names = RunNames(network)
    state = initial_discrete(names.model)
    initial = names.snapshot(state)
    steps = []
    for transition in path:
        event = names.event(state, transition)
        state, _ = execute_updates(names.model, state, transition)
        steps.append(ViewStep(None, event, names.snapshot(state)))
    return names.view(initial, steps)


def view_event(network: Network, path: Sequence[Transition], transition: Transition) -> TransitionView:
    """The view of a transition that is tried after a path."""
    names = RunNames(network)
    state = initial_discrete(names.model)
    for fired in path:
        state, _ = execute_updates(names.model, state, fired)
    return names.event(state, transition)


class RunNames:
    """The names of the numbers of one network."""

    def __init__(self, network: Network) -> None:
        self.network = network
        self.model = prepare(network)
        self.layout = self.model.layout
        self._indices = _index_names(network)
        self._hidden = tuple(network.hides(process) for process in network.processes)
        numbers = {  # halves of floating point constants, which say nothing
            self.layout.first[variable] + slot
            for variable in network.all_variables()
            if contains_double(variable.type)
            for slot in range(slot_count(variable.type))
        }
        variables = [
            (slot, name, isinstance(leaf, BoolType))
            for slot, (name, leaf, meta) in enumerate(
                zip(self.layout.names, self.layout.types, self.layout.meta, strict=True)
            )
            if slot not in numbers and not meta and not isinstance(leaf, ClockType | ChannelType)
        ]
        self._metas = [
            (slot, name)
            for slot, (name, leaf, meta) in enumerate(
                zip(self.layout.names, self.layout.types, self.layout.meta, strict=True)
            )
            if meta and slot not in numbers and not isinstance(leaf, ClockType | ChannelType)
        ]
        self._shown_at = {slot: (position, name, flag) for position, (slot, name, flag) in enumerate(variables)}
        self._last_values: tuple[tuple[int, ...], _NamedValues] = ((), (("", 0),) * len(variables))
        self._known_events = Memory()
        self._known_places: dict[tuple[int, ...], tuple[tuple[str, str], ...]] = {}
        self._clocks = tuple(self.layout.names[slot] for slot in self.layout.clock_slots)

    def view(self, initial: Snapshot, steps: Sequence[ViewStep]) -> TraceView:
        hidden = [p for p, hides in zip(self.network.processes, self._hidden, strict=True) if hides]
        variables = {variable for process in hidden for variable in process.variables}
        owned = {
            name
            for variable in variables
            for name in self.layout.names[self.layout.first[variable] :][: slot_count(variable.type)]
        }
        return TraceView(initial, tuple(steps), frozenset(p.name for p in hidden), frozenset(owned))

    def snapshot(self, state: DiscreteState) -> Snapshot:
        return Snapshot(self._places(state.locations), self._named_values(state.values))

    def _places(self, numbers: tuple[int, ...]) -> tuple[tuple[str, str], ...]:
        found = self._known_places.get(numbers)
        if found is None:
            named = zip(self.network.processes, numbers, strict=True)
            found = tuple((process.name, process.locations[number].name) for process, number in named)
            self._known_places[numbers] = found
        return found

    def _named_values(self, values: tuple[int, ...]) -> _NamedValues:
        """Of all variables their names and values; what is as in the state before is taken from there: a step changes
        few of hundreds."""
        before, named = self._last_values
        if before != values:
            changed = [*compress(range(len(values)), map(ne, before, values))] if before else range(len(values))
            fresh = list(named)
            for slot in changed:
                place = self._shown_at.get(slot)
                if place is not None:
                    position, name, flag = place
                    fresh[position] = name, bool(values[slot]) if flag else values[slot]
            named = tuple(fresh)
            self._last_values = values, named
        return named

    def timed_snapshot(self, state: TimedState) -> Snapshot:
        clocks = tuple(zip(self._clocks, state.clocks, strict=True))
        return replace(self.snapshot(state.discrete), clocks=clocks, time=state.time)

    def event(self, before: DiscreteState, transition: Transition) -> TransitionView:
        known = self._known_events.of(before)
        found: TransitionView | None = known.get(transition)
        if found is None:
            found = known[transition] = self._event(before, transition)
        return found

    def _event(self, before: DiscreteState, transition: Transition) -> TransitionView:
        first = transition.participants[0]
        synchronisation = self.model.edge(first).synchronisation
        channel = ""
        if synchronisation is not None:
            # `channel_of` would look over all edges of the network first.
            scratch = environment(self.model, before)
            bind_selects(self.model, first, scratch)
            number = channel_number(synchronisation.channel, scratch)
            channel = self._channel(self.layout.channel_slots[number])
        moves = tuple(self._move(participant) for participant in transition.participants)
        return TransitionView(channel, moves, self._payload(before, transition) if channel else ())

    def _payload(self, before: DiscreteState, transition: Transition) -> tuple[tuple[str, int], ...]:
        if not self._metas:
            return ()
        try:
            values = meta_values(self.model, before, transition)
        except EvaluationFault:
            return ()
        return tuple((name, int(values[slot])) for slot, name in self._metas)

    def _channel(self, slot: int) -> str:
        """The name of a channel, with constants of the model as indices where its edges write them."""
        name, *indices = self.layout.names[slot].replace("]", "").split("[")
        written = [self._indices.get((name, i), {}).get(int(index), index) for i, index in enumerate(indices)]
        return name + "".join(f"[{index}]" for index in written)

    def _move(self, participant: Participant) -> ProcessMove:
        process = self.network.processes[participant.process]
        edge = process.edges[participant.edge]
        news = edge.doc.startswith("!")
        indexing = {e.variable for _, e in _indices(edge) if isinstance(e, Reference)}
        return ProcessMove(
            process.name,
            process.locations[edge.source].name,
            process.locations[edge.target].name,
            None if edge.synchronisation is None else edge.synchronisation.direction,
            tuple((v.name, value) for v, value in zip(edge.selects, participant.selects, strict=True)),
            edge.doc.removeprefix("!").lstrip(),
            process.locations[edge.target].doc if edge.target != edge.source else "",
            edge.spans,
            frozenset(v.name for v in edge.selects if v in indexing),
            news,
            self._hidden[participant.process],
        )


def _index_names(network: Network) -> dict[tuple[str, int], dict[int, str]]:
    """The constants that stand for the values of an index: by array of channels, position, value.

    A value with two names has none.
    """
    constants = {name for name, _ in network.constants}
    found: dict[tuple[str, int], dict[int, set[str]]] = {}
    for process in network.processes:
        for edge in process.edges:
            for (variable, position), index in _indices(edge):
                if isinstance(index, Constant) and index.span.text in constants:
                    found.setdefault((variable.name, position), {}).setdefault(index.value, set()).add(index.span.text)
    return {
        place: {value: min(names) for value, names in values.items() if len(names) == 1}
        for place, values in found.items()
    }


def _indices(edge: Edge) -> Iterator[tuple[tuple[Variable, int], Expression]]:
    """The indices of the channel of an edge: the array, which of its dimensions, the index."""
    place = None if edge.synchronisation is None else edge.synchronisation.channel
    indices: list[Expression] = []
    while isinstance(place, Index):
        indices.append(place.index)
        place = place.base
    if isinstance(place, Reference):
        for position, index in enumerate(reversed(indices)):
            yield (place.variable, position), index
