"""The sockets of a relay: what arrives goes to `Decisions`, what leaves comes from there.

What waits in several sockets is taken in the order in which it came, and recorded at that time: a machine that is busy
with other work delays packets in the relay, but the capture says so.
"""

from __future__ import annotations

import asyncio
import signal
import socket
import struct
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Final

from tachk.base.records import dataclass
from tachk.xrce.messages import Endpoint
from tachk.xrce.proxy.decisions import Decisions, Departure, RelayArrival, RelayDecision
from tachk.xrce.proxy.recording import CaptureWriter, Sorted
from tachk.xrce.proxy.rules import PacketDirection

_BUFFER: Final = 1 << 22
"""Bytes that a socket keeps: a storm of packets must not be lost in the relay."""

_LARGEST: Final = 65535
_STAMPS: Final = 35
"""SO_TIMESTAMPNS of Linux, which ``socket`` does not name."""

_TIMESPEC: Final = struct.Struct("@ll")
_TRIES: Final = 3


@dataclass(frozen=True, slots=True)
class Received:
    """A datagram. ``time``: when it came, in nanoseconds of `time.monotonic_ns`."""

    octets: bytes
    source: Endpoint
    time: int


def made_socket() -> socket.socket:
    """A socket for datagrams that never waits, and notes when they come if the system can do that."""
    made = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    made.setblocking(False)
    for option in (socket.SO_RCVBUF, socket.SO_SNDBUF):
        made.setsockopt(socket.SOL_SOCKET, option, _BUFFER)
    if sys.platform == "linux":
        with suppress(OSError):
            made.setsockopt(socket.SOL_SOCKET, _STAMPS, 1)
    return made


def received(at: socket.socket, most: int) -> list[Received]:
    """The datagrams that wait in a socket, at most so many."""
    found: list[Received] = []
    since = _since_1970()
    for _ in range(most):
        try:
            octets, notes, _flags, source = at.recvmsg(_LARGEST, socket.CMSG_SPACE(_TIMESPEC.size))
        except BlockingIOError:
            break
        except ConnectionRefusedError:
            continue  # the other side does not listen at present
        now = time.monotonic_ns()
        stamps = [note for level, kind, note in notes if (level, kind) == (socket.SOL_SOCKET, _STAMPS)]
        came = min([now, *(_nanoseconds(stamp) - since for stamp in stamps if len(stamp) == _TIMESPEC.size)])
        found.append(Received(octets, Endpoint(*source), came))
    return found


def _nanoseconds(stamp: bytes) -> int:
    seconds, nanoseconds = _TIMESPEC.unpack(stamp)
    return int(seconds) * 1_000_000_000 + int(nanoseconds)


