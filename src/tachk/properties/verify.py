"""Queries about a network become verdicts."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from functools import partial

from tachk.certify.replay import ReplayError, replay
from tachk.compiler.features import check_selections, check_supported
from tachk.compiler.lower import lower
from tachk.diagnostics.diagnostic import Diagnostic, InputError, InternalError, UnsupportedError
from tachk.engines.concretise import concretise
from tachk.engines.options import Limits, Options
from tachk.engines.outcome import INTERRUPTED, TIME_LIMIT, GoalOutcome, Outcome, Progress, Statistics, Status
from tachk.engines.zone import explore
from tachk.model.fault import EvaluationFault
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.properties.fault_explanation import explain
from tachk.properties.observed import (
    ObserverMove,
    check_observable,
    fault_without_observer,
    observed,
    without_observer,
)
from tachk.properties.plan import Search, Task, plan
from tachk.properties.unexamined import unexamined
from tachk.properties.verdict import Answer, Verdict
from tachk.reduction.bystanders import without_bystanders
from tachk.reduction.spectators import every_action_counts, with_spectators, without_spectators
from tachk.semantics.discrete import PreparedNetwork, initial_discrete, prepare
from tachk.semantics.step import StepError, satisfies_invariant
from tachk.semantics.timed_trace import TimedState, TimedTrace
from tachk.time_limit import OutOfTimeError, time_limit

VerifyProgress = Callable[[Statistics, tuple[str, ...]], None]
"""What is told during a long search: the statistics so far, and the names of the queries that it is about to answer."""


def verify(
    network: Network,
    queries: Sequence[Query],
    options: Options = Options(),
    limits: Limits = Limits(),
    progress: VerifyProgress | None = None,
    trace: bool = True,
) -> tuple[Verdict, ...]:
    """Answer queries about a network, in their order.

    A query that cannot be checked gets the answer UNKNOWN with the diagnostic that says why; the others are not
    affected. Every trace has been replayed by `tachk.certify` before it is returned; without ``trace`` none is made
    except where it is needed to decide. Several searches may be needed. Each query has the same share of the seconds
    that are left when its search begins, so what one does not need is there for the others; preparing the model and
    compiling it count. The other limits hold for each search. The run behind an answer is made in any case.

    Raises:
        InputError: the initial state violates an invariant.
        UnsupportedError: the network itself uses a feature that cannot be checked.
    """
    started = time.monotonic()
    verdicts: dict[int, Verdict] = {}
    try:
        with time_limit(limits.seconds):
            check_selections(network)
            model = prepare(network)
            check_initial_state(model)
            tasks = []
            for number, query in enumerate(queries):
                try:
                    check_observable(network, query)
                    check_supported(network, query)
                except UnsupportedError as error:
                    verdicts[number] = _unsupported(query, error.diagnostic)
                else:
                    tasks.append(Task.of(number, query))
            searches = plan(tasks)
    except OutOfTimeError:
        return tuple(verdicts.get(number) or _not_begun(query, TIME_LIMIT) for number, query in enumerate(queries))
    interrupted = False
    left = len(tasks)
    for search in searches:
        if interrupted:
            found = _none_begun(search.tasks, INTERRUPTED)
        else:
            own = _share(_remaining(limits, started), Fraction(len(search.tasks), left))
            names = tuple(task.query.name for task in search.tasks)
            told = None if progress is None else partial(_tell, progress, names)
            try:
                found = _run(model, search, options, own, told, trace)
            except KeyboardInterrupt:
                # What was decided before is kept, wherever the interruption comes.
                found = _none_begun(search.tasks, INTERRUPTED)
            interrupted = any(verdict.reason == INTERRUPTED for verdict in found.values())
        left -= len(search.tasks)
        verdicts |= found
    return _examined(network, [verdicts[number] for number in range(len(queries))])


def _examined(network: Network, verdicts: Sequence[Verdict]) -> tuple[Verdict, ...]:
    """The verdicts; if one of them was proved by exploring everything, no run-time error was overlooked for any."""
    for verdict in verdicts:
        if _explored_everything(network, verdict):
            return tuple(replace(other, unexamined=()) for other in verdicts)
    return tuple(verdicts)


def _explored_everything(network: Network, verdict: Verdict) -> bool:
    query = verdict.query
    targets = () if query.target is None else (query.target,)
    proved = bool(targets) and verdict.answer is _answers(query)[1]
    return proved and query.observer is None and every_action_counts(network, targets)


def _tell(progress: VerifyProgress, names: tuple[str, ...], statistics: Statistics) -> None:
    progress(statistics, names)


def _share(limits: Limits, part: Fraction) -> Limits:
    """The limits of one search, which may use a part of the seconds that are left."""
    of_all = None if limits.seconds is None else limits.seconds * part.numerator / part.denominator
    allowed = [seconds for seconds in (of_all, limits.seconds_each) if seconds is not None]
    return replace(limits, seconds=min(allowed, default=None))


def _remaining(limits: Limits, started: float) -> Limits:
    return limits.after(time.monotonic() - started)


def _not_begun(query: Query, reason: str) -> Verdict:
    return Verdict(query, Answer.UNKNOWN, True, reason, Statistics())


def _none_begun(tasks: Iterable[Task], reason: str) -> dict[int, Verdict]:
    return {task.number: _not_begun(task.query, reason) for task in tasks}


def check_initial_state(model: PreparedNetwork) -> None:
    """Raises InputError (E0409) where the initial state violates an invariant."""
    start = TimedState(initial_discrete(model), (Fraction(0),) * (model.dimension - 1), Fraction(0))
    violated = []
    for number, process in enumerate(model.network.processes):
        # An invariant that cannot be evaluated is a run-time error, which the search reports.
        with suppress(EvaluationFault):
            if not satisfies_invariant(model, start, number):
                violated.append((process.name, process.locations[process.initial]))
    if violated:
        raise InputError(
            Diagnostic(
                "E0409",
                f"the invariant of the initial location {name}.{location.name} does not hold in the initial state",
                location.span,
                "every clock starts at 0 and every variable at its initial value",
            )
            for name, location in violated
        )


def refused(queries: Iterable[Query], reason: Diagnostic) -> tuple[Verdict, ...]:
    """The verdicts about a model that has something tachk does not check, so that no query can be decided."""
    return tuple(_unsupported(query, reason) for query in queries)


def _unsupported(query: Query, diagnostic: Diagnostic) -> Verdict:
    return Verdict(query, Answer.UNKNOWN, True, diagnostic.message, Statistics(), unsupported=diagnostic)


def _run(
    model: PreparedNetwork, search: Search, options: Options, limits: Limits, progress: Progress | None, trace: bool
) -> dict[int, Verdict]:
    """The verdicts about the tasks of a search, by number."""
    started = time.monotonic()
    try:
        with time_limit(limits.seconds):
            if search.observer is not None:
                model = prepare(observed(model.network, search.observer))
    except OutOfTimeError:
        return _none_begun(search.tasks, TIME_LIMIT)
    settled = {}
    if options.drop_bystanders:
        settled = _settle_without_bystanders(model.network, search, options, limits, progress)
    if any(verdict.reason == INTERRUPTED for verdict in settled.values()):
        return settled
    limits = _remaining(limits, started)
    rest = replace(search, tasks=tuple(task for task in search.tasks if task.number not in settled))
    return settled | (_explore(model, rest, options, limits, progress, trace) if rest.tasks else {})


_FIRST_TRY = 1_000_000
"""How many states may be stored without bystanders, which may have more states than the whole network."""


def _settle_without_bystanders(
    network: Network, search: Search, options: Options, limits: Limits, progress: Progress | None
) -> dict[int, Verdict]:
    """The verdicts about targets that are unreachable even if nothing hinders the processes they depend on."""
    started = time.monotonic()
    targets = [task.target for task in search.tasks]
    first_try = replace(
        limits,
        states=_FIRST_TRY if limits.states is None else min(limits.states, _FIRST_TRY),
        seconds=None if limits.seconds is None else limits.seconds / 2,
    )
    try:
        with time_limit(first_try.seconds):
            relaxed = without_bystanders(network, targets)
            if relaxed == network:
                return {}
            program, goals = lower(relaxed, targets)
    except OutOfTimeError:
        return {}
    outcome = explore(program, goals, options, _remaining(first_try, started), progress)
    if outcome.reason == INTERRUPTED:
        return _none_begun(search.tasks, INTERRUPTED)
    left_out = unexamined(network, relaxed)
    return {
        task.number: Verdict(task.query, _answers(task.query)[1], True, "", outcome.statistics, unexamined=left_out)
        for task, goal in zip(search.tasks, outcome.goals, strict=True)
        if goal.status is Status.UNREACHABLE
    }


def _explore(
    model: PreparedNetwork, search: Search, options: Options, limits: Limits, progress: Progress | None, trace: bool
) -> dict[int, Verdict]:
    started = time.monotonic()
    network = model.network
    targets = [task.target for task in search.tasks]
    try:
        with time_limit(limits.seconds):
            reduced = without_spectators(network, targets) if options.hold_spectators else network
            program, goals = lower(reduced, targets)
    except OutOfTimeError:
        return _none_begun(search.tasks, TIME_LIMIT)
    outcome = explore(program, goals, options, _remaining(limits, started), progress)
    searched = model if reduced == network else prepare(reduced)
    if outcome.fault is not None:
        fault = explain(searched, outcome.fault, limits.seconds)
        if fault.run is not None:
            fault = replace(fault, run=_whole_run(model, searched, fault.run))
        outcome = replace(outcome, fault=fault if search.observer is None else fault_without_observer(network, fault))
    verdicts: dict[int, Verdict] = {}
    for task, goal in zip(search.tasks, outcome.goals, strict=True):
        verdict = _verdict(model, searched, task, goal, outcome, trace)
        if verdict is None:
            everything = replace(options, hold_spectators=False)
            rest = limits
            if limits.seconds is not None:
                rest = replace(limits, seconds=max(limits.seconds - outcome.statistics.seconds, 0.0))
            verdicts |= _explore(model, replace(search, tasks=(task,)), everything, rest, progress, trace)
        else:
            verdicts[task.number] = verdict
    return verdicts


def _whole_run(model: PreparedNetwork, searched: PreparedNetwork, run: TimedTrace) -> TimedTrace | None:
    """A run of the whole network that is a run of the reduced one; None where a spectator meets an error on the way."""
    try:
        return with_spectators(model, searched.network, run)
    except (StepError, EvaluationFault):
        return None


def _answers(query: Query) -> tuple[Answer, Answer]:
    """The answers where the target is reachable and where it is not."""
    return (Answer.HOLDS, Answer.FAILS) if query.holds_when_reached else (Answer.FAILS, Answer.HOLDS)


_INEXACT = "the stopwatches make the search inexact, and the run it found is not possible"


def _verdict(
    model: PreparedNetwork, searched: PreparedNetwork, task: Task, goal: GoalOutcome, outcome: Outcome, trace: bool
) -> Verdict | None:
    """The verdict; None if the run that was found meets a run-time error of a process that was held still."""
    on_reached, otherwise = _answers(task.query)
    network, reduced = model.network, searched.network
    verdict = Verdict(task.query, Answer.UNKNOWN, outcome.exact, outcome.reason, outcome.statistics)
    if goal.status is Status.UNDECIDED:
        return replace(verdict, exact=True, fault=outcome.fault)
    if goal.status is Status.UNREACHABLE:
        # An over-approximation that does not reach the target proves that nothing does.
        return replace(verdict, answer=otherwise, exact=True, reason="", unexamined=unexamined(network, reduced))
    if not trace and outcome.exact:
        return replace(verdict, answer=on_reached, reason="", unexamined=unexamined(network, reduced))
    run = concretise(searched, goal.path or (), task.target)
    if run is None:
        if outcome.exact:
            raise InternalError(f"the path found for {task.query.text!r} has no timed run")
        return replace(verdict, reason=_INEXACT)
    whole = _whole_run(model, searched, run)
    if whole is None:
        return None if outcome.exact else replace(verdict, reason=_INEXACT)
    run = whole
    try:
        replay(model, run, task.target)
    except ReplayError as error:
        if not outcome.exact:
            return replace(verdict, reason=_INEXACT)
        raise InternalError(f"the run found for {task.query.text!r} does not replay: {error}") from error
    moves: tuple[ObserverMove, ...] = ()
    if task.query.observer is not None:
        run, moves = without_observer(network, run)
    return replace(verdict, answer=on_reached, exact=True, reason="", trace=run, moves=moves)
