"""Arithmetic on constants, as bounds of formulas and declarations have it."""

from __future__ import annotations

import operator
from collections.abc import Callable
from fractions import Fraction

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError
from tachk.base.operators import BinaryOperator, PrefixOperator
from tachk.syntax import ast

Evaluate = Callable[[ast.Expression], Fraction | int]
"""The value of a name or a call. Raises InputError where there is none."""

Divide = Callable[[Fraction, Fraction], Fraction]


def whole_quotient(dividend: Fraction, divisor: Fraction) -> Fraction:
    """The quotient of the language, whose integers drop the remainder."""
    return Fraction(int(dividend / divisor))


def value_of(expression: ast.Expression, evaluate: Evaluate, divide: Divide = operator.truediv) -> Fraction:
    """The value of an expression over numbers and constants.

    Args:
        divide: bounds are times, which are dense, so what is computed in a bound is exact.

    Raises:
        InputError: for a division by zero, and what ``evaluate`` reports.
    """
    match expression:
        case ast.IntegerLiteral(value=value):
            return Fraction(value)
        case ast.FloatLiteral(text=text):
            return Fraction(text)
        case ast.UnaryExpression(operator=PrefixOperator.MINUS, operand=operand):
            return -value_of(operand, evaluate, divide)
        case ast.UnaryExpression(operator=PrefixOperator.PLUS, operand=operand):
            return value_of(operand, evaluate, divide)
        case ast.BinaryExpression(
            operator=BinaryOperator.ADD
            | BinaryOperator.SUBTRACT
            | BinaryOperator.MULTIPLY
            | BinaryOperator.DIVIDE as sign,
            left=left,
            right=right,
        ):
            first, second = value_of(left, evaluate, divide), value_of(right, evaluate, divide)
            match sign:
                case BinaryOperator.ADD:
                    return first + second
                case BinaryOperator.SUBTRACT:
                    return first - second
                case BinaryOperator.MULTIPLY:
                    return first * second
                case BinaryOperator.DIVIDE:
                    if second == 0:
                        raise InputError([Diagnostic("E0602", "this divides by zero", expression.span)])
                    return divide(first, second)
        case _:
            return Fraction(evaluate(expression))
