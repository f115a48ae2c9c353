"""JSON that people and machines read: indented, but what fits on a line stands on one."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

_COLUMNS = 160


def json_text(value: Any) -> str:
    """The value as JSON, with a line feed at its end."""
    return _text(value, 0) + "\n"


def _text(value: Any, indent: int, before: int = 0) -> str:
    """The value behind ``before`` columns of its line; further lines begin deeper than ``indent``."""
    flat = json.dumps(value)
    if indent + before + len(flat) <= _COLUMNS or not isinstance(value, Mapping | list | tuple) or not value:
        return flat
    inner = " " * (indent + 1)
    if isinstance(value, Mapping):
        keys = [f"{json.dumps(key)}: " for key in value]
        lines = [key + _text(item, indent + 1, len(key)) for key, item in zip(keys, value.values(), strict=True)]
        opening, closing = "{", "}"
    else:
        lines = [_text(item, indent + 1) for item in value]
        opening, closing = "[", "]"
    return opening + "\n" + ",\n".join(inner + line for line in lines) + "\n" + " " * indent + closing
