"""Queries that one state decides: whether some state of a set can be reached."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace

from tachk.certify.replay import ReplayError, replay
from tachk.compiler.lower import lower
from tachk.compiler.program import Goal, Program
from tachk.diagnostics.diagnostic import InternalError
from tachk.engines.concretise import concretise
from tachk.engines.options import Limits, Options
from tachk.engines.outcome import INTERRUPTED, TIME_LIMIT, GoalOutcome, Outcome, Progress, Status
from tachk.engines.zone import explore
from tachk.model.expressions import Expression
from tachk.model.fault import EvaluationFault
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.properties.fault_explanation import explain
from tachk.properties.observed import ObserverMove, fault_without_observer, observed, without_observer
from tachk.properties.plan import Search, Task
from tachk.properties.unanswered import none_begun
from tachk.properties.unexamined import unexamined
from tachk.properties.vacuity import Trigger, noted, triggers_of, with_notes
from tachk.properties.verdict import Answer, Verdict
from tachk.reduction.bystanders import without_bystanders
from tachk.reduction.impossible import without_impossible
from tachk.reduction.spectators import with_spectators, without_spectators
from tachk.reduction.symmetry.tables import in_equal_parts, with_symmetry
from tachk.semantics.discrete import PreparedNetwork, prepare
from tachk.semantics.step import StepError
from tachk.semantics.timed_trace import TimedTrace
from tachk.time_limit import OutOfTimeError, time_limit


def answer(
    model: PreparedNetwork, search: Search, options: Options, limits: Limits, progress: Progress | None, trace: bool
) -> dict[int, Verdict]:
    """The verdicts about the tasks of a search, by number."""
    started = time.monotonic()
    try:
        with time_limit(limits.seconds):
            if search.observer is not None:
                model = prepare(observed(model.network, search.observer))
    except OutOfTimeError:
        return none_begun(search.tasks, TIME_LIMIT)
    settled = {}
    if options.drop_bystanders:
        settled = _settle_without_bystanders(model.network, search, options, limits, progress)
    if any(verdict.reason == INTERRUPTED for verdict in settled.values()):
        return settled
    rest = tuple(task for task in search.tasks if task.number not in settled)
    for tasks in _parts(model.network, rest, options):
        left = limits.after(time.monotonic() - started)
        settled |= _explore(model, replace(search, tasks=tasks), options, left, progress, trace)
    return settled


def _parts(network: Network, tasks: tuple[Task, ...], options: Options) -> list[tuple[Task, ...]]:
    """The tasks in sets that one exploration each decides."""
    if not tasks:
        return []
    parts = in_equal_parts(network, [task.target for task in tasks]) if options.symmetry else [list(range(len(tasks)))]
    return [tuple(tasks[number] for number in part) for part in parts]


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
            triggers = triggers_of(search.tasks, network)
            network = without_impossible(network)
            relaxed = without_bystanders(network, [*targets, *(trigger.condition for trigger in triggers)])
            if relaxed == network:
                return {}
            program, goals = _lowered(relaxed, targets, triggers, options)
    except OutOfTimeError:
        return {}
    outcome = explore(program, goals, options, first_try.after(time.monotonic() - started), progress)
    if outcome.reason == INTERRUPTED:
        return none_begun(search.tasks, INTERRUPTED)
    left_out = unexamined(network, relaxed)
    settled = {
        task.number: Verdict(task.query, answers_of(task.query)[1], True, "", outcome.statistics, unexamined=left_out)
        for task, goal in zip(search.tasks, outcome.goals[: len(targets)], strict=True)
        if goal.status is Status.UNREACHABLE
    }
    return with_notes(settled, triggers, outcome.goals[len(targets) :])


def _explore(
    model: PreparedNetwork, search: Search, options: Options, limits: Limits, progress: Progress | None, trace: bool
) -> dict[int, Verdict]:
    started = time.monotonic()
    network = model.network
    targets = [task.target for task in search.tasks]
    try:
        with time_limit(limits.seconds):
            triggers = triggers_of(search.tasks, network)
            mentioned = [*targets, *(trigger.condition for trigger in triggers)]
            reduced = without_spectators(network, mentioned) if options.hold_spectators else network
            program, goals = _lowered(reduced, targets, triggers, options)
    except OutOfTimeError:
        return none_begun(search.tasks, TIME_LIMIT)
    outcome = explore(program, goals, options, limits.after(time.monotonic() - started), progress)
    searched = model if reduced == network else prepare(reduced)
    if outcome.fault is not None:
        fault = explain(searched, outcome.fault, limits.seconds)
        if fault.run is not None:
            fault = replace(fault, run=_whole_run(model, searched, fault.run))
        outcome = replace(outcome, fault=fault if search.observer is None else fault_without_observer(network, fault))
    verdicts: dict[int, Verdict] = {}
    for task, goal in zip(search.tasks, outcome.goals[: len(targets)], strict=True):
        verdict = verdict_of(model, searched, task, goal, outcome, trace)
        if verdict is None:
            everything = replace(options, hold_spectators=False)
            rest = limits
            if limits.seconds is not None:
                rest = replace(limits, seconds=max(limits.seconds - outcome.statistics.seconds, 0.0))
            verdicts |= _explore(model, replace(search, tasks=(task,)), everything, rest, progress, trace)
        else:
            verdicts[task.number] = verdict
    return with_notes(verdicts, triggers, outcome.goals[len(targets) :])


def _lowered(
    network: Network, targets: Sequence[Expression], triggers: Sequence[Trigger], options: Options
) -> tuple[Program, tuple[Goal, ...]]:
    """The program, the goals of the targets, and behind them those of the triggers, for which no search goes on."""
    predicates = [*targets, *(trigger.condition for trigger in triggers)]
    program, goals = lower(network, predicates)
    if options.symmetry:
        program = with_symmetry(program, network, predicates)
    return program, (*goals[: len(targets)], *noted(goals[len(targets) :]))


def _whole_run(model: PreparedNetwork, searched: PreparedNetwork, run: TimedTrace) -> TimedTrace | None:
    """A run of the whole network that is a run of the reduced one; None where a spectator meets an error on the way."""
    try:
        return with_spectators(model, searched.network, run)
    except (StepError, EvaluationFault):
        return None


def answers_of(query: Query) -> tuple[Answer, Answer]:
    """The answers where the target is reachable and where it is not."""
    return (Answer.HOLDS, Answer.FAILS) if query.holds_when_reached else (Answer.FAILS, Answer.HOLDS)


_INEXACT = "the stopwatches make the search inexact, and the run it found is not possible"


def verdict_of(
    model: PreparedNetwork, searched: PreparedNetwork, task: Task, goal: GoalOutcome, outcome: Outcome, trace: bool
) -> Verdict | None:
    """The verdict; None if the run that was found meets a run-time error of a process that was held still."""
    on_reached, otherwise = answers_of(task.query)
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
    path = run.path
    if task.query.observer is not None:
        run, moves = without_observer(network, run)
    return replace(verdict, answer=on_reached, exact=True, reason="", trace=run, moves=moves, path=path)
