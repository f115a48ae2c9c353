"""Triggers of a formula, which are the left sides of the implications that it always demands, and what it awaits."""

from __future__ import annotations

from collections.abc import Iterator

from tachk.base.operators import BinaryOperator, PrefixOperator
from tachk.syntax import ast
from tachk.syntax.chains import chain
from tachk.syntax.formula import (
    Always,
    And,
    Atom,
    Eventually,
    Fall,
    Formula,
    Implies,
    Not,
    Once,
    Or,
    Rise,
    Until,
    WeakUntil,
)


def demanded_implications(formula: Formula) -> Iterator[Implies]:
    """The implications that the formula consists of, each demanded at some instants."""
    return (part for part, _ in _demanded(formula, always=False) if isinstance(part, Implies))


def demanded_conditions(formula: Formula) -> Iterator[Formula]:
    """The conditions on one state that are demanded at all instants: p of ``G p`` and of ``G (p && (q -> F r))``."""
    return (part for part, always in _demanded(formula, always=False) if always and needed_now(part) is not None)


def awaited_conditions(formula: Formula) -> Iterator[Formula]:
    """The conditions on one state that have to come and to last: q of ``F[0,5] q`` and of ``p U q``.

    Where ``F q`` has no deadline, q need not last.
    """
    if isinstance(formula, Eventually):
        if needed_now(formula.operand) is None:
            yield from awaited_conditions(formula.operand)
        elif formula.interval.upper is not None:
            yield formula.operand
    elif isinstance(formula, Until | WeakUntil):
        if needed_now(formula.right) is None:
            yield from awaited_conditions(formula.right)
        else:
            yield formula.right
    elif isinstance(formula, Always):
        yield from awaited_conditions(formula.operand)
    elif isinstance(formula, Implies):
        yield from awaited_conditions(formula.right)
    elif isinstance(formula, And | Or):
        for part in formula.operands:
            yield from awaited_conditions(part)


def _demanded(formula: Formula, always: bool) -> Iterator[tuple[Formula, bool]]:
    """The conjuncts of the formula, each with whether it is demanded at all instants."""
    if isinstance(formula, Always):
        yield from _demanded(formula.operand, always=True)
    elif isinstance(formula, And):
        for part in formula.operands:
            yield from _demanded(part, always)
    else:
        yield formula, always


def needed_state(formula: Formula) -> ast.Expression | None:
    """A condition that is true in some state of every run on which the formula ever is; None where none is known."""
    if isinstance(formula, Rise | Fall | Once):
        return needed_state(formula.operand)
    if isinstance(formula, And):
        known = [part for part in map(needed_now, formula.operands) if part is not None]
        if known:
            return _joined(BinaryOperator.AND, known)
        return next((part for part in map(needed_state, formula.operands) if part is not None), None)
    if isinstance(formula, Or):
        parts = [needed_state(part) for part in formula.operands]
        return None if None in parts else _joined(BinaryOperator.OR, [part for part in parts if part is not None])
    return needed_now(formula)


def needed_now(formula: Formula) -> ast.Expression | None:
    """The formula as a condition on one state; None where it looks at other instants."""
    if isinstance(formula, Atom):
        return formula.expression
    if isinstance(formula, Not):
        inner = needed_now(formula.operand)
        return None if inner is None else ast.UnaryExpression(formula.span, PrefixOperator.NOT, inner)
    if isinstance(formula, And | Or):
        parts = [needed_now(part) for part in formula.operands]
        operator = BinaryOperator.AND if isinstance(formula, And) else BinaryOperator.OR
        return None if None in parts else _joined(operator, [part for part in parts if part is not None])
    return None


def _joined(operator: BinaryOperator, parts: list[ast.Expression]) -> ast.Expression:
    return chain(operator, parts)
