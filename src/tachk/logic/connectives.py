"""Formulas joined by connectives, as somebody would write them: flat, and without what says nothing."""

from __future__ import annotations

from tachk.base.span import Span
from tachk.syntax.formula import And, Formula, Implies, Not, Or, TruthConstant


def negation(formula: Formula) -> Formula:
    """The opposite, without a double negation."""
    match formula:
        case Not(operand=operand):
            return operand
        case TruthConstant(value=value):
            return TruthConstant(formula.span, not value)
        case _:
            return Not(formula.span, formula)


def conjuncts(formula: Formula) -> tuple[Formula, ...]:
    return formula.operands if isinstance(formula, And) else (formula,)


def both(span: Span, left: Formula, right: Formula) -> Formula:
    """A conjunction that is flat and without parts that are always true."""
    parts = tuple(p for formula in (left, right) for p in conjuncts(formula) if p != TruthConstant(p.span, True))
    return And(span, parts) if len(parts) > 1 else parts[0] if parts else TruthConstant(span, True)


def either(span: Span, left: Formula, right: Formula) -> Formula:
    """A disjunction that is flat."""
    return Or(span, tuple(p for f in (left, right) for p in (f.operands if isinstance(f, Or) else (f,))))


def implies(span: Span, left: Formula, right: Formula) -> Formula:
    """An implication, or only the right side where the left one is always true."""
    return right if left == TruthConstant(span, True) else Implies(span, left, right)
