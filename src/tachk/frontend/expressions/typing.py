"""The rules for types: which of them go together."""

from __future__ import annotations

from typing import TypeGuard, assert_never

from tachk.base.operators import CONSTANT_HIGH, CONSTANT_LOW
from tachk.model.expressions import Call, Conditional, Constant, Expression, Field, Index, Reference
from tachk.model.floating import is_double
from tachk.model.types import (
    DEFAULT_INT_HIGH,
    DEFAULT_INT_LOW,
    ArrayType,
    BoolType,
    ChannelType,
    ClockType,
    IntType,
    RecordType,
    ScalarType,
    Type,
    VoidType,
    kinds_of_slots,
)

WIDE = IntType(CONSTANT_LOW, CONSTANT_HIGH)
"""The type of constants: the full 32 bits."""


def is_integral(type_: Type) -> TypeGuard[IntType | BoolType]:
    """True if arithmetic and conditions can use values of the type."""
    return isinstance(type_, IntType | BoolType)


def is_bounded(type_: Type) -> TypeGuard[IntType | BoolType | ScalarType]:
    """True if a variable may run over all values of the type: a bounded integer, bool or scalar, not plain ``int``."""
    return isinstance(type_, IntType | BoolType | ScalarType) and type_ not in (IntType(), WIDE)


def is_data(type_: Type) -> bool:
    """True if values of the type can be copied and compared: no clocks, channels or void inside."""
    return not isinstance(type_, VoidType) and not any(
        isinstance(leaf, ClockType | ChannelType) for leaf in kinds_of_slots(type_)
    )


def same_shape(left: Type, right: Type) -> bool:
    """True if values of one type can be stored in a variable of the other, ranges aside (they are checked when the
    model runs)."""
    match left, right:
        case (IntType(), IntType()) | (BoolType(), BoolType()) | (ClockType(), ClockType()):
            return True
        case ChannelType(), ChannelType():
            return True
        case ScalarType(), ScalarType():
            return left == right
        case ArrayType(element, index), ArrayType(other_element, other_index):
            if isinstance(index, ScalarType) or isinstance(other_index, ScalarType):
                return index == other_index and same_shape(element, other_element)
            return left.size == right.size and same_shape(element, other_element)
        case RecordType(_, fields), RecordType(_, other_fields):
            if is_double(left) or is_double(right):
                return is_double(left) and is_double(right)
            return len(fields) == len(other_fields) and all(
                name == other and same_shape(type_, other_type)
                for (name, type_), (other, other_type) in zip(fields, other_fields, strict=True)
            )
        case _:
            return False


def can_assign(target: Type, value: Type) -> bool:
    """True if a value of one type may be assigned to a variable of another (not a clock)."""
    if is_integral(target) and is_integral(value):
        return True
    if is_double(target) and is_integral(value):
        return True
    return is_data(target) and same_shape(target, value)


def describe(type_: Type) -> str:
    """A type as a user would write it."""
    match type_:
        case IntType(low, high):
            return "int" if type_ in (IntType(), WIDE) else f"int[{low},{high}]"
        case BoolType():
            return "bool"
        case ScalarType(name, size):
            return name or f"scalar[{size}]"
        case ClockType():
            return "clock"
        case ChannelType(broadcast, urgent):
            return "urgent " * urgent + "broadcast " * broadcast + "chan"
        case VoidType():
            return "void"
        case RecordType(name):
            return name or "struct"
        case ArrayType():
            dimensions = ""
            element: Type = type_
            while isinstance(element, ArrayType):
                dimensions += f"[{_index(element.index)}]"
                element = element.element
            return describe(element) + dimensions
        case _ as never:
            assert_never(never)


def _index(index: IntType | ScalarType) -> str:
    if isinstance(index, IntType) and index.low == 0:
        return str(index.high + 1)
    return describe(index)


def value_range(expression: Expression) -> tuple[int, int]:
    """Bounds of the value of an integral expression, as far as its form shows."""
    match expression:
        case Constant(value):
            return value, value
        case Conditional(_, then, otherwise):
            low, high = value_range(then)
            other_low, other_high = value_range(otherwise)
            return min(low, other_low), max(high, other_high)
        case _ if isinstance(expression.type, BoolType):
            return 0, 1
        case Reference() | Index() | Field() | Call() if isinstance(expression.type, IntType):
            return expression.type.low, expression.type.high
        case _:
            return DEFAULT_INT_LOW, DEFAULT_INT_HIGH


CHANNEL_HELP = "a channel has no value; it can only stand in a synchronisation, as in `sync go!`"
CLOCK_VALUE_HELP = "clocks can only be compared, as in `x <= 5` or `x - y < n`"
FINT_HELP = "`fint(e)` makes it an integer and cuts off what is behind the point"
