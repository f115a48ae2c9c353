"""Reading a model: text to network, queries and warnings, or all that is wrong with it."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from tachk.diagnostics.diagnostic import Diagnostic, InputError, Severity, UsageError
from tachk.diagnostics.span import Source
from tachk.frontend.context import Budget, Context
from tachk.frontend.elaborate import Elaborated, elaborate
from tachk.frontend.findings import Findings, did_you_mean
from tachk.frontend.imports import Importer
from tachk.frontend.queries import UncheckedQuery, elaborate_entries
from tachk.frontend.scope import Scope
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.syntax import ast
from tachk.syntax.parser import parse_expression
from tachk.syntax.query_files import parse_queries
from tachk.syntax.source_files import read_source

__all__ = ["LoadedModel", "UncheckedQuery", "elaborate_queries", "load_model"]

INSTANCES = 2**16
"""Quantifiers are written out at most that many times in one model."""


@dataclass(frozen=True, slots=True)
class LoadedModel:
    """Attributes:
    queries: the properties the model states, in order.
    unchecked: properties that belong to another kind of analysis.
    document: the syntax tree of the file itself, imports not followed.
    items: of the document, each import replaced by what the file declares.
    """

    network: Network
    queries: tuple[Query, ...]
    unchecked: tuple[UncheckedQuery, ...]
    warnings: tuple[Diagnostic, ...]
    document: ast.Document = field(repr=False)
    items: tuple[ast.Item, ...] = field(repr=False)
    _scope: Scope = field(repr=False)
    _constants: Context = field(repr=False)


def load_model(
    model: str | os.PathLike[str] | Source,
    constants: Mapping[str, int | bool | str] | None = None,
    strict_xta: bool = False,
) -> LoadedModel:
    """Reads and elaborates a model.

    Args:
        model: the path of a file, or a text. Imports are relative to its folder.
        constants: other values for global constants; a string is an expression of the language.
        strict_xta: refuse what tachk adds to XTA.

    Raises:
        InputError: with every diagnostic that was found, warnings included.
        UsageError: the file cannot be read, or there is no such constant.
    """
    source = model if isinstance(model, Source) else read_source(model)
    findings = Findings()
    document, items = Importer(findings, strict_xta).read(source)
    if document is None or findings.has_errors:
        raise InputError(findings.sorted())
    overrides = _overrides(constants or {}, items, findings)
    context = Context(findings, budget=Budget(INSTANCES))
    result: Elaborated = elaborate(items, document.span, overrides, context)
    if findings.has_errors:
        raise InputError(findings.sorted())
    return LoadedModel(
        result.network,
        result.queries,
        result.unchecked,
        findings.sorted(),
        document,
        tuple(items),
        result.scope,
        context,
    )


def elaborate_queries(loaded: LoadedModel, text: str | Source) -> tuple[tuple[Query, ...], tuple[UncheckedQuery, ...]]:
    """The queries of a .q file or of the command line, named ``q1``, ``q2``, ... in order.

    Raises:
        InputError: with every diagnostic that was found.
    """
    source = text if isinstance(text, Source) else Source("<query>", text)
    findings = Findings()
    entries, diagnostics = parse_queries(source)
    findings.extend(diagnostics)
    known = loaded._constants
    context = Context(findings, known.constants, known.effects, budget=Budget(INSTANCES))
    queries, unchecked = elaborate_entries(entries, loaded._scope, context)
    if findings.has_errors:
        raise InputError(findings.sorted())
    return queries, unchecked


def _overrides(
    constants: Mapping[str, int | bool | str], items: Iterable[ast.Item], findings: Findings
) -> dict[str, ast.Expression]:
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
