"""Other expressions in the place of variables."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import assert_never

from tachk.model.expressions import (
    Aggregate,
    Assign,
    Binary,
    Call,
    Comma,
    Conditional,
    Constant,
    Deadlock,
    Expression,
    Field,
    Increment,
    Index,
    LocationTest,
    Quantifier,
    Reference,
    Unary,
    Variable,
)


def substituted(expression: Expression, instead: Mapping[Variable, Expression]) -> Expression:
    """The expression with others in the place of variables, wherever they stand; functions that it calls stay as they
    are."""
    if isinstance(expression, Reference):
        return instead.get(expression.variable, expression)
    return with_parts(expression, lambda part: substituted(part, instead))


def with_parts(expression: Expression, of: Callable[[Expression], Expression]) -> Expression:
    """The expression with what ``of`` makes of each direct subexpression in its place."""
    match expression:
        case Constant() | Reference() | LocationTest() | Deadlock():
            return expression
        case Index(base, index):
            return replace(expression, base=of(base), index=of(index))
        case Field(base):
            return replace(expression, base=of(base))
        case Aggregate(items) | Comma(items):
            return replace(expression, items=tuple(map(of, items)))
        case Unary(_, operand):
            return replace(expression, operand=of(operand))
        case Binary(_, left, right):
            return replace(expression, left=of(left), right=of(right))
        case Conditional(condition, then, otherwise):
            return replace(expression, condition=of(condition), then=of(then), otherwise=of(otherwise))
        case Quantifier(_, _, body):
            return replace(expression, body=of(body))
        case Assign(target, value):
            return replace(expression, target=of(target), value=of(value))
        case Increment(target):
            return replace(expression, target=of(target))
        case Call(_, arguments):
            return replace(expression, arguments=tuple(map(of, arguments)))
        case _ as never:
            assert_never(never)
