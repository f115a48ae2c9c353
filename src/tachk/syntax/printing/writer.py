"""Lines with indentation, comments and blank lines: what the formatter writes into."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from tachk.base.operators import BinaryOperator
from tachk.syntax import ast
from tachk.syntax.chains import operands_of
from tachk.syntax.printing.comment_placement import Placement, line_nodes
from tachk.syntax.printing.expression_printer import needs_parentheses, print_expression

WIDTH = 100
"""Columns after which the formatter breaks a line where it can."""

ALIGNED = 60
"""Comments behind neighbouring lines of code that are no longer than this begin in one column."""

INDENT = "    "


class Writer:
    """Collects the lines of a text.

    Attributes:
        comments: where the comments of the document go.
    """

    def __init__(self, document: ast.Document, comments: Placement) -> None:
        self.comments = comments
        self._source = document.span.source
        self._lines: list[str] = []
        self._depth = 0
        self._code_ends: dict[int, int] = {}

    def text(self) -> str:
        for run in self._neighbours():
            column = max(self._code_ends[index] for index in run)
            for index in run:
                line, end = self._lines[index], self._code_ends[index]
                self._lines[index] = line[:end] + " " * (column - end) + line[end:]
        self._code_ends.clear()
        return "\n".join(self._lines) + "\n" if self._lines else ""

    def _neighbours(self) -> Iterator[list[int]]:
        """Runs of lines with equal indentation and a comment behind short code."""
        run: list[int] = []
        indent = -1
        for index, end in sorted(self._code_ends.items()):
            line = self._lines[index]
            deep = len(line) - len(line.lstrip())
            if run and (index > run[-1] + 1 or deep != indent or end > ALIGNED):
                yield run
                run = []
            if end <= ALIGNED:
                run.append(index)
            indent = deep
        if run:
            yield run

    def fits(self, line: str) -> bool:
        return len(INDENT) * self._depth + len(line) <= WIDTH

    def deeper(self, levels: int) -> None:
        self._depth += levels

    def raw(self, line: str) -> None:
        """A line with neither comments nor documentation."""
        self._lines.append(INDENT * self._depth + line if line else "")

    def separate(self, before: Any, node: Any, always: bool) -> None:
        """A blank line between two nodes, if there must be one or there is one in the text."""
        if before is not None and (always or self._blank_between(before, node)):
            self.raw("")

    def begin(self, node: Any, doc: str = "") -> None:
        """The comments before a node, and its documentation."""
        self._own_lines(self.comments.before.get(id(node), []))
        if doc:
            for line in doc.split("\n"):
                self.raw(f"/// {line}".rstrip())

    def ending(self, line: str, node: Any) -> None:
        """The last line of a node, and the comments behind it."""
        self.raw(line)
        self.behind(node)

    def line(self, line: str, node: Any) -> None:
        """A node of one line."""
        self.begin(node)
        self.ending(line, node)

    def behind(self, node: Any) -> None:
        """The comments behind a node whose last line is written."""
        self._behind(self.comments.behind.get(id(node), []))

    def begin_all(self, node: Any) -> None:
        """The comments before a node and all that belong to its parts, for a node that is written on one line."""
        self.begin(node)
        for part in line_nodes(node):
            for table in (self.comments.before, self.comments.behind):
                self._own_lines(table.get(id(part), []))

    def joined(self, line: str) -> str:
        """A line that continues behind the closing brace above it, if nothing else stands there."""
        if self._lines and self._lines[-1] == f"{INDENT * self._depth}}}":
            self._lines.pop()
            return f"}} {line}"
        return line

    def open(self, line: str, node: Any) -> None:
        """A line that ends with an opening brace."""
        self.raw(line)
        self._behind(self.comments.opening.get(id(node), []))
        self._depth += 1

    def close(self, line: str, node: Any) -> None:
        """The line of the closing brace, after the comments that stand before it."""
        self._own_lines(self.comments.closing.get(id(node), []))
        self._depth -= 1
        self.ending(line, node)

    def finish(self, document: ast.Document) -> None:
        """The comments at the end of the text."""
        rest = self.comments.closing.get(id(document), [])
        if rest and self._lines and self._blank_before(rest[0]):
            self.raw("")
        self._own_lines(rest)

    def condition(self, head: str, expression: ast.Expression, tail: str, node: Any) -> None:
        """A clause whose condition is broken between its conjuncts or disjuncts if it is too long."""
        line = f"{head}{print_expression(expression)}{tail}"
        parts = _chain(expression)
        if self.fits(line) or len(parts) < 2:
            self.ending(line, node)
            return
        self.raw(head + parts[0])
        self._depth += 1
        for part in parts[1:-1]:
            self.raw(part)
        self.ending(parts[-1] + tail, node)
        self._depth -= 1

    def filled(self, head: str, parts: Sequence[str]) -> None:
        """Rows of as many parts as fit; further rows are indented. No comments."""
        row = head
        indented = False
        for part in parts:
            if row and row != head and not self.fits(f"{row} {part}"):
                self.raw(row)
                row = part
                if head and not indented:
                    self._depth += 1
                    indented = True
            else:
                row = f"{row} {part}" if row else part
        self.raw(row)
        self._depth -= indented

    def _own_lines(self, comments: list[ast.Comment]) -> None:
        previous: ast.Comment | None = None
        for comment in comments:
            if previous is not None and self._blank_before(comment):
                self.raw("")
            self.raw(_text(comment))
            previous = comment
        if previous is not None and self._blank_behind(previous):
            self.raw("")

    def _behind(self, comments: list[ast.Comment]) -> None:
        for comment in comments:
            if "//" in self._last_comment():
                self.raw(_text(comment))
            else:
                if "\n" not in self._lines[-1] and comment.text.startswith("//"):
                    self._code_ends[len(self._lines) - 1] = len(self._lines[-1])
                self._lines[-1] += f"  {_text(comment)}"

    def _last_comment(self) -> str:
        """The line comment at the end of the last line, if there is one, else nothing."""
        line = self._lines[-1].rsplit("\n", 1)[-1]
        place = line.find("//")
        return line[place:] if place >= 0 else ""

    def _blank_between(self, before: Any, node: Any) -> bool:
        leading = self.comments.before.get(id(node), [])
        first = leading[0] if leading else node
        if before.span.source is not self._source or first.span.source is not self._source:
            return type(before) is not type(node)
        if first.span.start < before.span.end:
            return False
        return self._blank_before(first)

    def _blank_before(self, node: Any) -> bool:
        """True if a blank line stands directly before a node or comment, its documentation counted to it."""
        text = self._source.text
        start = text.rfind("\n", 0, node.span.start) + 1
        while start > 0:
            end = start - 1
            start = text.rfind("\n", 0, end) + 1
            line = text[start:end].strip()
            if isinstance(node, ast.Comment) or not line.startswith("///"):
                return not line
        return False

    def _blank_behind(self, comment: ast.Comment) -> bool:
        text = self._source.text
        end = text.find("\n", comment.span.end)
        if end < 0:
            return False
        following = text.find("\n", end + 1)
        return following >= 0 and not text[end + 1 : following].strip()


def _text(comment: ast.Comment) -> str:
    return "\n".join(line.rstrip() for line in comment.text.split("\n"))


def _chain(expression: ast.Expression) -> list[str]:
    """The operands of a chain of ``&&``, or of ``||`` and ``imply``, each but the first with its operator."""
    if not isinstance(expression, ast.BinaryExpression) or expression.operator not in (
        BinaryOperator.AND,
        BinaryOperator.OR,
        BinaryOperator.IMPLY,
    ):
        return [print_expression(expression)]
    level = expression.operator.level
    operands: list[tuple[str, ast.Expression]] = []
    rest: ast.Expression = expression
    grouped = False
    while isinstance(rest, ast.BinaryExpression) and rest.operator.level == level and not grouped:
        operator = rest.operator
        rest, *others = operands_of(rest)
        operands += ((operator, operand) for operand in reversed(others))
        grouped = needs_parentheses(rest, operator)
    return [
        _operand(rest, level + grouped, False),
        *(
            f"{operator} {_operand(right, level + 1, place == len(operands) - 1)}"
            for place, (operator, right) in enumerate(reversed(operands))
        ),
    ]


def _operand(expression: ast.Expression, least: int, last: bool) -> str:
    text = print_expression(expression)
    match expression:
        case ast.BinaryExpression(operator=operator):
            return text if operator.level >= least and not _swallows(expression, last) else f"({text})"
        case ast.ConditionalExpression() | ast.AssignmentExpression():
            return f"({text})"
        case _:
            return f"({text})" if _swallows(expression, last) else text


def _swallows(expression: ast.Expression, last: bool) -> bool:
    """True if the text of an operand ends in the body of a quantifier, which would take in what follows."""
    while not last:
        match expression:
            case ast.QuantifierExpression():
                return True
            case ast.BinaryExpression(right=right):
                expression = right
            case ast.UnaryExpression(operand=operand):
                expression = operand
            case _:
                return False
    return False
