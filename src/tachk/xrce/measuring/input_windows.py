"""The number of slots of the input stream of a client: the number that explains its ACKNACKs.

No message contains it. A message too far ahead is dropped and yet named as missing, and the bitmap of an ACKNACK is
about slots, so a client with few slots sends other ACKNACKs than one with many, once enough is missing.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from enum import IntEnum
from typing import Final

import numpy as np

from tachk.base.records import dataclass
from tachk.xrce.joined_submessages import places_in
from tachk.xrce.measuring.conversation import rows_of
from tachk.xrce.measuring.quantity import Confidence
from tachk.xrce.measuring.settings import Setting
from tachk.xrce.packets import Numbers
from tachk.xrce.streams import nearest_number
from tachk.xrce.transmissions import Capture
from tachk.xrce.wire import FIRST_RELIABLE_STREAM, LAST_FRAGMENT, SubmessageKind

_OF_STREAMS: Final = (SubmessageKind.CREATE_CLIENT, SubmessageKind.ACKNACK, SubmessageKind.HEARTBEAT)
_NOTHING: Final = -1
_SIZES: Final = (2, 4, 8, 16, 32)
_USUAL: Final = 16
"""The assumption of models: the Agent has no more under way."""
_ASLEEP: Final = 100_000_000
"""Nanoseconds after which a packet without answer is gone, where a client does not answer all of them."""


def unanswered(recording: Capture) -> int:
    """The number of packets that clients did not read. A client answers each that it reads, in their order."""
    return sum(_at_client(recording, link).unanswered() for link in range(len(recording.links)))


def input_history(recordings: Iterable[Capture]) -> Iterator[Setting]:
    """The setting, if ACKNACKs distinguish the numbers of slots."""
    wrong = dict.fromkeys(_SIZES, 0)
    for recording in recordings:
        for link in range(len(recording.links)):
            for size, count in _differences(_at_client(recording, link)).items():
                wrong[size] += count
    best = min(wrong.values())
    fitting = [size for size in _SIZES if wrong[size] == best]
    if _USUAL not in fitting:
        margin = wrong[_USUAL] - best
        how = f"{margin} ACKNACKs of clients are those of a window of {fitting[-1]}, and of no window of {_USUAL}"
        confidence = Confidence.MEASURED if margin > 1 else Confidence.ONE_SAMPLE
        yield Setting("INPUT_HISTORY", fitting[-1], False, confidence, how)


class _ClientEvent(IntEnum):
    """An ACKNACK that the client sends; or what comes to it: the beginning of a session, a HEARTBEAT, a message with a
    piece of a larger one that is not the last, or another message."""

    ACKNACK = 0
    BEGINS = 1
    HEARTBEAT = 2
    PIECE = 3
    MESSAGE = 4


@dataclass(frozen=True, slots=True)
class _AtClient:
    """What a client sends and gets, in the order of ``times``; an entry for each in every column.

    Attributes:
        kinds: a `_ClientEvent`.
        numbers: the first of an ACKNACK, the last of a HEARTBEAT, that of a message.
        bitmaps: of an ACKNACK.
    """

    times: Numbers
    kinds: Numbers
    numbers: Numbers
    bitmaps: Numbers

    def unanswered(self) -> int:
        """How many packets the client did not read before its last ACKNACK."""
        answers = np.flatnonzero(self.kinds == _ClientEvent.ACKNACK)
        received = self.kinds[: answers[-1]] > _ClientEvent.BEGINS if len(answers) else answers
        return max(int(np.count_nonzero(received)) - len(answers), 0)


def _at_client(recording: Capture, link: int) -> _AtClient:
    """Without entries where arrivals were not observed."""
    sent = recording.transmissions
    found = sent.submessages
    rows = sent.rows(link)
    rows = rows[sent.is_reliable[rows] | sent.having(rows, *_OF_STREAMS)]
    number = places_in(sent.first_events[rows], sent.event_counts[rows])
    row = np.repeat(rows, sent.event_counts[rows])
    to_agent, kind = sent.to_agent[row], found.kind[number]
    about = found.subject[number] == FIRST_RELIABLE_STREAM
    ours = (sent.stream[row] == FIRST_RELIABLE_STREAM) & (sent.sequence[row] >= 0) & (found.place[number] == 0)
    is_piece = (kind == SubmessageKind.FRAGMENT) & (found.flags[number] & LAST_FRAGMENT == 0)
    cases = {
        _ClientEvent.BEGINS: kind == SubmessageKind.CREATE_CLIENT,
        _ClientEvent.ACKNACK: to_agent & (kind == SubmessageKind.ACKNACK) & about,
        _NOTHING: to_agent,
        _ClientEvent.HEARTBEAT: (kind == SubmessageKind.HEARTBEAT) & about,
        _ClientEvent.PIECE: ours & is_piece,
        _ClientEvent.MESSAGE: ours,
    }
    kinds = np.select(list(cases.values()), list(cases), _NOTHING)
    said = np.select(
        [kinds == _ClientEvent.ACKNACK, kinds == _ClientEvent.HEARTBEAT, kinds >= _ClientEvent.PIECE],
        [found.first[number], found.last[number], sent.sequence[row]],
    )
    matters = kinds != _NOTHING
    entry = np.flatnonzero(matters)
    counts = np.where(to_agent[entry], 1, sent.counts[row[entry]])
    entry = np.repeat(entry, counts)
    times = sent.sent[row[entry]]
    arrives = ~to_agent[entry]
    within = np.arange(len(entry)) - np.repeat(np.cumsum(counts) - counts, counts)
    times[arrives] = sent.arrivals[(sent.first_arrivals[row[entry]] + within)[arrives], 0]
    order = np.lexsort((within, row[entry], times))
    entry = entry[order]
    return _AtClient(times[order], kinds[entry], said[entry], found.bitmap[number[entry]])


def _answered(stream: _AtClient) -> Iterator[tuple[int, int, int, int]]:
    """What a client reads, and the first number and the bitmap of the ACKNACK with which it answers."""
    sleeps = stream.unanswered() > 0
    waiting = deque[tuple[int, int, int]]()
    for time, kind, number, bitmap in rows_of(stream.times, stream.kinds, stream.numbers, stream.bitmaps):
        if kind != _ClientEvent.ACKNACK:
            waiting.append((time, kind, number))
            continue
        while waiting and (waiting[0][1] == _ClientEvent.BEGINS or (sleeps and time - waiting[0][0] > _ASLEEP)):
            if waiting.popleft()[1] == _ClientEvent.BEGINS:
                yield _ClientEvent.BEGINS, 0, 0, 0
        if waiting:
            _, read, received = waiting.popleft()
            yield read, received, number, bitmap


def _differences(stream: _AtClient) -> dict[int, int]:
    """By the number of slots, how many ACKNACKs a client with so many would not have sent.

    Mostly each message is the next one. As long as it is, the slots stay empty, and their number makes no difference:
    ``handled`` is the next number then, and there is no ``client``.
    """
    wrong = dict.fromkeys(_SIZES, 0)
    clients: list[_InputStream] = []
    handled = together = 0
    for kind, number, first, bitmap in _answered(stream):
        if kind == _ClientEvent.BEGINS:
            clients, handled = [], 0
            continue
        if not clients:
            ahead = nearest_number(number, handled) - handled
            if ahead < 0 or (ahead == 0 and kind == _ClientEvent.MESSAGE):
                handled += ahead == 0
                together += first != handled % 65536 or bitmap != 0
                continue
            clients = [_InputStream(size, handled) for size in _SIZES]
        for client in clients:
            client.receive(kind, number)
            wrong[client.size] += (first, bitmap) != client.acknack()
        if len({client.handled for client in clients}) == 1 and all(client.lacks_nothing() for client in clients):
            handled, clients = clients[0].handled, []
    return {size: count + together for size, count in wrong.items()}


class _InputStream:
    """The input stream of a client (uxr_receive_reliable_message, uxr_compute_acknack)."""

    def __init__(self, size: int, handled: int) -> None:
        self.size = size
        self.handled = handled
        self._announced = handled
        self._slots: dict[int, bool] = {}

    def receive(self, kind: int, number: int) -> None:
        number = nearest_number(number, self.handled)
        if kind != _ClientEvent.HEARTBEAT and self.handled <= number < self.handled + self.size:
            self._slots.setdefault(number % self.size, kind == _ClientEvent.PIECE)
        self._announced = max(self._announced, number + 1)
        while together := self._complete():
            for _ in range(together):
                del self._slots[self.handled % self.size]
                self.handled += 1

    def _complete(self) -> int:
        """The number of messages that are handed over together: one, or all pieces of a larger one."""
        for count in range(self.size):
            is_piece = self._slots.get((self.handled + count) % self.size)
            if is_piece is not True:
                return 0 if is_piece is None else count + 1
        return 0

    def lacks_nothing(self) -> bool:
        """True if no slot is in use, and nothing else has been announced."""
        return not self._slots and self._announced <= self.handled

    def acknack(self) -> tuple[int, int]:
        """The first number, and the bitmap."""
        first = self.handled
        while first % self.size in self._slots and first < self.handled + self.size:
            first += 1
        named = range(first, min(self._announced, first + 16))
        return first % 65536, sum(1 << n - first for n in named if n % self.size not in self._slots)
