"""Entries of UPPAAL's list of queries that are no properties of the text, or none for UPPAAL.

Headings and wrong queries are comments of a text; when XML is written they come back from there, in their order among
the properties. A formula that UPPAAL refuses is a comment of the XML.
"""

from __future__ import annotations

import re

from tachk.base.span import Span
from tachk.syntax.picture_layout import QueryLayout

_ASIDE = "/* UPPAAL does not check: "
_SET_ASIDE = re.compile(rf"\s*{re.escape(_ASIDE)}(?P<formula>.*\S)\s*\*/\s*", re.DOTALL)
_WRONG = "// a query that is wrong: "
_HEADING = "// a heading among the queries: "
_HEADING_FORMULA = "// a heading in place of a query: "
_BEHIND = " /// "
"""Between a formula and its comment."""


def wrong_query(formula: str, comment: str) -> str:
    """A query that no model can have, as a comment."""
    return _WRONG + _joined(formula, comment)


def wrong_query_in(comment: str) -> str | None:
    """The formula in a comment that `wrong_query` made; None for other comments."""
    entry = aside_in(comment) if comment.startswith(_WRONG) else None
    return None if entry is None else entry.formula


def heading(formula: str, comment: str) -> str:
    """A query without a formula, or with a heading in its place, as a comment; empty where it says nothing."""
    if formula.strip():
        return _HEADING_FORMULA + _joined(formula, comment)
    return f"{_HEADING}{_escaped(comment.strip())}" if comment.strip() else ""


def aside_in(comment: str) -> QueryLayout | None:
    """The entry that a comment holds; None for other comments."""
    if comment.startswith(_HEADING):
        return QueryLayout("", _unescaped(comment.removeprefix(_HEADING).strip()), "")
    for word in (_WRONG, _HEADING_FORMULA):
        if comment.startswith(word):
            formula, _, said = comment.removeprefix(word).partition(_BEHIND)
            return QueryLayout("", _unescaped(said.strip()), formula.strip())
    return None


def set_aside(formula: str) -> str:
    """A formula that UPPAAL refuses, as a comment from which it can be read again."""
    return f"{_ASIDE}{formula} */"


def is_set_aside(formula: Span) -> bool:
    """True if a formula stands in a comment that `set_aside` made, so that UPPAAL does not see it."""
    return formula.source.text[: formula.start].endswith(_ASIDE)


def formula_place(span: Span) -> Span:
    """The place of the formula itself, also of one that `set_aside` made a comment."""
    found = _SET_ASIDE.fullmatch(span.text)
    return span if found is None else Span(span.source, span.start + found.start(1), span.start + found.end(1))


def _joined(formula: str, comment: str) -> str:
    said = _escaped(comment.strip())
    return " ".join(formula.split()) + (f"{_BEHIND}{said}" if said else "")


def _escaped(text: str) -> str:
    return text.replace("\\", "\\\\").replace("\r", "").replace("\n", "\\n")


def _unescaped(text: str) -> str:
    return re.sub(r"\\(.)", lambda found: "\n" if found[1] == "n" else found[1], text)
