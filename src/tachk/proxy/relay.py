"""The sockets of a relay: what arrives goes to `Decisions`, what leaves comes from there."""

from __future__ import annotations

import asyncio
import signal
import socket
import time
from collections.abc import Callable, Sequence
from typing import Final

from tachk.proxy.decisions import Answer, Arrival, Decisions, Departure
from tachk.proxy.recording import Recording
from tachk.proxy.rules import Way
from tachk.records import dataclass
from tachk.xrce.messages import Endpoint

_BUFFER: Final = 1 << 22
"""Bytes that a socket keeps: a storm of packets must not be lost in the relay."""

_LARGEST: Final = 65535
_AT_ONCE: Final = 64


@dataclass(frozen=True, slots=True)
class Plan:
    """Where to listen, where to send.

    Attributes:
        listening: an address for each client.
        agent: where the Agent listens.
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
        recording: Recording | None,
        tell: Callable[[Arrival, Answer], None] = lambda _arrival, _answer: None,
    ) -> None:
        self._plan = plan
        self._decisions = decisions
        self._recording = recording
        self._tell = tell
        self._offset = time.time_ns() - time.monotonic_ns()
        self._listening: dict[int, socket.socket] = {}
        self._towards_agent: dict[tuple[int, Endpoint], socket.socket] = {}
        self._timer: asyncio.TimerHandle | None = None
        self._silence: asyncio.TimerHandle | None = None
        self._done = asyncio.Event()

    async def run(self, ready: Callable[[], None] = lambda: None) -> None:
        """Relays until the end. Raises OSError where a port cannot be used.

        Args:
            ready: is called when clients can come.
        """
        loop = asyncio.get_running_loop()
        try:
            for place in self._plan.listening:
                found = _socket()
                self._listening[place.port] = found
                try:
                    found.bind((place.host, place.port))
                except OSError as error:
                    raise OSError(error.errno, error.strerror, str(place)) from None
                loop.add_reader(found, self._from_client, found, place.port)
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

    # ---- what arrives ------------------------------------------------------------------------------------------------

    def _from_client(self, at: socket.socket, port: int) -> None:
        for octets, source in _received(at):
            client = Endpoint(*source)
            key = (port, client)
            if key not in self._towards_agent:
                self._towards_agent[key] = self._connected(port, client)
            self._record(time.monotonic_ns(), client, _name(at), octets)
            self._arrived(Arrival(port, client, Way.TO_AGENT, octets, time.monotonic_ns()))

    def _connected(self, port: int, client: Endpoint) -> socket.socket:
        found = _socket()
        found.connect((self._plan.agent.host, self._plan.agent.port))
        asyncio.get_running_loop().add_reader(found, self._from_agent, found, port, client)
        return found

    def _from_agent(self, at: socket.socket, port: int, client: Endpoint) -> None:
        for octets, _ in _received(at):
            self._record(time.monotonic_ns(), self._plan.agent, _name(at), octets)
            self._arrived(Arrival(port, client, Way.TO_CLIENT, octets, time.monotonic_ns()))

    def _arrived(self, arrival: Arrival) -> None:
        answer = self._decisions.arrived(arrival)
        self._tell(arrival, answer)
        self._follow(answer)
        if self._plan.idle is not None:
            if self._silence is not None:
                self._silence.cancel()
            self._silence = asyncio.get_running_loop().call_later(self._plan.idle, self._done.set)

    # ---- what leaves -------------------------------------------------------------------------------------------------

    def _follow(self, answer: Answer) -> None:
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
            if departure.way is Way.TO_AGENT:
                at = self._towards_agent[(departure.port, client)]
                self._record(now, _name(at), self._plan.agent, octets)
                at.send(octets)
            else:
                at = self._listening[departure.port]
                self._record(now, _name(at), client, octets)
                at.sendto(octets, (client.host, client.port))
        except (BlockingIOError, ConnectionRefusedError):
            pass  # nobody listens there: on a network the datagram would be gone, too

    def _record(self, now: int, source: Endpoint, destination: Endpoint, octets: bytes) -> None:
        if self._recording is not None:
            self._recording.packet(now + self._offset, source, destination, octets)


def _socket() -> socket.socket:
    made = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    made.setblocking(False)
    for option in (socket.SO_RCVBUF, socket.SO_SNDBUF):
        made.setsockopt(socket.SOL_SOCKET, option, _BUFFER)
    return made


def _received(at: socket.socket) -> list[tuple[bytes, tuple[str, int]]]:
    """What waits in a socket, with its senders."""
    found: list[tuple[bytes, tuple[str, int]]] = []
    try:
        while len(found) < _AT_ONCE:
            found.append(at.recvfrom(_LARGEST))
    except (BlockingIOError, ConnectionRefusedError):
        pass  # there is no more, or the other side does not listen at present
    return found


def _name(at: socket.socket) -> Endpoint:
    return Endpoint(*at.getsockname())
