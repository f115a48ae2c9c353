"""Verdicts about queries that were not looked into: refused, or not begun in time."""

from __future__ import annotations

from collections.abc import Iterable

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.engine.outcome import Statistics
from tachk.model.query import Query
from tachk.verify.plan import Task
from tachk.verify.verdict import Answer, Verdict


def not_begun(query: Query, reason: str) -> Verdict:
    return Verdict(query, Answer.UNKNOWN, True, reason, Statistics())


def none_begun(tasks: Iterable[Task], reason: str) -> dict[int, Verdict]:
    return {task.number: not_begun(task.query, reason) for task in tasks}


def refused(queries: Iterable[Query], reason: Diagnostic) -> tuple[Verdict, ...]:
    """The verdicts about a model that has something tachk does not check, so that no query can be decided."""
    return tuple(unsupported(query, reason) for query in queries)


def unsupported(query: Query, diagnostic: Diagnostic) -> Verdict:
    return Verdict(query, Answer.UNKNOWN, True, diagnostic.message, Statistics(), unsupported=diagnostic)
