"""Pictures of the templates of a model file, with the layout that it or its side file has or an automatic one."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from typing import Any

from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.base.records import replace
from tachk.formats.layout.completion import complete
from tachk.formats.layout_json import read_layout_beside
from tachk.formats.loading.imports import Importer
from tachk.formats.loading.model_files import read_model
from tachk.frontend.findings import DiagnosticCollector
from tachk.frontend.overrides import constant_overrides
from tachk.report.drawing.svg import Picture, draw_template, together
from tachk.syntax import ast
from tachk.syntax.picture_layout import EdgeKey, Layout, keyed_edges
from tachk.syntax.rewrite import rewrite
from tachk.syntax.source_files import read_source

Taken = Mapping[str, Mapping[EdgeKey, int]]
"""The number of times that the edges of templates were taken, by the names of templates."""


def draw_file(
    path: str | os.PathLike[str], constants: Mapping[str, str] | None = None, taken: Taken | None = None
) -> tuple[Picture, ...]:
    """A picture of each template of a model file and of what it imports, in order.

    The file need not be a complete model: only its text is read.

    Args:
        constants: other values for global constants, shown in place of their names.
        taken: how often edges were taken; only the templates that it knows are drawn.

    Raises:
        InputError: the text is wrong; carries every finding.
        UsageError: the file cannot be read, has no template, or no such constant.
    """
    items, layout = file_items(path)
    findings = DiagnosticCollector()
    values = constant_overrides(constants or {}, items, findings)
    if findings.has_errors:
        raise InputError(findings.sorted())
    drawn = [_with_values(item, values) if isinstance(item, ast.Template) else item for item in items]
    return draw_items(drawn, layout, str(path), taken)


def file_items(path: str | os.PathLike[str]) -> tuple[tuple[ast.Item, ...], Layout | None]:
    """The declarations of a model file and of what it imports, in order, and the layout that it or its side file has.

    Raises:
        InputError: the text is wrong; carries every finding.
        UsageError: the file cannot be read.
    """
    source = read_source(path)
    read = read_model(source)
    items = read.document.items
    if any(isinstance(item, ast.ImportDeclaration) for item in items):
        findings = DiagnosticCollector()
        _, imported = Importer(findings).read(source)
        if findings.has_errors:
            raise InputError(findings.sorted())
        items = tuple(imported)
    return items, read.layout or read_layout_beside(path)


def draw_items(
    items: Iterable[ast.Item], layout: Layout | None, name: str, taken: Taken | None = None
) -> tuple[Picture, ...]:
    """A picture of each template among declarations.

    Args:
        name: what a message calls them.
        taken: how often edges were taken; only the templates that it knows are drawn.

    Raises:
        UsageError: there is no template.
    """
    templates = [item for item in items if isinstance(item, ast.Template)]
    if not templates:
        raise UsageError(f"{name} has no template to draw")
    known = {} if layout is None else layout.templates
    if taken is None:
        return tuple(draw_template(one, complete(one, known.get(one.name.name))) for one in templates)
    covered = {one.name.name: _counted(one, taken[one.name.name]) for one in templates if one.name.name in taken}
    if not covered:
        raise UsageError(f"no template of {name} is in the coverage", "draw the model that `tachk conform` was given")
    return tuple(draw_template(one, complete(one, known.get(place)), taken[place]) for place, one in covered.items())


def _counted(template: ast.Template, taken: Mapping[EdgeKey, int]) -> ast.Template:
    """The template with comments on its edges that say how often they were taken, and nothing else: what is long would
    stand far from its edge."""
    often = {id(edge): taken.get(key, 0) for key, edge in keyed_edges(template)}

    def counted(edge: ast.EdgeDeclaration) -> ast.EdgeDeclaration:
        return replace(edge, doc=f"{often[id(edge)]}×" if often[id(edge)] else "never")

    def changed(edges: tuple[ast.EdgeDeclaration, ...]) -> tuple[ast.EdgeDeclaration, ...]:
        return tuple(counted(edge) for edge in edges)

    locations = tuple(replace(one, edges=changed(one.edges)) for one in template.locations)
    branchpoints = tuple(replace(one, edges=changed(one.edges)) for one in template.branchpoints)
    return replace(template, locations=locations, branchpoints=branchpoints, edges=changed(template.edges))


def _with_values(template: ast.Template, values: Mapping[str, ast.Expression]) -> ast.Template:
    """The template with the values of constants in place of their names; a name that it also declares is kept."""
    own: set[str] = set()

    def note(node: Any) -> Any:
        match node:
            case ast.Parameter(name=name) | ast.Declarator(name=name) | ast.SelectBinding(name=name):
                own.add(name.name)
            case ast.QuantifierExpression(variable=name):
                own.add(name.name)
            case _:
                pass
        return node

    rewrite(template, note)

    def change(node: Any) -> Any:
        if isinstance(node, ast.NameExpression) and node.name not in own:
            return values.get(node.name, node)
        return node

    return rewrite(template, change) if values else template


def draw(path: str | os.PathLike[str], template: str | None = None) -> Picture:
    """The picture of one template of a model file, or of all of them together.

    Raises:
        InputError: the text is wrong; carries every finding.
        UsageError: the file cannot be read, or has no such template.
    """
    return _one(draw_file(path), os.path.basename(path), template)


def draw_document(items: Iterable[ast.Item], layout: Layout | None, name: str, template: str | None = None) -> Picture:
    """The same of a model that has been read, or was never written. Raises UsageError as `draw`."""
    return _one(draw_items(items, layout, name), os.path.basename(name), template)


def _one(pictures: tuple[Picture, ...], name: str, template: str | None) -> Picture:
    if template is None:
        return pictures[0] if len(pictures) == 1 else together(name, pictures)
    return named(pictures, template)


def named(pictures: tuple[Picture, ...], template: str) -> Picture:
    """The picture of a template.

    Raises:
        UsageError: there is none.
    """
    for picture in pictures:
        if picture.name == template:
            return picture
    names = ", ".join(picture.name for picture in pictures)
    raise UsageError(f"there is no template `{template}`", f"the templates are {names}")
