"""Floating point variables, texts and hybrid clocks that only other such variables ever see, and functions with
something in them that is refused.

They belong to statistical checking. What is assigned to such variables, and the rate of a hybrid clock, is left out of
the network; whatever else uses one is refused where it does, and so is every call of such a function, so what is left
out can influence nothing that is checked.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from tachk.base.diagnostics.diagnostic import Diagnostic, Label
from tachk.base.operators import BinaryOperator
from tachk.base.span import Span
from tachk.frontend.context import Context
from tachk.frontend.dropped_fields import left_out_type, type_of_place
from tachk.frontend.expressions.builtin_names import BUILTIN_CONSTANTS, BUILTIN_FUNCTIONS, FLOATING_FUNCTIONS
from tachk.frontend.expressions.text_constants import text_value
from tachk.frontend.scope import DroppedSymbol, Scope, ValueSymbol
from tachk.model.types import Type
from tachk.syntax import ast
from tachk.syntax.walk import nodes_of_kind

FLOATING_CONSTANT = "floating point constant"
FLOATING_VARIABLE = "floating point variable"
HYBRID_CLOCK = "hybrid clock"


def dropped_kind(node: ast.TypeExpression) -> str | None:
    """The noun for variables of a type that is left out; None for any other type."""
    if not isinstance(node.base, ast.BuiltinType):
        return None
    if "hybrid" in node.prefixes and node.base.name == "clock":
        return HYBRID_CLOCK
    constant = "const" in node.prefixes
    if node.base.name == "double":
        return FLOATING_CONSTANT if constant else FLOATING_VARIABLE
    if node.base.name == "string":
        return "text constant" if constant else "text variable"
    return None


def declare_dropped(
    node: ast.VariableDeclaration, kind: str, shapes: Sequence[Type | None], scope: Scope, context: Context
) -> None:
    """Declares variables that are left out, with a note; a constant text needs no note."""
    for declarator, shape in zip(node.declarators, shapes, strict=True):
        name = declarator.name
        given = None if declarator.dimensions or not kind.endswith("constant") else declarator.initialiser
        text = None if given is None else text_value(given, scope)
        if text is not None:
            scope.declare(name, DroppedSymbol(name.span, kind, text=text), context.findings)
            continue
        scope.declare(name, dropped_variable(name, kind, shape, context), context.findings)


def dropped_variable(name: ast.Identifier, kind: str, shape: Type | None, context: Context) -> DroppedSymbol:
    """The symbol of a variable that is left out, after a warning."""
    context.error(
        "W0406",
        name.span,
        f"tachk does not check the {kind} `{name.name}`",
        "assignments to it are left out; anything that reads it is refused",
    )
    return DroppedSymbol(name.span, kind, shape=shape)


def declare_dropped_function(
    node: ast.FunctionDeclaration, reasons: Sequence[Diagnostic], scope: Scope, context: Context
) -> None:
    name = node.name
    context.findings.add(
        "W0407",
        name.span,
        f"tachk does not check the function `{name.name}`",
        "anything that calls it is refused",
        tuple(Label(reason.span, reason.message) for reason in reasons[:1]),
    )
    scope.declare(name, DroppedSymbol(name.span, "function", reasons[0]), context.findings)


def declare_foreign_functions(node: ast.ForeignImport, scope: Scope, context: Context) -> None:
    """Declares the functions of another program, which only it can run. The names are those in front of a parenthesis,
    or of ``name = original(...)``."""
    reason = Diagnostic("E0750", f"functions of the foreign library {node.library!r} are not supported", node.span)
    context.findings.add(
        "W0407",
        node.span,
        f"tachk does not check the functions of the foreign library {node.library!r}",
        "anything that calls them is refused",
    )
    text = _COMMENT.sub(lambda comment: " " * len(comment.group()), node.span.text)
    for found in _FOREIGN_FUNCTION.finditer(text, text.find("{")):
        start = node.span.start + found.start(1)
        span = Span(node.span.source, start, start + len(found[1]))
        scope.declare(ast.Identifier(span, found[1]), DroppedSymbol(span, "function", reason), context.findings)


_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
_FOREIGN_FUNCTION = re.compile(r"\b([A-Za-z_]\w*)\s*(?:=\s*\w+\s*)?\([^()]*\)\s*;")


def refuse_call(node: ast.Expression, symbol: DroppedSymbol, context: Context) -> None:
    """Reports a call of a function that is left out, or of what is not a function."""
    if symbol.reason is None:
        context.error("E0208", node.span, f"a {symbol.description} is not a function")
        return
    label = Label(symbol.reason.span, symbol.reason.message)
    context.findings.add("E0750", node.span, f"the function `{node.span.text}` is not supported", None, (label,))


def refuse_use(node: ast.NameExpression | ast.MemberExpression, symbol: DroppedSymbol, context: Context) -> None:
    """Reports that a checked part depends on one that is left out."""
    name = node.name if isinstance(node, ast.NameExpression) else node.name.name
    if symbol.reason is not None:
        context.error("E0203", node.span, f"`{name}` is a function", "write parentheses to call it")
        return
    advice = "declare a plain `clock`" if symbol.description == HYBRID_CLOCK else "use integers, scaled if need be"
    context.error("E0750", node.span, f"the {symbol.description} `{name}` is not supported here", advice)


def checked_part_of_update(update: ast.Expression, scope: Scope) -> ast.Expression | None:
    """The part of an update that stays. An assignment to a dropped variable leaves its value, if computing that may
    change something or fail, and else nothing."""
    if not isinstance(update, ast.AssignmentExpression) or not is_dropped(update.target, scope):
        return update
    return None if is_harmless(update.value, scope) else update.value


def refuse_reference(node: ast.Expression, parameter: str, context: Context) -> None:
    """Reports that a variable that is left out is passed by reference."""
    context.error(
        "E0750",
        node.span,
        f"tachk leaves `{node.span.text}` out, and `{parameter}` could read it",
        "return the number, and assign it: `g = f()`",
    )


def is_dropped(node: ast.Expression, scope: Scope) -> bool:
    named = isinstance(node, ast.NameExpression) and isinstance(scope.lookup(node.name), DroppedSymbol)
    return named or left_out_type(node, scope) is not None


def drop_rate(clock: ast.Expression, value: ast.Expression, scope: Scope, context: Context) -> bool:
    """True if a rate is that of a clock which is left out. Symbolic checking never computes such a rate, so that it may
    use what is not supported; names that nothing declares are reported."""
    while isinstance(clock, ast.IndexExpression):
        clock = clock.base
    if not is_dropped(clock, scope):
        return False
    report_unknown_names(value, scope, context)
    return True


def report_unknown_names(value: ast.Expression, scope: Scope, context: Context) -> None:
    """Reports the names in something that is left out which nothing declares."""
    bound = {quantifier.variable.name for quantifier in nodes_of_kind(value, ast.QuantifierExpression)}
    for node in nodes_of_kind(value, ast.NameExpression):
        builtin = node.name in FLOATING_FUNCTIONS or node.name in BUILTIN_FUNCTIONS or node.name in BUILTIN_CONSTANTS
        if scope.lookup(node.name) is None and not builtin and node.name not in bound:
            context.error("E0201", node.span, f"unknown name `{node.name}`", scope.suggestion(node.name))


def is_harmless(node: ast.Expression, scope: Scope) -> bool:
    """True if computing an expression changes nothing and cannot be a run-time error: no calls of the model's
    functions, no indices, no division by something that may be zero."""
    match node:
        case ast.IntegerLiteral() | ast.FloatLiteral() | ast.BooleanLiteral() | ast.StringLiteral():
            return True
        case ast.NameExpression(name=name):
            return isinstance(scope.lookup(name), ValueSymbol | DroppedSymbol)
        case ast.MemberExpression() | ast.IndexExpression():
            return left_out_type(node, scope) is not None or type_of_place(node, scope) is not None
        case ast.UnaryExpression(operand=operand):
            return is_harmless(operand, scope)
        case ast.BinaryExpression(
            operator=BinaryOperator.ADD | BinaryOperator.SUBTRACT | BinaryOperator.MULTIPLY, left=left, right=right
        ):
            return is_harmless(left, scope) and is_harmless(right, scope)
        case ast.BinaryExpression(operator=BinaryOperator.DIVIDE, left=left, right=ast.IntegerLiteral(value=value)):
            return value != 0 and is_harmless(left, scope)
        case ast.CallExpression(function=ast.NameExpression(name=name), arguments=arguments):
            known = name in FLOATING_FUNCTIONS and scope.lookup(name) is None
            return known and all(is_harmless(argument, scope) for argument in arguments)
        case _:
            return False
