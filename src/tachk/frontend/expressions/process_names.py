"""Processes in queries, signals and properties: ``P.idle``, ``T(1).x``."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import islice

from tachk.base.diagnostics.suggestion import did_you_mean
from tachk.frontend.context import Context
from tachk.frontend.findings import count
from tachk.frontend.scope import (
    BrokenSymbol,
    FamilySymbol,
    LocationSymbol,
    ProcessSymbol,
    Scope,
    Symbol,
    TemplateSymbol,
)
from tachk.syntax import ast
from tachk.syntax.walk import nodes_of_kind

ConstantArgument = Callable[[ast.Expression, Scope, Context], int | None]


def select_process(
    node: ast.Expression, scope: Scope, context: Context, argument: ConstantArgument
) -> ProcessSymbol | BrokenSymbol | None:
    """The process a prefix such as ``P`` or ``T(1)`` names; None where it is not the name of a process at all.

    A broken symbol stands for a process that was reported not to exist.
    """
    match node:
        case ast.NameExpression(span, name):
            symbol = scope.lookup(name)
            match symbol:
                case ProcessSymbol():
                    return symbol
                case FamilySymbol(instances):
                    example = next(iter(instances), ())
                    context.error(
                        "E0206",
                        span,
                        f"`{name}` has several instances",
                        f"say which, for example `{name}({', '.join(map(str, example))})`",
                    )
                    return BrokenSymbol(span)
                case TemplateSymbol():
                    _absent(name, node, scope, context)
                    return BrokenSymbol(span)
                case _:
                    return None
        case ast.CallExpression(span, ast.NameExpression(_, name), arguments):
            symbol = scope.lookup(name)
            if isinstance(symbol, TemplateSymbol):
                _absent(name, node, scope, context)
                return BrokenSymbol(span)
            if not isinstance(symbol, FamilySymbol):
                if isinstance(symbol, ProcessSymbol):
                    context.error("E0206", span, f"`{name}` is a single process without parameters of its own")
                    return BrokenSymbol(span)
                return None
            values = [argument(a, scope, context) for a in arguments]
            if None in values:
                return BrokenSymbol(span)
            key = tuple(v for v in values if v is not None)
            if len(key) != symbol.parameters:
                expected = count(symbol.parameters, "free parameter")
                context.error("E0308", span, f"`{name}` has {expected}, not {len(key)}", _instances(name, symbol))
                return BrokenSymbol(span)
            process = symbol.instances.get(key)
            if process is None:
                wanted = f"{name}({', '.join(map(str, key))})"
                context.error("E0206", span, f"there is no process `{wanted}`", _instances(name, symbol))
                return BrokenSymbol(span)
            return process
        case _:
            return None


def _instances(name: str, symbol: FamilySymbol) -> str:
    """The processes of a template, the first of them where there are many."""
    named = [f"`{name}({', '.join(map(str, values))})`" for values in islice(symbol.instances, 4)]
    return f"there are {', '.join(named)}{', ...' if len(symbol.instances) > len(named) else ''}"


def _absent(name: str, node: ast.Expression, scope: Scope, context: Context) -> None:
    """Reports a process that the model describes and does not run. People switch between system lines, and their
    queries are about several of them: such a query is refused and no mistake."""
    if context.in_query:
        running = ", ".join(f"`{process}`" for process in _made_from(name, scope))
        help_ = f"a property is checked where the system line names `{name}`"
        if running:
            help_ = f"made from `{name}` and running: {running}"
        context.error("E0733", node.span, f"no process `{name}` runs: it is not in the system line", help_)
    else:
        _outside_query(node, context)


def _made_from(template: str, scope: Scope) -> Iterator[str]:
    """The processes that run and that an instantiation of the template makes."""
    level: Scope | None = scope
    while level is not None:
        for name, symbol in level.symbols.items():
            if isinstance(symbol, ProcessSymbol | FamilySymbol) and level.parent is not None:
                made = level.parent.lookup(name)
                if isinstance(made, TemplateSymbol) and isinstance(made.template, ast.Instantiation):
                    if made.template.template.name == template:
                        yield name
        level = level.parent


def _outside_query(node: ast.Expression, context: Context) -> None:
    context.error(
        "E0206",
        node.span,
        "the inside of a process can only be seen by queries, signals, properties and recordings",
        "share a global variable instead",
    )


def select_member(process: ProcessSymbol | BrokenSymbol, name: ast.Identifier, context: Context) -> Symbol | None:
    """A name inside a process; None after a report."""
    if isinstance(process, BrokenSymbol):
        return None
    scope: Scope | None = process.members
    known: list[str] = []
    while scope is not None and scope.parent is not None:
        if name.name in scope.symbols:
            return scope.symbols[name.name]
        known.extend(scope.symbols)
        scope = scope.parent
    label = process.members.label
    locations = [n for n in known if isinstance(process.members.lookup(n), LocationSymbol)]
    context.error(
        "E0207",
        name.span,
        f"{label} has no location or variable `{name.name}`",
        did_you_mean(name.name, known) or (f"its locations are {', '.join(locations[:8])}" if locations else None),
    )
    return None


def mentions_family(node: object, scope: Scope) -> bool:
    """True if an expression names a process by arguments, as in ``T(i).x``."""
    return any(
        isinstance(call.function, ast.NameExpression) and isinstance(scope.lookup(call.function.name), FamilySymbol)
        for call in nodes_of_kind(node, ast.CallExpression)
    )
