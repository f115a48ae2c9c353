"""Negation normal form.

Negation is moved inwards as far as the nodes of the formula tree allow, keeping truth, robustness and what is
undetermined: De Morgan's laws, F and G, O and H are duals on every trace. It stops in front of atoms, edges, until and
since. An until has no dual among the nodes: its release would have to speak of the moment at which the left side
begins to fail, which need not exist in dense time (the failure may begin right after an instant). What is exact is left
in place of what is nearly so.
"""

from __future__ import annotations

from tachk.syntax.formula import (
    Always,
    And,
    Atom,
    Change,
    Eventually,
    Fall,
    Formula,
    Historically,
    Implies,
    Not,
    Once,
    Or,
    Rise,
    Since,
    Truth,
    Until,
    WeakUntil,
    all_time,
)


def negation_normal_form(formula: Formula) -> Formula:
    """An equivalent formula without implications; Not stands only in front of atoms, edges, until and since."""
    return _positive(formula)


def negate(formula: Formula) -> Formula:
    """The negation normal form of the negation."""
    return _negative(formula)


def _positive(formula: Formula) -> Formula:
    match formula:
        case Truth() | Atom() | Change():
            return formula
        case Not(operand=operand):
            return _negative(operand)
        case And(span=span, operands=operands):
            return And(span, tuple(_positive(operand) for operand in operands))
        case Or(span=span, operands=operands):
            return Or(span, tuple(_positive(operand) for operand in operands))
        case Implies(span=span, left=left, right=right):
            return Or(span, (_negative(left), _positive(right)))
        case Rise(span=span, operand=operand):
            return Rise(span, _positive(operand))
        case Fall(span=span, operand=operand):
            return Fall(span, _positive(operand))
        case WeakUntil(span=span, left=left, right=right):
            return WeakUntil(span, _positive(left), _positive(right))
        case Until(span=span, interval=interval, left=left, right=right):
            return Until(span, interval, _positive(left), _positive(right))
        case Since(span=span, interval=interval, left=left, right=right):
            return Since(span, interval, _positive(left), _positive(right))
        case Eventually(span=span, interval=interval, operand=operand):
            return Eventually(span, interval, _positive(operand))
        case Always(span=span, interval=interval, operand=operand):
            return Always(span, interval, _positive(operand))
        case Once(span=span, interval=interval, operand=operand):
            return Once(span, interval, _positive(operand))
        case Historically(span=span, interval=interval, operand=operand):
            return Historically(span, interval, _positive(operand))


def _negative(formula: Formula) -> Formula:
    span = formula.span
    match formula:
        case Truth(value=value):
            return Truth(span, not value)
        case Not(operand=operand):
            return _positive(operand)
        case And(operands=operands):
            return Or(span, tuple(_negative(operand) for operand in operands))
        case Or(operands=operands):
            return And(span, tuple(_negative(operand) for operand in operands))
        case Implies(left=left, right=right):
            return And(span, (_positive(left), _negative(right)))
        case Eventually(interval=interval, operand=operand):
            return Always(span, interval, _negative(operand))
        case Always(interval=interval, operand=operand):
            return Eventually(span, interval, _negative(operand))
        case Once(interval=interval, operand=operand):
            return Historically(span, interval, _negative(operand))
        case Historically(interval=interval, operand=operand):
            return Once(span, interval, _negative(operand))
        case WeakUntil(left=left, right=right):
            # f W g is (f U g) || G f.
            until = Until(span, all_time(span), _positive(left), _positive(right))
            return And(span, (Not(span, until), Eventually(span, all_time(span), _negative(left))))
        case _:
            return Not(span, _positive(formula))
