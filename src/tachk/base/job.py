"""The job that is under way: until when it may run, how much memory it may take, and who follows its progress.

Whoever has a limit opens a job, and the loops that may take long check it, wherever they are:

    with limited(seconds, memory):
        ...                     # a StoppedError is raised soon after a limit is hit

It is the only clock. A job inside of another one can only have less time and less memory. Searches count what they
store and stop by themselves; what they do not count, such as the actions of a single state, and what Python does before
and behind them shows in the resident size of the process, which is checked together with the time.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from math import inf
from time import monotonic
from typing import Any

from tachk.base.records import dataclass, replace

_STATM = "/proc/self/statm"
_SECONDS_BETWEEN_CHECKS = 0.025
_SLACK = 10
"""The memory of the process that is not counted may be a tenth of the limit, ..."""
_LEAST_SLACK = 16 << 20
"""... or so many bytes: modules are loaded and allocators keep something."""

Progress = Callable[[Any, tuple[str, ...]], None]
"""Called a few times a second, with the statistics of a search and the names of the queries that it answers."""


class StoppedError(Exception):
    """The job was stopped.

    Attributes:
        reason: why, as reports say it.
    """

    reason = "stopped"


class OutOfTimeError(StoppedError):
    """The time of the job is over."""

    reason = "time limit"


class OutOfMemoryError(StoppedError):
    """The process has grown by more than it may."""

    reason = "memory limit"


class _Ceiling:
    """The largest resident size that is allowed, in bytes."""

    def __init__(self, size: int) -> None:
        self.size = size
        self._next = 0.0

    def check(self, more: int = 0) -> None:
        now = monotonic()
        if not more and now < self._next:
            return
        self._next = now + _SECONDS_BETWEEN_CHECKS
        if _is_above(self.size - more):
            _give_back()
            if _is_above(self.size - more):
                raise OutOfMemoryError


class _Interruption:
    """True once the user has interrupted a job."""

    def __init__(self) -> None:
        self.came = False


@dataclass(frozen=True, slots=True)
class Job:
    """What is under way, and what it may take.

    Attributes:
        ends: the moment of `time.monotonic` at which its time is over; None: never.
        ceiling: the limit on the size of the process, if there is one.
        progress: follows its searches.
        about: the names of the queries that it answers.
        interruption: shared by the jobs in which an interruption of one ends all.
        is_unneeded: tells if nobody needs the result any more.
    """

    ends: float | None = None
    ceiling: _Ceiling | None = None
    progress: Progress | None = None
    about: tuple[str, ...] = ()
    interruption: _Interruption | None = None
    is_unneeded: Callable[[], bool] | None = None

    @property
    def seconds_left(self) -> float | None:
        """At least 0; None where there is no limit."""
        return None if self.ends is None else max(self.ends - monotonic(), 0.0)

    def narrowed(self, seconds: float | None = None, memory: int | None = None) -> Job:
        """The job with so many seconds from now on, and so many bytes more than the process takes now, at most."""
        ends, ceiling = self.ends, self.ceiling
        if seconds is not None:
            end = monotonic() + seconds
            ends = end if ends is None else min(ends, end)
        if memory is not None:
            _give_back()
            resident = resident_bytes()
            if resident is not None:
                largest = resident + memory + max(memory // _SLACK, _LEAST_SLACK)
                ceiling = _Ceiling(largest if ceiling is None else min(largest, ceiling.size))
        return replace(self, ends=ends, ceiling=ceiling)

    def check(self, more: int = 0) -> None:
        """Raises StoppedError if a limit is hit. Cheap: meant for inner loops.

        Args:
            more: so many bytes are about to be taken at once, which must fit too.
        """
        if self.ends is not None and monotonic() >= self.ends:
            raise OutOfTimeError
        self.check_memory(more)

    def check_memory(self, more: int = 0) -> None:
        """As `check`, but for the time: for a search of the core, which has that itself."""
        if self.is_unneeded is not None and self.is_unneeded():
            raise StoppedError
        if self.ceiling is not None:
            self.ceiling.check(more)


_WITHOUT_LIMITS = Job()
_current: ContextVar[Job] = ContextVar("job", default=_WITHOUT_LIMITS)


def current_job() -> Job:
    """The innermost job that is under way; one without limits where none was opened."""
    return _current.get()


def check_job(more: int = 0) -> None:
    """Raises StoppedError if a limit of the innermost job is hit, or will be by so many bytes more."""
    job = _current.get()
    if job.ends is not None and monotonic() >= job.ends:  # as `Job.check`, without two calls
        raise OutOfTimeError
    if job.ceiling is not None or job.is_unneeded is not None:
        job.check_memory(more)


@contextmanager
def under_way(job: Job) -> Iterator[None]:
    """Makes a job the innermost one."""
    token = _current.set(job)
    try:
        yield
    finally:
        _current.reset(token)


@contextmanager
def limited(seconds: float | None = None, memory: int | None = None) -> Iterator[None]:
    """A job that is stopped by a StoppedError after so many seconds of wall-clock time, and once the process has grown
    by so many bytes and some slack.

    Args:
        seconds, memory: None for no limit but those of the jobs around this one, which always count. The system gives
            the resident size on Linux only; elsewhere the limit on memory has no effect here.
    """
    with under_way(_current.get().narrowed(seconds, memory)):
        check_job()
        yield


@contextmanager
def unhurried(seconds: float = inf) -> Iterator[None]:
    """A part of a job that has at least so many seconds, whatever the job has left: what was found is explained.

    Also for a whole function: ``@unhurried()``.
    """
    outer = _current.get()
    ends = None if outer.ends is None else max(outer.ends, monotonic() + seconds)
    with under_way(replace(outer, ends=ends)):
        yield


@contextmanager
def followed(progress: Progress | None) -> Iterator[None]:
    """A part of a job whose searches report their progress; None: as the job around it does."""
    outer = _current.get()
    with under_way(outer if progress is None else replace(outer, progress=progress)):
        yield


@contextmanager
def stopped_if(is_unneeded: Callable[[], bool]) -> Iterator[None]:
    """A part of a job that is stopped by a StoppedError soon after nobody needs its result any more.

    Args:
        is_unneeded: tells so; it may be called in inner loops.
    """
    with under_way(replace(_current.get(), is_unneeded=is_unneeded)):
        yield


@contextmanager
def answering(queries: tuple[str, ...]) -> Iterator[None]:
    """A part of a job that answers the queries of these names."""
    with under_way(replace(_current.get(), about=queries)):
        yield


@contextmanager
def remembering_interruption() -> Iterator[None]:
    """A part of a job that knows whether the user has interrupted it; the one around it, if that knows already.

    A search that Ctrl-C ends says so in its result. Whoever combines several results may not pass that on: the job
    remembers it, so that nothing further is begun.
    """
    outer = _current.get()
    with under_way(outer if outer.interruption is not None else replace(outer, interruption=_Interruption())):
        yield


def note_interruption() -> None:
    """For a caller that turns a KeyboardInterrupt into a result."""
    interruption = _current.get().interruption
    if interruption is not None:
        interruption.came = True


def is_interrupted() -> bool:
    """True if the user has interrupted the job, or another part of the command that it belongs to."""
    interruption = _current.get().interruption
    return interruption is not None and interruption.came


def resident_bytes() -> int | None:
    """The memory of the machine that the process takes now; None where it is not known."""
    try:
        with open(_STATM, "rb") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except (OSError, ValueError, IndexError, AttributeError):
        return None


def _give_back() -> None:
    """Returns unused memory of the allocator to the system."""
    from tachk import _core  # not needed where there is no limit

    _core.give_back_memory()


def _is_above(size: int) -> bool:
    resident = resident_bytes()
    return resident is not None and resident > size
