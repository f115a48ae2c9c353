"""Arrays and records of the network as the flat variables of TChecker: what lies in a slot, and where."""

from __future__ import annotations

from collections.abc import Iterator

from tachk.analysis.fold import is_integer
from tachk.formats.tchecker.expression_writer import initial_slots
from tachk.model.expressions import Variable
from tachk.model.types import ArrayType, ClockType, RecordType, Type, slot_count


def leaf_types(type_: Type) -> Iterator[Type]:
    """The types of the leaves, channels among them."""
    for _, leaf in field_paths(type_, channels=True):
        if leaf is not None:
            yield leaf


def field_paths(
    type_: Type, path: tuple[str, ...] = (), channels: bool = False
) -> Iterator[tuple[tuple[str, ...], Type | None]]:
    """The field paths to the leaves of a type, indices left out, each with its leaf type.

    Args:
        channels: whether to list channels, which are not variables in TChecker; otherwise their leaf is None.
    """
    match type_:
        case ArrayType(element):
            yield from field_paths(element, path, channels)
        case RecordType(_, fields):
            for name, inner in fields:
                yield from field_paths(inner, (*path, name), channels)
        case _:
            listed = channels or is_integer(type_) or isinstance(type_, ClockType)
            yield path, type_ if listed else None


def leaf_values(variable: Variable, fields: tuple[str, ...]) -> Iterator[tuple[list[int], int]]:
    """The slots at one field path, each with its indices and its initial value."""
    values = initial_slots(variable)

    def inner(type_: Type, rest: tuple[str, ...], first: int, indices: list[int]) -> Iterator[tuple[list[int], int]]:
        match type_:
            case ArrayType(element):
                for i in range(type_.size):
                    yield from inner(element, rest, first + i * slot_count(element), [*indices, type_.low + i])
            case RecordType(_, listed):
                yield from inner(dict(listed)[rest[0]], rest[1:], first + type_.offset(rest[0]), indices)
            case _:
                yield indices, values[first]

    yield from inner(variable.type, fields, 0, [])


def indices_of(type_: Type, slot: int) -> list[int]:
    """The indices of one element of an array of arrays."""
    result = []
    while isinstance(type_, ArrayType):
        size = slot_count(type_.element)
        result.append(type_.low + slot // size)
        slot, type_ = slot % size, type_.element
    return result
