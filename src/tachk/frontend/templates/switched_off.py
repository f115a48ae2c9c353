"""Edges that a constant switches off on purpose."""

from __future__ import annotations

from tachk.base.operators import BinaryOperator
from tachk.base.records import replace
from tachk.frontend.context import Context
from tachk.frontend.expressions.typed_expressions import condition
from tachk.frontend.expressions.typing import is_integral
from tachk.frontend.findings import DiagnosticCollector
from tachk.frontend.scope import Scope, ValueSymbol
from tachk.model.connectives import conjuncts
from tachk.model.expressions import Constant, Expression
from tachk.syntax import ast
from tachk.syntax.rewrite import names_in


def switched_off(guard: ast.Expression | None, value: Expression | None, scope: Scope, context: Context) -> bool:
    """True if a part of a guard is false because of a global constant: with another value of it, which ``-D`` may
    give, the edge may be taken. A guard that is false whatever the constants are is not a switch.

    Args:
        value: the guard with its constants folded.
    """
    if (
        guard is None
        or value is None
        or not any(isinstance(part, Constant) and part.value == 0 for part in conjuncts(value))
    ):
        return False
    silent = replace(context, findings=DiagnosticCollector())
    pending = [guard]
    while pending:
        part = pending.pop()
        if isinstance(part, ast.BinaryExpression) and part.operator is BinaryOperator.AND:
            pending += [part.left, part.right]
        elif any(_is_global_constant(name, scope) for name in names_in(part)):
            folded = condition(part, scope, silent)
            if isinstance(folded, Constant) and folded.value == 0:
                return True
    return False


def _is_global_constant(name: str, scope: Scope) -> bool:
    outermost = scope
    while outermost.parent is not None:
        outermost = outermost.parent
    symbol = scope.lookup(name)
    return (
        isinstance(symbol, ValueSymbol)
        and symbol is outermost.symbols.get(name)
        and symbol.description == "constant"
        and is_integral(symbol.expression.type)
    )
