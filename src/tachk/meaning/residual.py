"""Conditions on clocks in one discrete state: what is left of a condition once everything else in it is known.

This is partial evaluation (Jones, Gomard and Sestoft 1993). The residual is a function of the clock values. It compares
their differences with the numbers that the evaluator gave, as the evaluator does, and knows no bounds of matrices.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from typing import TypeAlias

from tachk.base.operators import BinaryOperator, UnaryOperator
from tachk.model.evaluate import Environment, clock_number, evaluate
from tachk.model.expressions import Binary, Expression, Quantifier, QuantifierKind, Unary, Variable
from tachk.model.fault import EvaluationFault
from tachk.model.traversal import depends_on_clocks
from tachk.model.types import ClockType, ScalarLike, bounds

Clocks: TypeAlias = Sequence[Fraction]
"""Entry i is the value of clock number i + 1."""
Residual: TypeAlias = Callable[[Clocks], bool]


def residual(condition: Expression, scratch: Environment) -> Residual | None:
    """The condition as a function of the clock values.

    None where a part of it cannot be evaluated, or where clocks are compared in another way than by connectives and
    quantifiers over comparisons of a clock, or of a difference of two, with a number or a clock.
    """
    try:
        return _residual(condition, scratch)
    except EvaluationFault:
        return None


def _residual(condition: Expression, scratch: Environment) -> Residual | None:
    if not depends_on_clocks(condition):
        known = evaluate(condition, scratch) != 0
        return lambda clocks: known
    match condition:
        case Unary(UnaryOperator.NOT, operand):
            inner = _residual(operand, scratch)
            return None if inner is None else lambda clocks: not inner(clocks)
        case Binary(BinaryOperator.AND, left, right):
            return _joined((_residual(left, scratch), _residual(right, scratch)), False)
        case Binary(BinaryOperator.OR, left, right):
            return _joined((_residual(left, scratch), _residual(right, scratch)), True)
        case Quantifier(QuantifierKind.FORALL | QuantifierKind.EXISTS as kind, variable, body):
            assert isinstance(variable.type, ScalarLike)
            low, high = bounds(variable.type)
            instances = (_instance(body, variable, value, scratch) for value in range(low, high + 1))
            return _joined(instances, kind is QuantifierKind.EXISTS)
        case Binary(operator, left, right) if isinstance(left.type, ClockType) or isinstance(right.type, ClockType):
            return _compared(operator.comparison, left, right, scratch)
        case _:
            return None


def _instance(body: Expression, variable: Variable, value: int, scratch: Environment) -> Residual | None:
    scratch.bind(variable, value)
    return _residual(body, scratch)


def _joined(parts: Iterable[Residual | None], decisive: bool) -> Residual | None:
    """A disjunction (which a true part decides) or a conjunction (which a false one decides)."""
    known: list[Residual] = []
    for part in parts:
        if part is None:
            return None
        known.append(part)
    match known:
        case [first, second] if decisive:
            return lambda clocks: first(clocks) or second(clocks)
        case [first, second]:
            return lambda clocks: first(clocks) and second(clocks)
        case _ if decisive:
            return lambda clocks: any(part(clocks) for part in known)
        case _:
            return lambda clocks: all(part(clocks) for part in known)


def _compared(
    compare: Callable[[int | Fraction, int | Fraction], bool], left: Expression, right: Expression, scratch: Environment
) -> Residual:
    match _clock(left, scratch), _clock(right, scratch):
        case int(place), None if not isinstance(right.type, ClockType):
            number = evaluate(right, scratch)
            return lambda clocks: compare(clocks[place], number)
        case None, int(place) if not isinstance(left.type, ClockType):
            number = evaluate(left, scratch)
            return lambda clocks: compare(number, clocks[place])
    one, other = _value(left, scratch), _value(right, scratch)
    return lambda clocks: compare(one(clocks), other(clocks))


def _clock(expression: Expression, scratch: Environment) -> int | None:
    """The place of a clock among the values; None for another expression."""
    alone = isinstance(expression.type, ClockType) and not isinstance(expression, Binary)
    return clock_number(expression, scratch) - 1 if alone else None


def _value(expression: Expression, scratch: Environment) -> Callable[[Clocks], int | Fraction]:
    place = _clock(expression, scratch)
    if place is not None:
        return lambda clocks: clocks[place]
    if isinstance(expression, Binary) and isinstance(expression.type, ClockType):
        one, other = _value(expression.left, scratch), _value(expression.right, scratch)
        return lambda clocks: one(clocks) - other(clocks)
    number = evaluate(expression, scratch)
    return lambda clocks: number
