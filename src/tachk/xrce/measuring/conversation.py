"""A reliable stream in one direction, as its sender sees it: messages, answers and missing acknowledgements."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from tachk.base.records import dataclass
from tachk.xrce.events import SubmessageEvent
from tachk.xrce.measuring.quantity import PacketPlace
from tachk.xrce.streams import nearest_number
from tachk.xrce.transmission import Transmission
from tachk.xrce.transmissions import Capture
from tachk.xrce.wire import SubmessageKind


@dataclass(frozen=True, slots=True)
class SentMessage:
    """A message of the stream leaves. ``number`` goes on at 65536; ``again``: it left before."""

    time: int
    number: int
    again: bool
    unacknowledged: int
    transmission: Transmission


@dataclass(frozen=True, slots=True)
class Beat:
    """A HEARTBEAT about the stream leaves."""

    time: int
    unacknowledged: int
    transmission: Transmission


@dataclass(frozen=True, slots=True)
class Came:
    """Something comes in. ``first`` and ``missing`` are those of an ACKNACK about the stream, else None and empty.

    Attributes:
        before: how many messages were unacknowledged before it came.
        unacknowledged: how many are now.
    """

    time: int
    first: int | None
    missing: tuple[int, ...]
    before: int
    unacknowledged: int
    transmission: Transmission


Moment = SentMessage | Beat | Came


@dataclass(frozen=True, slots=True)
class Conversation:
    """Attributes:
    file: the name of the capture.
    link: the index of the link in its recording.
    from_client: whether the client sends the stream.
    stream: its id.
    moments: in the order of their times at the sender.
    end: when the capture ends, in nanoseconds since the epoch.
    """

    file: str
    link: int
    from_client: bool
    stream: int
    moments: tuple[Moment, ...]
    end: int

    def place(self, moment: Moment) -> PacketPlace:
        return PacketPlace(self.file, moment.transmission.packet)


def conversations(file: str, recording: Capture) -> Iterator[Conversation]:
    """Every stream of a capture in each direction in which messages of it are sent."""
    for link in range(len(recording.links)):
        ours = list(recording.transmissions.where(link))
        for from_client in (True, False):
            streams = {
                event.stream
                for one in ours
                if one.to_agent == from_client and one.is_reliable
                for event in one.events
                if event.is_reliable
            }
            for stream in sorted(number for number in streams if number is not None):
                moments = _moments(ours, from_client, stream)
                yield Conversation(file, link, from_client, stream, moments, recording.end)


def _moments(ours: Sequence[Transmission], from_client: bool, stream: int) -> tuple[Moment, ...]:
    at_sender = [
        (one.sent if one.to_agent == from_client else arrival, one)
        for one in ours
        for arrival in _arrivals(one, from_client)
    ]
    at_sender.sort(key=lambda pair: (pair[0], pair[1].packet))
    tracker = _StreamTracker(stream)
    return tuple(
        moment
        for time, one in at_sender
        for moment in (tracker.left(time, one) if one.to_agent == from_client else tracker.came(time, one))
    )


def _arrivals(one: Transmission, from_client: bool) -> Sequence[int]:
    if one.to_agent == from_client or one.arrivals is None:
        return (one.sent,)
    return [arrival.time for arrival in one.arrivals]


class _StreamTracker:
    def __init__(self, stream: int) -> None:
        self._stream = stream
        self._sent = 0
        self._acknowledged = 0

    @property
    def _outstanding(self) -> int:
        return max(self._sent - self._acknowledged, 0)

    def left(self, time: int, one: Transmission) -> Iterator[Moment]:
        events = one.events
        first = events[0]
        if SubmessageKind.CREATE_CLIENT in one.kinds:
            self._sent = self._acknowledged = 0
        if first.stream == self._stream and first.sequence is not None:
            number = nearest_number(first.sequence, self._sent)
            again = number < self._sent
            self._sent = max(self._sent, number + 1)
            yield SentMessage(time, number, again, self._outstanding, one)
        if any(self._is_about(event, SubmessageKind.HEARTBEAT) for event in events):
            yield Beat(time, self._outstanding, one)

    def came(self, time: int, one: Transmission) -> Iterator[Moment]:
        before = self._outstanding
        first: int | None = None
        missing: tuple[int, ...] = ()
        for event in one.events if SubmessageKind.ACKNACK in one.kinds else ():
            if self._is_about(event, SubmessageKind.ACKNACK):
                first = nearest_number(_number(event, "first"), self._sent)
                missing = tuple(nearest_number(number, self._sent) for number in _numbers(event, "missing"))
                self._acknowledged = max(self._acknowledged, min(first, self._sent))
        yield Came(time, first, missing, before, self._outstanding, one)

    def _is_about(self, event: SubmessageEvent, kind: SubmessageKind) -> bool:
        return event.kind is kind and event.fields["subject"] == self._stream


def _number(event: SubmessageEvent, name: str) -> int:
    value = event.fields[name]
    assert isinstance(value, int)
    return value


def _numbers(event: SubmessageEvent, name: str) -> list[int]:
    value = event.fields[name]
    assert isinstance(value, list)
    return value
