"""Traces with exact times and values, and what an expression is worth in one of their states.

Part of the oracle of monitoring (`tests.support.exact_monitor`): plain, exact and slow.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction

from tachk.base.operators import BinaryOperator, PrefixOperator
from tachk.syntax import ast
from tachk.syntax.printing.expression_printer import print_expression

Number = Fraction | float
"""A rational number, or an infinity."""

Scalar = Fraction | bool
"""What a column holds."""


class Ending(Enum):
    """What is known about the end of a trace.

    FINISHED: the trace is over; its end belongs to it. Nothing after the end is known.
    SETTLED: the trace goes on after its end, up to which, included, everything is known.
    OPEN: the trace goes on, and another row may still come for the instant at which it ends so far.
    """

    FINISHED = "finished"
    SETTLED = "settled"
    OPEN = "open"


@dataclass(frozen=True, slots=True)
class Value:
    """What a formula is worth at an instant.

    Attributes:
        truth: None if undetermined: some continuation may make it true, another one false.
        low, high: the robustness of every continuation lies between them.
    """

    truth: bool | None
    low: Number
    high: Number

    def __invert__(self) -> Value:
        return Value(None if self.truth is None else not self.truth, -self.high, -self.low)

    def __and__(self, other: Value) -> Value:
        if self.truth is False or other.truth is False:
            truth: bool | None = False
        elif self.truth is None or other.truth is None:
            truth = None
        else:
            truth = True
        return Value(truth, min(self.low, other.low), min(self.high, other.high))

    def __or__(self, other: Value) -> Value:
        if self.truth is True or other.truth is True:
            truth: bool | None = True
        elif self.truth is None or other.truth is None:
            truth = None
        else:
            truth = False
        return Value(truth, max(self.low, other.low), max(self.high, other.high))


TRUE = Value(True, math.inf, math.inf)
FALSE = Value(False, -math.inf, -math.inf)
UNKNOWN = Value(None, -math.inf, math.inf)


@dataclass(frozen=True, slots=True)
class ExactTrace:
    """Columns that keep their values from the instant of one row to that of the next.

    Attributes:
        times: of the rows, ascending; the first is 0. Of several rows for one instant the last one counts.
        columns: the values of each column in all rows.
        end: not before the last row.
    """

    times: tuple[Fraction, ...]
    columns: Mapping[str, tuple[Scalar, ...]]
    end: Fraction
    ending: Ending = Ending.FINISHED

    def __post_init__(self) -> None:
        if not self.times or self.times[0] != 0 or list(self.times) != sorted(self.times) or self.end < self.times[-1]:
            raise ValueError("the times of a trace ascend from 0 to its end")
        if any(len(values) != len(self.times) for values in self.columns.values()):
            raise ValueError("every column has a value in every row")

    def state_at(self, instant: Fraction) -> Mapping[str, Scalar] | None:
        """The values that hold at an instant, or None where they are not known."""
        if instant > self.end or (instant == self.end and self.ending is Ending.OPEN):
            return None
        row = max(index for index, time in enumerate(self.times) if time <= instant)
        return {name: values[row] for name, values in self.columns.items()}

    def prefix(self, end: Fraction, ending: Ending) -> ExactTrace:
        """What is known of the trace when time has come to ``end``."""
        rows = sum(time <= end for time in self.times)
        columns = {name: values[:rows] for name, values in self.columns.items()}
        return ExactTrace(self.times[:rows], columns, end, ending)


def pulses(end: Fraction | int, **signals: Sequence[tuple[Fraction | int, Fraction | int]]) -> ExactTrace:
    """A finished trace of boolean columns, each true on the given intervals ``[rise, fall)``."""
    edges = {Fraction(edge) for pieces in signals.values() for piece in pieces for edge in piece}
    times = tuple(sorted({Fraction(0)} | {edge for edge in edges if edge <= end}))
    columns = {
        name: tuple(any(rise <= time < fall for rise, fall in pieces) for time in times)
        for name, pieces in signals.items()
    }
    return ExactTrace(times, columns, Fraction(end))


def condition(expression: ast.Expression, state: Mapping[str, Scalar]) -> Value:
    """The worth of an expression as a condition: the robustness of a comparison is the distance to its boundary."""
    match expression:
        case ast.UnaryExpression(operator=PrefixOperator.NOT, operand=operand):
            return ~condition(operand, state)
        case ast.BinaryExpression(operator=BinaryOperator.AND, left=left, right=right):
            return condition(left, state) & condition(right, state)
        case ast.BinaryExpression(operator=BinaryOperator.OR, left=left, right=right):
            return condition(left, state) | condition(right, state)
        case ast.BinaryExpression(operator=BinaryOperator.IMPLY, left=left, right=right):
            return ~condition(left, state) | condition(right, state)
        case ast.BinaryExpression(operator=BinaryOperator.XOR, left=left, right=right):
            return ~equivalence(condition(left, state), condition(right, state))
        case ast.BinaryExpression(
            operator=BinaryOperator.EQUAL | BinaryOperator.NOT_EQUAL as operator, left=left, right=right
        ) if is_truth(left, state) and is_truth(right, state):
            same = equivalence(condition(left, state), condition(right, state))
            return same if operator == BinaryOperator.EQUAL else ~same
        case ast.BinaryExpression(
            operator=BinaryOperator.LESS
            | BinaryOperator.LESS_EQUAL
            | BinaryOperator.GREATER
            | BinaryOperator.GREATER_EQUAL
            | BinaryOperator.EQUAL
            | BinaryOperator.NOT_EQUAL as operator,
            left=left,
            right=right,
        ):
            return _comparison(operator, number(left, state), number(right, state))
        case _:
            return TRUE if number(expression, state) != 0 else FALSE


def number(expression: ast.Expression, state: Mapping[str, Scalar]) -> Fraction:
    """The worth of an expression as a number; conditions are worth 1 or 0."""
    match expression:
        case ast.NameExpression() | ast.MemberExpression() | ast.IndexExpression():
            return Fraction(state[print_expression(expression)])
        case ast.IntegerLiteral(value=value) | ast.BooleanLiteral(value=value):
            return Fraction(value)
        case ast.FloatLiteral(text=text):
            return Fraction(text)
        case ast.UnaryExpression(operator=PrefixOperator.MINUS, operand=operand):
            return -number(operand, state)
        case ast.UnaryExpression(operator=PrefixOperator.PLUS, operand=operand):
            return number(operand, state)
        case ast.BinaryExpression(
            operator=BinaryOperator.ADD
            | BinaryOperator.SUBTRACT
            | BinaryOperator.MULTIPLY
            | BinaryOperator.DIVIDE
            | BinaryOperator.MODULO
            | BinaryOperator.MINIMUM
            | BinaryOperator.MAXIMUM as operator
        ):
            return _arithmetic(operator, number(expression.left, state), number(expression.right, state))
        case ast.CallExpression(function=ast.NameExpression(name="abs"), arguments=(argument,)):
            return abs(number(argument, state))
        case ast.CallExpression(function=ast.NameExpression(name="min"), arguments=arguments):
            return min(number(argument, state) for argument in arguments)
        case ast.CallExpression(function=ast.NameExpression(name="max"), arguments=arguments):
            return max(number(argument, state) for argument in arguments)
        case ast.UnaryExpression() | ast.BinaryExpression():
            return Fraction(condition(expression, state).truth is True)
        case _:
            raise ValueError(f"no meaning on traces: {print_expression(expression)}")


def _arithmetic(operator: str, left: Fraction, right: Fraction) -> Fraction:
    match operator:
        case BinaryOperator.ADD:
            return left + right
        case BinaryOperator.SUBTRACT:
            return left - right
        case BinaryOperator.MULTIPLY:
            return left * right
        case BinaryOperator.DIVIDE:
            return left / right
        case BinaryOperator.MODULO:
            return left - right * math.trunc(left / right)
        case BinaryOperator.MINIMUM:
            return min(left, right)
        case _:
            return max(left, right)


def _comparison(operator: str, left: Fraction, right: Fraction) -> Value:
    match operator:
        case BinaryOperator.LESS:
            truth, margin = left < right, right - left
        case BinaryOperator.LESS_EQUAL:
            truth, margin = left <= right, right - left
        case BinaryOperator.GREATER:
            truth, margin = left > right, left - right
        case BinaryOperator.GREATER_EQUAL:
            truth, margin = left >= right, left - right
        case BinaryOperator.EQUAL:
            truth, margin = left == right, -abs(left - right)
        case _:
            truth, margin = left != right, abs(left - right)
    return Value(truth, margin, margin)


def equivalence(left: Value, right: Value) -> Value:
    return (left & right) | (~left & ~right)


def is_condition(expression: ast.Expression) -> bool:
    """Whether an expression is a condition by its form."""
    match expression:
        case ast.UnaryExpression(operator=operator):
            return operator == PrefixOperator.NOT
        case ast.BinaryExpression(operator=operator):
            return operator in {
                BinaryOperator.AND,
                BinaryOperator.OR,
                BinaryOperator.IMPLY,
                BinaryOperator.XOR,
                BinaryOperator.LESS,
                BinaryOperator.LESS_EQUAL,
                BinaryOperator.GREATER,
                BinaryOperator.GREATER_EQUAL,
                BinaryOperator.EQUAL,
                BinaryOperator.NOT_EQUAL,
            }
        case _:
            return isinstance(expression, ast.BooleanLiteral)


def is_truth(expression: ast.Expression, state: Mapping[str, Scalar]) -> bool:
    """Whether an expression is a condition by its form or by the values of its column, not a number."""
    if isinstance(expression, ast.NameExpression | ast.MemberExpression | ast.IndexExpression):
        return isinstance(state[print_expression(expression)], bool)
    return is_condition(expression)
