"""UPPAAL's .q files.

A block comment describes the query below it. The expectation stands in a comment of its own on the line after the
query, in the words that UPPAAL's parser understands.
"""

from __future__ import annotations

from collections.abc import Iterable

from tachk.formats.plain.plain_model import PlainQuery
from tachk.formats.uppaal.limits import is_rejected
from tachk.formats.uppaal.query_asides import set_aside
from tachk.syntax import ast
from tachk.syntax.printing.query_printer import print_expected, print_query

_OUTCOMES = {"holds": "T", "fails": "F"}


def print_queries(queries: Iterable[PlainQuery], without_deadlock: bool = False) -> str:
    """The text of a query file.

    Args:
        without_deadlock: UPPAAL refuses every query about deadlocks of the model. What it refuses is a comment.
    """
    return "\n".join(_query(query, is_rejected(query.formula, without_deadlock)) for query in queries)


def _query(query: PlainQuery, rejected: bool) -> str:
    lines = []
    comment = ": ".join(part for part in (query.name, query.comment) if part)
    if comment:
        lines += ["/*", *comment.replace("*/", "* /").split("\n"), "*/"]
    if rejected:
        return "\n".join([*lines, set_aside(print_query(query.formula))]) + "\n"
    lines.append(" \\\n".join(line.strip() for line in print_query(query.formula).splitlines() if line.strip()))
    if isinstance(query.expectation, ast.ConditionalExpectation):
        lines[-1] += f" expect {print_expected(query.expectation)}"
    elif query.expectation is not None:
        lines.append(f"/* EXPECT:{_OUTCOMES[query.expectation]} */")
    return "\n".join(lines) + "\n"
