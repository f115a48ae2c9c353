"""``expect A, B fails;``: what one system expects of the properties that it imports."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from tachk.diagnostics.diagnostic import Label
from tachk.diagnostics.span import Span
from tachk.diagnostics.suggestion import did_you_mean
from tachk.frontend.findings import Findings
from tachk.syntax import ast


def with_expectations(items: Iterable[ast.Item], findings: Findings) -> list[ast.Item]:
    """The items without the expectations, which the properties now have; they go before those at the properties."""
    items = list(items)
    names = [item.name.name for item in items if isinstance(item, ast.PropertyDeclaration)]
    expected: dict[str, tuple[str, Span]] = {}
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
