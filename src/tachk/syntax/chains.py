"""Chains of one operator: ``a && b && c``.

A chain of thousands of operands, as generators write them, would be a tree of as many levels if it were built from the
left. Where the operator is associative a long chain is therefore a balanced tree; the operands are evaluated in the
same order, and a short circuit leaves out the same ones. What differs is only which partial sums and products there
are. Short chains, and parentheses that the text has, stay as they are.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeGuard

from tachk.base.operators import BinaryOperator
from tachk.base.span import Span
from tachk.syntax import ast

LONGEST_FROM_LEFT = 32
"""Operands of a chain that is still built from the left."""


def chain(operator: BinaryOperator, operands: Sequence[ast.Expression], span: Span | None = None) -> ast.Expression:
    """The tree of ``operands[0] operator operands[1] operator ...``.

    Args:
        span: the place of every link of it; None: where its operands stand.
    """
    if operator.associative and len(operands) > LONGEST_FROM_LEFT:
        middle = _middle(len(operands))
        left, right = chain(operator, operands[:middle], span), chain(operator, operands[middle:], span)
        return _join(operator, left, right, span)
    tree = operands[0]
    for operand in operands[1:]:
        tree = _join(operator, tree, operand, span)
    return tree


def operands_of(expression: ast.BinaryExpression) -> list[ast.Expression]:
    """The operands of which `chain` makes this very tree, as many as possible; two or more."""
    operator = expression.operator
    if not operator.associative:
        return [expression.left, expression.right]
    long = _long_chain(expression)
    if long is not None:
        return long
    operands = [expression.right]
    first = expression.left
    while _continues(first, operator) and _long_chain(first) is None:
        operands.append(first.right)
        first = first.left
    if len(operands) >= LONGEST_FROM_LEFT:
        return [expression.left, expression.right]
    return [first, *reversed(operands)]


def _middle(count: int) -> int:
    return (count + 1) // 2


def _join(
    operator: BinaryOperator, left: ast.Expression, right: ast.Expression, span: Span | None
) -> ast.BinaryExpression:
    place = span or Span(left.span.source, left.span.start, right.span.end)
    return ast.BinaryExpression(place, operator, left, right)


def _continues(expression: ast.Expression, operator: BinaryOperator) -> TypeGuard[ast.BinaryExpression]:
    return isinstance(expression, ast.BinaryExpression) and expression.operator == operator


def _long_chain(expression: ast.BinaryExpression) -> list[ast.Expression] | None:
    """The operands of a chain that is built as a balanced tree, or None if this is no such tree."""
    operator = expression.operator
    if not _continues(expression.right, operator):
        return None
    operands: list[ast.Expression] = []
    pending: list[ast.Expression] = [expression]
    while pending:
        node = pending.pop()
        if _continues(node, operator):
            pending += [node.right, node.left]
        else:
            operands.append(node)
    balanced = len(operands) > LONGEST_FROM_LEFT and _is_chain(expression, operator, len(operands))
    return operands if balanced else None


def _is_chain(tree: ast.Expression, operator: BinaryOperator, count: int) -> bool:
    """True if `chain` makes this tree of its ``count`` innermost operands."""
    if count == 1:
        return not _continues(tree, operator)
    middle = _middle(count) if count > LONGEST_FROM_LEFT else count - 1
    return (
        _continues(tree, operator)
        and _is_chain(tree.left, operator, middle)
        and _is_chain(tree.right, operator, count - middle)
    )


def conjuncts(condition: ast.Expression) -> list[ast.Expression]:
    """The operands of every ``&&`` of a conjunction, in their order; the condition alone if it is none."""
    found: list[ast.Expression] = []
    pending = [condition]
    while pending:
        match pending.pop():
            case ast.BinaryExpression(operator=BinaryOperator.AND, left=left, right=right):
                pending += (right, left)
            case part:
                found.append(part)
    return found
