"""Which queries UPPAAL refuses that tachk takes."""

from __future__ import annotations

from collections.abc import Iterator

from tachk.diagnostics.diagnostic import Diagnostic
from tachk.formats.plain.expansion import expand_document
from tachk.formats.uppaal.limits import refuses_deadlock
from tachk.frontend.loaded import LoadedModel
from tachk.model.expressions import Deadlock, Expression
from tachk.model.query import Query
from tachk.model.traversal import walk
from tachk.syntax import ast
from tachk.words import QueryKind

_REASON = "where channels or processes have priorities, or a receiver of a broadcast has a clock in its guard"


def query_findings(model: LoadedModel, version: str) -> Iterator[Diagnostic]:
    """One error for each query that the version refuses."""
    never = refuses_deadlock(expand_document(ast.Document(model.document.span, model.items)))
    for query in model.queries:
        deadlock = next((n for e in _expressions(query) for n in walk(e) if isinstance(n, Deadlock)), None)
        if deadlock is None:
            continue
        if query.kind not in (QueryKind.POSSIBLY, QueryKind.INVARIANTLY):
            message = f"{version} takes `deadlock` in E<> and A[] only, not in {query.kind.value}"
            yield Diagnostic("E0815", message, deadlock.span)
        elif never:
            yield Diagnostic("E0815", f"{version} does not check `deadlock` {_REASON}; tachk does", deadlock.span)


def _expressions(query: Query) -> tuple[Expression, ...]:
    return query.operands if query.predicate is None else (query.predicate, *query.operands)
