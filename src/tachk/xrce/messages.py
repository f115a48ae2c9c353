"""Messages between clients and the Agent in the datagrams and segments of a capture.

UDP carries one message a datagram. TCP carries two bytes of length, little-endian, before each message.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import field
from ipaddress import IPv6Address

import numpy as np

from tachk.records import dataclass
from tachk.xrce import wire
from tachk.xrce.datagrams import TCP, Datagrams, Flags
from tachk.xrce.packets import Numbers, Octets
from tachk.xrce.tcp_stream import Found, TcpStream
from tachk.xrce.wire import Kind


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
        endpoints: whoever sent or received, by number.
    """

    def __init__(self, ports: Iterable[int] = ()) -> None:
        """Args:
        ports: of Agents; without any 8888, and each one to which a session is created, from then on.
        """
        given = sorted(set(ports))
        self._ports = np.array(given or [wire.DEFAULT_PORT], np.int64)
        self._found: dict[int, int] | None = None if given else {}
        self.endpoints: list[Endpoint] = []
        self._numbers: dict[bytes, int] = {}
        self._streams: dict[tuple[int, int, bool], TcpStream] = {}
        self._last: dict[tuple[int, int, bool], _Row] = {}

    def read(self, found: Datagrams) -> Messages:
        """The messages that these datagrams complete."""
        if self._found is not None:
            self._find(found, self._found)
        to_agent = self._are_agents(found.destination_ports, found.packets)
        ours = np.flatnonzero(to_agent | self._are_agents(found.source_ports, found.packets))
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
            for entry in np.flatnonzero(begins & (octets.take(kind, mode="clip") == Kind.CREATE_CLIENT)).tolist():
                at = int(kind[entry]) + 4
                port, packet = int(found.destination_ports[entry]), int(found.packets[entry])
                if octets[at : at + 4].tobytes() == wire.COOKIE:
                    ports[port] = min(packet, ports.get(port, packet))

    def _are_agents(self, ports: Numbers, packets: Numbers) -> Flags:
        known = np.isin(ports, self._ports)
        for port, first in (self._found or {}).items():
            known |= (ports == port) & (packets >= first)
        return known

    def _number(self, hosts: Octets, ports: Numbers) -> Numbers:
        """The numbers of endpoints, old and new."""
        keys = np.concatenate([hosts, ports.astype(">u2").view(np.uint8).reshape(-1, 2)], axis=1)
        different, inverse = np.unique(np.ascontiguousarray(keys).view("V18").ravel(), return_inverse=True)
        return np.array([self._endpoint(key.tobytes()) for key in different], np.int64)[inverse]

    def _endpoint(self, key: bytes) -> int:
        if key not in self._numbers:
            host = IPv6Address(key[:16])
            self._numbers[key] = len(self.endpoints)
            self.endpoints.append(Endpoint(str(host.ipv4_mapped or host), int.from_bytes(key[16:], "big")))
        return self._numbers[key]

    def _with_segments(self, messages: Messages, headers: Numbers, by_tcp: Flags) -> Messages:
        """The datagrams among them, and the messages that the segments among them complete."""
        octets = messages.octets.tobytes()
        rows = _Rows(octets)
        for at in range(len(by_tcp)):
            client, agent, to_agent = int(messages.clients[at]), int(messages.agents[at]), bool(messages.to_agent[at])
            row = (int(messages.packets[at]), int(messages.times[at]), client, agent, to_agent)
            start, size, missing = int(messages.starts[at]), int(messages.sizes[at]), int(messages.missing[at])
            if not by_tcp[at]:
                rows.add(row, start, size, missing)
                continue
            way = (client, agent, to_agent)
            stream = self._streams.setdefault(way, TcpStream())
            self._last[way] = row
            header = int(headers[at])
            number = int.from_bytes(octets[header + 4 : header + 8], "big")
            rows.append(row, stream.push(number, octets[start : start + size], missing, octets[header + 13]))
        return rows.messages()

    def close(self) -> Messages:
        """What TCP has begun and not completed when the capture ends."""
        rows = _Rows(b"")
        for way, stream in self._streams.items():
            rows.append(self._last[way], stream.close())
        return rows.messages()


_Row = tuple[int, int, int, int, bool]


class _Rows:
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
