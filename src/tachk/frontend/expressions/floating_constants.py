"""Floating point numbers and texts that are known before the model runs.

Symbolic checking has no such values. Where one is only compared with another one, or made an integer by `fint`, the
result is a constant, and nothing of it is left in the network. The numbers are IEEE doubles, as in UPPAAL; functions
that every library rounds alike are known.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from tachk.frontend.scope import DroppedSymbol, Scope
from tachk.operators import BinaryOperator, PrefixOperator
from tachk.syntax import ast

Value = float | str
IntegerOf = Callable[[ast.Expression], int | None]
"""The value of an integer expression; None where it is not known before the model runs."""

_ARITHMETIC: dict[BinaryOperator, Callable[[float, float], float]] = {
    BinaryOperator.ADD: lambda left, right: left + right,
    BinaryOperator.SUBTRACT: lambda left, right: left - right,
    BinaryOperator.MULTIPLY: lambda left, right: left * right,
    BinaryOperator.DIVIDE: lambda left, right: left / right,
}
_COMPARISONS: dict[BinaryOperator, Callable[[float, float], bool]] = {
    BinaryOperator.LESS: lambda left, right: left < right,
    BinaryOperator.LESS_EQUAL: lambda left, right: left <= right,
    BinaryOperator.GREATER: lambda left, right: left > right,
    BinaryOperator.GREATER_EQUAL: lambda left, right: left >= right,
    BinaryOperator.EQUAL: lambda left, right: left == right,
    BinaryOperator.NOT_EQUAL: lambda left, right: left != right,
}
_FUNCTIONS: dict[str, tuple[int, Callable[..., float]]] = {
    "fabs": (1, math.fabs),
    "sqrt": (1, math.sqrt),
    "floor": (1, lambda value: float(math.floor(value))),
    "ceil": (1, lambda value: float(math.ceil(value))),
    "trunc": (1, lambda value: float(math.trunc(value))),
    "round": (1, lambda value: math.copysign(math.floor(math.fabs(value) + 0.5), value)),
    "fmin": (2, min),
    "fmax": (2, max),
}
_EXACT = 2.0**52
"""Numbers as large as this are whole: adding a half would round."""


def is_floating(node: ast.Expression, scope: Scope) -> bool:
    """Whether an expression is a floating point number or a text, as far as its form and its constants tell."""
    match node:
        case ast.FloatLiteral() | ast.StringLiteral():
            return True
        case ast.NameExpression(name=name):
            symbol = scope.lookup(name)
            return isinstance(symbol, DroppedSymbol) and symbol.value is not None
        case ast.UnaryExpression(operator=PrefixOperator.MINUS, operand=operand):
            return is_floating(operand, scope)
        case ast.BinaryExpression(operator=operator, left=left, right=right) if operator in _ARITHMETIC:
            return is_floating(left, scope) or is_floating(right, scope)
        case ast.CallExpression(function=ast.NameExpression(name=name)):
            return name in _FUNCTIONS and scope.lookup(name) is None
        case _:
            return False


def floating_value(node: ast.Expression, scope: Scope, integer: IntegerOf) -> Value | None:
    """The value of an expression before the model runs; None where it has none, or one that is not finite."""
    if not is_floating(node, scope):
        whole = integer(node)
        return None if whole is None else float(whole)
    value: Value | None = None
    match node:
        case ast.FloatLiteral(text=text):
            value = float(text)
        case ast.StringLiteral(value=text):
            return text
        case ast.NameExpression(name=name):
            symbol = scope.lookup(name)
            value = symbol.value if isinstance(symbol, DroppedSymbol) else None
        case ast.UnaryExpression(operand=operand):
            inner = floating_value(operand, scope, integer)
            value = -inner if isinstance(inner, float) else None
        case ast.BinaryExpression(operator=operator, left=left, right=right):
            value = _computed(_ARITHMETIC[operator], (left, right), scope, integer)
        case ast.CallExpression(function=ast.NameExpression(name=name), arguments=arguments):
            count, function = _FUNCTIONS[name]
            value = _computed(function, arguments, scope, integer) if len(arguments) == count else None
        case _:
            pass
    return value if isinstance(value, str) or (value is not None and math.isfinite(value)) else None


def _computed(
    function: Callable[..., float], arguments: tuple[ast.Expression, ...], scope: Scope, integer: IntegerOf
) -> float | None:
    values = [floating_value(argument, scope, integer) for argument in arguments]
    numbers = [value for value in values if isinstance(value, float)]
    if len(numbers) != len(arguments):
        return None
    if function is _FUNCTIONS["round"][1] and abs(numbers[0]) >= _EXACT:
        return numbers[0]
    try:
        return function(*numbers)
    except (ArithmeticError, ValueError):
        return None


def compared(
    operator: BinaryOperator, left: ast.Expression, right: ast.Expression, scope: Scope, integer: IntegerOf
) -> bool | None:
    """The truth of a comparison in which a side is floating; None where it is not known before the model runs."""
    if operator not in _COMPARISONS or not (is_floating(left, scope) or is_floating(right, scope)):
        return None
    one, other = floating_value(left, scope, integer), floating_value(right, scope, integer)
    if isinstance(one, float) and isinstance(other, float):
        return _COMPARISONS[operator](one, other)
    if isinstance(one, str) and isinstance(other, str) and operator in (BinaryOperator.EQUAL, BinaryOperator.NOT_EQUAL):
        return (one == other) is (operator is BinaryOperator.EQUAL)
    return None
