"""Which expressions can meet a run-time error, as far as the ranges of variables tell."""

from __future__ import annotations

from collections.abc import Iterable
from typing import assert_never

from tachk.model.expressions import (
    Aggregate,
    Assert,
    Assign,
    Binary,
    BinaryOperator,
    Block,
    Call,
    Comma,
    Conditional,
    Constant,
    Deadlock,
    Declare,
    Evaluate,
    Expression,
    Field,
    If,
    Increment,
    Index,
    Iterate,
    LocationTest,
    Quantifier,
    Reference,
    Return,
    Statement,
    Unary,
    While,
)
from tachk.model.types import ArrayType, ClockType, Type
from tachk.semantics.fold import Known, fold, fold_place, is_integer
from tachk.semantics.intervals import arithmetic, interval
from tachk.semantics.layout import cell_range

_LONG = 2**14
"""Repetitions beyond which a loop might meet the limit on steps."""


def can_fail(expression: Expression, known: Known) -> bool:
    """Whether evaluating the expression can be a run-time error in some state. Conservative: what is not plain can.

    ``x / y``, for one, cannot where the range of ``y`` leaves out 0, and ``n = m`` cannot where all of ``m`` fits.
    """
    return _fails(fold(expression, known), known, 1)


def any_can_fail(expressions: Iterable[Expression], known: Known) -> bool:
    return any(can_fail(expression, known) for expression in expressions)


def _fails(expression: Expression, known: Known, times: int) -> bool:
    def inner(*parts: Expression) -> bool:
        return any(_fails(part, known, times) for part in parts)

    match expression:
        case Constant() | LocationTest() | Deadlock() | Reference():
            return False
        case Index(base, index):
            assert isinstance(base.type, ArrayType)
            last = base.type.low + base.type.size - 1
            return inner(base, index) or not _within(interval(index, known), (base.type.low, last))
        case Field(base):
            return inner(base)
        case Unary(_, operand):
            return inner(operand)
        case Binary(operator, left, right):
            return inner(left, right) or _undefined(operator, right, known)
        case Conditional(condition, then, otherwise):
            return inner(condition, then, otherwise)
        case Quantifier(_, variable, body):
            low, high = cell_range(variable.type)
            return (times * (high - low + 1) > _LONG) or _fails(body, known, times * (high - low + 1))
        case Assign():
            return inner(expression.target, expression.value) or _stores_badly(expression, known)
        case Increment():
            return True
        case Call(function, arguments):
            pairs = list(zip(function.parameters, arguments, strict=True))
            return (
                inner(*arguments)
                or any(not p.reference and not _fits(a, p.type, known) for p, a in pairs)
                or _statement_fails(function.body, function.result, known, times)
            )
        case Comma(items) | Aggregate(items):
            return inner(*items)
        case _ as never:
            assert_never(never)


def _undefined(operator: BinaryOperator, right: Expression, known: Known) -> bool:
    """Whether an operator may have no value for some right sides."""
    if operator in (BinaryOperator.DIVIDE, BinaryOperator.MODULO):
        low, high = interval(right, known)
        return low <= 0 <= high
    if operator in (BinaryOperator.SHIFT_LEFT, BinaryOperator.SHIFT_RIGHT):
        return not _within(interval(right, known), (0, 31))
    if operator is BinaryOperator.POWER:
        return interval(right, known)[0] < 0
    return False


def _stores_badly(assignment: Assign, known: Known) -> bool:
    target, value, operator = assignment.target, assignment.value, assignment.operator
    if isinstance(target.type, ClockType):
        return interval(value, known)[0] < 0
    if operator is None:
        return not _fits(value, target.type, known)
    if _undefined(operator, value, known):
        return True
    result = arithmetic(operator, interval(target, known), interval(value, known))
    return not _within(result, cell_range(target.type))


def _fits(value: Expression, type_: Type, known: Known) -> bool:
    """Whether all values of an expression lie in the ranges of a type."""
    if isinstance(value, Aggregate) or not is_integer(type_) or not is_integer(value.type):
        return value.type == type_ and not isinstance(value, Aggregate)
    return _within(interval(value, known), cell_range(type_))


def _within(inner: tuple[int, int], outer: tuple[int, int]) -> bool:
    return outer[0] <= inner[0] and inner[1] <= outer[1]


def _statement_fails(statement: Statement, result: Type, known: Known, times: int) -> bool:
    def fails(expression: Expression) -> bool:
        return _fails(fold(expression, known), known, times)

    match statement:
        case Evaluate(expression):
            return fails(expression)
        case Declare(variable, initial):
            return initial is not None and (fails(initial) or not _fits(fold(initial, known), variable.type, known))
        case Block(statements):
            return any(_statement_fails(inner, result, known, times) for inner in statements)
        case If(condition, then, otherwise):
            branches = (then,) if otherwise is None else (then, otherwise)
            return fails(condition) or any(_statement_fails(branch, result, known, times) for branch in branches)
        case While() | Assert():
            return True
        case Iterate(variable, body):
            low, high = cell_range(variable.type)
            repeated = times * (high - low + 1)
            return repeated > _LONG or _statement_fails(body, result, known, repeated)
        case Return(value):
            return value is not None and (fails(value) or not _fits(fold(value, known), result, known))
        case _ as never:
            assert_never(never)


def place_can_fail(place: Expression, known: Known) -> bool:
    """`can_fail` for a clock or a channel that an expression names."""
    return _fails(fold_place(place, known), known, 1)
