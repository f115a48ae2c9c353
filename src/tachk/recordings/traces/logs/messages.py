"""Recordings of messages on topics, as MCAP files and ROS bags hold them: each field of each message is a column.

A column is called after topic and field, ``odom.pose.x`` for the topic ``/odom``, elements of arrays with their number,
``scan.ranges[3]``. Only the messages of requested topics are decoded.
"""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from math import isfinite, isnan
from typing import Any, Generic, Protocol, TypeVar

import numpy as np

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.job import check_job
from tachk.recordings.traces.arrivals import topic_of
from tachk.recordings.traces.logs.dates import seconds_of
from tachk.recordings.traces.logs.sparse import sparse
from tachk.recordings.traces.trace import Trace
from tachk.recordings.traces.trace_header import no_such_column, without_unit

LOG_TIME = "log_time"
"""The time when a message was recorded, in place of the name of a field that holds the time."""

MOST_ELEMENTS = 4096
"""Elements of an array that are named as columns; images and clouds of points are longer."""

SAMPLES = 200
"""Messages of a topic whose fields are its columns: objects of JSON and arrays may differ from message to message."""

_STEP = re.compile(r"\.?([^.\[\]]+)|\[(\d+)\]")
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
        topics = paths or self.messages.topics
        events: list[tuple[int, Mapping[str, Any]]] = []
        met: set[str] = set()
        getters = {topic: _getters(topic_name(topic), names) for topic, names in paths.items()}
        for number, (topic, logged, content) in enumerate(self.messages.decoded(topics)):
            check_job()
            time = logged if self.time is None else self._stamp(topic, content)
            if abs(time) > LAST_TIME:
                raise self._out_of_range(f"message {number + 1} of {topic}", time)
            given = {column: get(content) for column, get in getters.get(topic, {}).items()}
            met.update(column for column, value in given.items() if value is not None)
            events.append((time, given))
        missing = next((column for column in wanted if column not in met and column not in self.columns), None)
        if missing is not None:
            raise no_such_column(missing, self.columns, self.name)
        if not events:
            raise UsageError(f"{self.name} has no messages", "the verdict needs at least the state at the beginning")
        events.sort(key=lambda event: event[0])
        end = self.messages.end if self.time is None else None
        if end is not None and end > LAST_TIME:
            raise self._out_of_range("the last message", end)
        if end is not None and end > events[-1][0]:
            events.append((end, {}))
        recording = sparse(self.name, "s", events, np.array([time for time, _ in events], "datetime64[ns]"))
        return replace(recording.read(list(wanted)), calendar=True, warnings=self.messages.warnings)

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
        for step in _steps(self.time):
            value = _part(value, step)
        time = _nanoseconds(value)
        if time is None:
            raise UsageError(
                f"{self.name}: a message of {topic} has no time {self.time!r}",
                "leave --time out: the time when messages were recorded; or read topics that have it",
            )
        return time


def topic_name(topic: str) -> str:
    """``/robot/odom`` as ``robot.odom``."""
    return topic.strip("/").replace("/", ".")


def flattened(name: str, value: Any) -> Iterator[tuple[str, Any]]:
    """The numbers, truth values and texts within a message, with their names; of long arrays none."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            yield from flattened(f"{name}.{without_unit(str(key))}", inner)
    elif hasattr(value, "__dataclass_fields__"):
        for key in value.__dataclass_fields__:
            if not key.startswith("_"):
                yield from flattened(f"{name}.{key}", getattr(value, key))
    elif isinstance(value, (list, tuple, np.ndarray)):
        if len(value) <= MOST_ELEMENTS:
            for number, inner in enumerate(value):
                yield from flattened(f"{name}[{number}]", inner)
    elif not isinstance(value, (bytes, bytearray, memoryview)):
        yield name, _plain(value)


def _getters(name: str, columns: Iterable[str]) -> dict[str, Callable[[Any], Any]]:
    """The functions that find the value of each column in a message; None where it has none."""
    return {
        column: _getter(column[len(name) :]) if topic_of(column) is None else _arrival(name, column)
        for column in columns
    }


def _arrival(name: str, column: str) -> Callable[[Any], Any]:
    """Says that a message of the topic gives what arrives in a column of arrivals."""
    path = topic_of(column) or ""
    get = _getter(path[len(name) :])
    return lambda content: True if path == name or get(content) is not None else None


def _getter(path: str) -> Callable[[Any], Any]:
    steps = _steps(path)

    def get(content: Any) -> Any:
        value = content
        for number, step in enumerate(steps):
            inner = _part(value, step)
            if inner is None and isinstance(value, Mapping) and number == 0:
                return dict(flattened("", content)).get(path)  # a key may hold dots
            value = inner
        return _plain(value) if isinstance(value, (bool, int, float, str, np.generic)) else None

    return get


def _steps(path: str) -> tuple[str | int, ...]:
    return tuple(match[1] or int(match[2]) for match in _STEP.finditer(path))


def _part(value: Any, step: str | int) -> Any:
    if isinstance(step, int):
        inside = isinstance(value, (list, tuple, np.ndarray)) and step < len(value)
        return value[step] if inside else None
    if not isinstance(value, Mapping):
        return getattr(value, step, None)
    found = value.get(step)
    if found is None:
        behind = f"{step} "
        named = [key for key in value if str(key).startswith(behind) and without_unit(str(key)) == step]
        if len(named) > 1:
            raise UsageError(f"a message has two fields {step!r}, {named[0]!r} and {named[1]!r}", "rename one of them")
        found = value[named[0]] if named else None
    return found


def _plain(value: Any) -> Any:
    """A value as one of Python; what is not a number means that the value stays."""
    plain = value.item() if isinstance(value, np.generic) else value
    return None if isinstance(plain, float) and isnan(plain) else plain


def _nanoseconds(value: Any) -> int | None:
    """A stamp of ROS, a number of seconds, or a date."""
    seconds = next((part for key in _SECONDS if (part := _part(value, key)) is not None), None)
    if seconds is not None:
        rest = next((part for key in _REST if (part := _part(value, key)) is not None), 0)
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
