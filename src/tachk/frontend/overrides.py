"""Other values for the global constants of a model, from the command line or a program."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from tachk.base.diagnostics.diagnostic import Severity, UsageError
from tachk.base.diagnostics.suggestion import did_you_mean
from tachk.base.span import Source
from tachk.frontend.findings import DiagnosticCollector
from tachk.syntax import ast
from tachk.syntax.parsing.parser import parse_expression

_BOOLEAN_WORDS = {"yes": "true", "on": "true", "no": "false", "off": "false", "true": "true", "false": "false"}
"""Spellings of Boolean constants, in any case."""


def constant_overrides(
    constants: Mapping[str, int | bool | str], items: Iterable[ast.Item], findings: DiagnosticCollector
) -> dict[str, ast.Expression]:
    """The new values of global constants. Raises UsageError for a name that is none."""
    known, variables = _declared_names(items)
    overrides: dict[str, ast.Expression] = {}
    for name, value in constants.items():
        if name in variables:
            raise UsageError(f"`{name}` is a variable, only constants can be set", "declare it `const` in the model")
        if name not in known:
            help_ = did_you_mean(name, known)
            listed = f"its constants are {', '.join(known)}" if known else "it has none"
            raise UsageError(f"the model has no constant `{name}`", help_ or listed)
        text = str(value).lower() if isinstance(value, bool) else str(value)
        expression, diagnostics = parse_expression(Source(f"-D {name}", text))
        findings.extend(diagnostics)
        if isinstance(expression, ast.NameExpression) and expression.name not in known:
            meant = _BOOLEAN_WORDS.get(expression.name.lower())
            if meant is not None:
                findings.add(
                    "E0201", expression.span, f"unknown name `{expression.name}`", f"a Boolean value is `{meant}`"
                )
                continue
        if expression is not None and not any(d.severity is Severity.ERROR for d in diagnostics):
            overrides[name] = expression
    return overrides


def _declared_names(items: Iterable[ast.Item]) -> tuple[list[str], set[str]]:
    """The names of the global constants, and of the global variables."""
    constants: list[str] = []
    variables: set[str] = set()
    for item in items:
        if isinstance(item, ast.VariableDeclaration):
            names = [declarator.name.name for declarator in item.declarators]
            if item.type is None or "const" in item.type.prefixes:
                constants.extend(names)
            else:
                variables.update(names)
    return constants, variables
