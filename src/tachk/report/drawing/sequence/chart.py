"""The content of a sequence chart, from a capture or from a run of a model."""

from __future__ import annotations

from collections.abc import Iterator
from enum import StrEnum
from fractions import Fraction
from typing import NamedTuple

from tachk.base.records import dataclass, replace


class Category(StrEnum):
    """The purpose of a message; it has a colour of its own."""

    DATA = "data"
    ANSWER = "answer"
    HEARTBEAT = "heartbeat"
    OTHER = "other"


class Moment(NamedTuple):
    """A time, and the rank among events of equal time."""

    time: Fraction
    order: int = 0


@dataclass(frozen=True, slots=True)
class Message:
    """Something that one process sends to others.

    Attributes:
        sender: the index of its lifeline.
        receivers: those of the lifelines that get it, or should.
        sent: when.
        arrivals: when it comes, several times if it was copied; none if it is lost or still under way.
        label: what it says, in the words of the protocol.
        detail: more about it, shown when the pointer is on it.
        category: what it is for.
        is_repeated: it has been sent before.
        tag: what it is called elsewhere, such as the number of its packet; stands before its time.
        is_lost: it never comes.
        is_under_way: it was sent before the chart begins.
    """

    sender: int
    receivers: tuple[int, ...]
    sent: Moment
    arrivals: tuple[Moment, ...]
    label: str
    detail: str = ""
    category: Category = Category.OTHER
    is_repeated: bool = False
    tag: str = ""
    is_lost: bool = False
    is_under_way: bool = False


@dataclass(frozen=True, slots=True)
class Note:
    """Something that a process does alone; without a lifeline it is about all of them."""

    lifeline: int | None
    moment: Moment
    text: str


@dataclass(frozen=True, slots=True)
class EnteredLocation:
    """The location in which a process is from a moment on: a condition of message sequence charts (ITU-T Z.120)."""

    lifeline: int
    moment: Moment
    text: str


Event = Message | Note | EnteredLocation


@dataclass(frozen=True, slots=True)
class Phase:
    """A time in which a process is in a state that is worth showing, such as asleep."""

    lifeline: int
    begin: Moment
    end: Moment
    text: str


@dataclass(frozen=True, slots=True)
class Chart:
    """Attributes:
    title: what the chart is of.
    description: the same at length.
    unit: of all times; empty if they have none.
    lifelines: names of processes, from left to right.
    events: in the order of their moments; messages at that of sending.
    phases: states that are shown along the lifelines.
    """

    title: str
    description: str
    unit: str
    lifelines: tuple[str, ...]
    events: tuple[Event, ...]
    phases: tuple[Phase, ...] = ()

    def part(self, begin: Fraction | None, end: Fraction | None) -> Chart:
        """The part of the chart from one time to another; messages belong to the time at which they are sent, and those
        that were sent before it and arrive in it begin at the top."""

        def is_inside(time: Fraction) -> bool:
            return (begin is None or begin <= time) and (end is None or time <= end)

        events = tuple(event for event in self.events if is_inside(begun(event).time))
        if begin is not None:
            top = Moment(begin, -1)
            coming = (_coming(one, top) for one in self.messages if one.sent.time < begin)
            events = (*(one for one in coming if one is not None and is_inside(one.arrivals[0].time)), *events)
        if not events:
            return replace(self, events=(), phases=())
        first, last = begun(events[0]), max(moment for event in events for moment in moments(event))
        phases = (
            replace(phase, begin=max(phase.begin, first), end=min(phase.end, last))
            for phase in self.phases
            if phase.begin < last and first < phase.end
        )
        return replace(self, events=events, phases=tuple(phases))

    @property
    def messages(self) -> tuple[Message, ...]:
        return tuple(event for event in self.events if isinstance(event, Message))

    def used(self) -> Chart:
        """The chart without lifelines of processes that do nothing in it."""
        busy = sorted(set(self._lifelines()))
        number = {old: new for new, old in enumerate(busy)}
        events = tuple(_renumbered(event, number) for event in self.events)
        phases = tuple(
            replace(phase, lifeline=number[phase.lifeline]) for phase in self.phases if phase.lifeline in number
        )
        return replace(self, lifelines=tuple(self.lifelines[old] for old in busy), events=events, phases=phases)

    def _lifelines(self) -> Iterator[int]:
        for event in self.events:
            yield from lifelines_of(event)


def _coming(message: Message, top: Moment) -> Message | None:
    """A message as it comes in from above; None if all of it has arrived before."""
    arrivals = tuple(moment for moment in message.arrivals if moment.time >= top.time)
    if not arrivals:
        return None
    label = message.label if len(arrivals) == len(message.arrivals) else f"copy of {message.label}"
    return replace(message, sent=top, arrivals=arrivals, label=label, is_under_way=True)


def begun(event: Event) -> Moment:
    """The moment at which an event happens or begins."""
    return event.sent if isinstance(event, Message) else event.moment


def lifelines_of(event: Event) -> tuple[int, ...]:
    """The lifelines that an event is about; none if it is about all of them."""
    if isinstance(event, Message):
        return event.sender, *event.receivers
    return () if event.lifeline is None else (event.lifeline,)


def moments(event: Event) -> tuple[Moment, ...]:
    """The moments at which an event begins, and at which messages arrive."""
    return (event.sent, *event.arrivals) if isinstance(event, Message) else (event.moment,)


def _renumbered(event: Event, number: dict[int, int]) -> Event:
    if isinstance(event, Message):
        receivers = tuple(number[receiver] for receiver in event.receivers)
        return replace(event, sender=number[event.sender], receivers=receivers)
    return event if event.lifeline is None else replace(event, lifeline=number[event.lifeline])
