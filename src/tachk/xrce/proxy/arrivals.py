"""What waits in a socket, and when it came: Linux notes that for each datagram, however late somebody reads it."""

from __future__ import annotations

import socket
import struct
import sys
import time
from contextlib import suppress
from typing import Final

from tachk.base.records import dataclass
from tachk.xrce.messages import Endpoint

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
    """What waits in a socket, at most so many datagrams."""
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
    """What `time.time_ns` is ahead of `time.monotonic_ns`; of a few tries the one that was least interrupted."""
    tries = []
    for _ in range(_TRIES):
        before, clock, after = time.monotonic_ns(), time.time_ns(), time.monotonic_ns()
        tries.append((after - before, clock - (before + after) // 2))
    return min(tries)[1]
