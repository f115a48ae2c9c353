"""Messages on their way: who sent each of them, when, and whether it arrived.

Where a relay between a client and the Agent was recorded on both sides, a message that got through is in the capture
twice, and one that was lost is there once. Elsewhere that is not known.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cached_property
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from typing import BinaryIO, Final

import numpy as np

from tachk.base.records import dataclass
from tachk.xrce.capture_decoder import CaptureDecoder
from tachk.xrce.datagrams import Datagrams, Flags, datagrams
from tachk.xrce.events import DEFAULT_PORT, SubmessageEvent, events
from tachk.xrce.joined_submessages import joined
from tachk.xrce.legs import Leg, Legs, MessageColumns, with_ends
from tachk.xrce.matching import matched
from tachk.xrce.messages import Endpoint
from tachk.xrce.packed_transmissions import PackedTransmissions
from tachk.xrce.packets import CaptureError, Numbers, read_packets
from tachk.xrce.serial_line import SerialDecoder
from tachk.xrce.serial_repair import repaired
from tachk.xrce.submessages import Submessages
from tachk.xrce.transmission import Link, ReadTransmission, TransmissionArrival
from tachk.xrce.wire import COOKIE, SubmessageKind

_FEW: Final = 10_000


@dataclass(frozen=True)
class Capture:
    """Attributes:
    links: in the order in which they began.
    transmissions: in the order in which they were sent.
    problem: why the capture ends too early; empty if it does not.
    """

    links: tuple[Link, ...]
    transmissions: PackedTransmissions
    problem: str = ""

    @property
    def begin(self) -> int:
        return self.transmissions[0].sent if self.transmissions else 0

    @cached_property
    def end(self) -> int:
        return self.transmissions.last_time


def read_transmissions(path: Path, ports: Iterable[int] = ()) -> Capture:
    """The messages of a capture, put together where a relay was recorded on both sides.

    Args:
        ports: of Agents and relays; without any 8888 and wherever a session is created, and if there is nothing by
            these, the frames of a serial line. A damaged frame is a message that was lost; what it was is known where
            only one message differs from it in one byte (`serial_repair`).

    Raises CaptureError for what is not a capture, OSError for a file that cannot be read.
    """
    found = open_transmissions(path, ports)
    return Capture(found.links, found.packed(), found.problem)


def open_transmissions(path: Path, ports: Iterable[int] = ()) -> Transmissions:
    """The same, to be read one by one, as often as one likes: of a long capture only what is needed stays in memory."""
    given = set(ports)
    wanted = given
    if not given:
        with path.open("rb") as stream:
            wanted = {DEFAULT_PORT, *session_ports(stream)}
    found = _of_network(path, wanted)
    return found if len(found) or given else _of_serial_line(path)


def _of_network(path: Path, ports: set[int]) -> Transmissions:
    legs = Legs()
    with path.open("rb") as stream:
        decoder = CaptureDecoder(stream, ports)
        for piece in decoder.pieces():
            legs.add(piece, decoder.endpoints, frozenset())

    def again() -> Iterator[NumberedPiece]:
        with path.open("rb") as stream:
            decoder = CaptureDecoder(stream, ports)
            first = 0
            for piece in decoder.pieces():
                known = with_ends(piece)
                yield NumberedPiece(piece, decoder.endpoints, np.where(known, np.cumsum(known) - 1 + first, -1))
                first += int(known.sum())

    return _together(legs.all(), decoder.problem, legs.messages, again)


def _of_serial_line(path: Path) -> Transmissions:
    """Whose times may be those of reading, so that it is read once."""
    legs = Legs()
    held: list[NumberedPiece] = []
    with path.open("rb") as stream:
        decoder = SerialDecoder(stream, repair=repaired)
        for piece in decoder.pieces():
            numbers = legs.add(piece, decoder.endpoints, decoder.dropped)
            held.append(NumberedPiece(piece, decoder.endpoints, numbers))
    return _together(_on_one_line(legs.all()), decoder.problem, legs.messages, lambda: iter(held))


@dataclass(frozen=True, slots=True)
class NumberedPiece:
    """A piece of a capture.

    Attributes:
        endpoints: those of the messages, by number.
        numbers: of each message its number in the capture, -1 for those that are left out.
    """

    found: Submessages
    endpoints: list[Endpoint]
    numbers: Numbers

    def chosen(self, wanted: Flags) -> Flags:
        """For each message whether it is wanted; ``wanted`` says so by number."""
        return (self.numbers >= 0) & wanted[self.numbers]

    def events(self, wanted: Flags) -> Iterator[tuple[int, tuple[SubmessageEvent, ...]]]:
        """The numbers of messages that are wanted, and their submessages."""
        entries = np.flatnonzero(self.chosen(wanted)[self.found.message])
        numbers = self.numbers[self.found.message[entries]].tolist()
        found = zip(numbers, events(self.found, self.endpoints, entries), strict=True)
        for number, inside in groupby(found, itemgetter(0)):
            yield number, tuple([event for _, event in inside])


def _on_one_line(legs: list[Leg]) -> list[Leg]:
    """With the messages of addresses that have no session as those of the client that has one: the CRC of a frame does
    not cover its addresses, so they may be damaged."""
    clients = [leg for leg in legs if leg.creation is not None]
    if len(clients) != 1:
        return legs
    (client,) = clients
    client.take(leg for leg in legs if leg is not client)
    return clients


@dataclass(frozen=True, slots=True)
class Transmissions:
    """The transmissions of a capture, in the order in which they were sent.

    Attributes:
        links, problem: as in `Capture`.
        rows: of each the number of its message, the number of its link, whether the client sent it, and how many
            arrivals it has; -1 if nobody looked.
        arrivals: of all of them, one behind the other: the times and the packets.
        messages: how many messages there are in the capture.
        again: reads the messages once more.
    """

    links: tuple[Link, ...]
    problem: str
    rows: Numbers
    arrivals: Numbers
    messages: int
    again: Callable[[], Iterator[NumberedPiece]]

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[ReadTransmission]:
        wanted = self._wanted()
        read = (each for piece in self.again() for each in piece.events(wanted))
        early: dict[int, tuple[SubmessageEvent, ...]] = {}
        first = 0
        for number, link, to_agent, count in _rows(self.rows):
            while number not in early:
                other, inside = next(read)
                early[other] = inside
            inside = early.pop(number)
            seen = None
            if count >= 0:
                places = self.arrivals[first : first + count].tolist()
                seen = tuple(TransmissionArrival(time, packet) for time, packet in places)
                first += count
            yield ReadTransmission(link, to_agent != 0, inside[0].time, inside[0].packet, seen, inside)

    def _wanted(self) -> Flags:
        """By the number of a message, whether it is one of them."""
        wanted = np.zeros(max(self.messages, 1), np.bool_)
        wanted[self.rows[:, 0]] = True
        return wanted

    def packed(self) -> PackedTransmissions:
        """All of them at once, as columns."""
        wanted = self._wanted()
        endpoints: list[Endpoint] = []

        def pieces() -> Iterator[tuple[Submessages, Flags]]:
            nonlocal endpoints
            for piece in self.again():
                endpoints = piece.endpoints
                yield piece.found, piece.chosen(wanted)

        return PackedTransmissions(self.rows, self.arrivals, joined(pieces()), endpoints)


def _rows(rows: Numbers) -> Iterator[list[int]]:
    """Some thousand at a time become Python's numbers."""
    for first in range(0, len(rows), _FEW):
        yield from rows[first : first + _FEW].tolist()


