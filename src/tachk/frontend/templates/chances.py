"""Rates of exponential distributions and weights of branches: only simulation looks at them.

Whatever is wrong with one is kept in its place: a search does not need it, and a simulation reports it.
"""

from __future__ import annotations

from tachk.base.diagnostics.diagnostic import Diagnostic, Severity
from tachk.base.records import replace
from tachk.frontend.context import Context
from tachk.frontend.expressions.typed_expressions import expression
from tachk.frontend.expressions.typing import describe, is_integral
from tachk.frontend.findings import DiagnosticCollector
from tachk.frontend.scope import Scope
from tachk.model.floating import DOUBLE, FloatingOperation
from tachk.model.floating_calls import operated
from tachk.model.network import Chance
from tachk.syntax import ast


def chance(node: ast.Expression | None, what: str, scope: Scope, context: Context) -> Chance | None:
    """A rate or weight as an integer or floating point expression; ``what`` reads like "a rate"."""
    if node is None:
        return None
    findings = DiagnosticCollector()
    own = replace(context, findings=findings)
    value = expression(node, scope, own)
    if value is not None and value.type != DOUBLE and not is_integral(value.type):
        own.error("E0301", node.span, f"{what} is a number, not {describe(value.type)}")
    if value is not None:
        own.require_pure(value, what)
    if value is None or findings.has_errors:
        return next(found for found in findings.sorted() if found.severity is Severity.ERROR)
    return value


def rate(location: ast.LocationDeclaration, scope: Scope, context: Context) -> Chance | None:
    """The rate of a location; of ``r : q`` the quotient."""
    value = chance(location.exponential_rate, "a rate", scope, context)
    divisor = chance(location.rate_divisor, "a rate", scope, context)
    if value is None or divisor is None or isinstance(value, Diagnostic):
        return value
    if isinstance(divisor, Diagnostic):
        return divisor
    return operated(FloatingOperation.DIVIDE, (value, divisor), value.span)
