"""Invariants: conditions on clocks and variables, and rates ``x' == e``."""

from __future__ import annotations

from tachk.base.operators import BinaryOperator
from tachk.base.span import Span
from tachk.frontend.context import Context
from tachk.frontend.dropped import drop_rate
from tachk.frontend.expressions import folded_expressions as fold
from tachk.frontend.expressions.clock_constraints import convex, forbid
from tachk.frontend.expressions.typed_expressions import condition, expression, type_reader
from tachk.frontend.expressions.typing import describe, is_integral, value_range
from tachk.frontend.scope import Scope, ValueSymbol
from tachk.model.expressions import BOOL, Block, Call, Constant, Expression, Function, Return
from tachk.model.floating import DOUBLE
from tachk.model.floating_calls import as_double
from tachk.model.traversal import holds_hybrid_clock
from tachk.model.types import ClockType, IntType, bounds
from tachk.syntax import ast
from tachk.syntax.walk import nodes_of_kind

Rates = tuple[tuple[Expression, Expression], ...]


def invariant_parts(
    node: ast.Expression | None, scope: Scope, context: Context
) -> tuple[Expression | None, Rates, Rates]:
    """The condition of an invariant (None where there is none, or after a report), its rates, and those of hybrid
    clocks."""
    if node is None:
        return None, (), ()
    conditions: list[Expression] = []
    rates: list[tuple[Expression, Expression]] = []
    hybrid_rates: list[tuple[Expression, Expression]] = []
    for part, inner in _conjuncts(node, scope, context):
        rate = _rate_sides(part)
        if rate is not None:
            if drop_rate(rate[0].clock, rate[1], inner, context):
                continue
            clock, value = expression(rate[0].clock, inner, context), expression(rate[1], inner, context)
            if clock is None or value is None:
                continue
            if holds_hybrid_clock(clock):
                if _is_hybrid_rate(value, context):
                    hybrid_rates.append((clock, as_double(value)))
                continue
            pair = _rate(clock, value, rate[0].clock.span, context)
            if pair is not None and not (isinstance(pair[1], Constant) and pair[1].value == 1):
                rates.append(pair)
            continue
        value = condition(part, inner, context)
        if value is None or not context.require_pure(value, "an invariant"):
            continue
        checked = convex(value, "invariant", context)
        if checked is None:
            continue
        conditions.append(checked)
    if len(conditions) > 1:
        conditions = [fold.joined(BinaryOperator.AND, [*map(fold.truth, conditions)], BOOL, node.span)]
    return (conditions[0] if conditions else None), tuple(rates), tuple(hybrid_rates)


def _conjuncts(node: ast.Expression, scope: Scope, context: Context) -> list[tuple[ast.Expression, Scope]]:
    """The conjuncts of an invariant, each with the scope to elaborate it in; ``forall`` over rates is expanded."""
    result: list[tuple[ast.Expression, Scope]] = []
    pending: list[tuple[ast.Expression, Scope]] = [(node, scope)]
    while pending:
        current, inner = pending.pop()
        match current:
            case ast.BinaryExpression(operator=BinaryOperator.AND, left=left, right=right):
                pending += [(right, inner), (left, inner)]
            case ast.QuantifierExpression(kind="forall", variable=name, type=type_, body=body) if _has_rate(body):
                bounded = type_reader(inner, context).bounded(type_, "the variable of `forall`")
                if bounded is not None:
                    low, high = bounds(bounded)
                    if not context.allow_instances(high - low + 1, current.span):
                        continue
                    for value in range(high, low - 1, -1):
                        symbol = ValueSymbol(Constant(value, bounded), False, "bound variable", name.span)
                        pending.append((body, Scope(inner, "", {name.name: symbol})))
            case _:
                result.append((current, inner))
    return result


def _has_rate(node: ast.Expression) -> bool:
    return any(nodes_of_kind(node, ast.RateExpression))


def _rate_sides(node: ast.Expression) -> tuple[ast.RateExpression, ast.Expression] | None:
    match node:
        case ast.BinaryExpression(operator=BinaryOperator.EQUAL, left=ast.RateExpression() as rate, right=value):
            return rate, value
        case ast.BinaryExpression(operator=BinaryOperator.EQUAL, left=value, right=ast.RateExpression() as rate):
            return rate, value
        case _:
            return None


def _is_hybrid_rate(value: Expression, context: Context) -> bool:
    if value.type != DOUBLE and not is_integral(value.type):
        context.error("E0301", value.span, f"a rate is a number, not {describe(value.type)}")
        return False
    return context.require_pure(value, "a rate")


def _rate(clock: Expression, value: Expression, place: Span, context: Context) -> tuple[Expression, Expression] | None:
    if not isinstance(clock.type, ClockType):
        context.error("E0334", place, f"only clocks have a rate, not {describe(clock.type)}")
        return None
    if isinstance(value.type, ClockType) or value.type == DOUBLE:
        _other_rate(value, context)
        return None
    if not is_integral(value.type):
        context.error("E0301", value.span, f"expected an integer, found {describe(value.type)}")
        return None
    if not context.require_pure(value, "a rate") or not forbid(value, "a rate", context):
        return None
    low, high = value_range(value)
    if high < 0 or low > 1 or (isinstance(value, Constant) and value.value not in (0, 1)):
        _other_rate(value, context)
        return None
    if low < 0 or high > 1:
        value = _checked(value, context)
    return clock, value


def _other_rate(written: Expression, context: Context) -> None:
    context.error(
        "E0750",
        written.span,
        "a clock rate other than 0 and 1 is not supported",
        "let the clock stand still (rate 0) or run (rate 1); other rates belong to statistical checking",
    )


def _checked(value: Expression, context: Context) -> Expression:
    """The value through a function with the result type ``int[0,1]``, so that another rate is a run-time error."""
    result = IntType(0, 1)
    function = Function("rate", (), result, Block((Return(value),)), value.span)
    context.record_function(function)
    return Call(function, (), result, value.span)
