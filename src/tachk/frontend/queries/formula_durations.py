"""Bounds of temporal operators, which may name constants of the model."""

from __future__ import annotations

from collections.abc import Iterable

from tachk.base.diagnostics.diagnostic import InputError
from tachk.base.records import replace
from tachk.base.span import Span
from tachk.frontend.context import Context
from tachk.frontend.expressions.typed_expressions import constant_integer
from tachk.frontend.findings import DiagnosticCollector
from tachk.frontend.scope import Scope
from tachk.logic.bound_directions import Easier, bound_directions
from tachk.logic.durations import resolve
from tachk.syntax import ast
from tachk.syntax.formula import Formula


def resolve_durations(formula: Formula, scope: Scope, context: Context) -> Formula | None:
    """The formula with every bound a number in the time unit of the model; None after a report."""

    unknown: list[ast.Expression] = []  # a bound without a value need not be a further finding
    directions: dict[Span, set[Easier]] = {}
    for part, easier in bound_directions(formula):
        directions.setdefault(part.span, set()).add(easier)

    def evaluate(expression: ast.Expression) -> int:
        own = DiagnosticCollector()
        easier = directions.get(expression.span, {None})
        value = bound_value(expression, easier, "the bound of an interval", scope, replace(context, findings=own))
        if value is None:
            unknown.append(expression)
            raise InputError(own.sorted())
        return value

    try:
        resolved = resolve(formula, evaluate, context.time_unit)
    except InputError as error:
        context.findings.extend(error.diagnostics)
        return None
    return None if unknown else resolved


def bound_value(
    expression: ast.Expression, easier: Iterable[Easier], what: str, scope: Scope, context: Context
) -> int | None:
    """The value of a name in the bound of a property; None after a report. Open constants are noted as parts of it.

    Args:
        easier: what more of the value does to the property, at each of its places.
        what: the beginning of a message, as of `Context.constant_slots`.
    """
    opened = replace(context.open_constants, needed={})
    value = constant_integer(expression, what, scope, replace(context, open_constants=opened))
    for name, span in opened.needed.items():
        is_it = isinstance(expression, ast.NameExpression) and expression.name == name
        for direction in easier:
            context.open_constants.in_bound(name, direction if is_it else None, span)
    return value
