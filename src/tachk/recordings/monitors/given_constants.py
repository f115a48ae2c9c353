"""Names in the bounds of formulas, where there is no network that gives them a meaning."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from tachk.base.diagnostics.diagnostic import Diagnostic, InputError
from tachk.base.diagnostics.suggestion import did_you_mean
from tachk.logic.constant_values import Evaluate
from tachk.syntax import ast
from tachk.syntax.printing.expression_printer import print_expression


def constants_by_name(constants: Mapping[str, Fraction | int]) -> Evaluate:
    """Finds the values of names. Raises InputError for other names, and for whatever is not a name."""

    def evaluate(expression: ast.Expression) -> Fraction | int:
        match expression:
            case ast.NameExpression(name=name) if name in constants:
                return constants[name]
            case ast.NameExpression(name=name, span=span):
                help_ = (
                    did_you_mean(name, constants)
                    or "a bound is a number, or computed from constants of the model; -D gives a name a value"
                )
                raise InputError([Diagnostic("E0201", f"there is no constant `{name}`", span, help_)])
            case _:
                text = print_expression(expression)
                raise InputError([Diagnostic("E0602", f"`{text}` is not a constant number", expression.span)])

    return evaluate
