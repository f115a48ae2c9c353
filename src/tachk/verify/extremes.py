"""Queries for the least and the largest values of expressions: ``sup``, ``inf`` and ``bounds``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from tachk.base.job import unhurried
from tachk.base.operators import BinaryOperator
from tachk.base.words import QueryKind
from tachk.engine.options import Limits, Options
from tachk.engine.outcome import Statistics
from tachk.meaning.discrete import PreparedNetwork, prepare
from tachk.model.expressions import BOOL, Binary, Constant, Expression
from tachk.model.query import Query
from tachk.verify.extreme_search import INEXACT, ExtremeSearch, Question, UndecidedExtremeError
from tachk.verify.fault_explanation import explain
from tachk.verify.over_approximations import reduced_for
from tachk.verify.plan import Search, Task
from tachk.verify.unexamined import unexamined
from tachk.verify.verdict import Answer, Extreme, Extremes, Verdict
from tachk.verify.witness import witness

NEVER = "no reachable state satisfies the restriction, so that there is no value"


def answer(model: PreparedNetwork, search: Search, options: Options, limits: Limits, trace: bool) -> dict[int, Verdict]:
    """The verdicts about the tasks of a search, by number: HOLDS with the values, FAILS where there are none."""
    return {task.number: _answer(model, task, options, limits, trace) for task in search.tasks}


def _answer(model: PreparedNetwork, task: Task, options: Options, limits: Limits, trace: bool) -> Verdict:
    query = task.query
    where = restriction(query)
    targets = [_where_it_is(where, expression, 0) for expression in query.operands]
    reduced = reduced_for(model.network, targets, options)
    searched = prepare(reduced.network)
    search = ExtremeSearch(searched, where, options, limits)
    verdict = Verdict(query, Answer.UNKNOWN, True, "", Statistics())
    try:
        found = search.find(_questions(query))
    except UndecidedExtremeError as error:
        fault = None if error.fault is None else explain(searched, error.fault)
        with unhurried():
            fault = None if fault is None else reduced.lift_fault(fault)
        exact = error.reason != INEXACT
        return replace(verdict, reason=error.reason, exact=exact, fault=fault, statistics=search.statistics)
    with unhurried():
        left_out = unexamined(model.network, reduced.network)
    verdict = replace(verdict, statistics=search.statistics, unexamined=left_out)
    if found is None:
        return replace(verdict, answer=Answer.FAILS, notes=(NEVER,))
    extremes = []
    for (expression, _), value in zip(_questions(query), found, strict=True):
        run = None
        if value.value is not None and not value.strict and (trace or not search.exact):
            target, what = _where_it_is(where, expression, value.value), f"the value {value.value}"
            run, possible = witness(reduced, value.path, target, search.exact, what)
            if not possible:
                return _answer(model, task, options.off("cone"), limits, trace)
        if not search.exact and run is None:
            return replace(verdict, reason=INEXACT, exact=False)
        extremes.append(Extreme(value.value, value.strict, run))
    shown = next((extreme.run for extreme in extremes if extreme.run is not None), None)
    return replace(verdict, answer=Answer.HOLDS, trace=shown, extremes=_by_expression(query, extremes))


def restriction(query: Query) -> Expression:
    """The states over which the values are taken."""
    return Constant(1, BOOL) if query.predicate is None else query.predicate


def _questions(query: Query) -> list[Question]:
    return [(expression, largest) for expression in query.operands for largest in _directions(query)]


def _directions(query: Query) -> tuple[bool, ...]:
    """Whether the largest values are asked for, or the least ones, or first these and then those."""
    if query.kind is QueryKind.BOUNDS:
        return False, True
    return (query.kind is QueryKind.SUPREMUM,)


def _by_expression(query: Query, extremes: Sequence[Extreme]) -> tuple[Extremes, ...]:
    texts = [" ".join(operand.span.text.split()) for operand in query.operands]
    count = len(_directions(query))
    found = []
    for number, text in enumerate(texts):
        sides = dict(zip(_directions(query), extremes[count * number :], strict=False))
        found.append(Extremes(text, sides.get(False), sides.get(True)))
    return tuple(found)


def _where_it_is(where: Expression, expression: Expression, value: int) -> Expression:
    return Binary(BinaryOperator.AND, where, Binary(BinaryOperator.EQUAL, expression, Constant(value), BOOL), BOOL)
