"""A timer beside a network: a process that sets its clock at one event and stops at another.

The timer looks at the state after each transition that leaves no process in a committed location, and no time passes
before it has: its edges are urgent, and while it has something to notice no process of the network may begin anything.
In a chain of committed locations it cannot act. There an edge that begins a transition first does what the timer would
do, on variables, so that events come in their order; at the end of the chain the timer acts as these say.

The start of the run is an event that does not come again. Behind the second event nothing counts then, and nothing
happens any more.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import reduce

from tachk.diagnostics.diagnostic import UsageError
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
    Unary,
    Variable,
    VariableKind,
)
from tachk.model.network import Edge, Location, Network, Process, Synchronisation
from tachk.model.types import ChannelType, ClockType, IntType
from tachk.operators import BinaryOperator, UnaryOperator
from tachk.records import dataclass
from tachk.words import Direction

NAME = "Timer"

_WAITING, _RUNNING, _DONE = range(3)
_NAMES = ("Waiting", "Running", "Done")


@dataclass(frozen=True, slots=True)
class Timed:
    """Attributes:
    network: with the timer as its last process.
    clock: since the event at which the timer was set.
    running: the second event has not come yet.
    done: it has come this moment.
    """

    network: Network
    clock: Expression
    running: Expression
    done: Expression


def with_timer(network: Network, start: Event | None, end: Event, last: bool = False) -> Timed:
    """The network with a timer that runs from one event to the next occurrence of another one, again and again.

    Args:
        start: None for the start of the run, once.
        last: where the first event comes again before the other, the timer starts again.

    Raises UsageError where an edge names a channel in a way that cannot be compared with that of an event.
    """
    clock = _local("time", ClockType(), 0)
    now = _local("now", ChannelType(broadcast=True, urgent=True), 0)
    first = _noticed(BecomesTrue(Constant(1, BOOL)) if start is None else start, "from")
    second = _noticed(end, "to")
    moment = _Moment(last)
    number = len(network.processes)
    once = start is None
    edges = _edges(first, second, moment, Reference(clock), Reference(now))
    timer = Process(
        NAME,
        NAME,
        tuple(Location(name, urgent=once and place >= _DONE) for place, name in enumerate(_NAMES)),
        tuple(edge for edge in edges if not (once and edge.source >= _DONE)),
        variables=(clock, now, *moment.variables, first.memory, second.memory),
        priority=max((process.priority for process in network.processes), default=0),
    )
    at = [LocationTest(number, location) for location in range(len(_NAMES))]
    pending = _any(first.is_new, second.is_new, moment.is_new, at[_DONE])
    has_chains = any(place.committed for process in network.processes for place in process.locations)
    in_chains = _look_in_chains(first, second, moment) if has_chains else ()
    processes = [_observed(process, network, pending, in_chains, (first, second)) for process in network.processes]
    return Timed(replace(network, processes=(*processes, timer)), Reference(clock), at[_RUNNING], at[_DONE])


class _Moment:
    """What has come of the events in this moment, as variables, and how a look at two events changes them.

    Attributes:
        runs: 1 where the second event is waited for.
        begun: 1 where that is since this moment.
        ended: 1 where the second event has come after a first one of an earlier moment.
        both: 1 where both have come in this moment, in this order or together.
    """

    def __init__(self, last: bool) -> None:
        self.variables = tuple(_local(name, IntType(0, 1), 0) for name in ("runs", "begun", "ended", "both"))
        self.runs, self.begun, self.ended, self.both = (_is_set(Reference(each)) for each in self.variables)
        self._last = last
        self.is_new = _any(self.begun, self.ended, self.both)

    def after(self, starts: Expression, ends: Expression, same: bool) -> tuple[Expression, ...]:
        """The conditions that `runs`, `begun`, `ended` and `both` become.

        Args:
            starts, ends: whether the events happen.
            same: they are one event; it does not end what it begins.
        """
        begins = _all(_not(self.runs), starts)
        begins_only = begins if same else _all(begins, _not(ends))
        at_once = Constant(0, BOOL) if same else _all(begins, ends)
        stops = _all(self.runs, ends)
        goes_on = _all(self.runs, _not(ends))
        again = _any(self.begun, starts) if self._last else self.begun
        return (
            _any(begins_only, goes_on, _all(stops, starts)),
            _any(begins_only, _all(goes_on, again), _all(stops, starts)),
            _any(self.ended, _all(stops, _not(self.begun))),
            _any(self.both, at_once, _all(stops, self.begun)),
        )

    def assigned(self, values: Sequence[Expression]) -> tuple[Expression, ...]:
        """The variables as `after` says. What needs an old value comes before it is gone."""
        pairs = zip(self.variables, values, strict=True)
        runs, begun, ended, both = (Assign(Reference(variable), _truth(value), INT) for variable, value in pairs)
        return ended, both, begun, runs


@dataclass(frozen=True, slots=True)
class _Noticed:
    """An event as the timer sees it.

    Attributes:
        memory: of a condition what it was when it was looked at last, of a channel whether it has fired since.
        happens: it has come since.
        is_new: there is something to notice.
        noticed: what remembers that it has been looked at.
    """

    event: Event
    memory: Variable
    happens: Expression
    is_new: Expression
    noticed: Expression

    @property
    def settled(self) -> bool:
        """Whether it is not looked at in chains of committed locations."""
        return isinstance(self.event, BecomesTrue) and self.event.settled

    def fired(self, edge: Edge) -> tuple[Expression, ...]:
        """What an edge of the network has to do before its own updates."""
        if not isinstance(self.event, Fires) or edge.synchronisation is None:
            return ()
        if edge.synchronisation.direction is not self.event.direction:
            return ()
        same = _same_channel(edge.synchronisation.channel, self.event.channel)
        if same == Constant(0, BOOL):
            return ()
        place = Reference(self.memory)
        return (Assign(place, _truth(_any(_is_set(place), same)), INT),)


def _noticed(event: Event, name: str) -> _Noticed:
    memory = _local(name, IntType(0, 1), 0)
    place = Reference(memory)
    match event:
        case BecomesTrue(condition):
            changes = Binary(BinaryOperator.NOT_EQUAL, _truth(condition), place, BOOL)
            remembers = Assign(place, _truth(condition), INT)
            return _Noticed(event, memory, _all(condition, _not(place)), changes, remembers)
        case Fires():
            fired = _is_set(place)
            return _Noticed(event, memory, fired, fired, Assign(place, Constant(0), INT))


def _look_in_chains(first: _Noticed, second: _Noticed, moment: _Moment) -> tuple[Expression, ...]:
    """What an edge that begins a transition does first. Where no process is in a committed location the timer has
    looked already, and it changes nothing."""
    starts, ends = (Constant(0, BOOL) if each.settled else each.happens for each in (first, second))
    looked = moment.assigned(moment.after(starts, ends, first.event == second.event))
    return (*looked, *(each.noticed for each in (first, second) if not each.settled))


def _edges(first: _Noticed, second: _Noticed, moment: _Moment, clock: Expression, now: Expression) -> list[Edge]:
    runs, begun, ended, both = moment.after(first.happens, second.happens, first.event == second.event)
    noticed = (first.noticed, second.noticed)
    set_ = Assign(clock, Constant(0), clock.type)
    something = _any(first.is_new, second.is_new, moment.is_new)
    urgent = Synchronisation(now, Direction.SEND)
    no = Constant(0, BOOL)

    def edge(source: int, target: int, guard: Expression, *updates: Expression) -> Edge:
        return Edge(source, target, guard=guard, synchronisation=urgent, updates=updates)

    found = []
    for source in (_WAITING, _RUNNING):
        # What has ended is measured, then what took no time; what begins anew begins behind both.
        ends_now, ends_at_once = (runs, begun, no, both), (runs, begun, no, no)
        found += [
            edge(source, _DONE, ended, *moment.assigned(ends_now), *noticed),
            edge(source, _DONE, _all(_not(ended), both), set_, *moment.assigned(ends_at_once), *noticed),
        ]
        quiet = _all(something, _not(ended), _not(both))
        rests = moment.assigned((runs, no, no, no))
        found += [
            edge(source, _RUNNING, _all(quiet, begun), set_, *rests, *noticed),
            edge(source, source, _all(quiet, _not(begun)), *rests, *noticed),
        ]
    kept = moment.runs
    return [
        *found,
        edge(_DONE, _DONE, moment.both, set_, *moment.assigned((kept, moment.begun, no, no))),
        edge(_DONE, _RUNNING, _all(_not(moment.both), kept), set_, *moment.assigned((kept, no, no, no))),
        edge(_DONE, _WAITING, _all(_not(moment.both), _not(kept)), *moment.assigned((kept, no, no, no))),
    ]


def _observed(
    process: Process,
    network: Network,
    pending: Expression,
    in_chains: tuple[Expression, ...],
    events: Sequence[_Noticed],
) -> Process:
    """The process, which begins nothing while the timer has something to notice, and looks for it in chains.

    Args:
        in_chains: what an edge that begins a transition does first.
    """
    committed = [
        LocationTest(number, location)
        for number, each in enumerate(network.processes)
        for location, place in enumerate(each.locations)
        if place.committed
    ]
    free = _any(_not(pending), *committed)
    edges = []
    for edge in process.edges:
        guard = edge.guard
        if edge.begins and not process.locations[edge.source].committed:
            guard = free if guard is None else _all(free, guard)
        looked = in_chains if edge.begins else ()
        fired = [update for event in events for update in event.fired(edge)]
        edges.append(replace(edge, guard=guard, updates=(*looked, *fired, *edge.updates)))
    return replace(process, edges=tuple(edges))


def _same_channel(named: Expression, wanted: Expression) -> Expression:
    """Whether two channels are the same; a wanted array stands for any of its channels."""
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


def _is_set(place: Expression) -> Expression:
    return Binary(BinaryOperator.EQUAL, place, Constant(1), BOOL)


def _truth(condition: Expression) -> Expression:
    """The condition as 0 or 1."""
    return Binary(BinaryOperator.NOT_EQUAL, condition, Constant(0), BOOL)


def _not(condition: Expression) -> Expression:
    return Unary(UnaryOperator.NOT, condition, BOOL)


def _all(*conditions: Expression) -> Expression:
    return reduce(lambda a, b: Binary(BinaryOperator.AND, a, b, BOOL), conditions)


def _any(*conditions: Expression) -> Expression:
    return reduce(lambda a, b: Binary(BinaryOperator.OR, a, b, BOOL), conditions)
