"""Documentation comments (``///``): the nodes that can hold one, and those that stand where none reaches a report."""

from __future__ import annotations

from collections.abc import Iterator

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.syntax import ast

Documented = (
    ast.SignalDeclaration | ast.PropertyDeclaration | ast.Template | ast.LocationDeclaration | ast.EdgeDeclaration
)

_KINDS: dict[type, str] = {
    ast.SignalDeclaration: "signal",
    ast.PropertyDeclaration: "property",
    ast.LocationDeclaration: "location",
    ast.EdgeDeclaration: "edge",
}


def documented(item: ast.Item) -> Iterator[Documented]:
    """The nodes of an item that can hold documentation; what is around a node comes before it."""
    if isinstance(item, ast.SignalDeclaration | ast.PropertyDeclaration):
        yield item
    elif isinstance(item, ast.Template):
        yield item
        yield from (d for d in item.declarations if isinstance(d, ast.SignalDeclaration))
        yield from item.edges
        for location in item.locations:
            yield location
            yield from location.edges
        for branchpoint in item.branchpoints:
            yield from branchpoint.edges


def lost_documentation(document: ast.Document) -> tuple[Diagnostic, ...]:
    """A warning for each documentation comment inside a node that can hold one, or behind it on its line.

    Documentation of functions and variables is for readers of the text only, so it is where it belongs.
    """
    lost = [c for c in document.comments if c.text.startswith("///") and not c.text.startswith("////")]
    if not lost:
        return ()
    nodes = [node for item in document.items for node in documented(item)]
    return tuple(_warning(comment, node) for comment in lost if (node := _holder(comment, nodes)) is not None)


def _holder(comment: ast.Comment, nodes: list[Documented]) -> Documented | None:
    """The innermost node that the comment seems to be about."""
    text, start = comment.span.source.text, comment.span.start
    line = text.rfind("\n", 0, start) + 1
    about = [
        node
        for node in nodes
        if node.span.start < start
        and (
            line <= node.span.end - 1 < start
            or (line <= node.span.start and not comment.own_line)
            or (node.span.end > start and not isinstance(node, ast.Template))
        )
    ]
    return max(about, key=lambda node: (node.span.start, -node.span.end), default=None)


def _warning(comment: ast.Comment, node: Documented) -> Diagnostic:
    kind = _KINDS.get(type(node), "template")
    return Diagnostic(
        "W0103",
        f"this documentation is behind the start of the {kind}, so no report shows it",
        comment.span,
        f"write it on a line of its own directly in front of the {kind}, or begin a comment with //",
    )
