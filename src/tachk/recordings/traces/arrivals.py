"""The rows in which something arrives: `arrived(hb)` is a column of a recording that has the column or the topic `hb`.

A recording reads it as a truth value of each row: whether the row gives the column, or one of the topic, a value. A
row is an instant and not a state, so monitors watch how often something has arrived (`counted`), which changes with
each arrival, also where the value that arrives is the one before.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable

import numpy as np
from numpy.typing import NDArray

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.recordings.traces.trace import Ticks

_ARRIVED = re.compile(r"arrived\((?P<topic>.*)\)", re.DOTALL)


def arrivals_of(topic: str) -> str:
    """The column of the arrivals of a topic or a column."""
    return f"arrived({topic})"


def topic_of(column: str) -> str | None:
    """The column whose arrivals a column counts; None for other columns."""
    match = _ARRIVED.fullmatch(column)
    return None if match is None else match["topic"]


def belongs(column: str, topic: str) -> bool:
    """True if a column is the topic, or a part of it."""
    return column == topic or column.startswith((f"{topic}.", f"{topic}["))


def arriving(wanted: Iterable[str], columns: Collection[str]) -> dict[str, tuple[str, ...]]:
    """The wanted columns of arrivals that other columns have, with these others."""
    found: dict[str, tuple[str, ...]] = {}
    for name in wanted:
        topic = None if name in columns else topic_of(name)
        if topic is not None and (parts := tuple(column for column in columns if belongs(column, topic))):
            found[name] = parts
    return found


def no_arrivals(name: str, topic: str, help: str) -> UsageError:
    """The error about a recording that does not show when something arrives.

    Args:
        name: of the recording.
        help: what to write instead.
    """
    return UsageError(f"{name} does not show when `{topic}` arrives", help)


def counted(flags: NDArray[np.uint8], times: Ticks) -> NDArray[np.float64]:
    """The number of arrivals since the first instant. Before that it is minus infinity if something arrives at the
    first instant, and else infinity."""
    first = times == times[0]
    count = np.cumsum((flags != 0) & ~first).astype(np.float64)
    before = -np.inf if bool(flags[first].any()) else np.inf
    return np.where(count > 0, count, before)
