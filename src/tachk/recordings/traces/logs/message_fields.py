"""The fields of messages: their names as columns, and their values in a message that has been read."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from math import isnan
from typing import Any

import numpy as np

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.recordings.traces.arrivals import topic_of
from tachk.recordings.traces.trace_header import without_unit

MOST_ELEMENTS = 4096
"""Elements of an array that are named as columns; images and clouds of points are longer."""

_STEP = re.compile(r"\.?([^.\[\]]+)|\[(\d+)\]")

Values = tuple[Any, ...]
"""Of some columns, in their order; None means that the value stays."""


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
        yield name, plain(value)


class Picker:
    """Takes the values of some columns out of messages of a topic.

    Attributes:
        paths: within a message, such as `.pose.x[3]`; that of arrivals of the topic is empty, of other arrivals None.
    """

    def __init__(self, topic: str, columns: Iterable[str]) -> None:
        name = topic_name(topic)
        self.columns = tuple(columns)
        self.paths = tuple(_path(name, column) for column in self.columns)
        self._getters = tuple(_getters(name, self.columns).values())

    def __call__(self, content: Any) -> Values:
        return tuple([get(content) for get in self._getters])


def _path(name: str, column: str) -> str | None:
    topic = topic_of(column)
    return column[len(name) :] if topic is None else "" if topic == name else None


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
    way = steps(path)

    def get(content: Any) -> Any:
        value = content
        for number, step in enumerate(way):
            inner = part_of(value, step)
            if inner is None and isinstance(value, Mapping) and number == 0:
                return dict(flattened("", content)).get(path)  # a key may hold dots
            value = inner
        return plain(value) if isinstance(value, (bool, int, float, str, np.generic)) else None

    def get_of_objects(content: Any) -> Any:
        """The same, and quick where the content is made of objects of JSON and has the value."""
        value = content
        for step in way:
            if type(value) is not dict or (value := value.get(step)) is None:
                return get(content)
        kind = type(value)
        if kind is float:
            return value if value == value else None
        return value if kind is int or kind is str or kind is bool else get(content)

    return get_of_objects


def steps(path: str) -> tuple[str | int, ...]:
    """The names and numbers in a path."""
    return tuple(match[1] or int(match[2]) for match in _STEP.finditer(path))


def part_of(value: Any, step: str | int) -> Any:
    """A field or an element of a value; None where it has none. Raises UsageError where it has two."""
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


def plain(value: Any) -> Any:
    """A value as one of Python; what is not a number means that the value stays."""
    number = value.item() if isinstance(value, np.generic) else value
    return None if isinstance(number, float) and isnan(number) else number


NO_COLUMNS = Picker("", ())
