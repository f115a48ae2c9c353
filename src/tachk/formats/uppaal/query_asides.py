"""Entries of UPPAAL's list of queries that are no properties, as comments of a text: headings, and wrong queries.

When XML is written they come back from there, in their order among the properties.
"""

from __future__ import annotations

import re

from tachk.syntax.picture_layout import QueryLayout

_WRONG = "// a query that is wrong: "
_HEADING = "// a heading among the queries: "
_HEADING_FORMULA = "// a heading in place of a query: "
_BEHIND = " /// "
"""Between a formula and what its comment says."""


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


def _joined(formula: str, comment: str) -> str:
    said = _escaped(comment.strip())
    return " ".join(formula.split()) + (f"{_BEHIND}{said}" if said else "")


def _escaped(text: str) -> str:
    return text.replace("\\", "\\\\").replace("\r", "").replace("\n", "\\n")


def _unescaped(text: str) -> str:
    return re.sub(r"\\(.)", lambda found: "\n" if found[1] == "n" else found[1], text)
