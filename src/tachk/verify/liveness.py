"""Queries that no single state decides: whether some run avoids a predicate for ever."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from typing import assert_never

from tachk.base.diagnostics.diagnostic import InternalError
from tachk.base.records import dataclass
from tachk.base.time_limit import OutOfTimeError, time_limit
from tachk.base.words import QueryKind
from tachk.engine.compiler.lower import lower_obligation, lower_recurrence
from tachk.engine.exact.concretise import discrete_run
from tachk.engine.lasso import lasso
from tachk.engine.liveness import find_avoiding_run, find_recurring_run
from tachk.engine.options import Limits, Options
from tachk.engine.outcome import AvoidingRun, LivenessOutcome, LivenessStatus, Obligation, Progress, RunEnd
from tachk.engine.symmetry.tables import with_symmetry
from tachk.meaning.clock_constants import clock_constants
from tachk.meaning.discrete import PreparedNetwork, prepare
from tachk.meaning.judge.replay import ReplayError
from tachk.meaning.judge.replay_lasso import replay_lasso
from tachk.meaning.step import satisfies
from tachk.model.connectives import either
from tachk.model.expressions import BOOL, Constant, Expression, LocationTest
from tachk.model.fault import EvaluationFault
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.model.run import DiscreteState, RunTimeFault, TimedState, TimedTrace
from tachk.model.traversal import asks_deadlock, clock_in
from tachk.transform.doubled_edges import DoubledNetwork, with_beats
from tachk.verify.fault_explanation import explain
from tachk.verify.plan import Search, Task
from tachk.verify.semantic_lint.unobtrusive import without_unobtrusive
from tachk.verify.unanswered import not_begun
from tachk.verify.unexamined import unexamined
from tachk.verify.vacuity import never_begins
from tachk.verify.verdict import Answer, Verdict


def answer(
    model: PreparedNetwork, search: Search, options: Options, limits: Limits, progress: Progress | None, trace: bool
) -> dict[int, Verdict]:
    """The verdicts about the tasks of a search, by number.

    Spectators are not held still: one that cannot influence the predicates may still run for ever, or stop time. Left
    out is what certainly does neither.
    """
    return {task.number: _verdict(model, task, options, limits, progress, trace) for task in search.tasks}


@dataclass(frozen=True, slots=True)
class _Searched:
    """What a search has found, and where: in the network with beats, or (None) in the network itself."""

    outcome: LivenessOutcome
    obligation: Obligation
    beating: DoubledNetwork | None = None


def _verdict(
    model: PreparedNetwork, task: Task, options: Options, limits: Limits, progress: Progress | None, trace: bool
) -> Verdict:
    started = time.monotonic()
    try:
        with time_limit(limits.seconds):
            reduced = _reduced(model.network, task.query) if options.drop_bystanders else model.network
    except OutOfTimeError as error:
        return not_begun(task.query, error.reason)
    left = limits.after(time.monotonic() - started)
    if reduced == model.network:
        return _of_network(model, task, options, left, progress, trace)
    # What is left out may be what meets something again and again: a run that does not need it decides nothing there.
    weaker = replace(task, query=replace(task.query, again=(), ends=None))
    verdict = _of_network(prepare(reduced), weaker, options, left, progress, trace=False)
    verdict = replace(verdict, query=task.query)
    no_run = verdict.answer is answers_of(task.query)[1]
    if no_run or (verdict.answer is Answer.UNKNOWN and verdict.fault is None and verdict.exact):
        return replace(verdict, unexamined=unexamined(model.network, reduced) if no_run else ())
    # There is a run, which is to be shown as one of the whole network.
    return _of_network(model, task, options, limits.after(time.monotonic() - started), progress, trace)


def _reduced(network: Network, query: Query) -> Network:
    """The network without what nobody notices, where any run that avoids the goal counts."""
    if query.non_zeno:
        return network
    return without_unobtrusive(network, [one for one in (query.avoided, query.begins) if one is not None])


def _of_network(
    model: PreparedNetwork, task: Task, options: Options, limits: Limits, progress: Progress | None, trace: bool
) -> Verdict:
    """The verdict from a search of one network."""
    started = time.monotonic()
    query = task.query
    try:
        searched = _searched(model, query, options, limits, progress)
    except OutOfTimeError as error:
        return not_begun(query, error.reason)
    outcome = searched.outcome
    if outcome.fault is not None:
        outcome = replace(outcome, fault=explain(model, fault_alone(outcome.fault, searched.beating), limits.seconds))
    verdict = _of_outcome(query, outcome)
    if outcome.run is not None and (trace or not outcome.exact):
        verdict = _shown(model, verdict, searched, limits.after(time.monotonic() - started))
    if searched.beating is not None and not query.again and outcome.status is LivenessStatus.NONE:
        verdict = replace(verdict, notes=(*verdict.notes, _ZENO_ONLY))
    return verdict


def fault_alone(fault: RunTimeFault, doubled: DoubledNetwork | None) -> RunTimeFault:
    """An error of a network in which actions are there twice, told of the network alone."""
    if doubled is None:
        return fault
    failed = None if fault.transition is None else doubled.without_copies(fault.transition)
    run = None if fault.run is None else doubled.run_alone(fault.run)
    return replace(fault, path=tuple(map(doubled.without_copies, fault.path)), transition=failed, run=run)


def _searched(
    model: PreparedNetwork, query: Query, options: Options, limits: Limits, progress: Progress | None
) -> _Searched:
    """Looks for any run first: where there is none, there is none that counts. Raises OutOfTimeError."""
    started = time.monotonic()
    avoided, begins = query.avoided, query.begins
    assert avoided is not None
    with time_limit(limits.seconds):
        program, goal, trigger = lower_obligation(model.network, avoided, begins)
        asked = [one for one in (avoided, begins) if one is not None]
        if options.symmetry and not any(asks_deadlock(one) or clock_in(one) is not None for one in asked):
            program = with_symmetry(program, model.network, asked)
    left = limits.after(time.monotonic() - started)
    first = find_avoiding_run(program, goal, trigger, options, left, progress)
    obligation = Obligation(avoided, begins, query.again, query.ends)
    ends = first.run is not None and first.run.end is not RunEnd.LOOP
    if first.run is None or not (query.again or (query.non_zeno and not ends)):
        return _Searched(first, obligation)
    if not (query.non_zeno and not ends) and _counts(model, first.run, obligation):
        return _Searched(first, obligation)
    if not query.non_zeno:
        second = _recurring(model.network, obligation, options, limits.after(time.monotonic() - started), progress)
        return _Searched(_after(first, second), obligation)
    searched = _Searched(first, obligation)
    for length, states in _beats(model.network, obligation, limits):
        beating = with_beats(model.network, length)
        counting = replace(obligation, again=(*query.again, _counted(model.network, query, beating)))
        left = replace(limits, states=states).after(time.monotonic() - started)
        second = _recurring(beating.network, counting, options, left, progress)
        searched = _Searched(_after(searched.outcome, second), counting, beating)
        if second.reason != _STATE_LIMIT:
            break
    return searched


def _counts(model: PreparedNetwork, run: AvoidingRun, obligation: Obligation) -> bool:
    """Whether a run that avoids the goal meets what it has to meet again and again, or ends where it may.

    What is asked speaks of locations and variables only.
    """
    states, _ = discrete_run(model, [*run.stem, *run.loop])

    def satisfied(state: DiscreteState, predicate: Expression) -> bool:
        return satisfies(model, TimedState(state, (Fraction(0),) * (model.dimension - 1), Fraction(0)), predicate)

    try:
        if run.end is not RunEnd.LOOP:
            return obligation.ends is None or satisfied(states[-1], obligation.ends)
        rounds = states[len(run.stem) + 1 :]
        return all(any(satisfied(state, predicate) for state in rounds) for predicate in obligation.again)
    except EvaluationFault:
        return False


def _after(first: LivenessOutcome, second: LivenessOutcome) -> LivenessOutcome:
    """The second outcome, with the work of both."""
    return replace(second, statistics=first.statistics.then(second.statistics))


def _recurring(
    network: Network, obligation: Obligation, options: Options, limits: Limits, progress: Progress | None
) -> LivenessOutcome:
    started = time.monotonic()
    ends = Constant(1, BOOL) if obligation.ends is None else obligation.ends
    with time_limit(limits.seconds):
        program, goals = lower_recurrence(network, obligation.goal, ends, obligation.trigger, obligation.again)
    left = limits.after(time.monotonic() - started)
    return find_recurring_run(program, goals, obligation.trigger is not None, options, left, progress)


_STATE_LIMIT = "state limit"

_SHORT_BEATS = 2000
"""How many states the search with the shortest beats may store: it finds short loops soon. That there is none takes
many times fewer states where a beat is as long as anything that the network waits for."""


def _beats(network: Network, obligation: Obligation, limits: Limits) -> Iterator[tuple[int, int | None]]:
    """How long a beat is to be, and how many states may be stored then."""
    predicates = [one for one in (obligation.goal, obligation.trigger) if one is not None]
    longest = max(clock_constants(network, predicates).maximum, default=0)
    if longest > 1 and (limits.states is None or limits.states > _SHORT_BEATS):
        yield 1, _SHORT_BEATS
    yield max(longest, 1), limits.states


def _counted(network: Network, query: Query, beating: DoubledNetwork) -> Expression:
    """What shows again and again that a run counts: time passes, or an observer has seen a violation, after which it
    does not matter how the run goes on."""
    if query.observer is None:
        return beating.mark
    return either(beating.mark, LocationTest(len(network.processes) - 1, query.observer.bad))


def _has_shown(query: Query, run: TimedTrace) -> bool:
    return query.observer is not None and run.states[-1].discrete.locations[-1] == query.observer.bad


_ZENO_ONLY = "only runs with infinitely many transitions in finite time would give another answer"

_INEXACT = "the stopwatches make the search inexact, and the run it found may not be possible"

NO_DELAYS = "a run that shows it was found, but there was no time to find its delays"

SECONDS_FOR_DELAYS = 30.0
"""How long the delays of a run that was found are looked for, whatever the limits."""


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


def _shown(model: PreparedNetwork, verdict: Verdict, searched: _Searched, limits: Limits) -> Verdict:
    """The verdict with the run that shows it. Where clocks stop, the run decides whether there is one.

    Raises InternalError if there is none although the search is exact.
    """
    outcome = searched.outcome
    seconds = SECONDS_FOR_DELAYS if limits.seconds is None else min(limits.seconds, SECONDS_FOR_DELAYS)
    problem = "it has no delays"
    try:
        with time_limit(seconds):
            run = _judged(model, verdict.query, searched)
    except OutOfTimeError:
        return replace(verdict, notes=(*verdict.notes, NO_DELAYS)) if outcome.exact else verdict
    except ReplayError as error:
        run, problem = None, str(error)
    if run is not None:
        return replace(verdict, answer=answers_of(verdict.query)[0], exact=True, reason="", trace=run)
    if outcome.exact:
        raise InternalError(f"the run found for {verdict.query.text!r} does not replay: {problem}")
    return verdict


def _judged(model: PreparedNetwork, query: Query, searched: _Searched) -> TimedTrace | None:
    """The run with its delays, as one of the model; None if there are none. Raises ReplayError."""
    assert searched.outcome.run is not None
    obligation, beating = searched.obligation, searched.beating
    whole = model if beating is None else prepare(beating.network)
    run = lasso(whole, searched.outcome.run, obligation)
    if run is None:
        return None
    due = replay_lasso(whole, run, obligation.goal, obligation.trigger, obligation.again, obligation.ends)
    if beating is not None:
        run = beating.run_alone(run)
        asked = obligation.goal, obligation.trigger, query.again, obligation.ends
        due = replay_lasso(model, run, *asked, diverges=not _has_shown(query, run))
    return replace(run, due=due)


def answers_of(query: Query) -> tuple[Answer, Answer]:
    """The answers where a run is found that avoids what it should meet, and where there is none."""
    if query.kind is QueryKind.POTENTIALLY_ALWAYS:
        return Answer.HOLDS, Answer.FAILS
    return Answer.FAILS, Answer.HOLDS
