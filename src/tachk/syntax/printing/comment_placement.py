"""The places at which the formatter puts comments back.

A comment belongs to the node that is printed on a line of its own (an item, a location, an edge, a clause, a statement)
next to it: the one that ends before it on its line, else the one that begins after it, else the one around it.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from tachk.syntax import ast
from tachk.syntax.edge_clauses import edge_clauses

Comments = dict[int, list[ast.Comment]]


@dataclass(frozen=True, slots=True)
class Placement:
    """Comments by the identity of the node they belong to.

    Attributes:
        before: on lines of their own before the node.
        behind: at the end of the node's last line.
        opening: at the end of its first line, behind the opening brace.
        closing: on lines of their own before its closing brace, or at the end of the text.
    """

    before: Comments = field(default_factory=lambda: defaultdict(list))
    behind: Comments = field(default_factory=lambda: defaultdict(list))
    opening: Comments = field(default_factory=lambda: defaultdict(list))
    closing: Comments = field(default_factory=lambda: defaultdict(list))

    def touches(self, node: Any) -> bool:
        """True if a comment belongs to the node itself."""
        key = id(node)
        return any(key in table for table in (self.before, self.behind, self.opening, self.closing))

    def inside(self, node: Any) -> bool:
        """True if a comment belongs to something within the node, or to its braces."""
        key = id(node)
        return (
            key in self.opening
            or key in self.closing
            or any(self.touches(child) or self.inside(child) for child in line_nodes(node))
        )


def place_comments(document: ast.Document) -> Placement:
    """Find the node of every comment of a document."""
    placement = Placement()
    anchors = sorted(_anchors(document), key=lambda node: (node.span.start, -node.span.end))
    by_end = sorted(anchors, key=lambda node: (node.span.end, -node.span.start))
    starts = [node.span.start for node in anchors]
    ends = [node.span.end for node in by_end]
    around: list[Any] = []
    opened = 0
    for comment in document.comments:
        start, end = comment.span.start, comment.span.end
        while opened < len(anchors) and starts[opened] < start:
            while around and around[-1].span.end <= starts[opened]:
                around.pop()
            around.append(anchors[opened])
            opened += 1
        while around and around[-1].span.end <= start:
            around.pop()
        container = around[-1] if around else document
        place = bisect_right(ends, start) - 1
        if not comment.own_line and place >= 0 and _same_line(comment, ends[place]):
            if container is document or ends[place] > container.span.start:
                placement.behind[id(by_end[place])].append(comment)
                continue
        if not comment.own_line and _has_braces(container) and _same_line(comment, container.span.start):
            placement.opening[id(container)].append(comment)
            continue
        if container is not document and not _has_braces(container) and not list(line_nodes(container)):
            placement.before[id(container)].append(comment)
            continue
        following = bisect_left(starts, end)
        if following < len(anchors) and (container is document or starts[following] < container.span.end):
            placement.before[id(anchors[following])].append(comment)
        elif _has_braces(container):
            placement.closing[id(container)].append(comment)
        else:
            placement.behind[id(container)].append(comment)
    return placement


def line_nodes(node: Any) -> Iterator[Any]:
    """The parts of a node that the formatter may print on lines of their own."""
    match node:
        case ast.Document(items=items):
            yield from items
        case ast.RecordingDeclaration(clauses=clauses):
            yield from clauses
        case ast.PropertyDeclaration(formula=ast.ScenarioFormula(clauses=steps)):
            yield from steps
        case ast.Template():
            yield from (*node.declarations, *node.locations, *node.branchpoints, *node.edges)
        case ast.LocationDeclaration():
            yield from (part for part in (node.invariant, node.exponential_rate) if part is not None)
            yield from node.edges
        case ast.Branchpoint():
            yield from node.edges
        case ast.EdgeDeclaration():
            yield from (clause.first for clause in edge_clauses(node))
        case ast.FunctionDeclaration():
            yield node.body
        case ast.BlockStatement():
            yield from (*node.declarations, *node.statements)
        case ast.IfStatement():
            yield node.then
            if node.otherwise is not None:
                yield node.otherwise
        case ast.WhileStatement() | ast.DoStatement() | ast.ForStatement() | ast.IterationStatement():
            yield node.body
        case ast.VariableDeclaration(type=ast.TypeExpression(base=ast.StructType(fields=fields))):
            yield from fields
        case ast.TypedefDeclaration(type=ast.TypeExpression(base=ast.StructType(fields=fields))):
            yield from fields
        case _:
            return


def _anchors(document: ast.Document) -> Iterator[Any]:
    source = document.span.source
    pending = list(line_nodes(document))
    while pending:
        node = pending.pop()
        if node.span.source is source:
            yield node
        pending += line_nodes(node)


def _has_braces(node: Any) -> bool:
    if isinstance(node, ast.PropertyDeclaration):
        return isinstance(node.formula, ast.ScenarioFormula)
    return isinstance(
        node,
        ast.Document
        | ast.Template
        | ast.RecordingDeclaration
        | ast.LocationDeclaration
        | ast.Branchpoint
        | ast.EdgeDeclaration
        | ast.BlockStatement,
    )


def _same_line(comment: ast.Comment, offset: int) -> bool:
    start = comment.span.start
    low, high = (offset, start) if offset <= start else (start, offset)
    return comment.span.source.text.find("\n", low, high) < 0
