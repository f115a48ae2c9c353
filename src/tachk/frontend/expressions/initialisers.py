"""Initial values: expressions, and lists in braces for arrays and structs."""

from __future__ import annotations

from tachk.base.diagnostics.suggestion import did_you_mean
from tachk.base.span import Span
from tachk.frontend.context import Context
from tachk.frontend.dropped import report_unknown_names
from tachk.frontend.expressions.places import converted
from tachk.frontend.expressions.typed_expressions import expression
from tachk.frontend.expressions.typing import can_assign, describe
from tachk.frontend.scope import Scope
from tachk.model.expressions import Aggregate, Expression
from tachk.model.floating import DOUBLE, is_double, value_type
from tachk.model.types import ArrayType, ClockType, IntType, RecordType, Type
from tachk.syntax import ast


def initialiser(node: ast.Expression, type_: Type, scope: Scope, context: Context) -> Expression | None:
    """The initial value of a variable of the given type."""
    if isinstance(node, ast.InitialiserList):
        return _list(node, type_, scope, context)
    value = expression(node, scope, context)
    if value is None:
        return None
    if isinstance(type_, ClockType):
        return clock_value(value, type_, node.span, context)
    if not can_assign(type_, value.type):
        context.error("E0302", node.span, f"{describe(value.type)} cannot initialise {describe(type_)}")
        return None
    return converted(value, value_type(type_))


def clock_value(value: Expression, type_: Type, span: Span, context: Context) -> Expression | None:
    """The initial value of a clock, plain or hybrid; None after a report."""
    if is_double(type_) and can_assign(type_, value.type):
        return converted(value, type_)
    if value.type == DOUBLE:
        help = "`tachk simulate` and `tachk estimate` know them; write an integer"
        context.error("E0750", span, "an initial value of a clock that is not an integer is not supported", help)
        return None
    if not isinstance(value.type, IntType):
        context.error("E0302", span, f"{describe(value.type)} cannot initialise clock")
        return None
    return value


def _list(node: ast.InitialiserList, type_: Type, scope: Scope, context: Context) -> Expression | None:
    wanted: list[Type | None]
    ordered: list[ast.Expression | None]
    match type_:
        case ArrayType():
            wanted = [type_.element] * type_.size
            for designator, _ in node.items:
                if designator is not None:
                    context.error("E0318", designator.span, "the elements of an array have no names")
                    return None
            ordered = [item for _, item in node.items]
        case RecordType(_, fields) if not is_double(type_):
            types = dict(fields)
            names = [name for name, _ in fields]
            for place, name, _ in type_.left_out:
                names.insert(place, name)
            wanted = [types.get(name) for name in names]
            ordered = [None] * len(names)
            for position, (designator, item) in enumerate(node.items):
                if designator is not None and designator.name not in names:
                    context.error(
                        "E0205",
                        designator.span,
                        f"{describe(type_)} has no field `{designator.name}`",
                        did_you_mean(designator.name, names),
                    )
                    return None
                place = position if designator is None else names.index(designator.name)
                if place >= len(names):
                    ordered.append(item)
                elif ordered[place] is not None:
                    context.error("E0318", item.span, f"field `{names[place]}` is initialised twice")
                    return None
                else:
                    ordered[place] = item
        case _:
            context.error("E0318", node.span, f"{describe(type_)} cannot be initialised with a list")
            return None
    given = [item for item in ordered if item is not None]
    if len(given) != len(wanted):
        context.error("E0318", node.span, f"{describe(type_)} needs {len(wanted)} initial values, not {len(given)}")
        return None
    items = []
    for item, wanted_type in zip(given, wanted, strict=True):
        if wanted_type is None:
            report_unknown_names(item, scope, context)
        else:
            items.append(initialiser(item, wanted_type, scope, context))
    if None in items:
        return None
    return Aggregate(tuple(item for item in items if item is not None), type_, node.span)
