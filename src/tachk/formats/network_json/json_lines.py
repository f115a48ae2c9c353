"""The text of plain data of any depth, as `json.dumps` writes it with an indent of 1.

Chains of thousands of operands or of ``else if`` are as deep as they are long. The generators of `json` hand each piece
through all levels, and the blanks before each line would be as many as its depth: both are quadratic. So this writer
keeps its own stack, and lines that lie deeper than `DEEPEST_INDENT` are indented as that.
"""

from __future__ import annotations

import json
from collections.abc import Iterator

from tachk.formats.network_json.types import Json

DEEPEST_INDENT = 64

_encoded = json.JSONEncoder().encode


def json_pieces(value: Json) -> Iterator[str]:
    """The pieces of the text, in order."""
    waiting: list[str | tuple[int, Json]] = [(0, value)]  # what follows, the next one last: text, or depth and value
    while waiting:
        following = waiting.pop()
        if isinstance(following, str):
            yield following
            continue
        depth, value = following
        if not isinstance(value, dict | list | tuple) or not value:
            yield _encoded(value)
            continue
        if isinstance(value, dict):
            opening, closing = "{", "}"
            parts = [(f"{_encoded(key)}: ", item) for key, item in value.items()]
        else:
            opening, closing = "[", "]"
            parts = [("", item) for item in value]
        waiting.append(_line(depth) + closing)
        line = _line(depth + 1)
        for number in range(len(parts) - 1, -1, -1):
            heading, item = parts[number]
            waiting.append((depth + 1, item))
            waiting.append(("," if number else opening) + line + heading)


def _line(depth: int) -> str:
    """The beginning of a line."""
    return "\n" + " " * min(depth, DEEPEST_INDENT)
