"""The operators of the language: one row for each, and every fact about it in that row.

The printer, the evaluator, the folders, the compiler and what asks what other tools know all read this table. Who adds
an operator adds a row; one without it stops the import. What code computes at run time is the C++ core's own, and
judged by this table on random expressions.
"""

from __future__ import annotations

import operator as op
from collections.abc import Callable
from enum import Enum, StrEnum
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from fractions import Fraction

CONSTANT_LOW, CONSTANT_HIGH = -(2**31), 2**31 - 1
"""Numbers have 32 bits."""


def wrapped(value: int) -> int:
    """The 32-bit number with the same low bits."""
    return (value - CONSTANT_LOW) % 2**32 + CONSTANT_LOW


class OperandGroup(Enum):
    """The types of operands and result of an operator."""

    ARITHMETIC = 1
    """Two numbers to a number."""
    COMPARISON = 2
    """Two numbers or clocks to a truth value."""
    CONNECTIVE = 3
    """Two truth values to a truth value; every number but 0 is true."""


class Failure(StrEnum):
    """The reasons why an operation has no value, with a text for one. Named like the run-time errors."""

    DIVISION = "{left} divided by 0"
    SHIFT = "the distance is {right}"
    NEGATIVE_EXPONENT = "the exponent is {right}"


class OperandError(ArithmeticError):
    """An operation has no value for these operands."""

    def __init__(self, failure: Failure, left: int, right: int) -> None:
        self.failure = failure
        super().__init__(failure.value.format(left=left, right=right))


class UnaryOperator(StrEnum):
    """An operator with one operand."""

    MINUS = "-"
    NOT = "!"

    def compute(self, operand: int) -> int:
        """The value, of 32 bits."""
        return _UNARY[self](operand)


class PrefixOperator(StrEnum):
    """The operators before an operand in texts; networks do not have the plus, as it changes nothing."""

    PLUS = "+"
    MINUS = "-"
    NOT = "!"

    def __repr__(self) -> str:
        """As it is written: a tree that is shown reads like its text."""
        return repr(self.value)

    @property
    def word(self) -> str | None:
        """Another spelling."""
        return "not" if self is PrefixOperator.NOT else None


class BinaryOperator(StrEnum):
    """The value of a member is how it is written."""

    ADD = "+"
    SUBTRACT = "-"
    MULTIPLY = "*"
    DIVIDE = "/"
    """Truncates towards zero, as in C; division by zero is a run-time error."""
    MODULO = "%"
    """Sign of the dividend, as in C."""
    POWER = "**"
    BIT_AND = "&"
    BIT_OR = "|"
    BIT_XOR = "^"
    SHIFT_LEFT = "<<"
    SHIFT_RIGHT = ">>"
    AND = "&&"
    """Evaluates its right side only if the left side is true; likewise OR and IMPLY."""
    OR = "||"
    IMPLY = "imply"
    XOR = "xor"
    EQUAL = "=="
    NOT_EQUAL = "!="
    LESS = "<"
    LESS_EQUAL = "<="
    GREATER = ">"
    GREATER_EQUAL = ">="
    MINIMUM = "<?"
    MAXIMUM = ">?"

    def __repr__(self) -> str:
        """As it is written: a tree that is shown reads like its text."""
        return repr(self.value)

    @property
    def word(self) -> str | None:
        """Another spelling."""
        return _ROWS[self].word

    @property
    def level(self) -> int:
        """The precedence: the larger, the stronger it binds. All operators associate to the left."""
        return _ROWS[self].level

    @property
    def group(self) -> OperandGroup:
        return _ROWS[self].group

    @property
    def associative(self) -> bool:
        """True if ``a o (b o c)`` is ``(a o b) o c``."""
        return _ROWS[self].associative

    @property
    def decided_by(self) -> bool | None:
        """The truth of the left side with which the right side is not evaluated; None where it always is."""
        return _ROWS[self].decided_by

    @property
    def total(self) -> bool:
        """True if there is a value for all operands."""
        return _ROWS[self].failure is None

    @property
    def negated(self) -> BinaryOperator:
        """The comparison that is true where this one is false."""
        return self._other(_ROWS[self].negated)

    @property
    def mirrored(self) -> BinaryOperator:
        """The comparison that says the same with its sides exchanged."""
        return self._other(_ROWS[self].mirrored)

    @property
    def since(self) -> tuple[int, int] | None:
        """The first version of UPPAAL that knows it, as far as tachk distinguishes them; None for none."""
        return _ROWS[self].since

    def compute(self, left: int, right: int) -> int:
        """The value, of 32 bits. Raises OperandError where there is none."""
        row = _ROWS[self]
        if row.failure is not None and not self.defined_for(right, right):
            raise OperandError(row.failure, left, right)
        return wrapped(int(row.meaning(left, right)))

    def holds(self, left: int | Fraction, right: int | Fraction) -> bool:
        """True if a comparison is true of two numbers or clock values."""
        return self.comparison(left, right)

    @property
    def comparison(self) -> Callable[[int | Fraction, int | Fraction], bool]:
        """A comparison as a function of two numbers or clock values. Raises ValueError for another operator."""
        row = _ROWS[self]
        if row.group is not OperandGroup.COMPARISON:
            raise ValueError(f"{self} is not a comparison")
        found: Callable[[int | Fraction, int | Fraction], bool] = row.meaning
        return found

    @property
    def rights(self) -> tuple[tuple[int, int], ...]:
        """The intervals of right sides for which there is a value."""
        return _ROWS[self].rights

    def defined_for(self, low: int, high: int) -> bool:
        """True if there is a value for every right side from ``low`` to ``high``."""
        return any(first <= low and high <= last for first, last in self.rights)

    def _other(self, name: str) -> BinaryOperator:
        if not name:
            raise ValueError(f"{self} is not a comparison")
        return BinaryOperator(name)