def _since_1970() -> int:
    """The lead of `time.time_ns` over `time.monotonic_ns`; of a few tries the one that was least interrupted."""
    tries = []
    for _ in range(_TRIES):
        before, clock, after = time.monotonic_ns(), time.time_ns(), time.monotonic_ns()
        tries.append((after - before, clock - (before + after) // 2))
    return min(tries)[1]


_AT_ONCE: Final = 64
_SETTLED: Final = 0.02
"""Seconds after which what was recorded is written: nothing that came earlier can be in a socket any more."""


@dataclass(frozen=True, slots=True)
class Plan:
    """The addresses to listen at and to send to.

    Attributes:
        listening: an address for each client.
        agent: the address of the Agent.
        idle: stop when nothing has come for so many seconds after the first packet; None: go on.
    """

    listening: Sequence[Endpoint]
    agent: Endpoint
    idle: float | None


class Relay:
    """Between clients and Agent until a signal ends it, or silence.

    A client that comes from another address gets another socket towards the Agent, which knows clients by addresses.
    """

    def __init__(
        self,
        plan: Plan,
        decisions: Decisions,
        recording: CaptureWriter | None,
        report: Callable[[RelayArrival, RelayDecision], None] = lambda _arrival, _answer: None,
    ) -> None:
        self._plan = plan
        self._decisions = decisions
        self._recording = None if recording is None else Sorted(recording)
        self._report = report
        self._offset = time.time_ns() - time.monotonic_ns()
        self._listening: dict[int, socket.socket] = {}
        self._towards_agent: dict[tuple[int, Endpoint], socket.socket] = {}
        self._timer: asyncio.TimerHandle | None = None
        self._silence: asyncio.TimerHandle | None = None
        self._done = asyncio.Event()
        self._settling: asyncio.TimerHandle | None = None

    async def run(self, ready: Callable[[], None] = lambda: None) -> None:
        """Relays until the end. Raises OSError where a port cannot be used.

        Args:
            ready: is called when clients can come.
        """
        loop = asyncio.get_running_loop()
        try:
            for place in self._plan.listening:
                found = made_socket()
                self._listening[place.port] = found
                try:
                    found.bind((place.host, place.port))
                except OSError as error:
                    raise OSError(error.errno, error.strerror, str(place)) from None
                loop.add_reader(found, self._take)
            for number in (signal.SIGINT, signal.SIGTERM):
                loop.add_signal_handler(number, self._done.set)
            ready()
            await self._done.wait()
        finally:
            for number in (signal.SIGINT, signal.SIGTERM):
                loop.remove_signal_handler(number)
            for found in (*self._listening.values(), *self._towards_agent.values()):
                loop.remove_reader(found)
                found.close()
            if self._recording is not None:
                self._recording.write(None)

    # ---- arrivals ---------------------------------------------------------------------------------------------------

    def _take(self) -> None:
        """Takes the packets that wait in all sockets, the earliest first."""
        known = time.monotonic_ns()
        waiting: list[tuple[Received, int, Endpoint | None]] = []
        places = [(at, port, None) for port, at in self._listening.items()]
        for at, port, client in (*places, *((at, *key) for key, at in self._towards_agent.items())):
            found = received(at, _AT_ONCE)
            waiting += [(each, port, client) for each in found]
            if len(found) == _AT_ONCE:
                known = min(known, found[-1].time)
        waiting.sort(key=lambda one: one[0].time)
        for each, port, client in waiting:
            if client is None:
                self._from_client(each, port)
            else:
                self._record(each.time, self._plan.agent, _name(self._towards_agent[port, client]), each.octets)
                self._arrived(RelayArrival(port, client, PacketDirection.TO_CLIENT, each.octets, each.time))
        if self._recording is not None:
            self._recording.write(known + self._offset)

    def _from_client(self, each: Received, port: int) -> None:
        if (port, each.source) not in self._towards_agent:
            self._towards_agent[port, each.source] = self._connected()
        self._record(each.time, each.source, _name(self._listening[port]), each.octets)
        self._arrived(RelayArrival(port, each.source, PacketDirection.TO_AGENT, each.octets, each.time))

    def _connected(self) -> socket.socket:
        found = made_socket()
        found.connect((self._plan.agent.host, self._plan.agent.port))
        asyncio.get_running_loop().add_reader(found, self._take)
        return found

    def _arrived(self, arrival: RelayArrival) -> None:
        answer = self._decisions.arrived(arrival)
        self._report(arrival, answer)
        self._follow(answer)
        if self._plan.idle is not None:
            if self._silence is not None:
                self._silence.cancel()
            self._silence = asyncio.get_running_loop().call_later(self._plan.idle, self._done.set)

    # ---- departures -------------------------------------------------------------------------------------------------

    def _follow(self, answer: RelayDecision) -> None:
        for departure in answer.departures:
            self._send(departure)
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        if answer.wake is not None:
            seconds = max(0, answer.wake - time.monotonic_ns()) / 1_000_000_000
            self._timer = asyncio.get_running_loop().call_later(seconds, self._wake)

    def _wake(self) -> None:
        self._timer = None
        self._follow(self._decisions.due(time.monotonic_ns()))

    def _send(self, departure: Departure) -> None:
        now, octets, client = time.monotonic_ns(), departure.octets, departure.client
        try:
            if departure.way is PacketDirection.TO_AGENT:
                at = self._towards_agent[(departure.port, client)]
                self._record(now, _name(at), self._plan.agent, octets)
                at.send(octets)
            else:
                at = self._listening[departure.port]
                self._record(now, _name(at), client, octets)
                at.sendto(octets, (client.host, client.port))
        except (BlockingIOError, ConnectionRefusedError):
            pass  # no socket listens there: on a network the datagram would be gone, too

    # ---- recording --------------------------------------------------------------------------------------------------

    def _record(self, moment: int, source: Endpoint, destination: Endpoint, octets: bytes) -> None:
        if self._recording is not None:
            self._recording.packet(moment + self._offset, source, destination, octets)
            if self._settling is None:
                self._settling = asyncio.get_running_loop().call_later(_SETTLED, self._settle)

    def _settle(self) -> None:
        self._settling = None
        self._take()


def _name(at: socket.socket) -> Endpoint:
    return Endpoint(*at.getsockname())
