"""Texts, which can only be compared before the model runs: nothing of them is left in the network."""

from __future__ import annotations

from tachk.base.operators import BinaryOperator
from tachk.frontend.scope import DroppedSymbol, Scope
from tachk.syntax import ast


def text_value(node: ast.Expression, scope: Scope) -> str | None:
    """The text that an expression is; None where it is none, or one that may change."""
    match node:
        case ast.StringLiteral(value=text):
            return text
        case ast.NameExpression(name=name):
            symbol = scope.lookup(name)
            return symbol.text if isinstance(symbol, DroppedSymbol) else None
        case _:
            return None


def compared_texts(operator: BinaryOperator, left: ast.Expression, right: ast.Expression, scope: Scope) -> bool | None:
    """The truth of a comparison of two texts; None where it is none."""
    if operator not in (BinaryOperator.EQUAL, BinaryOperator.NOT_EQUAL):
        return None
    one, other = text_value(left, scope), text_value(right, scope)
    return None if one is None or other is None else (one == other) is (operator is BinaryOperator.EQUAL)
