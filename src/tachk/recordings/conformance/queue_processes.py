"""The process that follows a queue: one location, and a counter of the events that have happened."""

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
from tachk.recordings.conformance.queues import Queue, Queues, element, index_range, index_type

Indices = Mapping[Variable, Expression]
"""What the indices of a channel are."""

_NEVER = Term(Constant(0, BOOL))


@dataclass(slots=True)
class QueueProcess:
    """Makes the process of one queue.

    Attributes:
        builder: takes the tables of the recording, constant arrays with an entry for each event and one behind them.
        now: the clock that nothing resets.
        positions: the counters of all queues.
        ended: the sender has ended the recording of this queue, which it does not do in the midst of something; None
            where somebody else ends it.
    """

    builder: NetworkBuilder
    queues: Queues
    number: int
    now: Term
    positions: Sequence[Term]
    queue: Queue = field(init=False)
    position: Term = field(init=False)
    columns: dict[str, Term] = field(init=False)
    known: dict[str, Term] = field(init=False)
    ended: Term | None = field(init=False)

    def __post_init__(self) -> None:
        self.queue = self.queues.queues[self.number]
        self.position = self.positions[self.number]
        self.ended = self.builder.boolean(f"ended[{self.number}]", False) if self.queue.ends_itself else None
        values = self.queue.values
        self.columns = {}
        self.known = {}
        for n, (name, _) in enumerate(self.queue.visible.columns):
            self.columns[name] = self._entry(name, [*(said[n] or 0 for said in values), 0])
            if any(said[n] is None for said in values):
                self.known[name] = self._entry(f"{name} known", [*(int(said[n] is not None) for said in values), 0])

    def build(self) -> Process:
        """Raises UsageError for events that cannot be followed."""
        process = ProcessBuilder(f"{self.queue.name}.", VariableKind.LOCAL, name=self.queue.name)
        after = self._entry("after", [0, *self.queue.earliest])
        before = self._entry("before", [*self.queue.latest, self.queues.horizon])
        in_time = (self.now >= after) & (self.now <= before)
        if self.queue.outputs:
            matches = self.builder.boolean(f"matches[{self.number}]", True)
            here = process.location("following", matches & in_time)
            for indices in cases(self.queue):
                self._hear(process, here, indices, matches)
            if self.ended is not None:
                process.edge(here, here, guard=self._is_over() & ~self.ended, updates=[self.ended.assign(~_NEVER)])
        else:
            here = process.location("following", in_time)
            if any(self.queue.optional):  # the search tries the last edge first
                optional = self._entry("optional", [*map(int, self.queue.optional), 0])
                process.edge(here, here, guard=optional == 1, updates=[self.position.assign(self.position + 1)])
            for indices in cases(self.queue):
                self._say(process, here, indices)
        return process.build()

    def _entry(self, name: str, values: Sequence[int]) -> Term:
        """What a new table says at the present position."""
        type_ = ArrayType(IntType(min(values), max(values)), IntType(0, len(values) - 1))
        table = self.builder.declare(f"{name}[{self.number}]", type_, values)
        return table[self.position]

    def _is_over(self) -> Term:
        """All events have happened, and what happens from now on need not have been recorded."""
        return (self.position == len(self.queue.events)) & (self.now >= self.queue.quiet_until)

    def _hear(self, process: ProcessBuilder, here: LocationHandle, indices: Indices, matches: Term) -> None:
        """The edges that receive an event of the model."""
        channel, count = Term(channel_of_queue(self.queue, indices)), len(self.queue.events)
        same = self.position < count
        for name, expression in self.queue.visible.columns:
            said = self.columns[name] == Term(substitute(expression, indices, set()))
            if name in self.known:
                said = ~(self.known[name] == 1) | said
            same = same & said
        updates = [matches.assign(same), self.position.assign(self.position + 1)]
        process.edge(here, here, guard=self.position < count, receive=channel, updates=updates)
        free = self._is_over() if self.ended is None else self.ended
        process.edge(here, here, guard=free, receive=channel)
        if is_broadcast(self.queue):
            quiet = self.now < self.queue.quiet_until if self.ended is None else ~self.ended
            unheard = (self.position == count) & quiet
            process.edge(here, here, guard=unheard, receive=channel, updates=[matches.assign(_NEVER)])

    def _say(self, process: ProcessBuilder, here: LocationHandle, indices: Indices) -> None:
        """The edge that sends an event from outside, with what it says."""
        guard = self.position < len(self.queue.events)
        for other, needed in self._needs():
            guard = guard & (self.positions[other] >= needed)
        updates: list[Term] = []
        for name, expression in self.queue.visible.columns:
            match expression:
                case Reference(variable) if variable in indices:
                    guard = guard & (self.columns[name] == Term(indices[variable]))
                case Constant():
                    pass
                case Reference() | Index():
                    if name in self.known:
                        event = self.queue.visible.event
                        raise UsageError(f"an event `{event}` does not say its {name}", "fill the cell")
                    updates.append(Term(substitute(expression, indices, set())).assign(self.columns[name]))
                case _:
                    raise UsageError(
                        f"`{name}` of `{self.queue.visible.event}`, which comes from outside, has no place to go to",
                        "an event from outside sets variables, and is none of their expressions",
                    )
        channel = Term(channel_of_queue(self.queue, indices))
        process.edge(here, here, guard=guard, send=channel, updates=[*updates, self.position.assign(self.position + 1)])

    def _needs(self) -> Iterator[tuple[int, Term]]:
        """The queues that events of this one wait for, with how many of their events must have happened."""
        counts: dict[int, list[int]] = {}
        for place, needs in enumerate(self.queue.needed):
            for other, count in needs:
                if other not in counts:
                    counts[other] = [0] * (len(self.queue.needed) + 1)
                if count > counts[other][place]:
                    counts[other][place] = count
        for other, needed in sorted(counts.items()):
            yield other, self._entry(f"needs[{other}]", needed)


