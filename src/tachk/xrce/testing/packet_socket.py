"""A UDP socket whose packets have the times at which they came, however late they are read."""

from __future__ import annotations

import select
import socket
import struct
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Final

from tachk.base.diagnostics.diagnostic import UsageError

HOST: Final = "127.0.0.1"
"""Where the programs under test run, too."""
_TIMES: Final = 35
"""SO_TIMESTAMPNS of Linux: the kernel notes when a packet comes. Elsewhere it is when it is read."""
_TIME: Final = struct.Struct("qq")
_LARGEST: Final = 65535
_SECONDS: Final = 0.2
_AGAIN: Final = 1_000_000_000
"""Nanoseconds after which the clocks are compared again."""
_PAIRS: Final = 5

Address = tuple[str, int]


def free_port() -> int:
    """A port of this machine that nobody listens to by UDP. Raises UsageError where there is none."""
    one = PacketSocket()
    one.close()
    return one.port


class PacketSocket:
    """Attributes:
    port: where it is reached, on this machine.
    """

    def __init__(self) -> None:
        """Raises UsageError where there is no free port."""
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.setblocking(False)
        with suppress(OSError):  # a system that does not know it
            self._socket.setsockopt(socket.SOL_SOCKET, _TIMES, 1)
        try:
            self._socket.bind((HOST, 0))
        except OSError as error:
            self._socket.close()
            raise UsageError(f"there is no port for UDP on {HOST}: {error.strerror}") from None
        self.port: int = self._socket.getsockname()[1]
        self._reader: threading.Thread | None = None
        self._is_closed = False
        self._offset = clock_offset()
        self._measured = time.monotonic_ns()
        self._last = 0

    def read_into(self, take: Callable[[int, bytes, Address], None]) -> None:
        """Lets a thread take packets until the socket is closed: their moments of `time.monotonic_ns`, and senders."""
        self._reader = threading.Thread(target=self._read, args=(take,), daemon=True)
        self._reader.start()

    def _read(self, take: Callable[[int, bytes, Address], None]) -> None:
        while not self._is_closed:
            if not select.select([self._socket], [], [], _SECONDS)[0]:
                continue
            try:
                octets, notes, _, address = self._socket.recvmsg(_LARGEST, socket.CMSG_SPACE(_TIME.size))
            except (BlockingIOError, ConnectionRefusedError):  # no socket listens there at present
                continue
            take(self._moment(notes), octets, address)

    def _moment(self, notes: list[tuple[int, int, bytes]]) -> int:
        """When a packet came. Later packets never have earlier moments."""
        now = time.monotonic_ns()
        if now - self._measured > _AGAIN:  # the other clock may be set
            self._offset, self._measured = clock_offset(), now
        for level, kind, data in notes:
            if (level, kind, len(data)) == (socket.SOL_SOCKET, _TIMES, _TIME.size):
                seconds, nanoseconds = map(int, _TIME.unpack(data))
                now = min(seconds * 10**9 + nanoseconds - self._offset, now)
        self._last = max(now, self._last)
        return self._last

    def send(self, octets: bytes, address: Address) -> int:
        """Sends a packet; the moment at which it left."""
        moment = time.monotonic_ns()
        with suppress(BlockingIOError, ConnectionRefusedError):  # on a network the packet would be gone, too
            self._socket.sendto(octets, address)
        return moment

    def close(self) -> None:
        self._is_closed = True
        if self._reader is not None:
            self._reader.join()
        self._socket.close()


def clock_offset() -> int:
    """What has to be taken from `time.time_ns` to get `time.monotonic_ns`. The thread may have to wait between the two:
    the best of some pairs counts."""
    pairs = []
    for _ in range(_PAIRS):
        before, middle, behind = time.monotonic_ns(), time.time_ns(), time.monotonic_ns()
        pairs.append((behind - before, middle - (before + behind) // 2))
    return min(pairs)[1]
