"""A limit on time for everything that is done before a search: reading, instantiating, computing constants, compiling.

The limit is set by whoever has one and looked at by the loops that may take long, wherever they are:

    with time_limit(seconds):
        ...                     # OutOfTimeError comes out of here soon after the time is over
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from time import monotonic

_deadline: ContextVar[float | None] = ContextVar("deadline", default=None)
_other_limit: ContextVar[Callable[[], None] | None] = ContextVar("other_limit", default=None)


class OutOfTimeError(Exception):
    """A time limit is over, or the other limit that is looked at together with it.

    Attributes:
        reason: which limit, as reports say it.
    """

    reason = "time limit"


@contextmanager
def time_limit(seconds: float | None) -> Iterator[None]:
    """Ends what is done within by an OutOfTimeError once so many seconds of wall-clock time have passed.

    Args:
        seconds: None for no limit but that of an enclosing `time_limit`, which always counts.
    """
    outer = _deadline.get()
    ends = [] if outer is None else [outer]
    if seconds is not None:
        ends.append(monotonic() + seconds)
    token = _deadline.set(min(ends, default=None))
    try:
        check_time()
        yield
    finally:
        _deadline.reset(token)


@contextmanager
def looked_at_too(limit: Callable[[], None]) -> Iterator[None]:
    """`check_time` calls another limit, too, which raises an OutOfTimeError of its own kind."""
    token = _other_limit.set(limit)
    try:
        yield
    finally:
        _other_limit.reset(token)


def time_left() -> float | None:
    """The seconds until the time is over, not less than 0; None without a limit."""
    deadline = _deadline.get()
    return None if deadline is None else max(deadline - monotonic(), 0.0)


def check_time() -> None:
    """Raises OutOfTimeError if the time is over or another limit is hit. Cheap: meant for inner loops."""
    deadline = _deadline.get()
    if deadline is not None and monotonic() >= deadline:
        raise OutOfTimeError
    check_other_limit()


def check_other_limit() -> None:
    """As `check_time`, where somebody else looks at the time."""
    limit = _other_limit.get()
    if limit is not None:
        limit()
