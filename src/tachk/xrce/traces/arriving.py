"""Bytes of a capture as they come through a pipe, until the time is over."""

from __future__ import annotations

from tachk.base.awaited_pipe import awaited_pipe
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
        """Does nothing: the opener of the stream closes it."""
