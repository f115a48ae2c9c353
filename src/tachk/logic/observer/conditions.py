"""Conditions on one state, as conjunctions of separate expressions."""

from __future__ import annotations

from collections.abc import Iterable

from tachk.base.operators import COMPARISONS, BinaryOperator, PrefixOperator
from tachk.base.span import Span
from tachk.syntax import ast
from tachk.syntax.chains import chain, conjuncts
from tachk.syntax.printing.expression_printer import print_expression

Conjunction = frozenset[ast.Expression]
"""Expressions that are all true; the empty one is true."""


def truth(value: bool, span: Span) -> ast.Expression:
    return ast.BooleanLiteral(span, value)


def negated(expression: ast.Expression) -> ast.Expression:
    """The opposite, negations moved inwards as far as no operand is evaluated that was not before."""
    span = expression.span
    match expression:
        case ast.BooleanLiteral(value=value):
            return ast.BooleanLiteral(span, not value)
        case ast.UnaryExpression(operator=PrefixOperator.NOT, operand=operand):
            return operand
        case ast.BinaryExpression(operator=BinaryOperator.AND, left=left, right=right):
            return ast.BinaryExpression(span, BinaryOperator.OR, negated(left), negated(right))
        case ast.BinaryExpression(operator=BinaryOperator.OR, left=left, right=right):
            return ast.BinaryExpression(span, BinaryOperator.AND, negated(left), negated(right))
        case ast.BinaryExpression(operator=BinaryOperator.IMPLY, left=left, right=right):
            return ast.BinaryExpression(span, BinaryOperator.AND, left, negated(right))
        case ast.BinaryExpression(operator=operator, left=left, right=right) if operator in COMPARISONS:
            return ast.BinaryExpression(span, operator.negated, left, right)
        case _:
            return ast.UnaryExpression(span, PrefixOperator.NOT, expression)


def all_of(parts: Iterable[ast.Expression], span: Span) -> ast.Expression:
    """The conjunction as one expression."""
    found = conjunction(parts)
    return chain(BinaryOperator.AND, sorted(found, key=_order), span) if found else truth(True, span)


def any_of(parts: Iterable[ast.Expression], span: Span) -> ast.Expression:
    """The disjunction as one expression."""
    possible = [part for part in dict.fromkeys(parts) if part != truth(False, span)]
    if any(part == truth(True, span) for part in possible):
        return truth(True, span)
    return chain(BinaryOperator.OR, possible, span) if possible else truth(False, span)


def conjunction(parts: Iterable[ast.Expression]) -> Conjunction:
    """The operands of every ``&&``; of contradicting ones, ``false`` alone is left."""
    found = _conjuncts(parts)
    for part in found:
        if isinstance(part, ast.BooleanLiteral) or _conjuncts((negated(part),)) <= found:
            return frozenset((truth(False, part.span),))
    return frozenset(found)


def _conjuncts(parts: Iterable[ast.Expression]) -> set[ast.Expression]:
    """The operands of every ``&&``, ``true`` left out."""
    found = {operand for part in parts for operand in conjuncts(part)}
    return {part for part in found if not (isinstance(part, ast.BooleanLiteral) and part.value)}


def is_false(condition: Conjunction) -> bool:
    return any(isinstance(part, ast.BooleanLiteral) and not part.value for part in condition)


def _order(part: ast.Expression) -> tuple[int, int, str]:
    """As in the text: what an expression guards against stands in front of it."""
    return part.span.start, part.span.end, print_expression(part)
