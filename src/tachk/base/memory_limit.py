"""A limit on what a process grows by, whatever takes the memory: reading, compiling, searches, explanations.

Searches count what they store and stop at the limit. What they do not count, such as the actions of a single state, and
what Python does before and behind them is seen here, by the resident size of the process. That is looked at wherever
the time is (`tachk.base.time_limit.check_time`), and a few times a second in the midst of a search.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from time import monotonic

from tachk.base.time_limit import OutOfTimeError, looked_at_too

_STATM = Path("/proc/self/statm")
_SECONDS_BETWEEN_LOOKS = 0.025
_SLACK = 10
"""What the process takes beside what is counted may be a tenth of the limit more, ..."""
_LEAST_SLACK = 16 << 20
"""... or so many bytes: modules are loaded and allocators keep something."""


class OutOfMemoryError(OutOfTimeError):
    """The process has grown by more than it may. Whoever gives up where the time is over gives up likewise."""

    reason = "memory limit"


class _Ceiling:
    """The largest resident size that is allowed, in bytes."""

    def __init__(self, size: int) -> None:
        self.size = size
        self._next = 0.0

    def look(self) -> None:
        now = monotonic()
        if now < self._next:
            return
        self._next = now + _SECONDS_BETWEEN_LOOKS
        if _is_above(self.size):
            _give_back()
            if _is_above(self.size):
                raise OutOfMemoryError


_ceiling: ContextVar[_Ceiling | None] = ContextVar("ceiling", default=None)


@contextmanager
def memory_limit(size: int | None) -> Iterator[None]:
    """Ends what is done within by an OutOfMemoryError once the process has grown by so many bytes and some slack.

    Without effect where the system does not tell the resident size: outside of Linux.

    Args:
        size: None for no limit but that of an enclosing `memory_limit`, which always counts.
    """
    if size is not None:
        _give_back()
    resident = resident_bytes()
    if size is None or resident is None:
        yield
        return
    outer = _ceiling.get()
    largest = resident + size + max(size // _SLACK, _LEAST_SLACK)
    ceiling = _Ceiling(largest if outer is None else min(largest, outer.size))
    token = _ceiling.set(ceiling)
    try:
        with looked_at_too(ceiling.look):
            yield
    finally:
        _ceiling.reset(token)


def resident_bytes() -> int | None:
    """The memory of the machine that the process takes now; None where the system does not tell."""
    try:
        return int(_STATM.read_bytes().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except (OSError, ValueError, IndexError, AttributeError):
        return None


def _give_back() -> None:
    """Lets go of what the allocator keeps."""
    from tachk import _core  # not needed where there is no limit

    _core.give_back_memory()


def _is_above(size: int) -> bool:
    resident = resident_bytes()
    return resident is not None and resident > size
