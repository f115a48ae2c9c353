"""Which queries UPPAAL refuses that tachk takes."""

from __future__ import annotations

from collections.abc import Iterator

from tachk.diagnostics.diagnostic import Diagnostic
from tachk.frontend.load import LoadedModel
from tachk.model.expressions import Deadlock, Expression
from tachk.model.network import Direction
from tachk.model.query import Query, QueryKind
from tachk.model.traversal import walk
from tachk.model.types import ChannelType
from tachk.semantics.conditions import reads_clock
from tachk.semantics.features import Feature, network_features


def query_findings(model: LoadedModel, version: str) -> Iterator[Diagnostic]:
    """One error for each query that the version refuses."""
    reason = _against_deadlock(model)
    for query in model.queries:
        deadlock = next((n for e in _expressions(query) for n in walk(e) if isinstance(n, Deadlock)), None)
        if deadlock is None:
            continue
        if query.kind not in (QueryKind.POSSIBLY, QueryKind.INVARIANTLY):
            message = f"{version} takes `deadlock` in E<> and A[] only, not in {query.kind.value}"
            yield Diagnostic("E0815", message, deadlock.span)
        elif reason:
            yield Diagnostic("E0815", f"{version} does not check `deadlock` where {reason}; tachk does", deadlock.span)


def _expressions(query: Query) -> tuple[Expression, ...]:
    return query.operands if query.predicate is None else (query.predicate, *query.operands)


def _against_deadlock(model: LoadedModel) -> str:
    if Feature.PRIORITIES in network_features(model.network):
        return "channels or processes have priorities"
    for process in model.network.processes:
        for edge in process.edges:
            synchronisation = edge.synchronisation
            if synchronisation is None or synchronisation.direction is not Direction.RECEIVE or edge.guard is None:
                continue
            channel = synchronisation.channel.type
            if isinstance(channel, ChannelType) and channel.broadcast and reads_clock(edge.guard):
                return "a receiver of a broadcast has a clock in its guard"
    return ""
