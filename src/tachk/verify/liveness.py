"""Strategies for queries that no single state decides: whether some run avoids a predicate for ever.

No process is frozen: one that is outside the cone of influence of the predicates may still run for ever, or stop time.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import assert_never

from tachk.base.diagnostics.diagnostic import InternalError
from tachk.base.job import StoppedError, limited, unhurried
from tachk.base.records import dataclass, replace
from tachk.engine.compiler.lower import lower_obligation, lower_recurrence
from tachk.engine.exact.concretise import discrete_run
from tachk.engine.lasso import lasso
from tachk.engine.liveness import find_avoiding_run, find_recurring_run
from tachk.engine.options import Limits, Options
from tachk.engine.outcome import AvoidingRun, LivenessOutcome, LivenessStatus, Obligation, RunEnd
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
from tachk.model.run import DiscreteState, TimedState, TimedTrace
from tachk.transform.accompanied_run import accompanied
from tachk.transform.doubled_edges import DoubledNetwork, strongly_non_zeno
from tachk.transform.liveness_slice import liveness_preserving_slice
from tachk.transform.transformation import Transformation, unchanged
from tachk.verify.fault_explanation import explain
from tachk.verify.plan import Task
from tachk.verify.strategy import Findings, Problem
from tachk.verify.unexamined import unexamined
from tachk.verify.vacuity import never_begins
from tachk.verify.verdict import Answer, Verdict, answers_of


@dataclass(frozen=True, slots=True)
class SearchedRun:
    """The outcome of a search for runs, and the doubled network that it searched; None: the network itself."""

    outcome: LivenessOutcome
    obligation: Obligation
    instrumented: DoubledNetwork | None = None


@dataclass(frozen=True, slots=True)
class RunOfSlice:
    """A run of the slice that preserves liveness."""

    reduced: Transformation
    searched: SearchedRun


def sliced(problem: Problem) -> Findings:
    """Searches the slice that preserves liveness.

    Only that there is no run is an answer: one that is found has to be one of the whole network (`accompanied_run`).
    """
    verdicts, runs = {}, {}
    for task in problem.tasks:
        reduced = _reduced(problem.network, task.query)
        if reduced.network is problem.network:
            continue
        # The slice may lack the part that meets a condition again: a run that does not need it decides nothing.
        query = replace(task.query, again=(), ends=None)
        searched = searched_for(prepare(reduced.network), query, problem)
        verdict = replace(outcome_of(query, searched.outcome), query=task.query)
        if verdict.answer is answers_of(task.query)[1]:
            with unhurried():
                left_out = unexamined(problem.network, reduced.network)
            verdicts[task.number] = replace(verdict, unexamined=left_out)
        elif verdict.answer is Answer.UNKNOWN and verdict.fault is None and verdict.exact:
            verdicts[task.number] = verdict
        elif searched.outcome.run is not None and query == task.query:
            runs[task.number] = RunOfSlice(reduced, searched)
    return Findings(verdicts, partial=runs)


def some_states(problem: Problem) -> Findings:
    """Searches some states of the whole network where the slice has a run: most runs are found at once."""
    found = [task.number for task in problem.tasks if isinstance(problem.partial.get(task.number), RunOfSlice)]
    return Findings(any_run(problem.about(found)).verdicts)


def accompanied_run(problem: Problem) -> Findings:
    """Carries a run of the slice over: the others do nothing as long as they can.

    Only a run that the judge accepts is an answer.
    """
    verdicts = {}
    for task in problem.tasks:
        found = problem.partial.get(task.number)
        if isinstance(found, RunOfSlice):
            try:
                with unhurried(LEAST_SECONDS_FOR_DELAYS), limited(SECONDS_FOR_OTHERS):
                    run = _accompanied_run(problem.model, found)
            except StoppedError:
                continue
            if run is not None:
                verdict = outcome_of(task.query, found.searched.outcome)
                verdicts[task.number] = replace(verdict, trace=run if problem.trace else None)
    return Findings(verdicts)


def _accompanied_run(model: PreparedNetwork, found: RunOfSlice) -> TimedTrace | None:
    """The run, as one of the whole network; None if there is none."""
    run, obligation = found.searched.outcome.run, found.searched.obligation
    assert run is not None
    conditions = [one for one in (obligation.goal, obligation.trigger) if one is not None]
    part = lasso(prepare(found.reduced.network), run, obligation)
    whole = None if part is None else accompanied(model, found.reduced, part, conditions)
    if whole is None:
        return None
    try:
        return replace(whole, due=replay_lasso(model, whole, obligation.goal, obligation.trigger))
    except ReplayError:
        return None


def _reduced(network: Network, query: Query) -> Transformation:
    """The slice of the network that preserves liveness, where any run that avoids the goal counts."""
    if query.non_zeno:
        return unchanged(network)
    return liveness_preserving_slice(network, conditions_of(query))


def conditions_of(query: Query) -> list[Expression]:
    """What a query avoids, and where that begins."""
    return [one for one in (query.avoided, query.begins) if one is not None]


def any_run(problem: Problem) -> Findings:
    """Searches for any run that avoids the goal: where there is none, there is none that counts."""
    verdicts, runs = {}, {}
    for task in problem.tasks:
        searched = searched_for(problem.model, task.query, problem)
        if _is_answer(problem.model, task.query, searched):
            verdicts[task.number] = _finished(problem, task, searched)
        else:
            runs[task.number] = searched
    return Findings(verdicts, partial=runs)


def recurring(problem: Problem) -> Findings:
    """Searches for runs that meet each predicate again and again, or end where they may."""
    verdicts = {}
    for task in problem.tasks:
        first = problem.partial.get(task.number)
        if isinstance(first, SearchedRun) and not task.query.non_zeno:
            second = _recurring(problem.network, first.obligation, problem.options, problem.limits)
            verdicts[task.number] = _finished(problem, task, replace(first, outcome=_after(first.outcome, second)))
    return Findings(verdicts)


def short_delays(problem: Problem) -> Findings:
    """A search for runs in which a time unit passes again and again, which finds short loops soon."""
    return _diverging(problem, lambda longest: 1 if longest > 1 else None)


def long_delays(problem: Problem) -> Findings:
    """A search for runs in which as much time passes again and again as anything in the network waits for: that there
    is none takes many times fewer states so."""
    return _diverging(problem, lambda longest: max(longest, 1))


def _diverging(problem: Problem, length_of: Callable[[int], int | None]) -> Findings:
    verdicts, runs = {}, {}
    for task in problem.tasks:
        first = problem.partial.get(task.number)
        if not isinstance(first, SearchedRun) or not task.query.non_zeno:
            continue
        query = task.query
        obligation = Obligation(_goal(query), query.begins, query.again, query.ends)
        predicates = [one for one in (obligation.goal, obligation.trigger) if one is not None]
        length = length_of(max(clock_constants(problem.network, predicates).maximum, default=0))
        if length is None:
            continue
        instrumented = strongly_non_zeno(problem.network, length)
        counting = replace(obligation, again=(*query.again, _counted(problem.network, query, instrumented)))
        second = _recurring(instrumented.network, counting, problem.options, problem.limits)
        searched = SearchedRun(_after(first.outcome, second), counting, instrumented)
        verdicts[task.number] = _finished(problem, task, searched)
        runs[task.number] = searched
    return Findings(verdicts, partial=runs)


def _finished(problem: Problem, task: Task, searched: SearchedRun) -> Verdict:
    """The verdict, with its run."""
    query, outcome = task.query, searched.outcome
    if outcome.fault is not None:
        with unhurried():
            fault = outcome.fault if searched.instrumented is None else searched.instrumented.lift_fault(outcome.fault)
        outcome = replace(outcome, fault=explain(problem.model, fault))
    verdict = outcome_of(query, outcome)
    if outcome.run is not None and (problem.trace or not outcome.exact):
        verdict = _shown(problem.model, verdict, searched)
    if searched.instrumented is not None and not query.again and outcome.status is LivenessStatus.NONE:
        verdict = replace(verdict, notes=(*verdict.notes, _ZENO_ONLY))
    return verdict


def _goal(query: Query) -> Expression:
    assert query.avoided is not None
    return query.avoided


def searched_for(model: PreparedNetwork, query: Query, problem: Problem) -> SearchedRun:
    """A search for any run that avoids the goal, with the options and limits of a problem."""
    avoided, begins, options = _goal(query), query.begins, problem.options
    program, goal, trigger = lower_obligation(model.network, avoided, begins)
    conditions = conditions_of(query)
    if options.symmetry:
        program = with_symmetry(program, model.network, conditions)
    outcome = find_avoiding_run(program, goal, trigger, options, problem.limits)
    return SearchedRun(outcome, Obligation(avoided, begins, query.again, query.ends))


@unhurried()
def _is_answer(model: PreparedNetwork, query: Query, searched: SearchedRun) -> bool:
    """True if the run that was found counts, or none was found."""
    run = searched.outcome.run
    if run is None:
        return True
    ends = run.end is not RunEnd.LOOP
    if query.non_zeno and not ends:
        return False
    return not query.again or _counts(model, run, searched.obligation)


def _counts(model: PreparedNetwork, run: AvoidingRun, obligation: Obligation) -> bool:
    """True if a run that avoids the goal meets what it has to meet again and again, or ends where it may.

    The queries speak of locations and variables only.
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


