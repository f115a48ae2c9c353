"""Messages on their way: who sent each of them, when, and whether it arrived.

Where a relay between a client and the Agent was recorded on both sides, a message that got through is in the capture
twice, and one that was lost is there once. Elsewhere that is not known.
"""

from __future__ import annotations

from bisect import bisect_left
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from pathlib import Path
from typing import BinaryIO, Final

from tachk.base.records import dataclass
from tachk.xrce.capture_decoder import CaptureDecoder
from tachk.xrce.datagrams import Datagrams, datagrams
from tachk.xrce.events import DEFAULT_PORT, SubmessageEvent, events
from tachk.xrce.messages import Endpoint
from tachk.xrce.packets import CaptureError, read_packets
from tachk.xrce.serial_line import SerialDecoder
from tachk.xrce.serial_repair import repaired
from tachk.xrce.wire import COOKIE, SESSION_IDS_NONE, SubmessageKind

_LONGEST_RELAY: Final = 5_000_000_000
"""Nanoseconds from a CREATE_CLIENT to its copy behind a relay."""


@dataclass(frozen=True, slots=True)
class Link:
    """The way between a client and the Agent.

    Attributes:
        client: its endpoint, at the side of the client.
        agent: the Agent's, at the side of the Agent.
        key: of the client, as its CREATE_CLIENT says; empty if that is not in the capture.
        relay: the endpoint that the client takes for the Agent where both sides of a relay are recorded.
    """

    client: Endpoint
    agent: Endpoint
    key: str
    relay: Endpoint | None

    @property
    def name(self) -> str:
        return f"client {self.key}" if self.key else f"client {self.client}"


@dataclass(frozen=True, slots=True)
class TransmissionArrival:
    """``time`` in nanoseconds since the epoch, ``packet`` the number in the capture."""

    time: int
    packet: int


@dataclass(frozen=True, slots=True)
class Transmission:
    """A message that was sent once.

    Attributes:
        link: the index of its link.
        to_agent: whether the client sent it.
        sent, packet: when it left its sender, in nanoseconds since the epoch, and in which packet.
        arrivals: where it was seen behind the relay, several times if it was duplicated, never if it was lost; None if
            nobody looked.
        events: its submessages.
    """

    link: int
    to_agent: bool
    sent: int
    packet: int
    arrivals: tuple[TransmissionArrival, ...] | None
    events: tuple[SubmessageEvent, ...]

    @property
    def is_lost(self) -> bool:
        return self.arrivals == ()

    @property
    def arrived(self) -> int:
        """The time of its arrival, if that is known; of a lost one the time when it was sent."""
        return self.arrivals[0].time if self.arrivals else self.sent


@dataclass(frozen=True)
class Capture:
    """Attributes:
    links: in the order in which they began.
    transmissions: in the order in which they were sent.
    problem: why the capture ends too early; empty if it does not.
    """

    links: tuple[Link, ...]
    transmissions: tuple[Transmission, ...]
    problem: str = ""

    @property
    def begin(self) -> int:
        return self.transmissions[0].sent if self.transmissions else 0

    @cached_property
    def end(self) -> int:
        return max((t.arrivals[-1].time if t.arrivals else t.sent for t in self.transmissions), default=0)


def read_transmissions(path: Path, ports: Iterable[int] = ()) -> Capture:
    """The messages of a capture, put together where a relay was recorded on both sides.

    Args:
        ports: of Agents and relays; without any 8888 and wherever a session is created, and if there is nothing by
            these, the frames of a serial line. A damaged frame is a message that was lost; what it was is known where
            only one message differs from it in one byte (`serial_repair`).

    Raises CaptureError for what is not a capture, OSError for a file that cannot be read.
    """
    wanted = set(ports)
    if not wanted:
        with path.open("rb") as stream:
            wanted = {DEFAULT_PORT, *session_ports(stream)}
    with path.open("rb") as stream:
        network = CaptureDecoder(stream, wanted)
        found = _recording(_legs(network), network.problem)
    if found.transmissions or set(ports):
        return found
    with path.open("rb") as stream:
        decoder = SerialDecoder(stream, repair=repaired)
        return _recording(_on_one_line(_legs(decoder)), decoder.problem)


