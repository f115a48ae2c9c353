"""Messages between clients and the Agent in the datagrams and segments of a capture.

UDP carries one message a datagram. TCP carries two bytes of length, little-endian, before each message.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from ipaddress import IPv6Address
from typing import Final

import numpy as np

from tachk.base.records import dataclass, field
from tachk.xrce import wire
from tachk.xrce.datagrams import TCP, Datagrams, Flags
from tachk.xrce.packets import Numbers, Octets
from tachk.xrce.wire import SubmessageKind

_SYN: Final = 0x02
_MOST_WAITING: Final = 1 << 20
"""The number of bytes after a gap from which it is given up: the segment was not captured."""

Found = list[tuple[bytes, int]]
"""Messages, each with the number of its bytes that were not captured."""


class TcpStream:
    """Puts segments in order and drops repeated bytes. Behind a gap a segment is taken to begin with a message."""

    def __init__(self) -> None:
        self._begin(None)

    def _begin(self, number: int | None) -> None:
        self._next = number
        self._waiting: dict[int, bytes] = {}
        self._octets = bytearray()

    def push(self, number: int, octets: bytes, missing: int, flags: int) -> Found:
        """The messages that a segment completes.

        Args:
            number: its sequence number.
            missing: how many bytes of it were not captured.
            flags: those of its header.
        """
        if flags & _SYN:
            found = self.close()
            self._begin((number + 1) % 2**32)
            return found
        if octets and (self._next is None or self._ahead(number) + len(octets) > 0):
            self._next = number if self._next is None else self._next
            self._waiting[number] = max(octets, self._waiting.get(number, b""), key=len)
        found = self._messages()
        if missing or sum(map(len, self._waiting.values())) > _MOST_WAITING:
            return found + self.close()
        return found

    def close(self) -> Found:
        """The messages that have begun and can no longer be completed; reading may go on behind them."""
        found: Found = []
        while self._waiting or self._octets:
            if self._octets:
                size = int.from_bytes(self._octets[:2], "little")
                found.append((bytes(self._octets[2:]), max(size + 2 - len(self._octets), 1)))
                self._octets.clear()
            elif self._waiting:
                found.append((b"", self._ahead(min(self._waiting, key=self._ahead))))
            if self._waiting:
                self._next = min(self._waiting, key=self._ahead)
                found += self._messages()
        self._next = None
        return found

    def _messages(self) -> Found:
        self._join()
        found: Found = []
        while len(self._octets) >= 2:
            size = int.from_bytes(self._octets[:2], "little")
            if len(self._octets) < 2 + size:
                break
            found.append((bytes(self._octets[2 : 2 + size]), 0))
            del self._octets[: 2 + size]
        return found

    def _join(self) -> None:
        """Takes the segments that follow what is there."""
        while self._waiting:
            number = min(self._waiting, key=self._ahead)
            ahead = self._ahead(number)
            if ahead > 0:
                return
            octets = self._waiting.pop(number)[-ahead:] if ahead else self._waiting.pop(number)
            self._octets += octets
            assert self._next is not None
            self._next = (self._next + len(octets)) % 2**32

    def _ahead(self, number: int) -> int:
        """The distance of a number from the expected one."""
        assert self._next is not None
        return (number - self._next + 2**31) % 2**32 - 2**31


_LENGTH: Final = 2
"""Bytes of length before a message by TCP."""
_MOST_HELD: Final = 1024
"""The number of possible connections to an Agent whose lengths are remembered."""


@dataclass(frozen=True, slots=True)
class Endpoint:
    """Attributes:
    host: an address of IPv4 or IPv6, or what stands for one: ``serial``.
    port: the port, or the address on a serial line.
    """

    host: str
    port: int

    def __str__(self) -> str:
        return f"[{self.host}]:{self.port}" if ":" in self.host else f"{self.host}:{self.port}"


@dataclass(frozen=True, slots=True)
class Messages:
    """Messages in the order in which they were complete; one entry for each in every column but ``octets``.

    Attributes:
        octets: the bytes that hold them all.
        packets: the number of the packet that completes it.
        times: nanoseconds since the epoch.
        clients, agents: numbers of endpoints in `MessageReader.endpoints`.
        to_agent: whether the client sent it.
        starts, sizes: where it is in ``octets``.
        missing: how many bytes of it were not captured, or lost.
        problems: by entry, why its receiver drops it; such an entry has no bytes.
    """

    octets: Octets
    packets: Numbers
    times: Numbers
    clients: Numbers
    agents: Numbers
    to_agent: Flags
    starts: Numbers
    sizes: Numbers
    missing: Numbers
    problems: Mapping[int, str] = field(default_factory=dict)


def one_message(octets: bytes) -> Messages:
    """A message without a capture around it."""
    zero = np.zeros(1, np.int64)
    content = np.frombuffer(octets, np.uint8)
    return Messages(content, zero, zero, zero, zero, zero != 0, zero, np.array([len(octets)]), zero)


class MessageReader:
    """Finds the messages to and from the ports of Agents; remembers what TCP has not completed.

    Attributes:
        endpoints: those that sent or received, by number.
    """

    def __init__(self, ports: Iterable[int] = ()) -> None:
        """Args:
        ports: of Agents; without any 8888, and each one to which a session is created, from then on; by TCP from the
            first segment of that connection on.
        """
        given = sorted(set(ports))
        self._ports = np.array(given or [wire.DEFAULT_PORT], np.int64)
        self._found: dict[int, int] | None = None if given else {}
        self.endpoints: list[Endpoint] = []
        self._numbers: dict[bytes, int] = {}
        self._streams: dict[tuple[int, int, bool], TcpStream] = {}
        self._last: dict[tuple[int, int, bool], _Row] = {}
        self._keys: list[bytes] = []
        self._held: dict[tuple[bytes, bytes], tuple[int, bytes]] = {}

    def read(self, found: Datagrams) -> Messages:
        """The messages that these datagrams complete."""
        if self._found is not None:
            self._find(found, self._found)
        to_agent = self._are_agents(found.destination_ports, found.packets)
        chosen = to_agent | self._are_agents(found.source_ports, found.packets)
        if self._found is not None:
            self._hold(found, ~chosen)
        ours = np.flatnonzero(chosen)
        to_agent = to_agent[ours]
        sources = self._number(found.sources[ours], found.source_ports[ours])
        destinations = self._number(found.destinations[ours], found.destination_ports[ours])
        messages = Messages(
            found.octets,
            found.packets[ours],
            found.times[ours],
            np.where(to_agent, sources, destinations),
            np.where(to_agent, destinations, sources),
            to_agent,
            found.starts[ours],
            found.sizes[ours],
            found.missing[ours],
        )
        by_tcp = found.protocol[ours] == TCP
        return self._with_segments(messages, found.headers[ours], by_tcp) if by_tcp.any() else messages

    def _find(self, found: Datagrams, ports: dict[int, int]) -> None:
        """Notes the ports to which sessions are created, and in which packet for the first time."""
        octets = found.octets
        for header in (4, 6, 8, 10):  # without and with a key, by UDP and by TCP
            kind = found.starts + header
            begins = (found.sizes >= header + 16) & (octets.take(kind + 4, mode="clip") == wire.COOKIE[0])
            for entry in np.flatnonzero(
                begins & (octets.take(kind, mode="clip") == SubmessageKind.CREATE_CLIENT)
            ).tolist():
                at = int(kind[entry]) + 4
                port, packet = int(found.destination_ports[entry]), int(found.packets[entry])
                if octets[at : at + 4].tobytes() == wire.COOKIE:
                    if found.protocol[entry] == TCP:
                        packet = self._begin(found, entry)
                    ports[port] = min(packet, ports.get(port, packet))

    def _begin(self, found: Datagrams, entry: int) -> int:
        """The packet of the first segment here of the connection to which a segment belongs: the length of its message
        may be in a segment of its own."""
        same = (found.protocol == TCP) & (found.source_ports == found.source_ports[entry])
        same &= found.destination_ports == found.destination_ports[entry]
        same &= (found.sources == found.sources[entry]).all(axis=1)
        same &= (found.destinations == found.destinations[entry]).all(axis=1)
        return int(found.packets[np.flatnonzero(same)[0]])

    def _hold(self, found: Datagrams, others: Flags) -> None:
        """Remembers segments that may be the length of the first message to an Agent whose port is not known yet."""
        small = (found.sizes > 0) & (found.sizes <= _LENGTH) & (found.protocol == TCP) & (found.missing == 0)
        for entry in np.flatnonzero(others & small).tolist():
            start, header = int(found.starts[entry]), int(found.headers[entry])
            number = int.from_bytes(found.octets[header + 4 : header + 8].tobytes(), "big")
            octets = found.octets[start : start + int(found.sizes[entry])].tobytes()
            way = (
                _key(found.sources[entry], int(found.source_ports[entry])),
                _key(found.destinations[entry], int(found.destination_ports[entry])),
            )
            before = self._held.pop(way, (0, b""))
            joined = (before[0] + len(before[1])) % 2**32 == number and len(before[1] + octets) <= _LENGTH
            self._held[way] = (before[0], before[1] + octets) if before[1] and joined else (number, octets)
            if len(self._held) > _MOST_HELD:
                del self._held[next(iter(self._held))]

    def _stream(self, way: tuple[int, int, bool], number: int) -> TcpStream:
        """The stream of a direction; a new one begins with what was remembered of it before this number."""
        stream = self._streams.get(way)
        if stream is None:
            stream = self._streams[way] = TcpStream()
            client, agent = self._keys[way[0]], self._keys[way[1]]
            first, octets = self._held.pop((client, agent) if way[2] else (agent, client), (0, b""))
            if octets and (first + len(octets)) % 2**32 == number:
                stream.push(first, octets, 0, 0)
        return stream

    def _are_agents(self, ports: Numbers, packets: Numbers) -> Flags:
        known = np.isin(ports, self._ports)
        for port, first in (self._found or {}).items():
            known |= (ports == port) & (packets >= first)
        return known

    def _number(self, hosts: Octets, ports: Numbers) -> Numbers:
        """The numbers of endpoints, old and new."""
        high, low = np.ascontiguousarray(hosts).view(">u8").astype(np.uint64).T
        order = np.lexsort((ports, low, high))
        begins = np.ones(len(order), np.bool_)
        begins[1:] = np.any([np.diff(column[order]) != 0 for column in (ports, low, high)], axis=0)
        different = [self._endpoint(_key(hosts[entry], int(ports[entry]))) for entry in order[begins].tolist()]
        numbers = np.zeros(len(order), np.int64)
        numbers[order] = np.array(different, np.int64)[np.cumsum(begins) - 1]
        return numbers

    def _endpoint(self, key: bytes) -> int:
        if key not in self._numbers:
            host = IPv6Address(key[:16])
            self._numbers[key] = len(self.endpoints)
            self._keys.append(key)
            self.endpoints.append(Endpoint(str(host.ipv4_mapped or host), int.from_bytes(key[16:], "big")))
        return self._numbers[key]

    def _with_segments(self, messages: Messages, headers: Numbers, by_tcp: Flags) -> Messages:
        """The datagrams among them, and the messages that the segments among them complete."""
        octets = messages.octets.tobytes()
        rows = _MessageRows(octets)
        for at in range(len(by_tcp)):
            client, agent, to_agent = int(messages.clients[at]), int(messages.agents[at]), bool(messages.to_agent[at])
            row = (int(messages.packets[at]), int(messages.times[at]), client, agent, to_agent)
            start, size, missing = int(messages.starts[at]), int(messages.sizes[at]), int(messages.missing[at])
            if not by_tcp[at]:
                rows.add(row, start, size, missing)
                continue
            way = (client, agent, to_agent)
            self._last[way] = row
            header = int(headers[at])
            number = int.from_bytes(octets[header + 4 : header + 8], "big")
            stream = self._stream(way, number)
            rows.append(row, stream.push(number, octets[start : start + size], missing, octets[header + 13]))
        return rows.messages()

    def close(self) -> Messages:
        """The messages that TCP has begun and not completed when the capture ends."""
        rows = _MessageRows(b"")
        for way, stream in self._streams.items():
            rows.append(self._last[way], stream.close())
        return rows.messages()


def _key(host: Octets, port: int) -> bytes:
    return host.tobytes() + port.to_bytes(2, "big")


_Row = tuple[int, int, int, int, bool]


class _MessageRows:
    """Messages one by one."""

    def __init__(self, octets: bytes) -> None:
        self._octets = bytearray(octets)
        self._rows: list[tuple[int, ...]] = []

    def add(self, row: _Row, start: int, size: int, missing: int) -> None:
        self._rows.append((*row, start, size, missing))

    def append(self, row: _Row, found: Found) -> None:
        for message, missing in found:
            self.add(row, len(self._octets), len(message), missing)
            self._octets += message

    def messages(self) -> Messages:
        packets, times, clients, agents, sent, starts, sizes, missing = np.array(self._rows, np.int64).reshape(-1, 8).T
        octets = np.frombuffer(bytes(self._octets), np.uint8)
        return Messages(octets, packets, times, clients, agents, sent != 0, starts, sizes, missing)
