"""Conditions on one state that are enough for a formula: where one is true in all states, the formula holds.

Of ``G (p -> F[0,5] q)`` that is ``p imply q``. A signal has at each instant the value of a state, so what is true in
all states is true at all instants. The formula itself asks nothing of states that last for no time.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

from tachk.base.operators import BinaryOperator
from tachk.logic.triggers import needed_now
from tachk.syntax import ast
from tachk.syntax.chains import chain
from tachk.syntax.formula import Always, And, Eventually, Formula, Implies, Interval, Or, Rise


def sufficient_condition(formula: Formula) -> ast.Expression | None:
    """A condition on one state: if it is true in all reachable ones, the formula is true at all instants of all runs.
    None where none is known. Bounds must be numbers."""
    now = needed_now(formula)
    if now is not None:
        return now
    if isinstance(formula, Always) or (isinstance(formula, Eventually) and not _is_empty(formula.interval)):
        return sufficient_condition(formula.operand)
    if isinstance(formula, And):
        return _all(map(sufficient_condition, formula.operands))
    return _enough_now(formula)


def _enough_now(formula: Formula) -> ast.Expression | None:
    """A condition that makes a formula true at an instant at which it is true itself, if it is true at all others."""
    now = needed_now(formula)
    if now is not None:
        return now
    if isinstance(formula, Eventually) and _contains_now(formula.interval):
        return _enough_now(formula.operand)
    if isinstance(formula, Implies):
        # A condition becomes true at an instant at which it is true.
        left = needed_now(formula.left.operand if isinstance(formula.left, Rise) else formula.left)
        right = _enough_now(formula.right)
        return None if left is None or right is None else chain(BinaryOperator.IMPLY, [left, right], formula.span)
    if isinstance(formula, And):
        return _all(map(_enough_now, formula.operands))
    if isinstance(formula, Or):
        known = [part for part in map(_enough_now, formula.operands) if part is not None]
        return chain(BinaryOperator.OR, known) if known else None
    return None


def _all(parts: Iterable[ast.Expression | None]) -> ast.Expression | None:
    known = list(parts)
    return None if None in known else chain(BinaryOperator.AND, [part for part in known if part is not None])


def _contains_now(interval: Interval) -> bool:
    return interval.lower_closed and interval.lower.value == 0 and not _is_empty(interval)


def _is_empty(interval: Interval) -> bool:
    if interval.upper is None:
        return False
    low, high = interval.lower.value, interval.upper.value
    if not isinstance(low, Fraction) or not isinstance(high, Fraction):
        raise TypeError("the bounds of a window are not numbers yet")
    return low > high or (low == high and not (interval.lower_closed and interval.upper_closed))
