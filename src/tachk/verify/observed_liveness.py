"""Temporal properties that only a run without end violates: whether the observer can stay for ever where it does.

An *ending* of the observer has a condition that holds while time passes there. A violation is a run that never leaves
an ending and whose states all satisfy its condition: as for ``A<>``, it is enough that what is awaited is there for no
time, between two steps at one instant. Elsewhere such values do not count. So the first search asks if some run never
leaves an ending, whatever its condition; where only such a run exists, the verdict says so.
"""

from __future__ import annotations

from functools import reduce

from tachk.base.job import StoppedError, unhurried
from tachk.base.operators import BinaryOperator, UnaryOperator
from tachk.base.records import replace
from tachk.base.words import QueryKind
from tachk.engine.options import Engine, Limits, Options
from tachk.engine.outcome import INTERRUPTED
from tachk.meaning.discrete import PreparedNetwork, prepare
from tachk.model.expressions import BOOL, Binary, Expression, LocationTest, Unary
from tachk.model.network import Network
from tachk.model.query import Observer, Query
from tachk.transform.observed import observed
from tachk.verify.plan import Analysis, Search, Task
from tachk.verify.strategies import avoidable, reachable
from tachk.verify.vacuity import never_true, triggers_of
from tachk.verify.verdict import Answer, Verdict, lifted

FLEETING = "holds as `A<>` does: what is awaited may be there for no time, between two steps at one instant"


def answer(model: PreparedNetwork, search: Search, options: Options, limits: Limits, trace: bool) -> dict[int, Verdict]:
    """The verdicts about the tasks of a search, by number."""
    assert search.observer is not None
    with_observer = observed(model.network, search.observer)
    network = with_observer.network
    watched = prepare(network)
    verdicts: dict[int, Verdict] = {}
    for task in search.tasks:
        wide = replace(task, query=_anywhere(task.query, search.observer, len(network.processes) - 1))
        (first,) = avoidable(watched, _alone(search, wide), options, limits, False).values()
        verdict = first
        if first.answer is Answer.FAILS:
            (second,) = avoidable(watched, _alone(search, task), options, limits, trace).values()
            verdict = replace(second, notes=(FLEETING,)) if second.answer is Answer.HOLDS else second
        if verdict.answer is Answer.HOLDS:
            verdict = _with_notes(model, network, task, verdict, options, limits)
        with unhurried():
            moves = () if verdict.trace is None else with_observer.moves(verdict.trace)
        verdicts[task.number] = replace(lifted(verdict, with_observer), query=task.query, moves=moves)
    return verdicts


def _with_notes(
    model: PreparedNetwork,
    network: Network,
    task: Task,
    verdict: Verdict,
    options: Options,
    limits: Limits,
) -> Verdict:
    """The verdict with a note for each trigger that never happens, which a search without the observer finds out.

    The observer does not show it: it moves only where it guesses a violation. A limit leaves the note out.

    Args:
        network: with the observer.
    """
    try:
        triggers = triggers_of([task], network)
    except StoppedError:
        return verdict
    conditions = [
        Task(number, Query(trigger.text, QueryKind.POSSIBLY, trigger.condition))
        for number, trigger in enumerate(triggers)
    ]
    if not conditions:
        return verdict
    by_zones = replace(options, engine=Engine.ZONE)
    found = reachable(model, Search(Analysis.REACHABILITY, tuple(conditions)), by_zones, limits, False).values()
    if any(one.reason == INTERRUPTED for one in found):
        raise KeyboardInterrupt
    never = [one.query.name for one in found if one.answer is Answer.FAILS]
    return replace(verdict, notes=(*verdict.notes, *map(never_true, never)))


def _alone(search: Search, task: Task) -> Search:
    return replace(search, tasks=(task,), observer=None)


def _anywhere(query: Query, observer: Observer, process: int) -> Query:
    """The query whether a run can stay in the endings, whatever their conditions."""
    places: list[Expression] = [
        LocationTest(process, place, span=query.span) for place in (observer.bad, *observer.endings, *observer.entries)
    ]
    there = reduce(lambda one, other: Binary(BinaryOperator.OR, one, other, BOOL, query.span), places)
    return replace(query, operands=(Unary(UnaryOperator.NOT, there, BOOL, query.span),))
