"""Common divisors of all values of an integer expression.

Needed where code computes the bound of a clock constraint or the value of a clock: the engine counts time in the
largest unit of which all times of a model are multiples.
"""

from __future__ import annotations

from math import gcd

from tachk.analysis.fold import Known
from tachk.analysis.intervals import ANYTHING, interval, possible_slots
from tachk.base.operators import BinaryOperator, UnaryOperator
from tachk.model.expressions import Binary, Comma, Conditional, Expression, Field, Index, Reference, Unary


def divisor(expression: Expression, known: Known) -> int:
    """A number that divides every value an evaluation without a run-time error can have; 0 if that is always 0."""
    low, high = interval(expression, known)
    if low == high:
        return abs(low)
    if (low, high) == ANYTHING:  # it may wrap around
        return 1
    found = _divisor(expression, known)
    return found if found <= max(abs(low), abs(high)) else 0


def _divisor(expression: Expression, known: Known) -> int:
    match expression:
        case Reference() | Index() | Field():
            slots = possible_slots(expression, known)
            if not slots or any(variable not in known.values for variable, _ in slots):
                return 1
            return gcd(*(known.values[variable][slot] for variable, slot in slots))
        case Unary(UnaryOperator.MINUS, operand):
            return divisor(operand, known)
        case Conditional(_, then, otherwise):
            return gcd(divisor(then, known), divisor(otherwise, known))
        case Binary(BinaryOperator.MULTIPLY, left, right):
            return divisor(left, known) * divisor(right, known)
        case Binary(
            BinaryOperator.ADD | BinaryOperator.SUBTRACT | BinaryOperator.MINIMUM | BinaryOperator.MAXIMUM, left, right
        ):
            return gcd(divisor(left, known), divisor(right, known))
        case Comma(items):
            return divisor(items[-1], known)
        case _:
            pass
    return 1
