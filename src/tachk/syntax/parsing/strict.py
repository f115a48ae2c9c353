"""Constructs of a document that are not plain XTA."""

from __future__ import annotations

from collections.abc import Iterator

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.span import Span
from tachk.syntax import ast


def additions(document: ast.Document) -> tuple[Diagnostic, ...]:
    """One error for each use of a construct that tachk adds to XTA."""
    return tuple(
        Diagnostic(
            "E0112", f"{what} is not part of XTA", span, "only tachk knows it; without --strict-xta it is accepted"
        )
        for item in document.items
        for what, span in _in_item(item)
    )


def _in_item(item: ast.Item) -> Iterator[tuple[str, Span]]:
    match item:
        case ast.ImportDeclaration():
            yield "the import of a file", item.span
        case ast.TimeUnitDeclaration():
            yield "'time_unit'", item.span
        case ast.SignalDeclaration():
            yield "a signal", item.name.span
        case ast.PropertyDeclaration():
            yield "a property", item.name.span
        case ast.ExpectationDeclaration():
            yield "an expectation", item.span
        case ast.HideDeclaration():
            yield "'hide'", item.span
        case ast.RecordingDeclaration():
            yield "'recording'", item.span
        case ast.Template():
            yield from _in_template(item)
        case _:
            pass


def _in_template(template: ast.Template) -> Iterator[tuple[str, Span]]:
    for declaration in template.declarations:
        if isinstance(declaration, ast.SignalDeclaration):
            yield "a signal", declaration.name.span
    owners: list[ast.LocationDeclaration | ast.Branchpoint] = [*template.locations, *template.branchpoints]
    if not template.classic:
        yield "a location block", owners[0].name.span
    edges = [*template.edges, *(edge for owner in owners for edge in owner.edges)]
    for edge in edges:
        synchronisation = edge.synchronisation
        if synchronisation is not None and synchronisation.value is not None:
            yield "a synchronisation with a value", synchronisation.span
