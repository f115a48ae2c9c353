"""The typing rules of operators."""

from __future__ import annotations

from tachk.base.operators import COMPARISONS, BinaryOperator
from tachk.base.span import Span
from tachk.frontend.context import Context
from tachk.frontend.expressions import folded_expressions as fold
from tachk.frontend.expressions.clock_constraints import compare
from tachk.frontend.expressions.typing import (
    CHANNEL_HELP,
    CLOCK_VALUE_HELP,
    can_assign,
    describe,
    is_data,
    is_integral,
    same_shape,
)
from tachk.model.expressions import BOOL, INT, Binary, Expression
from tachk.model.floating import DOUBLE, FloatingOperation, contains_double
from tachk.model.floating_calls import as_double, operated
from tachk.model.types import ChannelType, ClockType, ScalarType, Type, contains_left_out, element_type, is_aggregate


def combine(
    operator: BinaryOperator, left: Expression, right: Expression, span: Span, context: Context
) -> Expression | None:
    """An arithmetic operation or comparison; None after a report."""
    clocks = isinstance(left.type, ClockType) or isinstance(right.type, ClockType)
    if DOUBLE in (left.type, right.type):
        return _floating(operator, left, right, span, context)
    for side in (left, right):
        if not (is_integral(side.type) or (clocks and isinstance(side.type, ClockType))) and (
            clocks or operator not in (BinaryOperator.EQUAL, BinaryOperator.NOT_EQUAL)
        ):
            context.error("E0301", side.span, f"`{operator}` cannot be applied to {describe(side.type)}")
            return None
    if clocks and operator in COMPARISONS:
        if context.in_function:
            context.error(
                "E0333",
                span,
                "a function cannot compare clocks",
                "compare them in the guard or invariant that calls the function",
            )
            return None
        return compare(operator, left, right, span, context)
    if clocks:
        if operator in (BinaryOperator.ADD, BinaryOperator.SUBTRACT):
            return Binary(operator, left, right, ClockType(), span)
        context.error("E0750", span, f"`{operator}` on the value of a clock is not supported", CLOCK_VALUE_HELP)
        return None
    if operator in COMPARISONS:
        return _comparison(operator, left, right, span, context)
    return fold.binary(operator, left, right, INT, span)


def _floating(
    operator: BinaryOperator, left: Expression, right: Expression, span: Span, context: Context
) -> Expression | None:
    """An operation of which a side is a floating point number."""
    for side in (left, right):
        if isinstance(side.type, ClockType):
            mend = "compare it with an integer; choose a shorter time unit if need be"
            context.error("E0750", span, "comparing a clock with a floating point number is not supported", mend)
            return None
    operation = FloatingOperation.__members__.get(operator.name)
    if operation is None:
        context.error("E0750", span, f"`{operator}` on floating point numbers is not supported")
        return None
    for side in (left, right):
        if side.type != DOUBLE and not is_integral(side.type):
            context.error("E0301", side.span, f"`{operator}` cannot be applied to {describe(side.type)}")
            return None
    return operated(operation, (left, right), span)


def _comparison(
    operator: BinaryOperator, left: Expression, right: Expression, span: Span, context: Context
) -> Expression | None:
    if is_integral(left.type) and is_integral(right.type):
        return fold.binary(operator, left, right, BOOL, span)
    if not (is_data(left.type) and same_shape(left.type, right.type)):
        context.error(
            "E0304",
            span,
            f"{describe(left.type)} and {describe(right.type)} cannot be compared",
            _cannot_compare_help(left.type, right.type),
        )
        return None
    if contains_double(left.type) or contains_left_out(left.type):
        what = f"comparing values of type {describe(left.type)}, which contain floating point numbers,"
        context.error("E0750", span, f"{what} is not supported", "compare the numbers one by one")
        return None
    if is_aggregate(left.type):
        return Binary(operator, left, right, BOOL, span)
    return fold.binary(operator, left, right, BOOL, span)


def _cannot_compare_help(*types: Type) -> str | None:
    if any(isinstance(type_, ScalarType) for type_ in types):
        return "values of a scalar type can only be compared with each other"
    if any(isinstance(element_type(type_), ChannelType) for type_ in types):
        return CHANNEL_HELP
    return None


def choose(
    test: Expression, then: Expression, otherwise: Expression, span: Span, context: Context
) -> Expression | None:
    """A conditional expression; None after a report."""
    type_: Type
    if is_integral(then.type) and is_integral(otherwise.type):
        type_ = then.type if then.type == otherwise.type else INT
    elif DOUBLE in (then.type, otherwise.type) and can_assign(DOUBLE, then.type) and can_assign(DOUBLE, otherwise.type):
        return fold.conditional(test, as_double(then), as_double(otherwise), DOUBLE, span)
    elif same_shape(then.type, otherwise.type):
        type_ = then.type
    else:
        context.error(
            "E0304",
            span,
            f"the two sides of `?:` have different types, {describe(then.type)} and {describe(otherwise.type)}",
        )
        return None
    return fold.conditional(test, then, otherwise, type_, span)
