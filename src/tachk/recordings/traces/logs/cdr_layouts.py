"""The fields of messages in CDR (the encoding of ROS 2) at places that are known from messages before.

Messages of a type differ in the numbers that they hold, seldom in the lengths of their texts and sequences. All that
is no number in a message that rosbags has read is its layout: another message with the same octets there has its
numbers at the same places. rosbags itself has the last word on where they are: it has to read them from a message whose
numbers have been replaced by others.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from random import Random
from typing import Any, Final

from rosbags.interfaces import Nodetype

_FORMATS: Final = {
    "bool": "?", "byte": "B", "char": "B", "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i",
    "uint32": "I", "int64": "q", "uint64": "Q", "float32": "f", "float64": "d",
}  # fmt: skip
_HEADER: Final = 4
"""Octets before the message; that with the number 1 says the order of octets."""

_PROBES: Final = 8
_MOST_LAYOUTS: Final = 16
"""Of a type; messages that have more are read whole."""
_MOST_NUMBERS: Final = 4096
_STEP: Final = re.compile(r"\.?([^.\[\]]+)|\[(\d+)\]")

Values = tuple[Any, ...]
Pick = Callable[[Any], Values]
"""Takes the wanted values out of a message that has been read."""


class _UnknownType(Exception):
    """What a type holds is not known."""


@dataclass(frozen=True, slots=True)
class _CdrLayout:
    """Attributes:
    fixed: begin, end and content of what is no number.
    order: of each value, its place among the numbers that are read, and behind them among the constants.
    """

    size: int
    fixed: tuple[tuple[int, int, bytes], ...]
    numbers: struct.Struct
    constants: Values
    order: tuple[int, ...]

    def values(self, data: bytes) -> Values:
        found = self.numbers.unpack_from(data) + self.constants
        return tuple([None if (value := found[place]) != value else value for place in self.order])


class CdrPicker:
    """Reads the wanted values of messages of a type.

    Args:
        read: reads a whole message.
        pick: takes the values at these paths out of it, None for NaN; paths are such as `.pose.x[3]`, and empty where
            the value is always the same. None: what is taken is something else, so all messages are read whole.
        store, name: of rosbags: where the type is described, and what it is called there.
    """

    def __init__(
        self, read: Callable[[bytes], Any], pick: Pick, paths: Sequence[str | None], store: Any, name: str
    ) -> None:
        self._read, self._pick, self._store, self._name = read, pick, store, name
        self._paths = [_canonical(path) for path in paths if path is not None]
        self._layouts: list[_CdrLayout] = []
        self._misses = 0 if len(self._paths) == len(paths) else _MOST_LAYOUTS

    def __call__(self, data: bytes) -> Values:
        """Raises what rosbags raises about a damaged message."""
        for layout in self._layouts:
            if len(data) == layout.size:
                for begin, end, octets in layout.fixed:
                    if data[begin:end] != octets:
                        break
                else:
                    return layout.values(data)
        values = self._pick(self._read(data))
        if self._misses < _MOST_LAYOUTS:
            self._misses += 1
            if (learned := self._layout(data, values)) is not None:
                self._layouts.append(learned)
        return values

    def _layout(self, data: bytes, values: Values) -> _CdrLayout | None:
        walk = _PlacesOfNumbers(self._store, data)
        try:
            walk.message(self._name, "")
        except (_UnknownType, struct.error, KeyError):
            return None
        places = {path: (place, code) for path, place, code in walk.numbers}
        wanted = sorted({places[path] for path in self._paths if path in places})
        others = [(path, value) for path, value in zip(self._paths, values, strict=True) if path not in places]
        if any(path != "" and value is not None and not isinstance(value, str) for path, value in others):
            return None
        constants = tuple(value for _, value in others)
        ranks = {place: number for number, place in enumerate(wanted)}
        order, behind = [], len(wanted)
        for path in self._paths:
            if path in places:
                order.append(ranks[places[path]])
            else:
                order.append(behind)
                behind += 1
        layout = _CdrLayout(len(data), _fixed(walk, data), _struct(walk.sign, wanted), constants, tuple(order))
        return layout if self._is_right(layout, walk, data) else None

    def _is_right(self, layout: _CdrLayout, walk: _PlacesOfNumbers, data: bytes) -> bool:
        """True if rosbags reads the same values from the message, and from others with the layout."""
        random = Random(0)
        for _ in range(_PROBES):
            other = bytearray(data)
            for _, place, code in walk.numbers:
                size = struct.calcsize(code)
                other[place : place + size] = random.choice((b"\0", b"\1")) if code == "?" else random.randbytes(size)
            try:
                read = self._pick(self._read(bytes(other)))
            except Exception:  # of many libraries; so the places are wrong
                return False
            if repr(read) != repr(layout.values(bytes(other))):
                return False
        return repr(self._pick(self._read(data))) == repr(layout.values(data))


class _PlacesOfNumbers:
    """The places of all numbers in a message.

    Attributes:
        numbers: path, place and format of each.
    """

    def __init__(self, store: Any, data: bytes) -> None:
        self.numbers: list[tuple[str, int, str]] = []
        self.sign = "<" if data[1] else ">"
        self._store, self._data, self._place = store, data, _HEADER

    def message(self, name: str, path: str) -> None:
        for field, description in self._store.fielddefs[name][1]:
            self._field(description, f"{path}.{field}")

    def _field(self, description: Any, path: str) -> None:
        kind, content = description
        if kind == Nodetype.NAME:
            self.message(content, path)
        elif kind == Nodetype.BASE:
            self._plain(content[0], path)
        elif kind in (Nodetype.ARRAY, Nodetype.SEQUENCE):
            inner, count = content
            if kind == Nodetype.SEQUENCE:
                count = self._length()
            if count + len(self.numbers) > _MOST_NUMBERS:
                raise _UnknownType
            for number in range(count):
                self._field(inner, f"{path}[{number}]")
        else:
            raise _UnknownType

    def _plain(self, name: str, path: str) -> None:
        if name == "string":
            length = self._length()
            self._place += length
            return
        if name not in _FORMATS:
            raise _UnknownType
        size = struct.calcsize(_FORMATS[name])
        self._align(size)
        self.numbers.append((path, self._place, _FORMATS[name]))
        self._place += size

    def _length(self) -> int:
        self._align(4)
        (length,) = struct.unpack_from(f"{self.sign}I", self._data, self._place)
        self._place += 4
        return int(length)

    def _align(self, size: int) -> None:
        self._place = _HEADER + -(-(self._place - _HEADER) // size) * size


def _fixed(walk: _PlacesOfNumbers, data: bytes) -> tuple[tuple[int, int, bytes], ...]:
    """What is no number."""
    fixed, begin = [], 0
    for _, place, code in walk.numbers:
        if begin < place:
            fixed.append((begin, place, data[begin:place]))
        begin = place + struct.calcsize(code)
    if begin < len(data):
        fixed.append((begin, len(data), data[begin:]))
    return tuple(fixed)


def _struct(sign: str, places: Sequence[tuple[int, str]]) -> struct.Struct:
    """Reads the numbers at some places."""
    text, begin = sign, 0
    for place, code in places:
        text += f"{place - begin}x{code}"
        begin = place + struct.calcsize(code)
    return struct.Struct(text)


def _canonical(path: str) -> str:
    """The path as a walk writes it."""
    return "".join(f".{match[1]}" if match[1] else f"[{int(match[2])}]" for match in _STEP.finditer(path))
