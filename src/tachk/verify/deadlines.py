"""``A<>[<= t] p`` and ``p -->[<= t] q``: what must come on every run, and by when.

A process with a clock c stands beside the model. ``A<>[<= t] q`` is ``A<> (q and c <= t)`` with a clock that nothing
sets: a run violates it exactly if q does not hold at any moment up to t, however it goes on, and a run that ends, stops
time or does infinitely much before t without q violates it too.

For ``p -->[<= t] q`` every action is there twice: one copy sets the clock as well, and leaves a mark until the next
action. A run may set it whenever a state is entered, or never again. So the obligations are those of the marked states:
``mark and p and not q --> q and c <= t``. Setting the clock is part of an action of the model, so that nothing happens
earlier, later or instead; committed locations and priorities stay what they are.
"""

from __future__ import annotations

from tachk.base.diagnostics.diagnostic import Diagnostic, UnsupportedError
from tachk.base.operators import BinaryOperator
from tachk.base.records import replace
from tachk.base.words import QueryKind
from tachk.engine.options import Limits, Options
from tachk.meaning.discrete import PreparedNetwork, prepare
from tachk.model.connectives import both, negation
from tachk.model.expressions import BOOL, Binary, Constant, Expression
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.model.traversal import clock_in
from tachk.transform.doubled_edges import with_guessed_resets
from tachk.transform.extension import with_clock
from tachk.transform.transformation import Transformation
from tachk.verify.plan import Search, Task
from tachk.verify.strategies import avoidable
from tachk.verify.verdict import Verdict, lifted


def answer(model: PreparedNetwork, search: Search, options: Options, limits: Limits, trace: bool) -> dict[int, Verdict]:
    """The verdicts about the tasks of a search, by number; each has a deadline."""
    verdicts = {}
    for task in search.tasks:
        timed, query = with_deadline(model.network, task.query)
        alone = replace(search, tasks=(Task(task.number, query),))
        found = avoidable(prepare(timed.network), alone, options, limits, trace)[task.number]
        verdicts[task.number] = replace(lifted(found, timed), query=task.query)
    return verdicts


def check_deadline(network: Network, query: Query) -> None:
    """Raises UnsupportedError where a deadline since the left side of ``-->`` cannot be watched."""
    if query.deadline is None or query.kind is not QueryKind.LEADS_TO:
        return
    assert query.predicate is not None
    clock = clock_in(query.predicate) or clock_in(query.operands[0])
    if clock is not None:
        message = "queries with `-->[<= t]` are not checked that look at a clock"
        remedy = "let a location or a variable of the model show when the clock is there"
        raise UnsupportedError(Diagnostic("E0720", message, clock.span, remedy))


def with_deadline(network: Network, query: Query) -> tuple[Transformation, Query]:
    """A network with a clock more, and the query without a deadline that means the same there."""
    deadline = query.deadline
    assert deadline is not None and query.predicate is not None
    operator = BinaryOperator.LESS if deadline.strict else BinaryOperator.LESS_EQUAL

    def in_time(clock: Expression, condition: Expression) -> Expression:
        return both(condition, Binary(operator, clock, Constant(deadline.bound), BOOL))

    plain = replace(query, deadline=None)
    if query.kind is QueryKind.EVENTUALLY:
        timed = with_clock(network)
        return timed, replace(plain, predicate=in_time(timed.clock, query.predicate))
    (awaited,) = query.operands
    doubled = with_guessed_resets(network)
    begins = both(both(doubled.mark, query.predicate), negation(awaited))
    return doubled, replace(plain, predicate=begins, operands=(in_time(doubled.clock, awaited),))
