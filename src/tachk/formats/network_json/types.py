"""The types of a network as JSON.

Short strings for the frequent ones (``"bool"``, ``"clock"``, ``"int[0,3]"``), objects with one key for the others.
"""

from __future__ import annotations

import re
from typing import Any

from tachk.model.types import (
    ArrayType,
    BoolType,
    ChannelType,
    ClockType,
    IntType,
    RecordType,
    ScalarType,
    Type,
    VoidType,
    integer_range,
)

Json = Any
"""The argument of `json.dumps`. Checked by the schema, not by the type checker."""

_RANGE = re.compile(r"int\[(-?\d+),(-?\d+)\]")
_CHANNELS = {
    (False, False): "chan",
    (True, False): "broadcast chan",
    (False, True): "urgent chan",
    (True, True): "urgent broadcast chan",
}
_WORDS: dict[str, Type] = {
    "bool": BoolType(),
    "clock": ClockType(),
    "void": VoidType(),
    **{text: ChannelType(broadcast, urgent) for (broadcast, urgent), text in _CHANNELS.items()},
}


def type_to_json(type_: Type) -> Json:
    match type_:
        case IntType(low, high):
            return f"int[{low},{high}]"
        case BoolType():
            return "bool"
        case ClockType():
            return "clock"
        case VoidType():
            return "void"
        case ChannelType(broadcast, urgent):
            return _CHANNELS[broadcast, urgent]
        case ScalarType(name, size):
            return {"scalar": {"name": name, "size": size}}
        case ArrayType(element, index):
            return {"array": {"element": type_to_json(element), "index": type_to_json(index)}}
        case RecordType(name, fields):
            listed = [{"name": field, "type": type_to_json(inner)} for field, inner in fields]
            return {"struct": {"name": name, "fields": listed}}


def type_from_json(value: Json) -> Type:
    """Raises ValueError, KeyError or TypeError for anything `type_to_json` does not write."""
    if isinstance(value, str):
        found = _RANGE.fullmatch(value)
        if found is not None:
            return integer_range(int(found[1]), int(found[2]))
        return _WORDS[value]
    ((kind, parts),) = value.items()
    match kind:
        case "scalar":
            return ScalarType(parts["name"], parts["size"])
        case "array":
            index = type_from_json(parts["index"])
            if not isinstance(index, IntType | ScalarType):
                raise ValueError(f"arrays are not indexed by {index}")
            return ArrayType(type_from_json(parts["element"]), index)
        case "struct":
            fields = tuple((field["name"], type_from_json(field["type"])) for field in parts["fields"])
            return RecordType(parts["name"], fields)
        case _:
            raise ValueError(f"{kind!r} is not a kind of type")
