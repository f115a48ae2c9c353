"""Programs that exchange the same JSON lines over a socket: they run already, perhaps on another machine."""

from __future__ import annotations

import select
import socket
import threading
import time
from collections.abc import Iterator, Mapping
from fractions import Fraction

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.recordings.conformance.events import Cell
from tachk.simulation.testing.arrivals import Arrival
from tachk.simulation.testing.event_lines import READY, event_line, line_output, read_line
from tachk.simulation.testing.real_time import RealTimeSystem
from tachk.simulation.testing.system_adapter import SeenOutput, SystemEndedError

_SECONDS_TO_START = 30
_SECONDS_TO_CONNECT = 5.0
_SECONDS_TO_READ = 2.0
_AGAIN = 200_000_000
"""Nanoseconds after which a datagram that begins a test is sent again."""
_POLL = 0.1
_LARGEST = 1 << 16
_LONGEST_LINE = 1 << 20
BEGIN = b"\n"
"""The datagram that begins a test: it says where the test is."""


class SocketProgram(RealTimeSystem):
    """A program that is reached by TCP or UDP. Its first line is ``{"event": "ready"}``: the model starts then.

    By TCP a test is a connection. By UDP it begins with an empty line to the program, and a datagram has one line or
    more.
    """

    def __init__(self, place: str, kind: socket.SocketKind, nanoseconds: Fraction) -> None:
        """Args: nanoseconds: of a unit of the model. Raises UsageError for a place that is not HOST:PORT."""
        super().__init__(nanoseconds)
        host, colon, port = place.rpartition(":")
        if not colon or not host or not port.isdecimal() or not 0 < int(port) < 1 << 16:
            raise UsageError(f"`{place}` is no place of a program", "write HOST:PORT, such as localhost:7000")
        self._place = place
        self._address = host.removeprefix("[").removesuffix("]"), int(port)
        self._kind = kind
        self._is_closed = False

    @property
    def _is_stream(self) -> bool:
        return self._kind is socket.SOCK_STREAM

    def start(self) -> None:
        self._socket = self._connected()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        first = self._first()
        if first is None or read_line(first.octets)[0] != READY:
            raise UsageError(
                f'{self._place} did not send {{"event": "{READY}"}} when the test began',
                "let the program send this line when it is ready for inputs: the model starts then",
            )
        self.begin(first.moment)

    def _connected(self) -> socket.socket:
        error: OSError | None = None
        try:
            places = socket.getaddrinfo(*self._address, type=self._kind)
        except OSError as unknown:
            places, error = [], unknown
        for family, kind, protocol, _, address in places:
            one = socket.socket(family, kind, protocol)
            one.settimeout(_SECONDS_TO_CONNECT)
            try:
                one.connect(address)
            except OSError as failed:
                one.close()
                error = failed
            else:
                one.setblocking(False)
                if self._is_stream:
                    one.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                return one
        assert error is not None
        raise UsageError(f"{self._place} cannot be reached: {error.strerror or error}") from None

    def _first(self) -> Arrival | None:
        last = time.monotonic_ns() + _SECONDS_TO_START * 10**9
        first = None
        while first is None and not self.arrivals.is_over and time.monotonic_ns() < last:
            if not self._is_stream:
                self._write(BEGIN)
            first = self.arrivals.next(last if self._is_stream else min(last, time.monotonic_ns() + _AGAIN))
        return first

    def _read(self) -> None:
        rest = b""
        while not self._is_closed:
            if not select.select([self._socket], [], [], _POLL)[0]:
                continue
            try:
                octets = self._socket.recv(_LARGEST)
            except (BlockingIOError, ConnectionRefusedError):  # by UDP the program may begin later
                continue
            except OSError:
                octets = b""
            moment = time.monotonic_ns()
            if self._is_stream and not octets:
                break
            *lines, rest = (rest + octets).split(b"\n")
            if not self._is_stream or len(rest) > _LONGEST_LINE:
                lines, rest = [*lines, rest], b""
            for line in lines:
                if line.strip():
                    self.arrivals.put(moment, line)
        self.arrivals.end()

    def send(self, name: str, cells: Mapping[str, Cell]) -> Fraction:
        moment = time.monotonic_ns()
        self._write(event_line(name, cells).encode())
        return self.units(moment)

    def _write(self, octets: bytes) -> None:
        while octets:
            if not select.select([], [self._socket], [], _SECONDS_TO_READ)[1]:
                raise SystemEndedError(f"{self._place} does not read its inputs")
            try:
                octets = octets[self._socket.send(octets) :]
            except ConnectionRefusedError:
                return  # by UDP: it is lost, as on a network
            except OSError as error:
                raise SystemEndedError(f"{self._place} has ended: {error.strerror}") from None

    def outputs(self, arrival: Arrival) -> Iterator[SeenOutput]:
        yield line_output(arrival.octets, self.units(arrival.moment))

    def check(self) -> None:
        if self.arrivals.is_over:
            raise SystemEndedError(f"{self._place} has closed the connection")

    def close(self) -> None:
        self._is_closed = True
        if hasattr(self, "_reader"):
            self._reader.join()
            self._socket.close()

    def abandon(self) -> None:
        self.close()
