"""The types of the modelling language.

A value of any type is a sequence of *slots* (its scalar leaves, in declaration order), so an array of records and a
bounded integer differ only in how many slots they have. Clocks and channels are slots too: their content is the fixed
number of that clock or channel, which makes indexing, passing by reference and structs with clocks one mechanism.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeGuard

from tachk.base.operators import CONSTANT_HIGH, CONSTANT_LOW
from tachk.base.records import dataclass, field

DEFAULT_INT_LOW, DEFAULT_INT_HIGH = -32768, 32767


@dataclass(frozen=True, slots=True)
class IntType:
    """An integer in ``[low, high]``. Plain ``int`` is ``[-32768, 32767]``; constants may use the full 32 bits."""

    low: int = DEFAULT_INT_LOW
    high: int = DEFAULT_INT_HIGH


def integer_range(low: int, high: int, name: str = "") -> IntType:
    """The type of the integers in a range, perhaps of a variable of this name. Raises ValueError if the range is empty,
    or does not fit into 32 bits."""
    if not CONSTANT_LOW <= low <= high <= CONSTANT_HIGH:
        of = f" of {name}" if name else ""
        raise ValueError(f"the range [{low}, {high}]{of} is empty, or does not fit into 32 bits")
    return IntType(low, high)


@dataclass(frozen=True, slots=True)
class BoolType:
    """0 or 1."""


@dataclass(frozen=True, slots=True)
class ScalarType:
    """One of ``size`` interchangeable values; two scalar types are the same type only if their names are equal."""

    name: str
    size: int


@dataclass(frozen=True, slots=True)
class ClockType:
    pass


@dataclass(frozen=True, slots=True)
class ChannelType:
    broadcast: bool = False
    urgent: bool = False


@dataclass(frozen=True, slots=True)
class VoidType:
    pass


@dataclass(frozen=True, slots=True)
class ArrayType:
    """``size`` elements indexed by ``index``: ``int a[4]`` by ``[0, 3]``, ``int a[id_t]`` by the values of ``id_t``."""

    element: Type
    index: IntType | ScalarType

    @property
    def low(self) -> int:
        return self.index.low if isinstance(self.index, IntType) else 0

    @property
    def size(self) -> int:
        return self.index.high - self.index.low + 1 if isinstance(self.index, IntType) else self.index.size


@dataclass(frozen=True, slots=True)
class RecordType:
    """A struct; ``name`` is for messages only, equality of fields decides assignability.

    Attributes:
        left_out: fields of the text that the model is without, each with its place among all fields and its type.
    """

    name: str
    fields: tuple[tuple[str, Type], ...]
    left_out: tuple[tuple[int, str, Type], ...] = field(default=(), compare=False)

    def leaves_out(self, name: str) -> bool:
        return self.left_out_type(name) is not None

    def left_out_type(self, name: str) -> Type | None:
        """The type of a field that the model is without; None for any other name."""
        return next((type_ for _, left_out, type_ in self.left_out if left_out == name), None)

    def offset(self, field: str) -> int:
        """The number of slots in front of a field. Raises KeyError for an unknown field."""
        before = 0
        for name, type_ in self.fields:
            if name == field:
                return before
            before += slot_count(type_)
        raise KeyError(field)


ScalarLike = IntType | BoolType | ScalarType
Type = IntType | BoolType | ScalarType | ClockType | ChannelType | VoidType | ArrayType | RecordType


def is_aggregate(type_: Type) -> TypeGuard[ArrayType | RecordType]:
    return isinstance(type_, ArrayType | RecordType)


def contains_left_out(type_: Type) -> bool:
    """True if the model is without some field of a value of the type."""
    match type_:
        case ArrayType(element):
            return contains_left_out(element)
        case RecordType(_, fields, left_out):
            return bool(left_out) or any(contains_left_out(inner) for _, inner in fields)
        case BoolType() | IntType() | ScalarType() | ClockType() | ChannelType() | VoidType():
            return False


def element_type(type_: Type) -> Type:
    """The type of the elements of an array, through all dimensions, or the type itself."""
    while isinstance(type_, ArrayType):
        type_ = type_.element
    return type_


def slot_count(type_: Type) -> int:
    """The number of slots of a value of the type."""
    match type_:
        case ArrayType():
            return type_.size * slot_count(type_.element)
        case RecordType():
            return sum(slot_count(t) for _, t in type_.fields)
        case VoidType():
            return 0
        case IntType() | BoolType() | ScalarType() | ClockType() | ChannelType():
            return 1


def clock_count(type_: Type) -> int:
    """The number of slots that are clocks."""
    match type_:
        case ArrayType():
            return type_.size * clock_count(type_.element)
        case RecordType():
            return sum(clock_count(t) for _, t in type_.fields)
        case IntType() | BoolType() | ScalarType() | ClockType() | ChannelType() | VoidType():
            return int(isinstance(type_, ClockType))


def nesting(type_: Type) -> int:
    """The number of arrays and structs around the innermost part of a type; 0 for an integer."""
    match type_:
        case ArrayType():
            return 1 + nesting(type_.element)
        case RecordType():
            return 1 + max((nesting(t) for _, t in type_.fields), default=0)
        case IntType() | BoolType() | ScalarType() | ClockType() | ChannelType() | VoidType():
            return 0


def leaves(type_: Type, path: str = "") -> Iterator[tuple[str, Type]]:
    """The slots of a type in order, each with its access path (``[2].x``) and its leaf type."""
    match type_:
        case ArrayType():
            for i in range(type_.size):
                yield from leaves(type_.element, f"{path}[{type_.low + i}]")
        case RecordType():
            for name, field_type in type_.fields:
                yield from leaves(field_type, f"{path}.{name}")
        case VoidType():
            return
        case IntType() | BoolType() | ScalarType() | ClockType() | ChannelType():
            yield path, type_


def kinds_of_slots(type_: Type) -> Iterator[Type]:
    """The leaf types of a type; of an array those of one element."""
    match type_:
        case ArrayType():
            yield from kinds_of_slots(type_.element)
        case RecordType():
            for _, field_type in type_.fields:
                yield from kinds_of_slots(field_type)
        case VoidType():
            return
        case IntType() | BoolType() | ScalarType() | ClockType() | ChannelType():
            yield type_


def bounds(type_: ScalarLike) -> tuple[int, int]:
    """The smallest and the largest value of an integer-like type."""
    match type_:
        case IntType(low, high):
            return low, high
        case BoolType():
            return 0, 1
        case ScalarType(_, size):
            return 0, size - 1
