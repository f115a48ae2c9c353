"""Pipes that are read without waiting for longer than a moment, so that limits on time hold while nothing comes."""

from __future__ import annotations

import os
import select
import sys
from queue import Empty, Queue
from threading import Thread
from typing import Final, Protocol

PATIENCE: Final = 0.2
"""Seconds after which nothing has come for a while."""

_PIECE: Final = 1 << 16
_MOST_PIECES: Final = 16


class AwaitedPipe(Protocol):
    """The bytes that come through a pipe. The caller that opened the pipe closes it."""

    def read1(self, size: int, /) -> bytes | None:
        """The bytes that have come; empty at the end, None if none have come for a while."""
        ...


def awaited_pipe(descriptor: int) -> AwaitedPipe:
    """A pipe, or any other file descriptor that is open for reading."""
    return PipeByThread(descriptor) if sys.platform == "win32" else PipeBySelect(descriptor)


class PipeBySelect:
    """Asks the system whether something has come. Windows answers that about sockets only."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor

    def read1(self, size: int, /) -> bytes | None:
        ready, _, _ = select.select([self._descriptor], [], [], PATIENCE)
        return os.read(self._descriptor, size) if ready else None


class PipeByThread:
    """A thread reads, and waits where it must."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._pieces: Queue[bytes] = Queue(_MOST_PIECES)
        self._rest = b""
        self._ended = False
        Thread(target=self._read, daemon=True).start()

    def read1(self, size: int, /) -> bytes | None:
        if not self._rest and not self._ended:
            try:
                self._rest = self._pieces.get(timeout=PATIENCE)
            except Empty:
                return None
            self._ended = not self._rest
        piece, self._rest = self._rest[:size], self._rest[size:]
        return piece

    def _read(self) -> None:
        piece = b"there is more"
        while piece:
            try:
                piece = os.read(self._descriptor, _PIECE)
            except OSError:
                piece = b""
            self._pieces.put(piece)
