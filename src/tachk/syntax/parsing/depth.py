"""Limits on the depth of a tree, so that recursive passes over it need no stack of their own.

Nested expressions have few levels. A chain such as ``a - b - c`` or ``else if`` is written flat and may have thousands
of parts, although each is a level of the tree. For those the recursion limit of the interpreter is raised: passes that
are written in Python need memory for it only, and the part of the thread's stack that `STACK_OF_A_LEVEL` gives.
"""

from __future__ import annotations

import sys
from typing import Any

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.operators import BinaryOperator
from tachk.base.span import Span
from tachk.syntax import ast
from tachk.syntax.parsing.tokens import Token

DEEPEST = 250
"""Levels of the syntax tree below a declaration, clause or property; links of chains aside."""
LONGEST = 4000
"""Levels in all."""
STACK_OF_A_LEVEL = 2048
"""Bytes of the stack of a thread, with much to spare: Python 3.11 got along with 700 in every command."""
_FRAMES_OF_A_LEVEL = 20
_SMALL_STACK = 2**19


def nesting_errors(tokens: list[Token], value: Any) -> tuple[Diagnostic, ...]:
    """One diagnostic for the first part of a tree that is nested too deeply, if there is one."""
    if not _suspicious(tokens):
        return ()
    found, deepest = measured(value, max(min(LONGEST, _stack_size() // STACK_OF_A_LEVEL), DEEPEST))
    if deepest > DEEPEST and not found:
        sys.setrecursionlimit(max(sys.getrecursionlimit(), _FRAMES_OF_A_LEVEL * deepest))
    return found


def measured(value: Any, most: int = sys.maxsize) -> tuple[tuple[Diagnostic, ...], int]:
    """The first part of a tree that is nested too deeply or whose chains have more links, and how many levels the tree
    has down to there."""
    deepest = 0
    pending: list[tuple[Any, int, int, Any]] = [(value, 0, 0, None)]
    while pending:
        node, nested, level, whole = pending.pop()
        if isinstance(node, ast.Node):
            level += 1
            nested += not _continues(whole, node)
            if nested > DEEPEST:
                return (too_deep(node.span),), deepest
            if level > most:
                return (_too_long(node.span, most),), deepest
            deepest = max(deepest, level)
            names = (name for name in node.__dataclass_fields__ if name != "span")
            pending += [(getattr(node, name), nested, level, node) for name in names]
        elif isinstance(node, tuple | list):
            pending += [(item, nested, level, whole) for item in node]
    return (), deepest


def _continues(node: Any, part: ast.Node) -> bool:
    """True if a part is the next link of the chain that its node belongs to, not a level of nesting."""
    match node, part:
        case ast.BinaryExpression(operator=BinaryOperator.IMPLY), ast.BinaryExpression(operator=BinaryOperator.IMPLY):
            return True
        case ast.BinaryExpression(left=left, operator=operator), ast.BinaryExpression():
            return part is left and part.operator.level == operator.level
        case ast.ConditionalExpression(otherwise=otherwise), ast.ConditionalExpression():
            return part is otherwise
        case ast.IfStatement(otherwise=otherwise), ast.IfStatement():
            return part is otherwise
        case ast.UnaryExpression(), ast.UnaryExpression():
            return True
        case ast.AssignmentExpression(), ast.AssignmentExpression():
            return True
        case _:
            return False


def _stack_size() -> int:
    """The minimal size of the stack of this thread in bytes."""
    if sys.platform == "win32":
        return 2**20
    if sys.platform == "darwin":
        import threading

        if threading.current_thread() is not threading.main_thread():
            return _SMALL_STACK
    import resource

    limit = resource.getrlimit(resource.RLIMIT_STACK)[0]
    return 2**21 if limit == resource.RLIM_INFINITY else limit


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
    """The refusal of the text at a place."""
    return Diagnostic(
        "E0111",
        f"this is nested more than {DEEPEST} levels deep",
        Span(span.source, span.start, min(span.end, span.start + 40)),
        "name parts of it with functions or constants",
    )


def _too_long(span: Span, most: int) -> Diagnostic:
    return Diagnostic(
        "E0111",
        f"this chain has more than {most} parts",
        Span(span.source, span.start, min(span.end, span.start + 40)),
        "name parts of it with functions or constants, or use an array",
    )


def _suspicious(tokens: list[Token]) -> bool:
    """True if the tree can be deep at all: it cannot where brackets are shallow and statements short."""
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
