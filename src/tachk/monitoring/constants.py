"""Values of constant expressions in the bounds of formulas."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from tachk.diagnostics.diagnostic import Diagnostic, InputError
from tachk.frontend.findings import did_you_mean
from tachk.syntax import ast
from tachk.syntax.expression_printer import print_expression


def constant_value(expression: ast.Expression, constants: Mapping[str, int]) -> Fraction:
    """The exact value of an expression over numbers and constants. Raises InputError where it has none."""
    match expression:
        case ast.IntegerLiteral(value=value):
            return Fraction(value)
        case ast.FloatLiteral(text=text):
            return Fraction(text)
        case ast.NameExpression(name=name) if name in constants:
            return Fraction(constants[name])
        case ast.NameExpression(name=name, span=span):
            help_ = did_you_mean(name, constants) or "a bound is a number, or computed from constants of the model"
            raise InputError([Diagnostic("E0201", f"there is no constant `{name}`", span, help_)])
        case ast.UnaryExpression(operator="-" | "+" as operator, operand=operand):
            inner = constant_value(operand, constants)
            return -inner if operator == "-" else inner
        case ast.BinaryExpression(operator="+" | "-" | "*" | "/" as operator, left=left, right=right):
            first, second = constant_value(left, constants), constant_value(right, constants)
            match operator:
                case "+":
                    return first + second
                case "-":
                    return first - second
                case "*":
                    return first * second
            if second == 0:
                raise InputError([Diagnostic("E0602", "this bound divides by zero", expression.span)])
            return first / second
        case _:
            text = print_expression(expression)
            raise InputError([Diagnostic("E0602", f"`{text}` is no constant number", expression.span)])
