"""Pipes and growing files, read without waiting for longer than a moment: limits on time hold while nothing comes."""

from __future__ import annotations

import os
import select
import sys
import time
from collections.abc import Callable
from pathlib import Path
from queue import Empty, Queue
from threading import Thread
from typing import Final, Protocol

from tachk.base.job import check_job

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


class GrowingFile:
    """A file that is still being written; it has no end."""

    def __init__(self, path: Path, sleep: Callable[[float], None] = lambda seconds: time.sleep(seconds)) -> None:
        self._stream = path.open("rb")
        self._sleep = sleep

    def read1(self, size: int, /) -> bytes | None:
        """The bytes that have come; None if nothing has come for a while."""
        check_job()
        octets = self._stream.read(size)
        if not octets:
            self._sleep(PATIENCE)
        return octets or None

    def close(self) -> None:
        self._stream.close()


class AwaitedStream:
    """The bytes of a pipe, read without waiting for long. Reading waits, and raises OutOfTimeError where nothing comes
    before the time is over."""

    def __init__(self, read1: Callable[[int], bytes | None], close: Callable[[], None] = lambda: None) -> None:
        self._read1 = read1
        self.close = close
        self._come = b""
        self._at = 0
        self._ended = False

    def begins_dump(self) -> bool:
        """True if it begins as a value change dump does, with a keyword such as ``$date``."""
        while not self._come.strip() and self._take():
            pass
        return self._come.lstrip().startswith(b"$")

    def readline(self, size: int = -1, /) -> bytes:
        pieces = []
        room = size if size >= 0 else sys.maxsize
        while room > 0 and (self._at < len(self._come) or self._take()):
            end = self._come.find(b"\n", self._at, self._at + room) + 1
            pieces.append(self.read1(end - self._at if end else room))
            room -= len(pieces[-1])
            if end:
                break
        return b"".join(pieces)

    def read1(self, size: int = -1, /) -> bytes:
        if self._at == len(self._come):
            self._take()
        start, self._at = self._at, len(self._come) if size < 0 else min(self._at + size, len(self._come))
        return self._come[start : self._at]

    def _take(self) -> bool:
        """Adds the next bytes; False at the end."""
        while not self._ended:
            check_job()
            piece = self._read1(_PIECE)
            if piece is not None:
                self._come, self._at = self._come[self._at :] + piece, 0
                self._ended = not piece
                return not self._ended
        return False