def _quotient(left: int, right: int) -> int:
    size = abs(left) // abs(right)
    return size if (left < 0) == (right < 0) else -size


_EVERY = ((CONSTANT_LOW, CONSTANT_HIGH),)
_UPPAAL_4, _UPPAAL_5 = (4, 0), (5, 0)


class _OperatorRow(NamedTuple):
    """One operator; the columns are explained at the properties of `BinaryOperator`.

    Attributes:
        meaning: the exact value; connectives get all operands.
        failure: what it is if the right side lies outside ``rights``.
    """

    level: int
    group: OperandGroup
    meaning: Callable[[Any, Any], Any]
    since: tuple[int, int] | None = _UPPAAL_4
    associative: bool = False
    word: str | None = None
    decided_by: bool | None = None
    failure: Failure | None = None
    rights: tuple[tuple[int, int], ...] = _EVERY
    negated: str = ""
    mirrored: str = ""


_A, _C, _L = OperandGroup.ARITHMETIC, OperandGroup.COMPARISON, OperandGroup.CONNECTIVE
_DIVISORS = ((CONSTANT_LOW, -1), (1, CONSTANT_HIGH))
_DISTANCES = ((0, 31),)
_EXPONENTS = ((0, CONSTANT_HIGH),)
_O = BinaryOperator
_ROWS = {
    _O.OR: _OperatorRow(3, _L, lambda a, b: a != 0 or b != 0, associative=True, word="or", decided_by=True),
    _O.IMPLY: _OperatorRow(3, _L, lambda a, b: a == 0 or b != 0, decided_by=False),
    _O.XOR: _OperatorRow(3, _L, lambda a, b: (a != 0) != (b != 0), _UPPAAL_5, associative=True),
    _O.AND: _OperatorRow(4, _L, lambda a, b: a != 0 and b != 0, associative=True, word="and", decided_by=False),
    _O.BIT_OR: _OperatorRow(5, _A, op.or_, associative=True),
    _O.BIT_XOR: _OperatorRow(6, _A, op.xor, associative=True),
    _O.BIT_AND: _OperatorRow(7, _A, op.and_, associative=True),
    _O.EQUAL: _OperatorRow(8, _C, op.eq, negated="!=", mirrored="=="),
    _O.NOT_EQUAL: _OperatorRow(8, _C, op.ne, negated="==", mirrored="!="),
    _O.LESS: _OperatorRow(9, _C, op.lt, negated=">=", mirrored=">"),
    _O.LESS_EQUAL: _OperatorRow(9, _C, op.le, negated=">", mirrored=">="),
    _O.GREATER: _OperatorRow(9, _C, op.gt, negated="<=", mirrored="<"),
    _O.GREATER_EQUAL: _OperatorRow(9, _C, op.ge, negated="<", mirrored="<="),
    _O.MINIMUM: _OperatorRow(10, _A, min, associative=True),
    _O.MAXIMUM: _OperatorRow(10, _A, max, associative=True),
    _O.SHIFT_LEFT: _OperatorRow(11, _A, op.lshift, failure=Failure.SHIFT, rights=_DISTANCES),
    _O.SHIFT_RIGHT: _OperatorRow(11, _A, op.rshift, failure=Failure.SHIFT, rights=_DISTANCES),
    _O.ADD: _OperatorRow(12, _A, op.add, associative=True),
    _O.SUBTRACT: _OperatorRow(12, _A, op.sub),
    _O.MULTIPLY: _OperatorRow(13, _A, op.mul, associative=True),
    _O.DIVIDE: _OperatorRow(13, _A, _quotient, failure=Failure.DIVISION, rights=_DIVISORS),
    _O.MODULO: _OperatorRow(13, _A, lambda a, b: a - _quotient(a, b) * b, failure=Failure.DIVISION, rights=_DIVISORS),
    _O.POWER: _OperatorRow(
        14, _A, lambda a, b: pow(a, b, 2**32), _UPPAAL_5, failure=Failure.NEGATIVE_EXPONENT, rights=_EXPONENTS
    ),
}
_UNARY: dict[UnaryOperator, Callable[[int], int]] = {
    UnaryOperator.MINUS: lambda a: wrapped(-a),
    UnaryOperator.NOT: lambda a: int(a == 0),
}

COMPARISONS = frozenset(each for each in BinaryOperator if each.group is OperandGroup.COMPARISON)
CONNECTIVES = frozenset(each for each in BinaryOperator if each.group is OperandGroup.CONNECTIVE)
