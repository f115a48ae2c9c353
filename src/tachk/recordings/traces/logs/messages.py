"""Recordings of messages on topics, as MCAP files and ROS bags hold them: each field of each message is a column.

A column is called after topic and field, ``odom.pose.x`` for the topic ``/odom``, elements of arrays with their number,
``scan.ranges[3]``. Only the messages of requested topics are decoded.
"""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Collection, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from math import isfinite
from typing import Any, Generic, NamedTuple, Protocol, TypeVar

import numpy as np

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.job import check_job
from tachk.recordings.traces.arrivals import topic_of
from tachk.recordings.traces.logs.dates import seconds_of
from tachk.recordings.traces.logs.message_fields import (
    NO_COLUMNS,
    Picker,
    Values,
    flattened,
    part_of,
    steps,
    topic_name,
)
from tachk.recordings.traces.logs.sparse import ColumnChanges, SparseRecording, array_of
from tachk.recordings.traces.trace import Trace
from tachk.recordings.traces.trace_header import no_such_column

LOG_TIME = "log_time"
"""The time when a message was recorded, in place of the name of a field that holds the time."""

SAMPLES = 200
"""Messages of a topic whose fields are its columns: objects of JSON and arrays may differ from message to message."""

_CHECKED = 256
"""Messages between two looks at the limits of the job."""

_NUMBER = re.compile(r"\[\d+\]")
_NANOSECONDS = 10**9

_SECONDS = ("sec", "secs", "seconds")
_REST = ("nanosec", "nsecs", "nsec", "nanos")
"""The parts of a stamp, in ROS 2, ROS 1 and protocol buffers."""

LAST_TIME = 2**62
"""In nanoseconds since 1970."""


Enumerations = Mapping[str, Mapping[str, int]]
"""The names of the values of fields, by their path in a message: ``.state``, ``.parts[].state``."""


class MessageFile(Protocol):
    """A file of messages.

    Attributes:
        topics: of all messages, as they are called in the file.
    """

    @property
    def topics(self) -> Collection[str]: ...

    @property
    def end(self) -> int | None:
        """The time of the last message of all in nanoseconds, where that is known without reading them."""
        ...

    def decoded(self, topics: Collection[str]) -> Iterator[tuple[str, int, Any]]:
        """Topic, time in nanoseconds, and content of the messages of some topics, in the order of the file."""
        ...

    def picked(self, topics: Collection[str], pickers: Mapping[str, Picker]) -> Iterator[tuple[str, int, Values]]:
        """The same with the values that are wanted of each message, in place of its content."""
        ...

    def samples(self) -> Iterator[tuple[str, Any]]:
        """The first `SAMPLES` messages of each topic that can be decoded."""
        ...

    @property
    def warnings(self) -> tuple[str, ...]:
        """As of a `Trace`."""
        ...

    def constants(self) -> Mapping[str, Mapping[str, int | float | str]]:
        """For each topic the constants of its type, and of the types in it."""
        ...

    def enumerations(self, topics: Collection[str]) -> Mapping[str, Enumerations]:
        """For some topics the fields of which the type names the values."""
        ...


Topics = TypeVar("Topics", bound=Collection[str])


class WithSummary(ABC, Generic[Topics]):
    """The metadata of a file, read once."""

    @abstractmethod
    def _read_summary(self) -> tuple[Topics, int | None]:
        """The topics, and the time of the last message where it is known."""

    @abstractmethod
    def decoded(self, topics: Collection[str]) -> Iterator[tuple[str, int, Any]]:
        """See `MessageFile`."""

    def picked(self, topics: Collection[str], pickers: Mapping[str, Picker]) -> Iterator[tuple[str, int, Values]]:
        for topic, time, content in self.decoded(topics):
            yield topic, time, pickers.get(topic, NO_COLUMNS)(content)

    @cached_property
    def _summary(self) -> tuple[Topics, int | None]:
        return self._read_summary()

    @property
    def topics(self) -> Topics:
        return self._summary[0]

    @property
    def end(self) -> int | None:
        return self._summary[1]


