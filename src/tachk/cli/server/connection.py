"""A client of the server: the lines and descriptors that come from it, and what it is to read. Nothing here waits."""

from __future__ import annotations

import os
import socket
import sys
from collections.abc import Iterator
from contextlib import suppress

_PIECE = 1 << 16
_LONGEST_LINE = 64 << 20
_MOST_DESCRIPTORS = 3
"""Those of the standard streams of a request."""

_BYTES_OF_DESCRIPTOR = 4
_CLOSE_ON_EXEC = getattr(socket, "MSG_CMSG_CLOEXEC", 0)


class TooMuchError(Exception):
    """A client has sent a line without end, or descriptors that belong to no request."""


class Connection:
    """The socket of a client.

    Attributes:
        process: its number; None where the system does not say it.
        unsent: what it has not read yet.
        ended: it sends nothing more, but may still read.
    """

    def __init__(self, connected: socket.socket, process: int | None) -> None:
        connected.setblocking(False)
        self.process = process
        self.unsent = bytearray()
        self.ended = False
        self._socket = connected
        self._received = bytearray()
        self._descriptors: list[int] = []

    def fileno(self) -> int:
        return self._socket.fileno()

    def receive(self) -> Iterator[bytes]:
        """The lines that have come. Raises TooMuchError, and OSError where the client is gone."""
        room = socket.CMSG_SPACE(_MOST_DESCRIPTORS * _BYTES_OF_DESCRIPTOR)
        with suppress(BlockingIOError):
            piece, ancillary, _, _ = self._socket.recvmsg(_PIECE, room, _CLOSE_ON_EXEC)
            for level, kind, data in ancillary:
                if (level, kind) == (socket.SOL_SOCKET, socket.SCM_RIGHTS):
                    self._descriptors += _numbers(data)
            self.ended = not piece
            *lines, rest = (self._received + piece).split(b"\n")
            self._received = bytearray(rest)
            if len(rest) > _LONGEST_LINE or len(self._descriptors) > _MOST_DESCRIPTORS:
                raise TooMuchError
            yield from (bytes(line) for line in lines if line.strip())

    def take_descriptors(self) -> tuple[int, ...]:
        """The descriptors that have come; whoever takes them closes them."""
        taken, self._descriptors = self._descriptors, []
        return tuple(taken)

    def say(self, text: bytes) -> None:
        """Sends bytes, now or once the client has read what came before. Drops them where it is gone."""
        self.unsent += text
        try:
            while self.unsent:
                del self.unsent[: self._socket.send(self.unsent)]
        except BlockingIOError:
            return
        except OSError:
            self.unsent.clear()

    def close(self) -> None:
        self._socket.close()
        for descriptor in self.take_descriptors():
            os.close(descriptor)


def _numbers(data: bytes) -> list[int]:
    size = _BYTES_OF_DESCRIPTOR
    return [int.from_bytes(data[at : at + size], sys.byteorder) for at in range(0, len(data) - size + 1, size)]
