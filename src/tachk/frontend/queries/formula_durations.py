"""Bounds of temporal operators, which may name constants of the model."""

from __future__ import annotations

from dataclasses import replace

from tachk.diagnostics.diagnostic import InputError
from tachk.frontend.context import Context
from tachk.frontend.expressions.typed_expressions import constant_integer
from tachk.frontend.findings import Findings
from tachk.frontend.scope import Scope
from tachk.logic.durations import resolve
from tachk.syntax import ast
from tachk.syntax.formula import Formula


def resolve_durations(formula: Formula, scope: Scope, context: Context) -> Formula | None:
    """The formula with every bound a number in the time unit of the model; None after a report."""

    unknown: list[ast.Expression] = []  # a bound without a value need not be a further finding

    def evaluate(expression: ast.Expression) -> int:
        own = Findings()
        value = constant_integer(expression, "the bound of an interval", scope, replace(context, findings=own))
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