def _legs(decoder: CaptureDecoder | SerialDecoder) -> list[_Leg]:
    legs: dict[tuple[Endpoint, Endpoint], _Leg] = {}
    for message in _messages(decoder):
        legs.setdefault((message.client, message.agent), _Leg(message.client, message.agent)).add(message)
    return list(legs.values())


def _on_one_line(legs: list[_Leg]) -> list[_Leg]:
    """With the messages of addresses that have no session as those of the client that has one: the CRC of a frame does
    not cover its addresses, so they may be damaged."""
    clients = [leg for leg in legs if leg.creation is not None]
    if len(clients) != 1:
        return legs
    (client,) = clients
    client.take(leg for leg in legs if leg is not client)
    return clients


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
    ports = set()
    for start, size, port in zip(
        found.starts.tolist(), found.sizes.tolist(), found.destination_ports.tolist(), strict=True
    ):
        if port in ports or size < 20:
            continue
        octets = found.octets[start : start + 20].tobytes()
        if any(
            octets[at] == SubmessageKind.CREATE_CLIENT and octets[at + 4 : at + 8] == COOKIE for at in (4, 6, 8, 10)
        ):
            ports.add(port)
    return ports


@dataclass(frozen=True, slots=True)
class _PacketMessage:
    """A message as one packet has it; ``dropped``: its receiver did not take it."""

    client: Endpoint
    agent: Endpoint
    to_agent: bool
    time: int
    packet: int
    octets: bytes
    events: tuple[SubmessageEvent, ...]
    dropped: bool = False


def _messages(decoder: CaptureDecoder | SerialDecoder) -> Iterator[_PacketMessage]:
    for found in decoder.pieces():
        messages = found.messages
        dropped = decoder.dropped if isinstance(decoder, SerialDecoder) else frozenset()
        of_message: dict[int, list[SubmessageEvent]] = defaultdict(list)
        for number, event in zip(found.message.tolist(), events(found, decoder.endpoints), strict=True):
            of_message[number].append(event)
        for number, inside in of_message.items():
            first = inside[0]
            start, size = int(messages.starts[number]), int(messages.sizes[number])
            if first.client is not None and first.agent is not None:
                octets = messages.octets[start : start + size].tobytes()
                yield _PacketMessage(
                    first.client,
                    first.agent,
                    first.to_agent,
                    first.time,
                    first.packet,
                    octets,
                    tuple(inside),
                    number in dropped,
                )


class _Leg:
    """The packets that one capture point saw between two endpoints."""

    def __init__(self, client: Endpoint, agent: Endpoint) -> None:
        self.client = client
        self.agent = agent
        self.messages: list[_PacketMessage] = []

    def add(self, message: _PacketMessage) -> None:
        self.messages.append(message)

    @cached_property
    def creation(self) -> _PacketMessage | None:
        """The first CREATE_CLIENT."""
        return next(
            (m for m in self.messages if m.to_agent and any(e.kind is SubmessageKind.CREATE_CLIENT for e in m.events)),
            None,
        )

    @property
    def key(self) -> str:
        if self.creation is None:
            return ""
        return next(str(e.fields["key"]) for e in self.creation.events if e.kind is SubmessageKind.CREATE_CLIENT)

    @cached_property
    def session(self) -> int | None:
        """As the client says in the headers of its messages; None if it says none."""
        said = (e.session for m in self.messages if m.to_agent for e in m.events if e.session is not None)
        return next((one for one in said if one not in SESSION_IDS_NONE), None)

    def goes_on(self, other: _Leg, legs: Sequence[_Leg]) -> bool:
        """True if the client of the other leg, whose relay was recorded on both sides, has got this address later: the
        messages have its session, come to the same port of the relay, and it is the only client with it there."""
        here = [leg for leg in legs if leg.agent == self.agent and leg.session == self.session and leg.creation]
        begins = self.messages[0]
        later = begins.to_agent and begins.packet > other.messages[0].packet
        return later and self.creation is None and self.session is not None and here == [other]

    def take(self, others: Iterable[_Leg]) -> None:
        """Has their messages, too."""
        messages = [*self.messages, *(message for leg in others for message in leg.messages)]
        self.messages = sorted(messages, key=lambda message: message.packet)

    def is_before(self, other: _Leg) -> bool:
        """True if a relay passes messages of this leg on to the other one."""
        ours, theirs = self.creation, other.creation
        return (
            ours is not None
            and theirs is not None
            and self.agent != other.agent
            and ours.octets == theirs.octets
            and 0 <= theirs.time - ours.time < _LONGEST_RELAY
        )


