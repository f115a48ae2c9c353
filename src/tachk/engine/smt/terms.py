"""Numbers and truth values as terms of z3, worked out at once where they are known.

A number carries the interval in which it lies and is a bit vector just wide enough for that; arithmetic has 32 bits and
wraps around, as the language says. A formula is a Python ``bool`` where it is known.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, TypeAlias

import z3

from tachk.base.operators import CONSTANT_HIGH, CONSTANT_LOW, BinaryOperator, OperandError
from tachk.base.records import dataclass

Formula: TypeAlias = "bool | z3.BoolRef"

_LISTED = 64
"""A number with at most so many values is compared with clocks value by value."""


def conj(*formulas: Formula) -> Formula:
    return all_of(formulas)


def disj(*formulas: Formula) -> Formula:
    return any_of(formulas)


def all_of(formulas: Iterable[Formula]) -> Formula:
    parts = []
    for formula in formulas:
        if formula is False:
            return False
        if formula is not True:
            parts.append(formula)
    return (parts[0] if len(parts) == 1 else z3.And(parts)) if parts else True


def any_of(formulas: Iterable[Formula]) -> Formula:
    parts = []
    for formula in formulas:
        if formula is True:
            return True
        if formula is not False:
            parts.append(formula)
    return (parts[0] if len(parts) == 1 else z3.Or(parts)) if parts else False


def neg(formula: Formula) -> Formula:
    return not formula if isinstance(formula, bool) else z3.Not(formula)


def same(left: Formula, right: Formula) -> Formula:
    """The formula that two formulas have the same truth."""
    if isinstance(left, bool):
        return right if left else neg(right)
    if isinstance(right, bool):
        return left if right else neg(left)
    return left == right


@dataclass(frozen=True, slots=True)
class SymbolicNumber:
    """``term``: None exactly where ``low`` equals ``high``."""

    low: int
    high: int
    term: z3.BitVecRef | None = None

    def at_width(self, bits: int) -> z3.BitVecRef:
        if self.term is None:
            return z3.BitVecVal(self.low, bits)
        size = self.term.size()
        if size == bits:
            return self.term
        return z3.SignExt(bits - size, self.term) if size < bits else z3.Extract(bits - 1, 0, self.term)

    def is_value(self, value: int) -> Formula:
        return compare(BinaryOperator.EQUAL, self, constant(value))

    @property
    def values(self) -> range:
        return range(self.low, self.high + 1)


def constant(value: int) -> SymbolicNumber:
    return SymbolicNumber(value, value)


def unknown(name: str, low: int, high: int) -> SymbolicNumber:
    """A number of which only the range is known; `in_range` says that range to the solver."""
    return constant(low) if low == high else SymbolicNumber(low, high, z3.BitVec(name, _width(low, high)))


def in_range(number: SymbolicNumber) -> Formula:
    """The formula that a number which `unknown` made lies in its range."""
    if number.term is None:
        return True
    widest = 1 << (number.term.size() - 1)
    parts: list[Formula] = []
    if number.low > -widest:
        parts.append(number.term >= number.low)
    if number.high < widest - 1:
        parts.append(number.term <= number.high)
    return all_of(parts)


def narrowed(number: SymbolicNumber, low: int, high: int) -> SymbolicNumber:
    """The number where it is known to lie in a range."""
    low, high = max(number.low, low), min(number.high, high)
    if low >= high:  # above: it never lies there, so that any value will do
        return constant(low)
    return SymbolicNumber(low, high, SymbolicNumber(number.low, number.high, number.term).at_width(_width(low, high)))


def of_formula(formula: Formula) -> SymbolicNumber:
    return choose(formula, constant(1), constant(0))


def truth_of(number: SymbolicNumber) -> Formula:
    return neg(number.is_value(0))


def choose(condition: Formula, then: SymbolicNumber, otherwise: SymbolicNumber) -> SymbolicNumber:
    if isinstance(condition, bool):
        return then if condition else otherwise
    if then is otherwise or (then.term is None and otherwise.term is None and then.low == otherwise.low):
        return then
    low, high = min(then.low, otherwise.low), max(then.high, otherwise.high)
    bits = _width(low, high)
    return SymbolicNumber(low, high, z3.If(condition, then.at_width(bits), otherwise.at_width(bits)))


def compare(operator: BinaryOperator, left: SymbolicNumber, right: SymbolicNumber) -> Formula:
    if left.term is None and right.term is None:
        return operator.holds(left.low, right.low)
    if left.high < right.low:
        return operator.holds(0, 1)
    if left.low > right.high:
        return operator.holds(1, 0)
    if operator in (BinaryOperator.LESS_EQUAL, BinaryOperator.GREATER) and left.high <= right.low:
        return operator is BinaryOperator.LESS_EQUAL
    if operator in (BinaryOperator.GREATER_EQUAL, BinaryOperator.LESS) and left.low >= right.high:
        return operator is BinaryOperator.GREATER_EQUAL
    bits = _width(min(left.low, right.low), max(left.high, right.high))
    a, b = left.at_width(bits), right.at_width(bits)
    match operator:
        case BinaryOperator.EQUAL:
            return a == b
        case BinaryOperator.NOT_EQUAL:
            return a != b
        case BinaryOperator.LESS:
            return a < b
        case BinaryOperator.LESS_EQUAL:
            return a <= b
        case BinaryOperator.GREATER:
            return a > b
        case BinaryOperator.GREATER_EQUAL:
            return a >= b
        case _:
            raise ValueError(f"{operator} does not compare")


def compute(operator: BinaryOperator, left: SymbolicNumber, right: SymbolicNumber) -> SymbolicNumber:
    """The value of an operation where it has one; anything where it has none.

    Raises ValueError for a power whose exponent varies too much.
    """
    if left.term is None and right.term is None:
        try:
            return constant(operator.compute(left.low, right.low))
        except OperandError:
            return constant(0)
    match operator:
        case BinaryOperator.ADD:
            return _exact(left.low + right.low, left.high + right.high, left, right, lambda a, b: a + b)
        case BinaryOperator.SUBTRACT:
            return _exact(left.low - right.high, left.high - right.low, left, right, lambda a, b: a - b)
        case BinaryOperator.MULTIPLY:
            products = [a * b for a in (left.low, left.high) for b in (right.low, right.high)]
            return _exact(min(products), max(products), left, right, lambda a, b: a * b)
        case BinaryOperator.DIVIDE:
            most = max(abs(left.low), abs(left.high))
            low = 0 if left.low >= 0 and right.low >= 0 else -most
            return _exact(low, most, left, right, lambda a, b: a / b)
        case BinaryOperator.MODULO:
            most = min(max(abs(right.low), abs(right.high), 1) - 1, max(abs(left.low), abs(left.high)))
            return _exact(0 if left.low >= 0 else -most, most, left, right, z3.SRem)
        case BinaryOperator.MINIMUM:
            return choose(compare(BinaryOperator.LESS_EQUAL, left, right), left, right)
        case BinaryOperator.MAXIMUM:
            return choose(compare(BinaryOperator.GREATER_EQUAL, left, right), left, right)
        case BinaryOperator.BIT_AND:
            return _bitwise(left, right, lambda a, b: a & b)
        case BinaryOperator.BIT_OR:
            return _bitwise(left, right, lambda a, b: a | b)
        case BinaryOperator.BIT_XOR:
            return _bitwise(left, right, lambda a, b: a ^ b)
        case BinaryOperator.SHIFT_LEFT:
            return _exact(-(1 << 63), (1 << 63) - 1, left, right, lambda a, b: a << b)
        case BinaryOperator.SHIFT_RIGHT:
            return _exact(min(left.low, 0), max(left.high, 0), left, right, lambda a, b: a >> b)
        case BinaryOperator.POWER:
            return _power(left, right)
        case _:
            raise ValueError(f"{operator} does not compute a number")


def undefined(operator: BinaryOperator, right: SymbolicNumber) -> Formula:
    """The formula that an operation has no value for a right side."""
    if operator.total or operator.defined_for(right.low, right.high):
        return False
    if operator in (BinaryOperator.DIVIDE, BinaryOperator.MODULO):
        return right.is_value(0)
    below = compare(BinaryOperator.LESS, right, constant(0))
    if operator is BinaryOperator.POWER:
        return below
    return disj(below, compare(BinaryOperator.GREATER, right, constant(31)))


def of_each_value(number: SymbolicNumber) -> list[tuple[Formula, int]] | None:
    """The values of a number, each with the condition that it has it; None where there are many."""
    if number.high - number.low >= _LISTED:
        return None
    return [(number.is_value(value), value) for value in number.values]


def real(number: SymbolicNumber) -> z3.ArithRef:
    """The number among the reals, as a sum of its bits."""
    if number.term is None:
        return z3.RealVal(number.low)
    top = number.term.size() - 1
    weights = [(1 << bit) if bit < top else -(1 << bit) for bit in range(top + 1)]
    zero = z3.RealVal(0)
    return z3.Sum([z3.If(z3.Extract(bit, bit, number.term) == 1, z3.RealVal(w), zero) for bit, w in enumerate(weights)])


def _width(low: int, high: int) -> int:
    """The number of bits that hold every number of an interval, with a sign."""
    return max((low if low >= 0 else ~low).bit_length(), (high if high >= 0 else ~high).bit_length()) + 1


def _exact(
    low: int, high: int, left: SymbolicNumber, right: SymbolicNumber, apply: Callable[[Any, Any], Any]
) -> SymbolicNumber:
    """An operation in as many bits as its exact result needs, cut to 32 bits if that is more."""
    bits = _width(min(low, left.low, right.low), max(high, left.high, right.high))
    term = apply(left.at_width(bits), right.at_width(bits))
    if low < CONSTANT_LOW or high > CONSTANT_HIGH:
        return SymbolicNumber(CONSTANT_LOW, CONSTANT_HIGH, SymbolicNumber(low, high, term).at_width(32))
    if low == high:
        return constant(low)
    return SymbolicNumber(low, high, SymbolicNumber(low, high, term).at_width(_width(low, high)))


def _bitwise(left: SymbolicNumber, right: SymbolicNumber, apply: Callable[[Any, Any], Any]) -> SymbolicNumber:
    bits = _width(min(left.low, right.low), max(left.high, right.high))
    top = (1 << (bits - 1)) - 1
    return _exact(0 if left.low >= 0 and right.low >= 0 else -top - 1, top, left, right, apply)


def _power(base: SymbolicNumber, exponent: SymbolicNumber) -> SymbolicNumber:
    choices = of_each_value(exponent)
    if choices is None:
        raise ValueError("the exponent has too many values")
    result = constant(0)
    power, so_far = constant(1), 0
    for condition, value in choices:
        if value < 0:
            continue
        while so_far < value:
            power, so_far = compute(BinaryOperator.MULTIPLY, power, base), so_far + 1
        result = choose(condition, power, result)
    return result
