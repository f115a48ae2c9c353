"""Floating point numbers: IEEE doubles as values of two slots, and what can be computed with them.

A double is a record of two 32-bit integers, its high and its low half, so that storing, passing and indexing need
nothing of their own. `src/core/machine/floating.hpp` mirrors the numbers of the operations and what they compute. What
every library computes alike, to the last bit, may be verified; the others are for simulations only.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator, Sequence
from enum import IntEnum

from tachk.model.types import ArrayType, BoolType, IntType, RecordType, Type, slot_count

_HALF = IntType(-(2**31), 2**31 - 1)

DOUBLE = RecordType("double", (("high", _HALF), ("low", _HALF)))
"""The type `double`."""

HYBRID_DOUBLE = RecordType("hybrid clock", DOUBLE.fields)
"""The place of a hybrid clock in a record. An expression of it is a `double`."""


class FloatingOperation(IntEnum):
    """The computation of functions with this `Function.operation`. A result that is not finite is a run-time error."""

    ADD = 0
    SUBTRACT = 1
    MULTIPLY = 2
    DIVIDE = 3
    MINIMUM = 4
    """The first of equal ones."""
    MAXIMUM = 5
    NEGATE = 6
    ABSOLUTE = 7
    SQUARE_ROOT = 8
    FLOOR = 9
    CEILING = 10
    TRUNCATE = 11
    ROUND = 12
    """Halves away from zero."""
    FROM_INTEGER = 13
    TO_INTEGER = 14
    """The whole part; a run-time error beyond 32 bits."""
    EQUAL = 15
    NOT_EQUAL = 16
    LESS = 17
    LESS_EQUAL = 18
    GREATER = 19
    GREATER_EQUAL = 20
    EXPONENTIAL = 21
    LOGARITHM = 22
    """The natural one."""
    DECIMAL_LOGARITHM = 23
    BINARY_LOGARITHM = 24
    SINE = 25
    COSINE = 26
    TANGENT = 27
    ARC_SINE = 28
    ARC_COSINE = 29
    ARC_TANGENT = 30
    RANDOM = 31
    """Uniformly from 0 up to the argument, which is left out. Only the core can draw."""
    ARC_TANGENT_2 = 32
    POWER = 33
    REMAINDER = 34
    """With the sign of the first argument."""
    HYPOTENUSE = 35
    RANDOM_NORMAL = 36
    """By mean and standard deviation."""
    RANDOM_POISSON = 37
    """By mean."""
    RANDOM_ARCSINE = 38
    """Between two numbers."""
    RANDOM_GAMMA = 39
    """By shape and scale."""
    RANDOM_BETA = 40
    RANDOM_WEIBULL = 41
    """By shape and scale."""
    RANDOM_TRIANGULAR = 42
    """On 0 to 1, by the most probable value."""

    @property
    def parameters(self) -> tuple[Type, ...]:
        if self is FloatingOperation.FROM_INTEGER:
            return (_HALF,)
        exact = FloatingOperation.NEGATE <= self <= FloatingOperation.TO_INTEGER
        unary = exact or FloatingOperation.EXPONENTIAL <= self <= FloatingOperation.RANDOM
        unary = unary or self in (FloatingOperation.RANDOM_POISSON, FloatingOperation.RANDOM_TRIANGULAR)
        return (DOUBLE,) if unary else (DOUBLE, DOUBLE)

    @property
    def result(self) -> Type:
        if self is FloatingOperation.TO_INTEGER:
            return _HALF
        compares = FloatingOperation.EQUAL <= self <= FloatingOperation.GREATER_EQUAL
        return BoolType() if compares else DOUBLE

    @property
    def draws(self) -> bool:
        """True if the result is a random number."""
        return self is FloatingOperation.RANDOM or self >= FloatingOperation.RANDOM_NORMAL

    @property
    def only_simulated(self) -> bool:
        """True if the result is random, or depends on the library that computes it."""
        return self >= FloatingOperation.EXPONENTIAL

    @property
    def total(self) -> bool:
        """True if there is always a result."""
        return self not in _PARTIAL and not self.only_simulated

    def compute(self, arguments: Sequence[float]) -> float | int | None:
        """The result; None where it is not finite, or too large for an integer."""
        first, second = arguments[0], arguments[-1]
        if self.draws:
            return None
        try:
            result = _library(self, first, second) if self.only_simulated else _computed(self, first, second)
        except (ArithmeticError, ValueError):
            return None
        if self is FloatingOperation.TO_INTEGER:
            return int(result) if _HALF.low <= result <= _HALF.high else None
        return result if math.isfinite(result) else None


_PARTIAL = (
    FloatingOperation.ADD,
    FloatingOperation.SUBTRACT,
    FloatingOperation.MULTIPLY,
    FloatingOperation.DIVIDE,
    FloatingOperation.SQUARE_ROOT,
    FloatingOperation.TO_INTEGER,
)


def _computed(operation: FloatingOperation, first: float, second: float) -> float | int:
    match operation:
        case FloatingOperation.ADD:
            return first + second
        case FloatingOperation.SUBTRACT:
            return first - second
        case FloatingOperation.MULTIPLY:
            return first * second
        case FloatingOperation.DIVIDE:
            return first / second
        case FloatingOperation.MINIMUM:
            return second if second < first else first
        case FloatingOperation.MAXIMUM:
            return second if second > first else first
        case FloatingOperation.NEGATE:
            return -first
        case FloatingOperation.ABSOLUTE:
            return math.fabs(first)
        case FloatingOperation.SQUARE_ROOT:
            return math.sqrt(first)
        case FloatingOperation.FLOOR:
            return math.copysign(math.floor(first), first)
        case FloatingOperation.CEILING:
            return math.copysign(math.ceil(first), first)
        case FloatingOperation.TRUNCATE | FloatingOperation.TO_INTEGER:
            return math.copysign(math.trunc(first), first)
        case FloatingOperation.ROUND:
            whole = math.trunc(first)
            return math.copysign(abs(whole) + (math.fabs(first - whole) >= 0.5), first)
        case FloatingOperation.FROM_INTEGER:
            return float(first)
        case FloatingOperation.EQUAL:
            return first == second
        case FloatingOperation.NOT_EQUAL:
            return first != second
        case FloatingOperation.LESS:
            return first < second
        case FloatingOperation.LESS_EQUAL:
            return first <= second
        case FloatingOperation.GREATER:
            return first > second
        case FloatingOperation.GREATER_EQUAL:
            return first >= second
        case _:
            raise ValueError(f"{operation} is computed by a library")


def _library(operation: FloatingOperation, first: float, second: float) -> float:
    match operation:
        case FloatingOperation.EXPONENTIAL:
            return math.exp(first)
        case FloatingOperation.LOGARITHM:
            return math.log(first)
        case FloatingOperation.DECIMAL_LOGARITHM:
            return math.log10(first)
        case FloatingOperation.BINARY_LOGARITHM:
            return math.log2(first)
        case FloatingOperation.SINE:
            return math.sin(first)
        case FloatingOperation.COSINE:
            return math.cos(first)
        case FloatingOperation.TANGENT:
            return math.tan(first)
        case FloatingOperation.ARC_SINE:
            return math.asin(first)
        case FloatingOperation.ARC_COSINE:
            return math.acos(first)
        case FloatingOperation.ARC_TANGENT:
            return math.atan(first)
        case FloatingOperation.ARC_TANGENT_2:
            return math.atan2(first, second)
        case FloatingOperation.POWER:
            return math.pow(first, second)
        case FloatingOperation.REMAINDER:
            return math.fmod(first, second)
        case FloatingOperation.HYPOTENUSE:
            return math.hypot(first, second)
        case _:
            raise ValueError(f"{operation} is not computed by a library")


def halves(number: float) -> tuple[int, int]:
    """The slots of a floating point number."""
    high, low = struct.unpack(">ii", struct.pack(">d", number))
    return high, low


def number_of(slots: Sequence[int]) -> float:
    """The floating point number in two slots."""
    number: float = struct.unpack(">d", struct.pack(">ii", *slots))[0]
    return number


def contains_double(type_: Type) -> bool:
    """True if a value of the type has a floating point number in it."""
    match type_:
        case RecordType(_, fields):
            return is_double(type_) or any(contains_double(inner) for _, inner in fields)
        case ArrayType(element):
            return contains_double(element)
        case _:
            return False


def is_floating(type_: Type) -> bool:
    """True if a value of the type consists of floating point numbers only."""
    match type_:
        case ArrayType(element):
            return is_floating(element)
        case RecordType(_, fields):
            return is_double(type_) or (bool(fields) and all(is_floating(inner) for _, inner in fields))
        case _:
            return False


def is_double(type_: Type) -> bool:
    """True if a place of the type holds one floating point number."""
    return type_ in (DOUBLE, HYBRID_DOUBLE)


def value_type(type_: Type) -> Type:
    """The type of what a place of the type holds, as an expression has it."""
    return DOUBLE if type_ == HYBRID_DOUBLE else type_


def variable_type(type_: Type) -> Type:
    """The type of a variable that is declared with a type: `Variable.is_hybrid` marks hybrid clocks."""
    match type_:
        case ArrayType(element, index):
            return ArrayType(variable_type(element), index)
        case _:
            return value_type(type_)


def hybrid_offsets(type_: Type, first: int = 0) -> Iterator[int]:
    """The slots at which the hybrid clocks among the fields of a type begin."""
    match type_:
        case RecordType() if type_ == HYBRID_DOUBLE:
            yield first
        case RecordType(_, fields):
            for _, inner in fields:
                yield from hybrid_offsets(inner, first)
                first += slot_count(inner)
        case ArrayType(element):
            inside = tuple(hybrid_offsets(element))
            size = slot_count(element)
            yield from (first + number * size + offset for number in range(type_.size) for offset in inside)
        case _:
            return