def _recurring(network: Network, obligation: Obligation, options: Options, limits: Limits) -> LivenessOutcome:
    ends = Constant(1, BOOL) if obligation.ends is None else obligation.ends
    program, goals = lower_recurrence(network, obligation.goal, ends, obligation.trigger, obligation.again)
    return find_recurring_run(program, goals, obligation.trigger is not None, options, limits)


def _counted(network: Network, query: Query, instrumented: DoubledNetwork) -> Expression:
    """The predicate that a run that counts meets again and again: time passes, or an observer has seen a violation,
    after which the rest of the run does not matter."""
    if query.observer is None:
        return instrumented.mark
    return either(instrumented.mark, LocationTest(len(network.processes) - 1, query.observer.bad))


def _has_shown(query: Query, run: TimedTrace) -> bool:
    return query.observer is not None and run.states[-1].discrete.locations[-1] == query.observer.bad


_ZENO_ONLY = "only runs with infinitely many transitions in finite time would give another answer"

_INEXACT = "the stopwatches make the search inexact, and the run it found may not be possible"

NO_DELAYS = "a run that shows it was found, but there was no time to find its delays"

SECONDS_FOR_OTHERS = 5.0
"""The longest time in which a run of the slice is carried over to the whole network."""

SECONDS_FOR_DELAYS, LEAST_SECONDS_FOR_DELAYS = 30.0, 1.0
"""The longest and the shortest time that the search for the delays of a found run gets, whatever the limits."""


