"""JSON that people and machines read: indented, but what fits on a line stands on one."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from json.encoder import encode_basestring_ascii
from typing import Any

from tachk.base.records import dataclass

_COLUMNS = 160
_encoded = json.JSONEncoder().encode


@dataclass(frozen=True, slots=True)
class LongList:
    """A list that is too long for a line. Its items are made while they are written."""

    items: Iterable[Any]


def json_text(value: Any) -> str:
    """The value as JSON, with a line feed at its end."""
    return _text(value, 0, 0) + "\n"


def json_pieces(value: Any) -> Iterator[str]:
    """`json_text` in pieces, also of a value with `LongList`s in it."""
    yield from _pieces(value, 0, 0)
    yield "\n"


def _pieces(value: Any, indent: int, before: int) -> Iterator[str]:
    """As `_text`."""
    if not _has_long_list(value):
        yield _text(value, indent, before)
        return
    inner = "\n" + " " * (indent + 1)
    separator = inner
    yield "{" if isinstance(value, dict) else "["
    if isinstance(value, LongList):
        for item in value.items:
            line = _encoded(item)
            yield separator + (line if indent + 1 + len(line) <= _COLUMNS else _text(item, indent + 1, 0))
            separator = "," + inner
    else:
        pairs = value.items() if isinstance(value, dict) else ((None, item) for item in value)
        for key, item in pairs:
            name = "" if key is None else f"{encode_basestring_ascii(key)}: "
            yield separator + name
            yield from _pieces(item, indent + 1, len(name))
            separator = "," + inner
    yield "\n" + " " * indent + ("}" if isinstance(value, dict) else "]")


def _has_long_list(value: Any) -> bool:
    if isinstance(value, dict | list | tuple):
        return any(map(_has_long_list, value.values() if isinstance(value, dict) else value))
    return isinstance(value, LongList)


def _text(value: Any, indent: int, before: int) -> str:
    """The value behind ``before`` columns of its line; further lines begin deeper than ``indent``.

    The parts are written first, so that each of them is written once, however deep it lies.
    """
    if isinstance(value, str):
        return encode_basestring_ascii(value)
    if isinstance(value, int | float | None) or not value:
        return _encoded(value)
    if isinstance(value, dict):
        keys = [f"{encode_basestring_ascii(key)}: " for key in value]
        parts = [key + _text(item, indent + 1, len(key)) for key, item in zip(keys, value.values(), strict=True)]
        opening, closing = "{", "}"
    else:
        parts = [_text(item, indent + 1, 0) for item in value]
        opening, closing = "[", "]"
    length = 2 * len(parts) + sum(map(len, parts))
    if indent + before + length <= _COLUMNS and not any("\n" in part for part in parts):
        return opening + ", ".join(parts) + closing
    inner = " " * (indent + 1)
    return opening + "\n" + ",\n".join(inner + part for part in parts) + "\n" + " " * indent + closing