@dataclass(frozen=True, eq=False)
class MessageRecording:
    """Attributes:
    time: the field that holds the time of a message; None: the time when it was recorded.
    """

    name: str
    messages: MessageFile = field(repr=False)
    time: str | None = None

    @property
    def unit(self) -> str:
        return "s"

    @cached_property
    def _fields(self) -> Mapping[str, Collection[str]]:
        """The columns of each topic, as its first messages have them."""
        fields: dict[str, dict[str, Any]] = {}
        for topic, content in self.messages.samples():
            check_job()
            fields.setdefault(topic, {}).update(flattened(topic_name(topic), content))
        return fields

    @property
    def columns(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(column for fields in self._fields.values() for column in fields))

    def read(self, columns: Collection[str] | None = None) -> Trace:
        wanted = self.columns if columns is None else tuple(columns)
        paths: dict[str, dict[str, str]] = {}
        for column in wanted:
            paths.setdefault(self._topic(topic_of(column) or column), {})[column] = column
        pickers = {topic: Picker(topic, names) for topic, names in paths.items()}
        times: list[int] = []
        given: dict[str, _Given] = {}
        for topic, time, values in self._values(paths or self.messages.topics, pickers):
            own = given.get(topic)
            if own is None:
                own = given[topic] = _Given([], [])
            own.messages.append(len(times))
            own.values.append(values)
            times.append(time)
            if not -LAST_TIME <= time <= LAST_TIME:
                raise self._out_of_range(f"message {len(times)} of {topic}", time)
            if len(times) % _CHECKED == 0:
                check_job()
        changes = _changes(times, given, pickers)
        met = {column for column, own in changes.items() if len(own.rows)}
        missing = next((column for column in wanted if column not in met and column not in self.columns), None)
        if missing is not None:
            raise no_such_column(missing, self.columns, self.name)
        if not times:
            raise UsageError(f"{self.name} has no messages", "the verdict needs at least the state at the beginning")
        times.sort()
        end = self.messages.end if self.time is None else None
        if end is not None and end > LAST_TIME:
            raise self._out_of_range("the last message", end)
        if end is not None and end > times[-1]:
            times.append(end)
        recording = SparseRecording(self.name, "s", np.array(times, "datetime64[ns]"), changes)
        return replace(recording.read(list(wanted)), calendar=True, warnings=self.messages.warnings)

    def _values(self, topics: Collection[str], pickers: Mapping[str, Picker]) -> Iterator[tuple[str, int, Values]]:
        """Topic, time and values of messages."""
        if self.time is None:
            yield from self.messages.picked(topics, pickers)
            return
        for topic, _, content in self.messages.decoded(topics):
            yield topic, self._stamp(topic, content), pickers.get(topic, NO_COLUMNS)(content)

    def named_values(self) -> Mapping[str, Mapping[str, int | float | str]]:
        """The constants of the type of each topic, by the name of its columns."""
        return {topic_name(topic): values for topic, values in self.messages.constants().items()}

    def enumerations(self, columns: Collection[str]) -> Mapping[str, Mapping[str, int]]:
        """For those of some columns of which the types name the values: the values by their names."""
        topics: dict[str, list[str]] = {}
        for column in columns:
            with suppress(UsageError):  # no column of the file
                topics.setdefault(self._topic(column), []).append(column)
        known = self.messages.enumerations(topics)
        return {
            column: known[topic][path]
            for topic, own in topics.items()
            for column in own
            if (path := _NUMBER.sub("[]", column[len(topic_name(topic)) :])) in known.get(topic, {})
        }

    def _out_of_range(self, message: str, time: int) -> UsageError:
        return UsageError(
            f"{self.name}: {message} is at {time} ns since 1970, which is beyond what can be counted",
            "a time that rolled over? --time takes the times of a field, as --time header.stamp, or publish_time",
        )

    def _topic(self, column: str) -> str:
        """The topic of a column. Raises UsageError where there is none, or several."""
        named = {topic: topic_name(topic) for topic in self.messages.topics}
        found = [
            topic for topic, name in named.items() if column == name or column.startswith((f"{name}.", f"{name}["))
        ]
        if len(found) > 1:
            found = [topic for topic in found if column in self._fields.get(topic, ())]
        if not found:
            raise no_such_column(column, self.columns, self.name)
        if len(found) > 1:
            raise UsageError(f"{self.name}: {column!r} is a field of both {found[0]} and {found[1]}")
        return found[0]

    def _stamp(self, topic: str, content: Any) -> int:
        """The time that a message gives itself, in nanoseconds."""
        assert self.time is not None
        value = content
        for step in steps(self.time):
            value = part_of(value, step)
        time = _nanoseconds(value)
        if time is None:
            raise UsageError(
                f"{self.name}: a message of {topic} has no time {self.time!r}",
                "leave --time out: the time when messages were recorded; or read topics that have it",
            )
        return time


class _Given(NamedTuple):
    """The messages of a topic, by their numbers among all, and the values that each gives."""

    messages: list[int]
    values: list[Values]


def _changes(times: list[int], given: Mapping[str, _Given], pickers: Mapping[str, Picker]) -> dict[str, ColumnChanges]:
    """The changes of each column, in the order of time; of the same time in the order of the file."""
    order = np.argsort(np.array(times, np.int64), kind="stable")
    places = np.empty(len(times), np.int64)
    places[order] = np.arange(len(times))
    rows = {topic: places[own.messages] for topic, own in given.items()}
    found: dict[str, ColumnChanges] = {}
    for topic in sorted(given, key=lambda each: int(rows[each].min())):
        own = np.argsort(rows[topic])
        values = given[topic].values
        ordered = [values[number] for number in own.tolist()]
        for place, column in enumerate(pickers.get(topic, NO_COLUMNS).columns):
            cells = [each[place] for each in ordered]
            known = np.array([cell is not None for cell in cells], dtype=bool)
            held = cells if known.all() else [cell for cell in cells if cell is not None]
            found[column] = ColumnChanges(rows[topic][own][known], array_of(held))
    return found


def _nanoseconds(value: Any) -> int | None:
    """A stamp of ROS, a number of seconds, or a date."""
    seconds = next((part for key in _SECONDS if (part := part_of(value, key)) is not None), None)
    if seconds is not None:
        rest = next((part for key in _REST if (part := part_of(value, key)) is not None), 0)
        parts = [part.item() if isinstance(part, np.generic) else part for part in (seconds, rest)]
        return parts[0] * _NANOSECONDS + parts[1] if all(isinstance(part, int) for part in parts) else None
    if isinstance(value, str):
        try:
            return round(seconds_of(value) * _NANOSECONDS)
        except ValueError:
            return None
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not isfinite(value):
        return None
    return round(Fraction(repr(value)) * _NANOSECONDS)