def cases(queue: Queue) -> Iterator[dict[Variable, Expression]]:
    """The values that the indices of a queue can have, as constants."""
    free = [i for i in queue.visible.indices if isinstance(i, Variable) and i not in queue.common]
    for values in product(*(index_range(index_type(v)) for v in free)):
        chosen = {**queue.common, **dict(zip(free, values, strict=True))}
        yield {variable: Constant(value) for variable, value in chosen.items()}


def channel_of_queue(queue: Queue, indices: Indices) -> Expression:
    """The element of the channel that has these indices."""
    visible = queue.visible
    return element(visible.channel, [indices[i] if isinstance(i, Variable) else i for i in visible.indices])


def is_broadcast(queue: Queue) -> bool:
    type_ = element_type(queue.visible.channel.type)
    assert isinstance(type_, ChannelType)
    return type_.broadcast


# ---- what lets more happen than was recorded ------------------------------------------------------------------------


def speaking(process: Process, queue: Queue, said: Mapping[str, Variable]) -> Process:
    """The process of a queue of outputs that lets every event happen and keeps what it says in variables."""
    edges_of_case = 3 if is_broadcast(queue) else 2
    edges = []
    heard = process.edges[:-1] if queue.ends_itself else process.edges
    for edge, indices in zip(heard, (i for i in cases(queue) for _ in range(edges_of_case)), strict=True):
        told = (
            Assign(Reference(said[name]), substitute(expression, indices, set()), said[name].type)
            for name, expression in queue.visible.columns
        )
        edges.append(replace(edge, updates=tuple(told)))
    edges += process.edges[len(heard) :]
    return replace(process, edges=tuple(edges), locations=tuple(replace(x, invariant=None) for x in process.locations))


def patient(process: Process, queue: Queue, position: Variable) -> Process:
    """The process of a queue of inputs that lets time pass when all of them have happened."""
    over = Term(Reference(position)) == len(queue.events)
    calm = []
    for location in process.locations:
        assert location.invariant is not None
        calm.append(replace(location, invariant=(over | Term(location.invariant)).expression))
    return replace(process, locations=tuple(calm))
