"""A timer beside a network: a process that sets its clock at one event and stops at another.

The timer looks at the state after each transition, and no time passes before it has: its edges are urgent, it observes
(committed locations do not keep it from acting), and while it has something to notice no process of the network may
begin anything.

The start of the run is an event that does not come again. Behind the second event nothing counts then, and nothing
happens any more.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.operators import BinaryOperator
from tachk.base.records import dataclass, replace
from tachk.base.words import Direction
from tachk.model.connectives import as_number, is_any_committed, is_set, negation
from tachk.model.event import BecomesTrue, Event, Fires
from tachk.model.expressions import (
    BOOL,
    INT,
    Assign,
    Binary,
    Constant,
    Expression,
    Index,
    LocationTest,
    Reference,
    Variable,
    VariableKind,
)
from tachk.model.network import Edge, Location, Network, Process, Synchronisation
from tachk.model.types import ChannelType, ClockType, IntType
from tachk.transform.extension import Extension
from tachk.transform.transformation import Exactness

NAME = "Timer"

_WAITING, _RUNNING, _DONE, _DONE_AND_AGAIN = range(4)
_NAMES = ("Waiting", "Running", "Done", "DoneAndAgain")


@dataclass(frozen=True, slots=True)
class EventTimer(Extension):
    """A network with a timer as its last process.

    Attributes:
        clock: since the event at which the timer was set.
        running: the second event has not come yet, and time may pass before it does.
        done: it has come this moment.
    """

    clock: Expression
    running: Expression
    done: Expression


def with_event_timer(network: Network, start: Event | None, end: Event, last: bool = False) -> EventTimer:
    """The network with a timer that runs from one event to the next occurrence of another one, again and again.

    Args:
        start: None for the start of the run, once.
        last: where the first event comes again before the other, the timer starts again.

    Raises UsageError where an edge names a channel in a way that cannot be compared with that of an event.
    """
    clock = _local("time", ClockType(), 0)
    now = _local("now", ChannelType(broadcast=True, urgent=True), 0)
    committed = is_any_committed(network)
    began = BecomesTrue(Constant(1, BOOL)) if start is None else start
    first = _Noticed(began, _local("from", IntType(0, 1), 0), committed)
    second = _Noticed(end, _local("to", IntType(0, 1), 0), committed)
    number = len(network.processes)
    once = start is None
    edges = _edges(first, second, Reference(clock), Reference(now), last)
    timer = Process(
        NAME,
        NAME,
        tuple(Location(name, urgent=once and place >= _DONE, observes=True) for place, name in enumerate(_NAMES)),
        tuple(edge for edge in edges if not (once and edge.source >= _DONE)),
        variables=(clock, now, first.memory, second.memory),
        priority=max((process.priority for process in network.processes), default=0),
    )
    at = [LocationTest(number, location) for location in range(len(_NAMES))]
    done = _any(at[_DONE], at[_DONE_AND_AGAIN])
    pending = _any(first.is_new, second.is_new, done)
    processes = [_observed(process, pending, (first, second)) for process in network.processes]
    waits = _all(at[_RUNNING], negation(pending), negation(committed))
    timed = replace(network, processes=(*processes, timer))
    return EventTimer(network, timed, Exactness.REACHABLE, Reference(clock), waits, done)


class _Noticed:
    """An event with the variable that remembers it: of a condition what it was when the timer looked last, of a channel
    whether it has fired since."""

    def __init__(self, event: Event, memory: Variable, committed: Expression) -> None:
        self.event = event
        self.memory = memory
        place = Reference(memory)
        match event:
            case BecomesTrue(condition, settled):
                changes = Binary(BinaryOperator.NOT_EQUAL, as_number(condition), place, BOOL)
                is_seen = negation(committed) if settled else Constant(1, BOOL)
                self.happens = _all(is_seen, condition, negation(place))
                """Seen from the timer."""
                self.is_new: Expression = _all(is_seen, changes)
                """The timer has something to do."""
                now = _any(_all(is_seen, condition), _all(negation(is_seen), is_set(place)))
                self.noticed = Assign(place, as_number(now), INT)
            case Fires():
                self.happens = self.is_new = is_set(place)
                self.noticed = Assign(place, Constant(0), INT)

    def updates(self, edge: Edge) -> tuple[Expression, ...]:
        """The updates of the timer before those of an edge of the network."""
        if not isinstance(self.event, Fires) or edge.synchronisation is None:
            return ()
        if edge.synchronisation.direction is not self.event.direction:
            return ()
        same = _same_channel(edge.synchronisation.channel, self.event.channel)
        if same == Constant(0, BOOL):
            return ()
        place = Reference(self.memory)
        return (Assign(place, as_number(_any(is_set(place), same)), INT),)


def _edges(first: _Noticed, second: _Noticed, clock: Expression, now: Expression, last: bool) -> list[Edge]:
    starts, ends = first.happens, second.happens
    same = first.event == second.event  # from one occurrence to the next one
    at_once = Constant(0, BOOL) if same else ends
    noticed = (first.noticed, second.noticed)
    set_ = Assign(clock, Constant(0), clock.type)
    something = _any(first.is_new, second.is_new)
    restart = _all(starts, negation(ends)) if last else Constant(0, BOOL)
    urgent = Synchronisation(now, Direction.SEND)

    def edge(source: int, target: int, guard: Expression | None, *updates: Expression) -> Edge:
        return Edge(source, target, guard=guard, synchronisation=urgent, updates=updates)

    return [
        edge(_WAITING, _RUNNING, _all(starts, negation(at_once)), set_, *noticed),
        edge(_WAITING, _DONE, _all(starts, at_once), set_, *noticed),
        edge(_WAITING, _WAITING, _all(something, negation(starts)), *noticed),
        edge(_RUNNING, _DONE, _all(ends, negation(starts)), *noticed),
        edge(_RUNNING, _DONE_AND_AGAIN, _all(ends, starts), *noticed),
        *([edge(_RUNNING, _RUNNING, restart, set_, *noticed)] if last else []),
        edge(_RUNNING, _RUNNING, _all(_all(something, negation(ends)), negation(restart)), *noticed),
        edge(_DONE, _WAITING, None),
        edge(_DONE_AND_AGAIN, _RUNNING, None, set_),
    ]


def _observed(process: Process, pending: Expression, events: Sequence[_Noticed]) -> Process:
    """The process, which begins nothing while the timer has something to notice."""
    free = negation(pending)
    edges = []
    for edge in process.edges:
        guard = edge.guard
        if edge.begins:
            guard = free if guard is None else _all(free, guard)
        updates = [update for event in events for update in event.updates(edge)]
        edges.append(replace(edge, guard=guard, updates=(*updates, *edge.updates)))
    return replace(process, edges=tuple(edges))


def _same_channel(named: Expression, wanted: Expression) -> Expression:
    """The condition that two channels are the same; a wanted array stands for any of its channels."""
    (one, indices), (other, given) = _path(named), _path(wanted)
    if one is not other:
        return Constant(0, BOOL)
    pairs = zip(indices, given, strict=False)
    return _all(Constant(1, BOOL), *(Binary(BinaryOperator.EQUAL, i, j, BOOL) for i, j in pairs))


def _path(channel: Expression) -> tuple[Variable, list[Expression]]:
    match channel:
        case Reference(variable):
            return variable, []
        case Index(base, index):
            variable, before = _path(base)
            return variable, [*before, index]
        case _:
            raise UsageError(
                f"an event cannot be the use of a channel that an edge computes as {channel.span.text!r}",
                "name a condition that becomes true with it",
            )


def _local(name: str, type_: ClockType | ChannelType | IntType, initial: int) -> Variable:
    return Variable(f"{NAME}.{name}", type_, VariableKind.LOCAL, (initial,))


def _all(*conditions: Expression) -> Expression:
    return reduce(lambda a, b: Binary(BinaryOperator.AND, a, b, BOOL), conditions)


def _any(*conditions: Expression) -> Expression:
    return reduce(lambda a, b: Binary(BinaryOperator.OR, a, b, BOOL), conditions)
