"""The process that follows a stream: one location, and a counter of the events that have happened."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.frontend.expressions.folded_expressions import substitute
from tachk.model.builder import LocationHandle, NetworkBuilder, ProcessBuilder, Term
from tachk.model.expressions import BOOL, Assign, Constant, Expression, Index, Reference, Variable, VariableKind
from tachk.model.network import Process
from tachk.model.types import ArrayType, ChannelType, IntType, element_type
from tachk.recordings.conformance.event_streams import EventStream, EventStreams, element, index_range, index_type

Indices = Mapping[Variable, Expression]
"""The values of the indices of a channel."""

_NEVER = Term(Constant(0, BOOL))


@dataclass(slots=True)
class TraceAutomaton:
    """Makes the process of one stream.

    Attributes:
        builder: takes the tables of the recording, constant arrays with an entry for each event and one behind them.
        now: the clock that nothing resets.
        positions: the counters of all streams.
        ended: the sender has ended the recording of this stream, which it does not do in the midst of something; None
            where another automaton ends it.
    """

    builder: NetworkBuilder
    streams: EventStreams
    number: int
    now: Term
    positions: Sequence[Term]
    stream: EventStream = field(init=False)
    position: Term = field(init=False)
    columns: dict[str, Term] = field(init=False)
    known: dict[str, Term] = field(init=False)
    ended: Term | None = field(init=False)

    def __post_init__(self) -> None:
        self.stream = self.streams.streams[self.number]
        self.position = self.positions[self.number]
        self.ended = self.builder.boolean(f"ended[{self.number}]", False) if self.stream.ends_itself else None
        values = self.stream.values
        self.columns = {}
        self.known = {}
        for n, (name, _) in enumerate(self.stream.visible.columns):
            self.columns[name] = self._entry(name, [*(said[n] or 0 for said in values), 0])
            if any(said[n] is None for said in values):
                self.known[name] = self._entry(f"{name} known", [*(int(said[n] is not None) for said in values), 0])

    def build(self) -> Process:
        """Raises UsageError for events that cannot be followed."""
        process = ProcessBuilder(f"{self.stream.name}.", VariableKind.LOCAL, name=self.stream.name)
        after = self._entry("after", [0, *self.stream.earliest])
        before = self._entry("before", [*self.stream.latest, self.streams.time_bound])
        in_time = (self.now >= after) & (self.now <= before)
        if self.stream.outputs:
            matches = self.builder.boolean(f"matches[{self.number}]", True)
            here = process.location("following", matches & in_time)
            for indices in cases(self.stream):
                self._add_receiving_edges(process, here, indices, matches)
            if self.ended is not None:
                process.edge(here, here, guard=self._is_over() & ~self.ended, updates=[self.ended.assign(~_NEVER)])
        else:
            here = process.location("following", in_time)
            if any(self.stream.optional):  # the search tries the last edge first
                optional = self._entry("optional", [*map(int, self.stream.optional), 0])
                process.edge(here, here, guard=optional == 1, updates=[self.position.assign(self.position + 1)])
            for indices in cases(self.stream):
                self._add_sending_edges(process, here, indices)
        return process.build()

    def _entry(self, name: str, values: Sequence[int]) -> Term:
        """The entry of a new table at the present position."""
        type_ = ArrayType(IntType(min(values), max(values)), IntType(0, len(values) - 1))
        table = self.builder.declare(f"{name}[{self.number}]", type_, values)
        return table[self.position]

    def _is_over(self) -> Term:
        """All events have happened, and what happens from now on need not have been recorded."""
        return (self.position == len(self.stream.events)) & (self.now >= self.stream.quiet_until)

    def _add_receiving_edges(
        self, process: ProcessBuilder, here: LocationHandle, indices: Indices, matches: Term
    ) -> None:
        """The edges that receive an event of the model."""
        channel, count = Term(channel_of_stream(self.stream, indices)), len(self.stream.events)
        same = self.position < count
        for name, expression in self.stream.visible.columns:
            said = self.columns[name] == Term(substitute(expression, indices, set()))
            if name in self.known:
                said = ~(self.known[name] == 1) | said
            same = same & said
        updates = [matches.assign(same), self.position.assign(self.position + 1)]
        process.edge(here, here, guard=self.position < count, receive=channel, updates=updates)
        free = self._is_over() if self.ended is None else self.ended
        process.edge(here, here, guard=free, receive=channel)
        if is_broadcast(self.stream):
            quiet = self.now < self.stream.quiet_until if self.ended is None else ~self.ended
            not_recorded = (self.position == count) & quiet
            process.edge(here, here, guard=not_recorded, receive=channel, updates=[matches.assign(_NEVER)])

    def _add_sending_edges(self, process: ProcessBuilder, here: LocationHandle, indices: Indices) -> None:
        """The edge that sends an event from outside, with its values."""
        guard = self.position < len(self.stream.events)
        for other, needed in self._needs():
            guard = guard & (self.positions[other] >= needed)
        updates: list[Term] = []
        for name, expression in self.stream.visible.columns:
            match expression:
                case Reference(variable) if variable in indices:
                    guard = guard & (self.columns[name] == Term(indices[variable]))
                case Constant():
                    pass
                case Reference() | Index():
                    if name in self.known:
                        event = self.stream.visible.event
                        raise UsageError(f"an event `{event}` does not say its {name}", "fill the cell")
                    updates.append(Term(substitute(expression, indices, set())).assign(self.columns[name]))
                case _:
                    raise UsageError(
                        f"`{name}` of `{self.stream.visible.event}`, which comes from outside, has no place to go to",
                        "an event from outside sets variables, and is none of their expressions",
                    )
        channel = Term(channel_of_stream(self.stream, indices))
        process.edge(here, here, guard=guard, send=channel, updates=[*updates, self.position.assign(self.position + 1)])

    def _needs(self) -> Iterator[tuple[int, Term]]:
        """The streams that events of this one wait for, with how many of their events must have happened."""
        counts: dict[int, list[int]] = {}
        for place, needs in enumerate(self.stream.needed):
            for other, count in needs:
                if other not in counts:
                    counts[other] = [0] * (len(self.stream.needed) + 1)
                if count > counts[other][place]:
                    counts[other][place] = count
        for other, needed in sorted(counts.items()):
            yield other, self._entry(f"needs[{other}]", needed)


def cases(stream: EventStream) -> Iterator[dict[Variable, Expression]]:
    """The values that the indices of a stream can have, as constants."""
    free = [i for i in stream.visible.indices if isinstance(i, Variable) and i not in stream.common]
    for values in product(*(index_range(index_type(v)) for v in free)):
        chosen = {**stream.common, **dict(zip(free, values, strict=True))}
        yield {variable: Constant(value) for variable, value in chosen.items()}


def channel_of_stream(stream: EventStream, indices: Indices) -> Expression:
    """The element of the channel that has these indices."""
    visible = stream.visible
    return element(visible.channel, [indices[i] if isinstance(i, Variable) else i for i in visible.indices])


def is_broadcast(stream: EventStream) -> bool:
    type_ = element_type(stream.visible.channel.type)
    assert isinstance(type_, ChannelType)
    return type_.broadcast


# ---- unrecorded events ----------------------------------------------------------------------------------------------


def with_any_output(process: Process, stream: EventStream, said: Mapping[str, Variable]) -> Process:
    """The process of a stream of outputs that lets every event happen and keeps what it says in variables."""
    edges_of_case = 3 if is_broadcast(stream) else 2
    edges = []
    received = process.edges[:-1] if stream.ends_itself else process.edges
    for edge, indices in zip(received, (i for i in cases(stream) for _ in range(edges_of_case)), strict=True):
        listed_values = (
            Assign(Reference(said[name]), substitute(expression, indices, set()), said[name].type)
            for name, expression in stream.visible.columns
        )
        edges.append(replace(edge, updates=tuple(listed_values)))
    edges += process.edges[len(received) :]
    return replace(process, edges=tuple(edges), locations=tuple(replace(x, invariant=None) for x in process.locations))


def without_deadlines(process: Process, stream: EventStream, position: Variable) -> Process:
    """The process of a stream of inputs that lets time pass when all of them have happened."""
    over = Term(Reference(position)) == len(stream.events)
    calm = []
    for location in process.locations:
        assert location.invariant is not None
        calm.append(replace(location, invariant=(over | Term(location.invariant)).expression))
    return replace(process, locations=tuple(calm))
