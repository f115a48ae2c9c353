"""The form that the formatter writes: location blocks, and none of UPPAAL 3.x."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace

from tachk.syntax import ast


def canonical(document: ast.Document) -> ast.Document:
    """The same model with every template in the location-centric form and every constant with a type."""
    return replace(document, items=tuple(_item(item) for item in document.items), legacy=False)


def _item(item: ast.Item) -> ast.Item:
    match item:
        case ast.Template():
            return _template(item)
        case ast.VariableDeclaration():
            return _typed(item)
        case _:
            return item


def _typed(declaration: ast.VariableDeclaration) -> ast.VariableDeclaration:
    if declaration.type is not None:
        return declaration
    span = declaration.span
    return replace(declaration, type=ast.TypeExpression(span, ("const",), ast.BuiltinType(span, "int")))


def _template(template: ast.Template) -> ast.Template:
    declarations = tuple(
        _typed(declaration) if isinstance(declaration, ast.VariableDeclaration) else declaration
        for declaration in template.declarations
    )
    if not template.classic or not (template.locations or template.branchpoints):
        return replace(template, declarations=declarations)
    leaving: dict[str, list[ast.EdgeDeclaration]] = defaultdict(list)
    for edge in template.edges:
        assert edge.source is not None, "an edge of the classic form has a source"
        leaving[edge.source.name].append(replace(edge, source=None))
    # An edge whose source does not exist is kept, so that the formatter loses nothing; elaboration reports it.
    known = {node.name.name for node in template.locations} | {node.name.name for node in template.branchpoints}
    lost = [edge for name, edges in leaving.items() if name not in known for edge in edges]
    if lost:
        return replace(template, declarations=declarations)
    taken: set[str] = set()

    def edges_of(name: str) -> tuple[ast.EdgeDeclaration, ...]:
        if name in taken:
            return ()
        taken.add(name)
        return tuple(leaving[name])

    return replace(
        template,
        declarations=declarations,
        locations=tuple(replace(node, edges=edges_of(node.name.name)) for node in template.locations),
        branchpoints=tuple(replace(node, edges=edges_of(node.name.name)) for node in template.branchpoints),
        edges=(),
        classic=False,
    )
