"""UPPAAL's .q files: one query a line.

A backslash at the end of a line continues it. A comment describes the query after it, or the one before it on its line.
UPPAAL reads ``EXPECT:`` in a block comment as the outcome of the query before the comment; so do we.
"""

from __future__ import annotations

import re

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.records import dataclass, field, replace
from tachk.base.span import Source, Span
from tachk.syntax import ast
from tachk.syntax.parsing.parser import parse_query

_PIECE = re.compile(
    r"(?P<comment>//[^\n]*|/\*[\s\S]*?(?:\*/|\Z))|(?P<continued>\\[ \t]*\r?\n)|(?P<end>\n)|(?P<blank>[ \t\r\ufeff]+)|."
)
_EXPECT = re.compile(r"EXPECT:[ \t]*(\S+)")
_OUTCOMES = {"T": "holds", "SAT": "holds", "F": "fails", "UNSAT": "fails"}


@dataclass(slots=True)
class _QueryPlace:
    """The place of a query, with its comments and its expectation."""

    start: int
    end: int
    comments: list[str] = field(default_factory=list)
    expectation: str | None = None


@dataclass(frozen=True, slots=True)
class BrokenQuery:
    """A query that cannot be read, with the reasons.

    Attributes:
        name: of the property that it was to be; empty in a .q file.
    """

    name: str
    text: str
    comment: str
    span: Span
    diagnostics: tuple[Diagnostic, ...]


def parse_queries(source: Source) -> tuple[tuple[ast.QueryEntry, ...], tuple[Diagnostic, ...]]:
    """The queries of a file, and what is wrong with those that could not be read."""
    entries = parse_each_query(source)
    diagnostics = [found for entry in entries if isinstance(entry, BrokenQuery) for found in entry.diagnostics]
    return tuple(entry for entry in entries if isinstance(entry, ast.QueryEntry)), tuple(diagnostics)


def parse_each_query(source: Source) -> tuple[ast.QueryEntry | BrokenQuery, ...]:
    """All queries of a file in order, readable or not."""
    entries: list[ast.QueryEntry | BrokenQuery] = []
    for place in _places(source.text):
        entry, found = parse_query(source, place.start, place.end)
        comment = "\n".join(place.comments)
        if entry is None or found:
            span = Span(source, place.start, place.end)
            entries.append(BrokenQuery("", span.text, comment, span, found))
        else:
            entries.append(replace(entry, comment=comment, expectation=entry.expectation or place.expectation))
    return tuple(entries)


def _places(text: str) -> list[_QueryPlace]:
    places: list[_QueryPlace] = []
    comments: list[str] = []
    current: _QueryPlace | None = None
    for piece in _PIECE.finditer(text):
        kind = piece.lastgroup
        if kind == "comment":
            comment = piece.group()
            if comment.startswith("/*") and _EXPECT.search(comment):
                target = current or (places[-1] if places else None)
                if target is not None:
                    target.expectation = expectation_in(comment) or target.expectation
            elif current is not None:
                current.comments.append(_plain(comment))
            else:
                comments.append(_plain(comment))
        elif kind == "end":
            if current is not None:
                places.append(current)
                current = None
        elif kind is None:
            if current is None:
                current = _QueryPlace(piece.start(), piece.end(), [comment for comment in comments if comment])
                comments = []
            current.end = piece.end()
    if current is not None:
        places.append(current)
    return places


def expectation_in(comment: str) -> str | None:
    """The outcome among the comma-separated words of an ``EXPECT:``; limits and "may be" outcomes say nothing."""
    found = _EXPECT.search(comment)
    words = found.group(1).split(",") if found else []
    return next((_OUTCOMES[word] for word in words if word in _OUTCOMES), None)


def _plain(comment: str) -> str:
    """The text of a comment without its delimiters and the stars in front of its lines."""
    if comment.startswith("//"):
        return comment.lstrip("/").strip()
    inner = comment[2:].removesuffix("*/")
    lines = [line.strip().removeprefix("*").strip() for line in inner.splitlines()]
    return "\n".join(line for line in lines if line)
