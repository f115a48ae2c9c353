"""The socket of a bridge."""

from __future__ import annotations

import select
import socket
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Final

from tachk.xrce.bridge.bridging import Bridge
from tachk.xrce.bridge.clock import WallClock
from tachk.xrce.messages import Endpoint
from tachk.xrce.proxy.recording import CaptureWriter

_LARGEST: Final = 65535
_LONGEST_WAIT: Final = 0.5


class BridgeSocket:
    """A bridge with a UDP socket, which never waits.

    Attributes:
        address: where others reach it.
        packets: how many were sent, and received.
    """

    def __init__(
        self, bridge: Bridge, listen: Endpoint | None, to: Endpoint | None, recording: CaptureWriter | None = None
    ) -> None:
        """Args:
            listen: where it listens; None: at any free port.
            to: where it sends; None: to the last sender.

        Raises OSError where the port cannot be used."""
        self.bridge = bridge
        self.packets = [0, 0]
        self._peer = to
        self._recording = recording
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        try:
            self._socket.bind((listen.host, listen.port) if listen is not None else ("127.0.0.1", 0))
        except OSError:
            self._socket.close()
            raise
        self.address = Endpoint(*self._socket.getsockname())

    def poll(self) -> bool:
        """Takes the packets that have come; whether there were any."""
        found = False
        while True:
            try:
                octets, source = self._socket.recvfrom(_LARGEST)
            except BlockingIOError:
                return found
            except ConnectionRefusedError:
                continue  # no socket listens there at present
            found = True
            if self._peer is None or not self.bridge.is_open:
                self._peer = Endpoint(*source)
            if Endpoint(*source) != self._peer:
                continue  # a bridge stands for one end of one session
            self.packets[1] += 1
            self._record(self._peer, self.address, octets)
            self._send(self.bridge.arrived(octets))

    def due(self) -> None:
        """Sends the packets that are due."""
        self._send(self.bridge.due())

    def run(self, clock: WallClock, until: int, stop: Callable[[], bool] = lambda: False) -> None:
        """Takes part until a moment of the clock, in nanoseconds, as time passes."""
        while clock.now() < until and not stop():
            self.poll()
            self.due()
            wake = self.bridge.wake()
            left = (min(until, until if wake is None else wake) - clock.now()) / 1e9 / clock.speed
            select.select([self._socket], [], [], min(max(left, 0), _LONGEST_WAIT))

    def close(self) -> None:
        self._socket.close()

    def _send(self, packets: list[bytes]) -> None:
        if self._peer is None:
            return
        for octets in packets:
            self.packets[0] += 1
            self._record(self.address, self._peer, octets)
            with suppress(BlockingIOError, ConnectionRefusedError):  # on a network the packet would be gone, too
                self._socket.sendto(octets, (self._peer.host, self._peer.port))

    def _record(self, source: Endpoint, destination: Endpoint, octets: bytes) -> None:
        if self._recording is not None:
            self._recording.packet(time.time_ns(), source, destination, octets)
