"""A limit on nesting, so that recursive passes over the tree need no stack of their own."""

from __future__ import annotations

from typing import Any

from tachk.diagnostics.diagnostic import Diagnostic
from tachk.diagnostics.span import Span
from tachk.syntax import ast
from tachk.syntax.parsing.tokens import Token

DEEPEST = 250
"""Levels of the syntax tree below a declaration, clause or property."""


def nesting_errors(tokens: list[Token], value: Any) -> tuple[Diagnostic, ...]:
    """One diagnostic for the first part of a tree that is nested too deeply, if there is one."""
    if not _suspicious(tokens):
        return ()
    pending = [(value, 0)]
    while pending:
        node, level = pending.pop()
        if isinstance(node, ast.Node):
            level += 1
            if level > DEEPEST:
                return (too_deep(node.span),)
            pending += [(getattr(node, name), level) for name in node.__dataclass_fields__ if name != "span"]
        elif isinstance(node, tuple | list):
            pending += [(item, level) for item in node]
    return ()


def bracket_errors(tokens: list[Token]) -> tuple[Diagnostic, ...]:
    """One diagnostic if brackets alone are nested too deeply; such a text is not worth parsing."""
    depth = 0
    for token in tokens:
        if token.text in ("{", "(", "["):
            depth += 1
            if depth > DEEPEST:
                return (too_deep(token.span),)
        elif token.text in ("}", ")", "]"):
            depth -= 1
    return ()


def too_deep(span: Span) -> Diagnostic:
    """The refusal of what stands at a place."""
    return Diagnostic(
        "E0111",
        f"this is nested more than {DEEPEST} levels deep",
        Span(span.source, span.start, min(span.end, span.start + 40)),
        "name parts of it with functions or constants",
    )


def _suspicious(tokens: list[Token]) -> bool:
    """Whether the tree can be deep at all: it cannot where brackets are shallow and statements short."""
    length = depth = branches = 0
    for token in tokens:
        text = token.text
        if text in ("{", "(", "["):
            depth += 1
            if depth > 40:
                return True
        elif text in ("}", ")", "]"):
            depth -= 1
        if text in (";", "{", "}"):
            length = 0
            branches = branches if depth else 0
        else:
            length += 1
            if length > 150:
                return True
        if token.type in ("ELSE", "IF", "FOR", "WHILE", "DO"):
            branches += 1
            if branches > 100:
                return True
    return False
