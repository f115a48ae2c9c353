"""Places: what can be indexed, what has fields, what can be assigned to, and how values are stored."""

from __future__ import annotations

from tachk.base.diagnostics.suggestion import did_you_mean
from tachk.frontend.context import Context
from tachk.frontend.expressions import folded_expressions as fold
from tachk.frontend.expressions.typing import describe, is_integral
from tachk.frontend.scope import Scope, ValueSymbol
from tachk.model.expressions import Conditional, Expression, Field, Index, Reference
from tachk.model.floating import DOUBLE, value_type
from tachk.model.floating_calls import as_double
from tachk.model.types import ArrayType, BoolType, IntType, RecordType, ScalarType, Type
from tachk.syntax import ast

_COMPARE = "write `==` to compare"


def assignable(node: ast.Expression, scope: Scope, context: Context, mend: str | None = _COMPARE) -> bool:
    """True if an expression is a place that may change; reports if it is not.

    Args:
        mend: what to do where it is not a variable at all.
    """
    match node:
        case ast.NameExpression(span, name):
            symbol = scope.lookup(name)
            if isinstance(symbol, ValueSymbol) and not symbol.assignable:
                help_ = "copy it to a local variable" if symbol.description == "parameter" else None
                context.error("E0303", span, f"`{name}` is a {symbol.description} and cannot be changed", help_)
                return False
            return True
        case ast.IndexExpression(_, base):
            return assignable(base, scope, context, mend)
        case ast.MemberExpression(_, base):
            return assignable(base, scope, context, mend)
        case ast.ConditionalExpression(_, _, then, otherwise):
            return all(assignable(side, scope, context, mend) for side in (then, otherwise))
        case ast.IncrementExpression(operator=operator, prefix=False):
            what = f"`{operator}` behind a variable gives its old value, which cannot be changed"
            context.error("E0303", node.span, what, f"write `{operator}` in front of the variable")
            return False
        case _:
            context.error("E0303", node.span, "only a variable can be changed", mend)
            return False


def is_place(value: Expression) -> bool:
    match value:
        case Reference():
            return True
        case Index(base) | Field(base):
            return is_place(base)
        case Conditional(_, then, otherwise):
            return is_place(then) and is_place(otherwise)
        case _:
            return False


def converted(value: Expression, target: Type) -> Expression:
    """The value as it is stored in a variable of the target type: an integer in a bool becomes 0 or 1."""
    if isinstance(target, BoolType) and isinstance(value.type, IntType):
        return fold.truth(value)
    return as_double(value) if target == DOUBLE else value


def element(base: Expression, number: Expression, node: ast.IndexExpression, context: Context) -> Expression | None:
    """An element of an array; None after a report."""
    if not isinstance(base.type, ArrayType):
        context.error("E0306", node.span, f"{describe(base.type)} cannot be indexed, only arrays can")
        return None
    wanted = base.type.index
    if isinstance(wanted, ScalarType) and number.type != wanted:
        context.error(
            "E0306", node.index.span, f"this array is indexed by {describe(wanted)}, not by {describe(number.type)}"
        )
        return None
    if isinstance(wanted, IntType) and not is_integral(number.type):
        context.error("E0306", node.index.span, f"an index must be an integer, not {describe(number.type)}")
        return None
    return fold.index(base, number, value_type(base.type.element), node.span, context.constants)


def field(base: Expression, node: ast.MemberExpression, context: Context) -> Expression | None:
    """A field of a struct; None after a report."""
    if not isinstance(base.type, RecordType) or base.type == DOUBLE:
        context.error("E0307", node.span, f"{describe(base.type)} has no fields, only structs do")
        return None
    if base.type.leaves_out(node.name.name):
        what = f"the floating point field `{node.name.name}` is not supported here"
        context.error("E0750", node.span, what, "use integers, scaled if need be")
        return None
    for name, type_ in base.type.fields:
        if name == node.name.name:
            return fold.field(base, name, value_type(type_), node.span, context.constants)
    context.error(
        "E0205",
        node.name.span,
        f"{describe(base.type)} has no field `{node.name.name}`",
        did_you_mean(node.name.name, (name for name, _ in base.type.fields)),
    )
    return None
