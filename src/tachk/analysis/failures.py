"""Which expressions can meet a run-time error, as far as the ranges of variables tell."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field, replace
from typing import assert_never

from tachk.analysis.conditions import conjuncts
from tachk.analysis.fold import Known, fold, fold_place, is_integer
from tachk.analysis.intervals import Interval, arithmetic, interval
from tachk.base.operators import COMPARISONS, BinaryOperator
from tachk.base.records import dataclass
from tachk.base.words import Direction
from tachk.model.cell_layout import cell_range
from tachk.model.clock_sums import clock_sum
from tachk.model.expressions import (
    Aggregate,
    Assert,
    Assign,
    Binary,
    Block,
    Call,
    Comma,
    Conditional,
    Constant,
    Deadlock,
    Declare,
    Evaluate,
    Expression,
    Field,
    If,
    Increment,
    Index,
    Iterate,
    LocationTest,
    Quantifier,
    Reference,
    Return,
    Statement,
    Unary,
    Variable,
    While,
)
from tachk.model.network import Edge, Location
from tachk.model.traversal import written_variables
from tachk.model.types import ArrayType, ClockType, RecordType, Type

_LONG = 2**14
"""Repetitions beyond which a loop might meet the limit on steps."""


def can_fail(expression: Expression, known: Known) -> bool:
    """Whether evaluating the expression can be a run-time error in some state. Conservative: what is not plain can.

    ``x / y``, for one, cannot where the range of ``y`` leaves out 0, and ``n = m`` cannot where all of ``m`` fits.
    """
    return _NarrowedScope(known).fails(expression)


def location_can_fail(location: Location, known: Known) -> bool:
    """Whether the invariant or a rate of a location can be a run-time error."""
    invariant = () if location.invariant is None else (location.invariant,)
    return any(can_fail(expression, known) for expression in (*invariant, *(rate for _, rate in location.rates)))


def edge_can_fail(edge: Edge, known: Known, updates: Sequence[Expression] | None = None) -> bool:
    """Whether something of an edge can be a run-time error.

    Args:
        updates: those of its updates that are asked about, and nothing but them; all of the edge if there are none.
    """
    asked = edge.updates if updates is None else updates
    before, fails = ({}, False) if edge.guard is None else _narrowed(fold(edge.guard, known), known)
    if updates is None and edge.synchronisation is not None:
        fails = fails or _NarrowedScope(known, before).fails(edge.synchronisation.channel)
    if updates is None and fails:
        return True
    receives = edge.synchronisation is not None and edge.synchronisation.direction is Direction.RECEIVE
    # What the sender does comes between the guard of a receiver and its updates.
    narrow = {} if receives else before
    for update in edge.updates:
        if update in asked and _NarrowedScope(known, narrow).fails(update):
            return True
        narrow = {v: range_ for v, range_ in narrow.items() if v not in written_variables([update])}
    return False


def _narrowed(guard: Expression, known: Known) -> tuple[dict[Variable, Interval], bool]:
    """The ranges of variables where a guard holds, as far as it compares them with constants, and whether the guard can
    fail, each part of it behind those to its left."""
    found: dict[Variable, Interval] = {}
    fails = False
    for part in conjuncts(guard):
        fails = fails or _NarrowedScope(known, found).fails(part)
        match part:
            case Binary(operator, Reference(variable), Constant(value)) if is_integer(variable.type):
                pass
            case Binary(operator, Constant(value), Reference(variable)) if operator in COMPARISONS and is_integer(
                variable.type
            ):
                operator = operator.mirrored
            case _:
                continue
        low, high = found.get(variable, cell_range(variable.type))
        match operator:
            case BinaryOperator.EQUAL:
                low, high = max(low, value), min(high, value)
            case BinaryOperator.LESS:
                high = min(high, value - 1)
            case BinaryOperator.LESS_EQUAL:
                high = min(high, value)
            case BinaryOperator.GREATER:
                low = max(low, value + 1)
            case BinaryOperator.GREATER_EQUAL:
                low = max(low, value)
            case _:
                pass
        if low <= high:
            found[variable] = low, high
    return found, fails


@dataclass(frozen=True, slots=True)
class _NarrowedScope:
    """Where an expression is evaluated.

    Attributes:
        narrow: the ranges of variables, where they are smaller than the declared ones.
        times: how often the loops around it may repeat it.
    """

    known: Known
    narrow: Mapping[Variable, Interval] = field(default_factory=dict)
    times: int = 1

    def fails(self, expression: Expression) -> bool:
        """Whether evaluating the expression can be a run-time error."""
        return self._folded_fails(fold_place(expression, self.known))

    def _interval(self, expression: Expression) -> Interval:
        return interval(expression, self.known, self.narrow)

    def _repeated(self, variable: Variable) -> _NarrowedScope:
        low, high = cell_range(variable.type)
        return replace(self, times=self.times * (high - low + 1))

    def _folded_fails(self, expression: Expression) -> bool:
        def inner(*parts: Expression) -> bool:
            return any(map(self._folded_fails, parts))

        match expression:
            case Constant() | LocationTest() | Deadlock() | Reference():
                return False
            case Index(base, index):
                assert isinstance(base.type, ArrayType)
                last = base.type.low + base.type.size - 1
                return inner(base, index) or not _within(self._interval(index), (base.type.low, last))
            case Field(base):
                return inner(base)
            case Unary(_, operand):
                return inner(operand)
            case Binary(operator, left, right):
                return inner(left, right) or self._undefined(operator, right)
            case Conditional(condition, then, otherwise):
                return inner(condition, then, otherwise)
            case Quantifier(_, variable, body):
                repeated = self._repeated(variable)
                return repeated.times > _LONG or repeated._folded_fails(body)
            case Assign(target, value):
                return inner(target, value) or self._stores_badly(expression)
            case Increment(target, delta):
                low, high = self._interval(target)
                return inner(target) or not _within((low + delta, high + delta), cell_range(target.type))
            case Call(function, arguments) if function.operation is not None:
                return inner(*arguments) or not function.operation.total
            case Call(function, arguments):
                pairs = zip(function.parameters, arguments, strict=True)
                return (
                    inner(*arguments)
                    or any(not p.reference and not self._fits(a, p.type) for p, a in pairs)
                    or _NarrowedScope(self.known, times=self.times)._statement_fails(function.body, function.result)
                )
            case Comma(items) | Aggregate(items):
                return inner(*items)
            case _ as never:
                assert_never(never)

    def _undefined(self, operator: BinaryOperator, right: Expression) -> bool:
        """Whether an operator may have no value for some right sides."""
        return not operator.total and not operator.defined_for(*self._interval(right))

    def _stores_badly(self, assignment: Assign) -> bool:
        target, value, operator = assignment.target, assignment.value, assignment.operator
        if isinstance(target.type, ClockType):
            whole = clock_sum(value)
            return whole is None or (whole.offset is not None and self._interval(whole.offset)[0] < 0)
        if operator is None:
            return not self._fits(value, target.type)
        if self._undefined(operator, value):
            return True
        result = arithmetic(operator, self._interval(target), self._interval(value))
        return not _within(result, cell_range(target.type))

    def _fits(self, value: Expression, type_: Type) -> bool:
        """Whether all values of an expression lie in the ranges of a type."""
        if is_integer(type_):
            return _within(self._interval(value), cell_range(type_))
        if isinstance(value, Aggregate):
            parts = [inner for _, inner in type_.fields] if isinstance(type_, RecordType) else []
            parts = [type_.element] * len(value.items) if isinstance(type_, ArrayType) else parts
            return all(self._fits(item, part) for item, part in zip(value.items, parts, strict=True))
        return value.type == type_

    def _statement_fails(self, statement: Statement, result: Type) -> bool:
        def inner(*parts: Statement | None) -> bool:
            return any(part is not None and self._statement_fails(part, result) for part in parts)

        match statement:
            case Evaluate(expression):
                return self.fails(expression)
            case Declare(variable, initial):
                return initial is not None and (self.fails(initial) or not self._fits(initial, variable.type))
            case Block(statements):
                return inner(*statements)
            case If(condition, then, otherwise):
                return self.fails(condition) or inner(then, otherwise)
            case While() | Assert():
                return True
            case Iterate(variable, body):
                repeated = self._repeated(variable)
                return repeated.times > _LONG or repeated._statement_fails(body, result)
            case Return(value):
                return value is not None and (self.fails(value) or not self._fits(value, result))
            case _ as never:
                assert_never(never)


def _within(inner: Interval, outer: Interval) -> bool:
    return outer[0] <= inner[0] and inner[1] <= outer[1]
