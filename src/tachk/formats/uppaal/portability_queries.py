"""Which queries UPPAAL refuses that tachk takes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from tachk.base.diagnostics.diagnostic import Diagnostic
from tachk.base.words import QueryKind
from tachk.formats.plain.expansion import expand_document
from tachk.formats.uppaal.limits import refuses_deadlock
from tachk.frontend.loaded import LoadedModel
from tachk.model.expressions import Deadlock, Expression
from tachk.model.floating import contains_double
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.model.traversal import process_expressions, walk
from tachk.syntax import ast

_MEND = "let a function with an integer or boolean result compute it"
_REASON = "where channels or processes have priorities, or a receiver of a broadcast has a clock in its guard"


def query_findings(model: LoadedModel, version: str) -> Iterator[Diagnostic]:
    """One error for each query that the version refuses."""
    never = refuses_deadlock(expand_document(ast.Document(model.document.span, model.items)))
    for query in model.queries:
        number = _floating_part(_expressions(query))
        if number is not None:
            message = f"{version} takes no floating point numbers in queries that are checked symbolically"
            yield Diagnostic("E0815", message, number.span, _MEND)
        deadlock = next((n for e in _expressions(query) for n in walk(e) if isinstance(n, Deadlock)), None)
        if deadlock is None:
            continue
        if query.kind not in (QueryKind.POSSIBLY, QueryKind.INVARIANTLY):
            message = f"{version} takes `deadlock` in E<> and A[] only, not in {query.kind.value}"
            yield Diagnostic("E0815", message, deadlock.span)
        elif never:
            yield Diagnostic("E0815", f"{version} does not check `deadlock` {_REASON}; tachk does", deadlock.span)


def floating_findings(network: Network, version: str) -> Iterator[Diagnostic]:
    """One warning for each process in whose guards or updates the version would not check floating point numbers."""
    for process in network.processes:
        number = _floating_part(process_expressions(process))
        if number is not None:
            message = f"{version} answers no symbolic query where guards or updates use floating point numbers"
            yield Diagnostic("W0501", message, number.span, _MEND)


def _floating_part(expressions: Iterable[Expression]) -> Expression | None:
    """The first part of expressions that is, or computes with, a floating point number; what the functions that they
    call do inside is their own matter."""
    return next((node for each in expressions for node in walk(each) if contains_double(node.type)), None)


def _expressions(query: Query) -> tuple[Expression, ...]:
    return query.operands if query.predicate is None else (query.predicate, *query.operands)
