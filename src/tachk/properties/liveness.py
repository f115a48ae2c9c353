"""Queries that no single state decides: whether some run avoids a predicate for ever."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import assert_never

from tachk.certify.replay import ReplayError
from tachk.certify.replay_lasso import replay_lasso
from tachk.compiler.lower import lower_obligation
from tachk.diagnostics.diagnostic import InternalError
from tachk.engines.lasso import lasso
from tachk.engines.liveness import find_avoiding_run
from tachk.engines.options import Limits, Options
from tachk.engines.outcome import TIME_LIMIT, LivenessOutcome, LivenessStatus, Obligation, Progress
from tachk.model.query import Query
from tachk.properties.fault_explanation import explain
from tachk.properties.plan import Search, Task
from tachk.properties.unanswered import not_begun
from tachk.properties.vacuity import never_begins
from tachk.properties.verdict import Answer, Verdict
from tachk.semantics.discrete import PreparedNetwork
from tachk.time_limit import OutOfTimeError, time_limit
from tachk.words import QueryKind


def answer(
    model: PreparedNetwork, search: Search, options: Options, limits: Limits, progress: Progress | None, trace: bool
) -> dict[int, Verdict]:
    """The verdicts about the tasks of a search, by number.

    The whole network is searched: a process that cannot influence the predicates may still run for ever, or stop time.
    """
    return {task.number: _verdict(model, task, options, limits, progress, trace) for task in search.tasks}


def _verdict(
    model: PreparedNetwork, task: Task, options: Options, limits: Limits, progress: Progress | None, trace: bool
) -> Verdict:
    started = time.monotonic()
    query = task.query
    avoided, begins = query.avoided, query.begins
    assert avoided is not None
    try:
        with time_limit(limits.seconds):
            program, goal, trigger = lower_obligation(model.network, avoided, begins)
    except OutOfTimeError:
        return not_begun(query, TIME_LIMIT)
    left = limits.after(time.monotonic() - started)
    outcome = find_avoiding_run(program, goal, trigger, options, left, progress)
    if outcome.fault is not None:
        outcome = replace(outcome, fault=explain(model, outcome.fault, limits.seconds))
    verdict = _of_outcome(query, outcome)
    if outcome.run is None or not (trace or not outcome.exact):
        return verdict
    return _shown(model, verdict, outcome, Obligation(avoided, begins), limits.after(time.monotonic() - started))


_INEXACT = "the stopwatches make the search inexact, and the run it found may not be possible"

_NO_DELAYS = "a run that shows it was found, but there was no time to find its delays"

_SECONDS_FOR_DELAYS = 30.0


def _of_outcome(query: Query, outcome: LivenessOutcome) -> Verdict:
    """The verdict without the run behind it."""
    verdict = Verdict(query, Answer.UNKNOWN, True, outcome.reason, outcome.statistics, fault=outcome.fault)
    on_found, otherwise = answers_of(query)
    match outcome.status:
        case LivenessStatus.UNDECIDED:
            return verdict
        case LivenessStatus.NONE:
            # An over-approximation without such a run proves that there is none.
            return replace(verdict, answer=otherwise, notes=() if outcome.begins else never_begins(query))
        case LivenessStatus.FOUND:
            if not outcome.exact:
                return replace(verdict, exact=False, reason=_INEXACT)
            return replace(verdict, answer=on_found)
        case never:
            assert_never(never)


def _shown(
    model: PreparedNetwork, verdict: Verdict, outcome: LivenessOutcome, obligation: Obligation, limits: Limits
) -> Verdict:
    """The verdict with the run that shows it. Where clocks stop, the run decides whether there is one.

    Raises InternalError if there is none although the search is exact.
    """
    assert outcome.run is not None
    seconds = _SECONDS_FOR_DELAYS if limits.seconds is None else min(limits.seconds, _SECONDS_FOR_DELAYS)
    problem = "it has no delays"
    try:
        with time_limit(seconds):
            run = lasso(model, outcome.run, obligation)
            if run is not None:
                replay_lasso(model, run, obligation.goal, obligation.trigger)
    except OutOfTimeError:
        return replace(verdict, notes=(*verdict.notes, _NO_DELAYS)) if outcome.exact else verdict
    except ReplayError as error:
        run, problem = None, str(error)
    if run is not None:
        return replace(verdict, answer=answers_of(verdict.query)[0], exact=True, reason="", trace=run)
    if outcome.exact:
        raise InternalError(f"the run found for {verdict.query.text!r} does not replay: {problem}")
    return verdict


def answers_of(query: Query) -> tuple[Answer, Answer]:
    """The answers where a run is found that avoids what it should meet, and where there is none."""
    if query.kind is QueryKind.POTENTIALLY_ALWAYS:
        return Answer.HOLDS, Answer.FAILS
    return Answer.FAILS, Answer.HOLDS
