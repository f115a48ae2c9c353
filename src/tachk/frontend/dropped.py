"""Floating point variables and hybrid clocks that only other such variables ever see.

They belong to statistical checking. What is assigned to them, and the rate of a hybrid clock, is left out of the
network; whatever else uses one is refused where it does, so what is left out can influence nothing that is checked.
"""

from __future__ import annotations

from tachk.frontend.builtin_names import FLOATING_FUNCTIONS
from tachk.frontend.context import Context
from tachk.frontend.scope import DroppedSymbol, Scope, ValueSymbol
from tachk.syntax import ast


def dropped_kind(node: ast.TypeExpression) -> str | None:
    """What to call variables of a type that is left out; None for any other type."""
    if not isinstance(node.base, ast.BuiltinType):
        return None
    if "hybrid" in node.prefixes and node.base.name == "clock":
        return "hybrid clock"
    if node.base.name == "double":
        return "floating point constant" if "const" in node.prefixes else "floating point variable"
    return None


def declare_dropped(node: ast.VariableDeclaration, kind: str, scope: Scope, context: Context) -> None:
    for declarator in node.declarators:
        name = declarator.name
        context.error(
            "W0406",
            name.span,
            f"the {kind} `{name.name}` is not part of what is checked",
            "assignments to it are left out; what reads it is refused",
        )
        scope.declare(name, DroppedSymbol(name.span, kind), context.findings)


def refuse_use(node: ast.NameExpression | ast.MemberExpression, symbol: DroppedSymbol, context: Context) -> None:
    """Reports that something checked depends on what is left out."""
    name = node.name if isinstance(node, ast.NameExpression) else node.name.name
    advice = "declare a plain `clock`" if symbol.description == "hybrid clock" else "use integers, scaled if need be"
    context.error("E0750", node.span, f"the {symbol.description} `{name}` is not supported here", advice)


def without_effect(update: ast.Expression, scope: Scope) -> bool:
    """Whether an update only changes what is left out, and cannot fail."""
    return (
        isinstance(update, ast.AssignmentExpression)
        and is_dropped(update.target, scope)
        and is_harmless(update.value, scope)
    )


def is_dropped(node: ast.Expression, scope: Scope) -> bool:
    return isinstance(node, ast.NameExpression) and isinstance(scope.lookup(node.name), DroppedSymbol)


def is_harmless(node: ast.Expression, scope: Scope) -> bool:
    """Whether computing an expression changes nothing and cannot be a run-time error: no calls of the model's
    functions, no indices, no division by something that may be zero."""
    match node:
        case ast.IntegerLiteral() | ast.FloatLiteral() | ast.BooleanLiteral():
            return True
        case ast.NameExpression(name=name):
            return isinstance(scope.lookup(name), ValueSymbol | DroppedSymbol)
        case ast.UnaryExpression(operand=operand):
            return is_harmless(operand, scope)
        case ast.BinaryExpression(operator="+" | "-" | "*", left=left, right=right):
            return is_harmless(left, scope) and is_harmless(right, scope)
        case ast.BinaryExpression(operator="/", left=left, right=ast.IntegerLiteral(value=value)):
            return value != 0 and is_harmless(left, scope)
        case ast.CallExpression(function=ast.NameExpression(name=name), arguments=arguments):
            known = name in FLOATING_FUNCTIONS and scope.lookup(name) is None
            return known and all(is_harmless(argument, scope) for argument in arguments)
        case _:
            return False
