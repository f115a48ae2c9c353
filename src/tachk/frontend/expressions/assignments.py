"""The typing rules of assignments."""

from __future__ import annotations

from tachk.base.operators import BinaryOperator
from tachk.frontend.context import Context
from tachk.frontend.expressions.operator_types import combine
from tachk.frontend.expressions.places import converted
from tachk.frontend.expressions.typing import CHANNEL_HELP, FINT_HELP, can_assign, describe, is_integral
from tachk.model.clock_sums import clock_sum
from tachk.model.expressions import Assign, Expression
from tachk.model.floating import DOUBLE
from tachk.model.traversal import may_change, walk
from tachk.model.types import ChannelType, ClockType, ScalarType, Type, element_type
from tachk.syntax import ast


def assignment(
    target: Expression, value: Expression, node: ast.AssignmentExpression, context: Context
) -> Expression | None:
    """A value stored in a place; None after a report."""
    operator = node.operator
    if isinstance(target.type, ClockType):
        if value.type == DOUBLE:
            what = "setting a clock to a floating point number is not supported"
            context.error("E0750", node.span, what, FINT_HELP)
            return None
        if not (is_integral(value.type) or isinstance(value.type, ClockType)):
            context.error("E0302", node.span, f"a clock cannot be set to {describe(value.type)}")
            return None
        if operator is not None:
            place, step = node.target.span.text, node.value.span.text
            step = step if step.isalnum() else f"({step})"
            help = f"write `{place} = {place} + {step}`" if operator is BinaryOperator.ADD else None
            context.error("E0750", node.span, f"`{operator}=` on a clock is not supported", help)
            return None
        if clock_sum(value) is None:
            context.error(
                "E0750",
                node.span,
                "setting a clock to this value of clocks is not supported",
                "write `x = y` or `x = y + e` with a clock `y` and an integer expression `e` that is not negative",
            )
            return None
        return Assign(target, value, target.type, None, node.span)
    if operator is not None and target.type == DOUBLE:
        if any(map(may_change, walk(target))):
            what = f"`{operator}=` on this element is not supported"
            context.error("E0750", node.span, what, "compute its index before")
            return None
        whole = combine(operator, target, value, node.span, context)
        return None if whole is None else Assign(target, whole, DOUBLE, None, node.span)
    if operator is not None:
        for side in (target, value):
            if not is_integral(side.type):
                context.error("E0301", side.span, f"`{operator}=` needs integers, not {describe(side.type)}")
                return None
        return Assign(target, value, target.type, operator, node.span)
    if not can_assign(target.type, value.type):
        context.error(
            "E0302",
            node.span,
            f"{describe(value.type)} cannot be assigned to {describe(target.type)}",
            _cannot_assign_help(target.type, value.type),
        )
        return None
    return Assign(target, converted(value, target.type), target.type, None, node.span)


def _cannot_assign_help(target: Type, value: Type) -> str | None:
    if isinstance(target, ScalarType):
        return "values of a scalar type can only be copied"
    if isinstance(element_type(target), ChannelType):
        return CHANNEL_HELP
    if value == DOUBLE and is_integral(target):
        return FINT_HELP
    if isinstance(value, ClockType):
        return "the value of a clock cannot be stored; compare the clock in a guard"
    return None
