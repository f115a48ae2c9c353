"""Bytes of a capture as they come, until the time is over: from a pipe, or from a file that grows."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

from tachk.base.awaited_pipe import PATIENCE, awaited_pipe
from tachk.base.job import check_job


class Pipe:
    """A file descriptor that is read without waiting for long."""

    def __init__(self, descriptor: int) -> None:
        self._pipe = awaited_pipe(descriptor)

    def read1(self, size: int, /) -> bytes | None:
        """The bytes that have come; empty at the end, None if nothing has come for a while."""
        check_job()
        return self._pipe.read1(size)

    def close(self) -> None:
        """It belongs to whoever opened it."""


class GrowingFile:
    """A file to which somebody writes; it has no end."""

    def __init__(self, path: Path, sleep: Callable[[float], None] = time.sleep) -> None:
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
