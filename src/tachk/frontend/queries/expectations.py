"""Expected answers: ``expect A, B fails;`` for imported properties, and outcomes that depend on constants."""

from __future__ import annotations

from collections.abc import Iterable

from tachk.base.diagnostics.diagnostic import Label
from tachk.base.diagnostics.suggestion import did_you_mean
from tachk.base.records import dataclass, replace
from tachk.base.span import Span
from tachk.frontend.context import Context
from tachk.frontend.expressions.typed_expressions import condition
from tachk.frontend.findings import DiagnosticCollector
from tachk.frontend.scope import Scope
from tachk.model.query import Expectation
from tachk.syntax import ast


def with_expectations(items: Iterable[ast.Item], findings: DiagnosticCollector) -> list[ast.Item]:
    """The items without the expectations, which the properties now have; they go before those at the properties."""
    items = list(items)
    names = [item.name.name for item in items if isinstance(item, ast.PropertyDeclaration)]
    expected: dict[str, tuple[ast.Expected, Span]] = {}
    for item in items:
        if not isinstance(item, ast.ExpectationDeclaration):
            continue
        for identifier in item.names:
            name = identifier.name
            if name not in names:
                help_ = did_you_mean(name, names) or "state the property, or import the file that does"
                findings.add("E0419", identifier.span, f"there is no property `{name}`", help_)
            elif name in expected:
                where = (Label(expected[name][1], "first here"),)
                message = f"two lines say what is expected of `{name}`"
                findings.add("E0419", identifier.span, message, "keep one", where)
            else:
                expected[name] = item.expectation, identifier.span
    return [
        replace(item, expectation=expected[item.name.name][0])
        if isinstance(item, ast.PropertyDeclaration) and item.name.name in expected
        else item
        for item in items
        if not isinstance(item, ast.ExpectationDeclaration)
    ]


@dataclass(frozen=True, slots=True)
class ExpectationClause:
    """The expected answer of one query.

    Attributes:
        expectation: for the values that the constants have; None if nothing is said.
        conditional: it depends on constants, so that it is about other values, too.
    """

    expectation: Expectation | None = None
    conditional: bool = False


def expectation_clause(expected: ast.Expected | None, scope: Scope, context: Context) -> ExpectationClause:
    """The outcome that is expected with the values of the constants; nothing after a report."""
    if expected is None:
        return ExpectationClause()
    if isinstance(expected, str):
        return ExpectationClause(Expectation(expected))
    otherwise = expectation_clause(expected.otherwise, scope, context)
    value = condition(expected.condition, scope, context)
    slots = None if value is None else context.constant_slots(value, "the condition of an expectation")
    if slots is None:
        return ExpectationClause()
    return ExpectationClause(Expectation(expected.outcome) if slots[0] else otherwise.expectation, True)
