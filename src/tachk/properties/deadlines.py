"""``A<>[<= t] p`` and ``p -->[<= t] q``: what must come on every run, and by when.

A process with a clock c stands beside the model. ``A<>[<= t] q`` is ``A<> (q and c <= t)`` with a clock that nothing
sets: a run violates it exactly if q does not hold at any moment up to t, however it goes on, and a run that ends, stops
time or does infinitely much before t without q violates it too.

For ``p -->[<= t] q`` the process may at any moment with p set its clock and watch from then on. Once it watches and q
holds, nobody may act any more; so the states in which it watches and q does not hold are those that have not seen q
since p, and ``watching and not q --> q and c <= t`` is the question. That the process can set its clock whenever p
holds is why models with committed locations or priorities are refused: there others may have to act first.
"""

from __future__ import annotations

from dataclasses import replace

from tachk.diagnostics.diagnostic import Diagnostic, UnsupportedError
from tachk.engines.options import Limits, Options
from tachk.engines.outcome import Progress
from tachk.model.expressions import (
    BOOL,
    Assign,
    Binary,
    Constant,
    Expression,
    LocationTest,
    Reference,
    Unary,
    Variable,
    VariableKind,
)
from tachk.model.network import Edge, Location, Network, Process
from tachk.model.query import Query
from tachk.model.traversal import clock_in
from tachk.model.types import ClockType
from tachk.operators import BinaryOperator, UnaryOperator
from tachk.properties import liveness
from tachk.properties.observed import fault_without_observer, without_observer
from tachk.properties.plan import Search, Task
from tachk.properties.verdict import Verdict
from tachk.semantics.discrete import PreparedNetwork, prepare
from tachk.words import Direction, QueryKind

NAME = "Deadline"


def answer(
    model: PreparedNetwork, search: Search, options: Options, limits: Limits, progress: Progress | None, trace: bool
) -> dict[int, Verdict]:
    """The verdicts about the tasks of a search, by number; each has a deadline."""
    verdicts = {}
    for task in search.tasks:
        network, query = with_deadline(model.network, task.query)
        alone = replace(search, tasks=(Task(task.number, query),))
        found = liveness.answer(prepare(network), alone, options, limits, progress, trace)[task.number]
        verdicts[task.number] = _told(network, replace(found, query=task.query))
    return verdicts


def _told(network: Network, verdict: Verdict) -> Verdict:
    """The verdict with its run, and the error that ended it, told of the model alone."""
    if verdict.fault is not None:
        verdict = replace(verdict, fault=fault_without_observer(network, verdict.fault))
    if verdict.trace is not None:
        verdict = replace(verdict, trace=without_observer(network, verdict.trace)[0])
    return verdict


def check_deadline(network: Network, query: Query) -> None:
    """Raises UnsupportedError where a deadline since the left side of ``-->`` cannot be watched."""
    if query.deadline is None or query.kind is not QueryKind.LEADS_TO:
        return
    assert query.predicate is not None
    clock = clock_in(query.predicate) or clock_in(query.operands[0])
    committed = any(location.committed for process in network.processes for location in process.locations)
    if clock is not None:
        reason, span = "that look at a clock", clock.span
    elif committed:
        reason, span = "in models with committed locations", query.span
    elif network.has_priorities:
        reason, span = "in models with priorities of channels or processes", query.span
    else:
        return
    message = f"queries with `-->[<= t]` are not checked {reason}"
    raise UnsupportedError(Diagnostic("E0720", message, span, "the formula G (p -> F[0, t] q) asks nearly the same"))


def with_deadline(network: Network, query: Query) -> tuple[Network, Query]:
    """A network with one more process, and the query without a deadline that means the same there."""
    deadline = query.deadline
    assert deadline is not None and query.predicate is not None
    clock = Variable(f"{NAME}.time", ClockType(), VariableKind.LOCAL, (0,))
    operator = BinaryOperator.LESS if deadline.strict else BinaryOperator.LESS_EQUAL
    in_time = Binary(operator, Reference(clock), Constant(deadline.bound), BOOL)
    plain = replace(query, deadline=None)
    if query.kind is QueryKind.EVENTUALLY:
        observer = Process(NAME, NAME, (Location("Running"),), (), variables=(clock,))
        target = _both(query.predicate, in_time)
        return replace(network, processes=(*network.processes, observer)), replace(plain, predicate=target)
    (awaited,) = query.operands
    watching = LocationTest(len(network.processes), 1)
    begin = Edge(0, 1, guard=query.predicate, updates=(Assign(Reference(clock), Constant(0), clock.type),))
    observer = Process(NAME, NAME, (Location("Idle"), Location("Watching")), (begin,), variables=(clock,))
    free = _not(_both(watching, awaited))
    processes = [_held(process, free) for process in network.processes]
    return replace(network, processes=(*processes, observer)), replace(
        plain, predicate=_both(watching, _not(awaited)), operands=(_both(awaited, in_time),)
    )


def _held(process: Process, free: Expression) -> Process:
    """The process, which begins something only where that is allowed."""
    edges = []
    for edge in process.edges:
        if edge.synchronisation is None or edge.synchronisation.direction is Direction.SEND:
            edges.append(replace(edge, guard=free if edge.guard is None else _both(free, edge.guard)))
        else:
            edges.append(edge)
    return replace(process, edges=tuple(edges))


def _both(left: Expression, right: Expression) -> Expression:
    return Binary(BinaryOperator.AND, left, right, BOOL)


def _not(condition: Expression) -> Expression:
    return Unary(UnaryOperator.NOT, condition, BOOL)
