"""Name resolution in expressions: the variable, constant, process or channel that a name denotes."""

from __future__ import annotations

from itertools import islice

from tachk.base.diagnostics.suggestion import did_you_mean
from tachk.frontend.context import Context
from tachk.frontend.dropped import refuse_use
from tachk.frontend.expressions.builtin_names import BUILTIN_CONSTANTS, BUILTIN_DOUBLES
from tachk.frontend.expressions.typing import WIDE
from tachk.frontend.scope import (
    BrokenSymbol,
    DroppedSymbol,
    EmptyTypeSymbol,
    FamilySymbol,
    FunctionSymbol,
    LocationSymbol,
    ProcessSymbol,
    Scope,
    Symbol,
    ValueSymbol,
)
from tachk.model.expressions import Constant, Expression
from tachk.model.floating_calls import floating_constant
from tachk.syntax import ast

_PROCESSES_NAMED = 3
"""A help line names at most so many processes."""


def named(node: ast.NameExpression, scope: Scope, context: Context) -> Expression | None:
    """The value a name stands for; None after a report."""
    symbol = scope.lookup(node.name)
    match symbol:
        case ValueSymbol():
            return symbol.use(node.span)
        case BrokenSymbol():
            return None
        case EmptyTypeSymbol(diagnostics):
            context.findings.extend(diagnostics)
        case DroppedSymbol():
            refuse_use(node, symbol, context)
            return None
        case None:
            if node.name in BUILTIN_CONSTANTS:
                return Constant(BUILTIN_CONSTANTS[node.name], WIDE, node.span)
            if node.name in BUILTIN_DOUBLES:
                return floating_constant(BUILTIN_DOUBLES[node.name], node.span)
            if node.name == "deadlock":
                context.error("E0501", node.span, "`deadlock` can only be used in queries")
                return None
            help_ = (
                _inside_a_process(node.name, scope)
                or scope.suggestion(node.name)
                or (did_you_mean(node.name, ["deadlock"]) if context.in_query else None)
                or "declare it above, globally or in the template"
            )
            context.error("E0201", node.span, f"unknown name `{node.name}`", help_)
        case _:
            context.error(
                "E0203", node.span, f"`{node.name}` is a {symbol.description}, not a value", misuse_help(symbol)
            )
    return None


def _inside_a_process(name: str, scope: Scope) -> str | None:
    """The full names that a query may have meant by the bare name of a location, clock or variable of a process."""
    found = []
    for visible in dict.fromkeys(scope.names()):
        match scope.lookup(visible):
            case ProcessSymbol(members=members) if _is_inside(name, members):
                found.append(f"`{visible}.{name}`")
            case FamilySymbol(instances=instances):
                holders = (values for values, process in instances.items() if _is_inside(name, process.members))
                found += [f"`{visible}({', '.join(map(str, values))}).{name}`" for values in islice(holders, 1)]
            case _:
                pass
    if not found:
        return None
    more = " or the like" if len(found) > _PROCESSES_NAMED else ""
    return f"say of which process: {' or '.join(found[:_PROCESSES_NAMED])}{more}"


def _is_inside(name: str, members: Scope) -> bool:
    """True if a process has a location or variable of its own with that name; a parameter is a name like any."""
    symbol = members.symbols.get(name)
    return symbol is not None and symbol.description in ("location", "clock", "variable")


def misuse_help(symbol: Symbol) -> str | None:
    """Advice about a name that is not a value."""
    match symbol:
        case FunctionSymbol():
            return "write parentheses to call it"
        case ProcessSymbol() | FamilySymbol():
            return "name a location or variable of the process, as in `P.idle`"
        case LocationSymbol():
            return (
                "only queries, signals and properties can ask where a process is; a variable can carry it into a guard"
            )
        case _:
            return None