def _together(
    legs: Sequence[Leg], problem: str, messages: int, again: Callable[[], Iterator[NumberedPiece]]
) -> Transmissions:
    left = list(legs)
    links: list[Link] = []
    sent: list[_SentColumns] = []
    while left:
        near = left.pop(0)
        far = next((other for other in left if near.is_before(other)), None)
        if far is not None:
            later = [leg for leg in left if leg.goes_on(near, legs)]
            left = [leg for leg in left if leg not in later]
            near.take(later)
        number = len(links)
        if far is None:
            links.append(Link(near.client, near.agent, near.key, None))
            sent.append(_seen_once(number, near.columns()))
            continue
        left.remove(far)
        links.append(Link(near.client, far.agent, near.key, near.agent))
        ours, theirs = near.columns(), far.columns()
        for to_agent, (begin, end) in {True: (ours, theirs), False: (theirs, ours)}.items():
            before, behind = (each.where(each.to_agent == to_agent) for each in (begin, end))
            sent += _passed(number, to_agent, before, behind)
    return Transmissions(tuple(links), problem, *_in_order(sent), messages, again)


@dataclass(frozen=True, slots=True)
class _SentColumns:
    """Transmissions of a link: their packets, the rows of `Transmissions`, and their arrivals behind one another."""

    packets: Numbers
    rows: Numbers
    arrivals: Numbers