def outcome_of(query: Query, outcome: LivenessOutcome) -> Verdict:
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


def _shown(model: PreparedNetwork, verdict: Verdict, searched: SearchedRun) -> Verdict:
    """The verdict with the run that shows it. Where clocks stop, the run decides whether there is one.

    Raises InternalError if there is none although the search is exact.
    """
    outcome = searched.outcome
    problem = "it has no delays"
    try:
        with unhurried(LEAST_SECONDS_FOR_DELAYS), limited(SECONDS_FOR_DELAYS):
            run = _replayed_run(model, verdict.query, searched)
    except StoppedError:
        return replace(verdict, notes=(*verdict.notes, NO_DELAYS)) if outcome.exact else verdict
    except ReplayError as error:
        run, problem = None, str(error)
    if run is not None:
        return replace(verdict, answer=answers_of(verdict.query)[0], exact=True, reason="", trace=run)
    if outcome.exact:
        raise InternalError(f"the run found for {verdict.query.text!r} does not replay: {problem}")
    return verdict


def _replayed_run(model: PreparedNetwork, query: Query, searched: SearchedRun) -> TimedTrace | None:
    """The run with its delays, as one of the model; None if there are none. Raises ReplayError."""
    assert searched.outcome.run is not None
    obligation, instrumented = searched.obligation, searched.instrumented
    whole = model if instrumented is None else prepare(instrumented.network)
    run = lasso(whole, searched.outcome.run, obligation)
    if run is None:
        return None
    due = replay_lasso(whole, run, obligation.goal, obligation.trigger, obligation.again, obligation.ends)
    if instrumented is not None:
        run = instrumented.lift(run)
        conditions = obligation.goal, obligation.trigger, query.again, obligation.ends
        due = replay_lasso(model, run, *conditions, diverges=not _has_shown(query, run))
    return replace(run, due=due)