def _recording(legs: Sequence[_Leg], problem: str) -> Capture:
    left = list(legs)
    links: list[Link] = []
    sent: list[Transmission] = []
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
            sent += [_seen_once(number, message) for message in near.messages]
            continue
        left.remove(far)
        links.append(Link(near.client, far.agent, near.key, near.agent))
        for to_agent, (begin, end) in {True: (near, far), False: (far, near)}.items():
            before, behind = ([m for m in leg.messages if m.to_agent == to_agent] for leg in (begin, end))
            sent += _matched(number, before, behind)
    return Capture(tuple(links), tuple(sorted(sent, key=lambda one: one.packet)), problem)


def _seen_once(link: int, message: _PacketMessage) -> Transmission:
    arrivals = () if message.dropped else None
    return Transmission(link, message.to_agent, message.time, message.packet, arrivals, message.events)


def _matched(link: int, before: Sequence[_PacketMessage], behind: Sequence[_PacketMessage]) -> Iterator[Transmission]:
    """Messages before a relay with those behind it that have the same bytes.

    What comes out and never went in counts as sent there.
    """
    entered: dict[bytes, list[int]] = defaultdict(list)
    left: dict[bytes, list[_PacketMessage]] = defaultdict(list)
    for number, message in enumerate(before):
        entered[message.octets].append(number)
    for message in behind:
        left[message.octets].append(message)
    arrivals: list[list[TransmissionArrival]] = [[] for _ in before]
    for octets, numbers in entered.items():
        for number, message in _equal_ones(before, numbers, left[octets]):
            arrivals[number].append(TransmissionArrival(message.time, message.packet))
    for message in behind:
        if message.octets not in entered:
            arrival = TransmissionArrival(message.time, message.packet)
            yield Transmission(link, message.to_agent, message.time, message.packet, (arrival,), message.events)
    for message, found in zip(before, arrivals, strict=True):
        seen = tuple(sorted(found, key=lambda arrival: arrival.packet))
        yield Transmission(link, message.to_agent, message.time, message.packet, seen, message.events)


def _equal_ones(
    before: Sequence[_PacketMessage], numbers: Sequence[int], behind: Sequence[_PacketMessage]
) -> Iterator[tuple[int, _PacketMessage]]:
    """Matches messages with the same bytes that came out with those that went in.

    Only the time distinguishes them. If there are not more than went in, the last that came out is the last that had
    gone in, and so on, which makes the delays as short as they can be in this order. Else the first that came out is
    the first that had gone in, and so on, and the rest are copies: each of the last that had gone in.
    """
    entered = [before[number].packet for number in numbers]
    if len(behind) <= len(numbers):
        free = len(numbers)
        for message in reversed(behind):
            free = min(bisect_left(entered, message.packet), free) - 1
            if free < 0:
                return
            yield numbers[free], message
        return
    waiting = 0
    for message in behind:
        at = bisect_left(entered, message.packet)
        if waiting < at:
            yield numbers[waiting], message
            waiting += 1
        elif at:
            yield numbers[at - 1], message
