"""JSON that people and machines read: indented, but what fits on a line stands on one."""

from __future__ import annotations

import json
from json.encoder import encode_basestring_ascii
from typing import Any

_COLUMNS = 160
_encoded = json.JSONEncoder().encode


def json_text(value: Any) -> str:
    """The value as JSON, with a line feed at its end."""
    return _text(value, 0, 0) + "\n"


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