def _columns_of(link: int, to_agent: Flags | bool, messages: MessageColumns, counts: Numbers) -> Numbers:
    size = len(messages.numbers)
    columns = messages.numbers, np.broadcast_to(link, size), np.broadcast_to(to_agent, size), counts
    return np.stack([column.astype(np.int32) for column in columns], axis=1)


_NO_ARRIVAL: Final = np.zeros((0, 2), np.int64)


def _seen_once(link: int, messages: MessageColumns) -> _SentColumns:
    counts = np.where(messages.dropped, 0, -1)
    return _SentColumns(messages.packets, _columns_of(link, messages.to_agent, messages, counts), _NO_ARRIVAL)


def _passed(link: int, to_agent: bool, before: MessageColumns, behind: MessageColumns) -> Iterator[_SentColumns]:
    """Messages before a relay with those behind it that have the same bytes.

    What comes out and never went in counts as sent there.
    """
    found = matched(before, behind)
    unsent = behind.where(found.unsent)
    once = _columns_of(link, to_agent, unsent, np.ones(len(unsent.numbers), np.int64))
    yield _SentColumns(unsent.packets, once, np.stack([unsent.times, unsent.packets], axis=1))
    counts = np.bincount(found.arrivals[:, 0], minlength=len(before.numbers))
    arrived = found.arrivals[:, 1]
    places = np.stack([behind.times[arrived], behind.packets[arrived]], axis=1)
    yield _SentColumns(before.packets, _columns_of(link, to_agent, before, counts), places)


def _in_order(sent: Sequence[_SentColumns]) -> tuple[Numbers, Numbers]:
    """All rows in the order of packets, and their arrivals in the same order."""
    if not sent:
        return np.zeros((0, 4), np.int64), _NO_ARRIVAL
    rows = np.concatenate([each.rows for each in sent])
    arrivals = np.concatenate([each.arrivals for each in sent])
    order = np.argsort(np.concatenate([each.packets for each in sent]), kind="stable")
    counts = np.maximum(rows[:, 3], 0)
    first = (np.cumsum(counts) - counts)[order]
    rows, counts = rows[order], counts[order]
    within = np.arange(len(arrivals)) - np.repeat(np.cumsum(counts) - counts, counts)
    return rows, arrivals[np.repeat(first, counts) + within]


def session_ports(stream: BinaryIO) -> set[int]:
    """The ports to which CREATE_CLIENT is sent. Raises CaptureError for what is not a capture."""
    ports: set[int] = set()
    any_packet = False
    try:
        for packets in read_packets(stream):
            any_packet = True
            ports |= _created(datagrams(packets))
    except CaptureError:
        if not any_packet:
            raise
    return ports


def _created(found: Datagrams) -> set[int]:
    ports = set[int]()
    begin, long_enough = found.starts, found.sizes >= 20
    for header in (4, 6, 8, 10):  # without and with a key, by UDP and by TCP
        created = long_enough & (found.octets.take(begin + header, mode="clip") == SubmessageKind.CREATE_CLIENT)
        for number, octet in enumerate(COOKIE, header + 4):
            created &= found.octets.take(begin + number, mode="clip") == octet
        ports |= set(found.destination_ports[created].tolist())
    return ports
