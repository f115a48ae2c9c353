"""Finding nodes in syntax trees."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields
from functools import cache
from typing import Any

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
            pending += [getattr(node, name) for name in _parts(type(node))]


@cache
def _parts(kind: type[ast.Node]) -> tuple[str, ...]:
    """The fields of a kind of node that may hold nodes, the last first."""
    return tuple(field.name for field in reversed(fields(kind)) if field.name != "span")
