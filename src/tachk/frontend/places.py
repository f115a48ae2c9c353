"""What can be assigned to, and how values are stored."""

from __future__ import annotations

from tachk.frontend import fold
from tachk.frontend.context import Context
from tachk.frontend.scope import Scope, ValueSymbol
from tachk.model.expressions import Conditional, Expression, Field, Index, Reference
from tachk.model.types import BoolType, IntType, Type
from tachk.syntax import ast


def assignable(node: ast.Expression, scope: Scope, context: Context) -> bool:
    """Whether an expression is a place that may change; reports if it is not."""
    match node:
        case ast.NameExpression(span, name):
            symbol = scope.lookup(name)
            if isinstance(symbol, ValueSymbol) and not symbol.assignable:
                help_ = "copy it to a local variable" if symbol.description == "parameter" else None
                context.error("E0303", span, f"`{name}` is a {symbol.description} and cannot be changed", help_)
                return False
            return True
        case ast.IndexExpression(_, base):
            return assignable(base, scope, context)
        case ast.MemberExpression(_, base):
            return assignable(base, scope, context)
        case ast.ConditionalExpression(_, _, then, otherwise):
            return assignable(then, scope, context) and assignable(otherwise, scope, context)
        case _:
            context.error("E0303", node.span, "only a variable can be assigned to")
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
    return value
