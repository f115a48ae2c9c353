"""Queries that one state decides: whether some state of a set can be reached."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace

from tachk.certify.replay import ReplayError, replay
from tachk.compiler.lower import lower
from tachk.compiler.program import Goal, Program
from tachk.diagnostics.diagnostic import InternalError
from tachk.engines.concretise import concretise
from tachk.engines.guided_search import explore_along, states_along
from tachk.engines.options import Limits, Options
from tachk.engines.outcome import INTERRUPTED, TIME_LIMIT, GoalOutcome, Outcome, Progress, Statistics, Status
from tachk.engines.zone import explore
from tachk.model.expressions import Expression, Variable
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
from tachk.records import dataclass
from tachk.reduction.budgets import budgets
from tachk.reduction.bystanders import without_bystanders
from tachk.reduction.guided import guided
from tachk.reduction.impossible import without_impossible
from tachk.reduction.spectators import with_spectators, without_spectators
from tachk.reduction.symmetry.tables import in_equal_parts, with_symmetry
from tachk.semantics.discrete import PreparedNetwork, prepare
from tachk.semantics.step import StepError
from tachk.semantics.timed_trace import TimedTrace, Transition
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
    settled: dict[int, Verdict] = {}
    if options.drop_bystanders:
        settled, reached = _settle_without_bystanders(model.network, search, options, limits, progress)
        for task in search.tasks:
            if task.number in reached and not _is_interrupted(settled):
                left = limits.after(time.monotonic() - started)
                settled |= _carried_over(model, task, reached[task.number], options, left, progress, trace)
    if _is_interrupted(settled):
        return none_begun((t for t in search.tasks if t.number not in settled), INTERRUPTED) | settled
    rest = tuple(task for task in search.tasks if task.number not in settled)
    for tasks in _parts(model.network, rest, options):
        left = limits.after(time.monotonic() - started)
        settled |= _explore(model, replace(search, tasks=tasks), options, left, progress, trace)
    return settled


def _is_interrupted(settled: Mapping[int, Verdict]) -> bool:
    return any(verdict.reason == INTERRUPTED for verdict in settled.values())


def _parts(network: Network, tasks: tuple[Task, ...], options: Options) -> list[tuple[Task, ...]]:
    """The tasks in sets that one exploration each decides."""
    if not tasks:
        return []
    parts = in_equal_parts(network, [task.target for task in tasks]) if options.symmetry else [list(range(len(tasks)))]
    return [tuple(tasks[number] for number in part) for part in parts]


_FIRST_TRY = 1_000_000
"""How many states may be stored without bystanders, which may have more states than the whole network."""


WORTH_CARRYING_OVER = 5_000
"""So many states without bystanders make it worth while to look for the run with them along the one without."""


@dataclass(frozen=True, slots=True)
class _Found:
    """A target that is reached in the network without bystanders.

    Attributes:
        network: that network.
        path: the transitions of the others that lead to it.
        spared: budgets that they use.
    """

    network: Network
    path: tuple[Transition, ...]
    spared: frozenset[Variable]
    statistics: Statistics


def _settle_without_bystanders(
    network: Network, search: Search, options: Options, limits: Limits, progress: Progress | None
) -> tuple[dict[int, Verdict], dict[int, _Found]]:
    """The verdicts about targets that are unreachable even if nothing hinders the processes they depend on, and what
    was found about those that are reachable then."""
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
            mentioned = [*targets, *(trigger.condition for trigger in triggers)]
            network = without_impossible(network)
            relaxed = without_bystanders(network, mentioned)
            if relaxed == network:
                return {}, {}
            program, goals = _lowered(relaxed, targets, triggers, options)
            spared = budgets(network, mentioned)
    except OutOfTimeError:
        return {}, {}
    outcome = explore(program, goals, options, first_try.after(time.monotonic() - started), progress)
    if outcome.reason == INTERRUPTED:
        return none_begun(search.tasks, INTERRUPTED), {}
    left_out = unexamined(network, relaxed)
    found = list(zip(search.tasks, outcome.goals[: len(targets)], strict=True))
    settled = {
        task.number: Verdict(task.query, answers_of(task.query)[1], True, "", outcome.statistics, unexamined=left_out)
        for task, goal in found
        if goal.status is Status.UNREACHABLE
    }
    reached = {
        task.number: _Found(relaxed, goal.path, spared, outcome.statistics)
        for task, goal in found
        if goal.status is Status.REACHED and goal.path is not None
    }
    if options.shortest or not outcome.exact or outcome.statistics.states_stored < WORTH_CARRYING_OVER:
        reached = {}
    return with_notes(settled, triggers, outcome.goals[len(targets) :]), reached


def _carried_over(
    model: PreparedNetwork,
    task: Task,
    found: _Found,
    options: Options,
    limits: Limits,
    progress: Progress | None,
    trace: bool,
) -> dict[int, Verdict]:
    """The verdict about a target that is reached without bystanders, if it is reached in the same way with them."""
    started = time.monotonic()
    members = {number for number, process in enumerate(found.network.processes) if process.edges}
    try:
        with time_limit(limits.seconds):
            network = without_spectators(model.network, [task.target]) if options.hold_spectators else model.network
            if any(not network.processes[number].edges for number in members):
                return {}
            along = guided(network, found.path, members, found.spared)
            most = states_along(found.path, found.statistics.states_stored)
            bounded = replace(limits, states=most if limits.states is None else min(limits.states, most))
            left = bounded.after(time.monotonic() - started)
            outcome = explore_along(along, network, task.target, options, left, progress)
    except OutOfTimeError:
        return {}
    outcome = replace(outcome, statistics=found.statistics.then(outcome.statistics))
    if outcome.reason == INTERRUPTED:
        return none_begun([task], INTERRUPTED)
    if outcome.goals[0].status is not Status.REACHED:
        return {}
    verdict = verdict_of(model, prepare(network), task, outcome.goals[0], outcome, trace)
    return {} if verdict is None else {task.number: verdict}


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
