"""The number of slots of the input stream of a client: the number that explains its ACKNACKs.

No message contains it. A message too far ahead is dropped and yet named as missing, and the bitmap of an ACKNACK is
about slots, so a client with few slots sends other ACKNACKs than one with many, once enough is missing.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from typing import Final

from tachk.base.records import dataclass
from tachk.xrce.events import SubmessageEvent
from tachk.xrce.measuring.quantity import Confidence
from tachk.xrce.measuring.settings import Setting
from tachk.xrce.streams import nearest_number
from tachk.xrce.transmissions import Capture
from tachk.xrce.wire import FIRST_RELIABLE_STREAM, SubmessageKind

_OF_STREAMS: Final = frozenset({SubmessageKind.CREATE_CLIENT, SubmessageKind.ACKNACK, SubmessageKind.HEARTBEAT})
_SIZES: Final = (2, 4, 8, 16, 32)
_USUAL: Final = 16
"""The assumption of models: the Agent has no more under way."""
_ASLEEP: Final = 100_000_000
"""Nanoseconds after which a packet without answer is gone, where a client does not answer all of them."""


def unanswered(recording: Capture) -> int:
    """The number of packets that clients did not read. A client answers each that it reads, in their order."""
    return sum(_unanswered(_at_client(recording, link)) for link in range(len(recording.links)))


def _unanswered(stream: Sequence[_SentAcknack | _ReceivedMessage]) -> int:
    answers = [number for number, each in enumerate(stream) if isinstance(each, _SentAcknack)]
    received = [each for each in stream[: answers[-1]] if isinstance(each, _ReceivedMessage)] if answers else []
    return max(sum(not each.begins for each in received) - len(answers), 0)


def input_history(recordings: Iterable[Capture]) -> Iterator[Setting]:
    """The setting, if ACKNACKs distinguish the numbers of slots."""
    wrong = dict.fromkeys(_SIZES, 0)
    for recording in recordings:
        for link in range(len(recording.links)):
            stream = _at_client(recording, link)
            for size in _SIZES:
                wrong[size] += _differences(stream, size)
    best = min(wrong.values())
    fitting = [size for size in _SIZES if wrong[size] == best]
    if _USUAL not in fitting:
        margin = wrong[_USUAL] - best
        how = f"{margin} ACKNACKs of clients are those of a window of {fitting[-1]}, and of no window of {_USUAL}"
        confidence = Confidence.MEASURED if margin > 1 else Confidence.ONE_SAMPLE
        yield Setting("INPUT_HISTORY", fitting[-1], False, confidence, how)


@dataclass(frozen=True, slots=True)
class _SentAcknack:
    """An ACKNACK that the client sends: ``first``, and the numbers that are missing."""

    time: int
    first: int
    missing: frozenset[int]


@dataclass(frozen=True, slots=True)
class _ReceivedMessage:
    """An arrival at the client: a message, a HEARTBEAT with the last ``number`` that there is, or the beginning of a
    session."""

    time: int
    number: int
    is_message: bool
    is_piece: bool
    begins: bool = False


def _at_client(recording: Capture, link: int) -> list[_SentAcknack | _ReceivedMessage]:
    """In the order of times; empty where arrivals were not observed."""
    found: list[tuple[int, int, _SentAcknack | _ReceivedMessage]] = []
    for one in recording.transmissions.where(link):
        if not one.is_reliable and one.kinds.isdisjoint(_OF_STREAMS):
            continue
        events, packet = one.events, one.packet
        times = [one.sent] if one.to_agent else [arrival.time for arrival in one.arrivals or ()]
        found += [(time, packet, each) for time in times for event in events for each in _of(time, event)]
    return [each for _, _, each in sorted(found, key=lambda row: row[:2])]


def _of(time: int, event: SubmessageEvent) -> Iterator[_SentAcknack | _ReceivedMessage]:
    fields = event.fields
    if event.kind is SubmessageKind.CREATE_CLIENT:
        yield _ReceivedMessage(time, 0, False, False, begins=True)
    elif event.to_agent:
        if (
            event.kind is SubmessageKind.ACKNACK
            and fields["subject"] == FIRST_RELIABLE_STREAM
            and isinstance(fields["missing"], list)
        ):
            yield _SentAcknack(time, int(str(fields["first"])), frozenset(fields["missing"]))
    elif event.kind is SubmessageKind.HEARTBEAT and fields["subject"] == FIRST_RELIABLE_STREAM:
        yield _ReceivedMessage(time, int(str(fields["last"])), False, False)
    elif event.stream == FIRST_RELIABLE_STREAM and event.sequence is not None and event.place == 0:
        yield _ReceivedMessage(time, event.sequence, True, event.kind is SubmessageKind.FRAGMENT and not fields["last"])


def _differences(stream: Sequence[_SentAcknack | _ReceivedMessage], size: int) -> int:
    """The number of ACKNACKs that a client with ``size`` slots would not have sent."""
    client, waiting, wrong = _InputStream(size), deque[_ReceivedMessage](), 0
    sleeps = _unanswered(stream) > 0
    for each in stream:
        if isinstance(each, _ReceivedMessage):
            waiting.append(each)
            continue
        while waiting and (waiting[0].begins or (sleeps and each.time - waiting[0].time > _ASLEEP)):
            if waiting.popleft().begins:
                client = _InputStream(size)
        if waiting:
            client.receive(waiting.popleft())
            wrong += (each.first, each.missing) != client.acknack()
    return wrong


class _InputStream:
    """The input stream of a client (uxr_receive_reliable_message, uxr_compute_acknack)."""

    def __init__(self, size: int) -> None:
        self._size = size
        self._handled = 0
        self._announced = 0
        self._slots: dict[int, bool] = {}

    def receive(self, received: _ReceivedMessage) -> None:
        number = nearest_number(received.number, self._handled)
        if received.is_message and self._handled <= number < self._handled + self._size:
            self._slots.setdefault(number % self._size, received.is_piece)
        self._announced = max(self._announced, number + 1)
        while together := self._complete():
            for _ in range(together):
                del self._slots[self._handled % self._size]
                self._handled += 1

    def _complete(self) -> int:
        """The number of messages that are handed over together: one, or all pieces of a larger one."""
        for count in range(self._size):
            is_piece = self._slots.get((self._handled + count) % self._size)
            if is_piece is not True:
                return 0 if is_piece is None else count + 1
        return 0

    def acknack(self) -> tuple[int, frozenset[int]]:
        first = self._handled
        while first % self._size in self._slots and first < self._handled + self._size:
            first += 1
        named = range(first, min(self._announced, first + 16))
        return first % 65536, frozenset(n % 65536 for n in named if n % self._size not in self._slots)
