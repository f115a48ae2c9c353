"""Queries that one state decides, answered by z3: instead of the zone engine, or to compare the two."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import assert_never

from tachk.base.diagnostics.diagnostic import Diagnostic, InternalError, UnsupportedError
from tachk.base.job import StoppedError, current_job, limited, unhurried
from tachk.engine.options import Engine, Limits, Options
from tachk.engine.outcome import INTERRUPTED, Outcome
from tachk.meaning.discrete import PreparedNetwork, prepare
from tachk.model.query import Query
from tachk.model.run import RunTimeFault
from tachk.transform.observed import ObservedNetwork, observed
from tachk.transform.transformation import unchanged
from tachk.verify import reachability
from tachk.verify.fault_explanation import explain
from tachk.verify.plan import Analysis, Search, analysis_of
from tachk.verify.strategies import reachable
from tachk.verify.unanswered import none_begun, unsupported
from tachk.verify.verdict import Answer, Verdict

Answering = Callable[
    [PreparedNetwork, Search, Options, Limits, bool],
    dict[int, Verdict],
]
"""From a search to the verdicts about its tasks, by number."""


class DisagreementError(InternalError):
    """Two engines have contradicted each other: one of them is wrong.

    Attributes:
        query: what they were asked.
        options: with which options.
        zone, smt: their verdicts.
    """

    def __init__(self, query: Query, options: Options, zone: Verdict, smt: Verdict) -> None:
        self.query = query
        self.options = options
        self.zone = zone
        self.smt = smt
        super().__init__(
            f"the engines contradict each other about {query.text!r}: "
            f"zone says {zone.answer.value}, smt says {smt.answer.value}"
        )


def answering(engine: Engine) -> Answering:
    """What answers with an engine."""
    match engine:
        case Engine.ZONE:
            return reachable
        case Engine.SMT:
            return answer
        case Engine.BOTH:
            return answer_by_both
        case never:
            assert_never(never)


def check_answerable(query: Query, engine: Engine) -> None:
    """Raises UnsupportedError for a query that z3 alone is to answer and cannot."""
    if engine is Engine.SMT and analysis_of(query) is not Analysis.REACHABILITY:
        raise UnsupportedError(
            Diagnostic(
                "E0745",
                f"the engine smt does not answer {query.kind.value}",
                query.span,
                "ask the zone engine: --engine zone",
            )
        )


def uncompared(verdicts: dict[int, Verdict], engine: Engine) -> dict[int, Verdict]:
    """Verdicts of the zone engine about queries that z3 does not answer."""
    if engine is not Engine.BOTH:
        return verdicts
    note = "only the zone engine has answered: the engine smt answers E<> and A[]"
    return {number: replace(verdict, notes=(*verdict.notes, note)) for number, verdict in verdicts.items()}


def answer(model: PreparedNetwork, search: Search, options: Options, limits: Limits, trace: bool) -> dict[int, Verdict]:
    """The verdicts of z3 about the tasks of a search. Nothing is left out of the network."""
    from tachk.engine.smt.search import explore

    watched = observed(model.network, search.observer)
    try:
        outcome = explore(watched.network, [task.target for task in search.tasks], limits)
    except UnsupportedError as error:
        return {task.number: unsupported(task.query, error.diagnostic) for task in search.tasks}
    outcome = _explained(watched, outcome)
    verdicts = {}
    for task, goal in zip(search.tasks, outcome.goals, strict=True):
        verdict = reachability.verdict_of(watched, unchanged(watched.network), task, goal, outcome, trace)
        assert verdict is not None  # nobody was frozen
        verdicts[task.number] = verdict
    return verdicts


def _explained(watched: ObservedNetwork, outcome: Outcome) -> Outcome:
    def of_the_model(fault: RunTimeFault | None) -> RunTimeFault | None:
        if fault is None:
            return None
        explained = explain(prepare(watched.network), fault)
        with unhurried():
            return watched.lift_fault(explained)

    goals = tuple(replace(goal, fault=of_the_model(goal.fault)) for goal in outcome.goals)
    return replace(outcome, goals=goals, fault=of_the_model(outcome.fault))


def answer_by_both(
    model: PreparedNetwork, search: Search, options: Options, limits: Limits, trace: bool
) -> dict[int, Verdict]:
    """The verdicts of the zone engine, each compared with that of z3, which has the time that is left.

    Raises DisagreementError.
    """
    left = current_job().seconds_left
    try:
        with limited(None if left is None else left / 2):
            by_zones = reachable(model, search, options, limits, trace)
    except StoppedError as error:
        by_zones = none_begun(search.tasks, error.reason)
    if any(verdict.reason == INTERRUPTED for verdict in by_zones.values()):
        return by_zones
    by_smt = answer(model, search, options, limits, trace)
    return {task.number: _compared(options, by_zones[task.number], by_smt[task.number]) for task in search.tasks}


def _compared(options: Options, zone: Verdict, smt: Verdict) -> Verdict:
    """What two engines say together."""
    if smt.answer is Answer.UNKNOWN:
        return replace(zone, notes=(*zone.notes, f"only the zone engine has answered; smt: {smt.reason}"))
    if zone.answer is Answer.UNKNOWN:
        return replace(smt, notes=(*smt.notes, f"only the engine smt has answered; zone: {zone.reason}"))
    if zone.answer is not smt.answer:
        raise DisagreementError(zone.query, options, zone, smt)
    return zone
