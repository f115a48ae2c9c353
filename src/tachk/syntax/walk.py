"""Finding nodes in syntax trees."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from tachk.base.records import fields
from tachk.syntax import ast


def nodes_of_kind(tree: object, *kinds: type[Any]) -> Iterator[Any]:
    """The nodes of some kinds in a tree or a sequence of trees, in the order of the text."""
    pending: list[object] = [tree]
    while pending:
        node = pending.pop()
        if isinstance(node, tuple | list):
            pending += reversed(node)
        elif isinstance(node, ast.Node):
            if isinstance(node, kinds):
                yield node
            pending += [getattr(node, name) for name in _parts(node)]


def outermost(tree: object, matches: Callable[[ast.Node], bool]) -> Iterator[ast.Node]:
    """The nodes in a tree, or in a sequence of trees, that match and do not lie inside another one that does."""
    pending: list[object] = [tree]
    while pending:
        node = pending.pop()
        if isinstance(node, tuple | list):
            pending += reversed(node)
        elif isinstance(node, ast.Node):
            if matches(node):
                yield node
            else:
                pending += [getattr(node, name) for name in _parts(node)]


_known_parts: dict[type, tuple[str, ...]] = {}


def _parts(node: ast.Node) -> tuple[str, ...]:
    """The fields that may hold nodes, the last first."""
    kind = type(node)
    if kind not in _known_parts:
        _known_parts[kind] = tuple(field.name for field in reversed(fields(node)) if field.name != "span")
    return _known_parts[kind]


def edges_with_sources(template: ast.Template) -> Iterator[tuple[str, ast.EdgeDeclaration]]:
    """All edges of a template, each with the name of the location or branchpoint that it leaves, whichever way the
    template is written."""
    owners: tuple[ast.LocationDeclaration | ast.Branchpoint, ...] = (*template.locations, *template.branchpoints)
    for owner in owners:
        for edge in owner.edges:
            yield owner.name.name, edge
    for edge in template.edges:
        if edge.source is not None:
            yield edge.source.name, edge
