"""Queries that one state decides: whether some state of a set can be reached."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace

from tachk.base.diagnostics.diagnostic import InternalError
from tachk.base.time_limit import OutOfTimeError, time_limit
from tachk.engine.core_search import RUN_TIME_ERROR
from tachk.engine.exact.concretise import concretise
from tachk.engine.guided_search import explore_along, states_along
from tachk.engine.options import Limits, Options, SearchOrder
from tachk.engine.outcome import INTERRUPTED, STATE_LIMIT, GoalOutcome, Outcome, Progress, Status
from tachk.engine.symmetry.forgotten import with_less_known
from tachk.engine.symmetry.tables import in_equal_parts
from tachk.engine.zone import explore
from tachk.meaning.discrete import PreparedNetwork, prepare
from tachk.meaning.judge.replay import ReplayError, replay
from tachk.meaning.step import StepError
from tachk.model.expressions import Expression
from tachk.model.fault import EvaluationFault
from tachk.model.network import Network
from tachk.model.run import RunTimeFault, TimedTrace
from tachk.transform.cone_of_influence import with_spectators
from tachk.transform.guided import guided
from tachk.transform.observed import ObserverMove, fault_without_observer, observed, without_observer
from tachk.verify.fault_explanation import explain
from tachk.verify.plan import Search, Task
from tachk.verify.unanswered import none_begun
from tachk.verify.unexamined import unexamined
from tachk.verify.vacuity import triggers_of, with_notes
from tachk.verify.verdict import Answer, Verdict, answers_of
from tachk.verify.weaker import (
    ReachedInAbstraction,
    Weaker,
    held,
    lowered,
    naming_some,
    settle_asked_of_all,
    settle_weaker,
    settle_without_bystanders,
)


def answer(
    model: PreparedNetwork, search: Search, options: Options, limits: Limits, progress: Progress | None, trace: bool
) -> dict[int, Verdict]:
    """The verdicts about the tasks of a search, by number."""
    started = time.monotonic()
    unobserved = model.network
    try:
        with time_limit(limits.seconds):
            if search.observer is not None:
                model = prepare(observed(model.network, search.observer))
    except OutOfTimeError as error:
        return none_begun(search.tasks, error.reason)
    settled: dict[int, Verdict] = {}
    if options.drop_bystanders:
        settled, reached = settle_without_bystanders(model.network, search, options, limits, progress)
        for task in search.tasks:
            if task.number in reached and not _is_interrupted(settled):
                left = limits.after(time.monotonic() - started)
                settled |= _carried_over(model, task, reached[task.number], options, left, progress, trace)
    if options.symmetry and not _is_interrupted(settled):
        left = limits.after(time.monotonic() - started)
        rest = search.without(settled)
        settled |= _settle_asked_of_all(unobserved, model, rest, options, left, progress, trace)
    if _is_interrupted(settled):
        return none_begun((t for t in search.tasks if t.number not in settled), INTERRUPTED) | settled
    for tasks in _parts(model.network, search.without(settled).tasks, options):
        part = replace(search, tasks=tasks)
        left = limits.after(time.monotonic() - started)
        found = _settle_with_less_known(model, part, options, left, progress, trace) if options.symmetry else {}
        settled |= found
        if _is_interrupted(found):
            return none_begun(search.tasks, INTERRUPTED) | settled
        part = part.without(found)
        if part.tasks:
            left = limits.after(time.monotonic() - started)
            settled |= _explore(model, part, options, left, progress, trace)
    return settled


def _is_interrupted(settled: Mapping[int, Verdict]) -> bool:
    return any(verdict.reason == INTERRUPTED for verdict in settled.values())


def _decided(verdicts: Mapping[int, Verdict]) -> dict[int, Verdict]:
    """What a short search does not leave open."""
    return {number: verdict for number, verdict in verdicts.items() if verdict.reason != STATE_LIMIT}


def _parts(network: Network, tasks: tuple[Task, ...], options: Options) -> list[tuple[Task, ...]]:
    """The tasks in sets that one exploration each decides."""
    if not tasks:
        return []
    parts = in_equal_parts(network, [task.target for task in tasks]) if options.symmetry else [list(range(len(tasks)))]
    return [tuple(tasks[number] for number in part) for part in parts]


FIRST_LOOK = 20_000
"""Where so many states are enough, less is not asked to be known."""


FEW = 1_000
"""Where so many states are enough, what names some interchangeable processes is not asked of all of them."""


def _settle_asked_of_all(
    unobserved: Network,
    model: PreparedNetwork,
    search: Search,
    options: Options,
    limits: Limits,
    progress: Progress | None,
    trace: bool,
) -> dict[int, Verdict]:
    """The verdicts about targets that name some of several interchangeable processes, and are unreachable whichever
    these are; and those that few states decide."""
    started = time.monotonic()
    if limits.states is not None and limits.states <= FEW:
        return {}
    some = naming_some(unobserved, model.network, search, options, limits)
    if not some.tasks:
        return {}
    few = replace(limits.after(time.monotonic() - started), states=FEW)
    decided = _decided(_explore(model, some, options, few, progress, trace))
    rest = some.without(decided)
    if rest.tasks and not _is_interrupted(decided):
        left = limits.after(time.monotonic() - started)
        decided |= settle_asked_of_all(model.network, rest, options, left, progress)
    return decided


def _settle_with_less_known(
    model: PreparedNetwork, search: Search, options: Options, limits: Limits, progress: Progress | None, trace: bool
) -> dict[int, Verdict]:
    """The verdicts about targets that are unreachable even if processes are not gone through by number, where that
    makes them interchangeable; and those that a short search finds."""
    started = time.monotonic()
    if limits.states is not None and limits.states <= FIRST_LOOK:
        return {}
    network, targets = model.network, [task.target for task in search.tasks]
    try:
        with time_limit(limits.seconds):
            triggers = triggers_of(search.tasks, network)
            mentioned = [*targets, *(trigger.condition for trigger in triggers)]
            reduced = held(network, mentioned, options)
            less = with_less_known(reduced, mentioned)
    except OutOfTimeError:
        return {}
    if less is None:
        return {}

    def short_search(part: Search, order: SearchOrder) -> dict[int, Verdict]:
        look = replace(limits.after(time.monotonic() - started), states=FIRST_LOOK)
        return _explore(model, part, replace(options, order=order), look, progress, trace)

    decided = _decided(short_search(search, options.order))
    rest = search.without(decided)
    if not rest.tasks or _is_interrupted(decided):
        return decided
    names = tuple(variable.name for variable in less.variables)

    def coarser(targets: Sequence[Expression], conditions: Sequence[Expression]) -> Weaker:
        return Weaker(less.network, targets, conditions, unexamined=unexamined(network, reduced), less_known=names)

    left = limits.after(time.monotonic() - started)
    settled, _ = settle_weaker(coarser, network, rest, options, left, progress)
    decided |= settled
    rest = search.without(decided)
    if rest.tasks and options.order is SearchOrder.AUTO and not options.shortest:
        # A run that nothing hinders is found fast. What this order does not find decides nothing.
        deep = short_search(rest, SearchOrder.DFS)
        decided |= {
            number: verdict
            for number, verdict in deep.items()
            if verdict.answer is not Answer.UNKNOWN or verdict.reason == INTERRUPTED
        }
    return decided


def _carried_over(
    model: PreparedNetwork,
    task: Task,
    found: ReachedInAbstraction,
    options: Options,
    limits: Limits,
    progress: Progress | None,
    trace: bool,
) -> dict[int, Verdict]:
    """The verdict about a target that is reached without bystanders, if it is reached in the same way with them."""
    started = time.monotonic()
    members = {number for number, process in enumerate(found.weaker.network.processes) if process.edges}
    try:
        with time_limit(limits.seconds):
            network = held(model.network, [task.target], options)
            if any(not network.processes[number].edges for number in members):
                return {}
            along = guided(network, found.path, members, found.weaker.spared)
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
            conditions = [trigger.condition for trigger in triggers]
            mentioned = [*targets, *conditions]
            reduced = held(network, mentioned, options)
            program, goals = lowered(reduced, targets, conditions, options)
    except OutOfTimeError as error:
        return none_begun(search.tasks, error.reason)
    outcome = explore(program, goals, options, limits.after(time.monotonic() - started), progress)
    searched = model if reduced == network else prepare(reduced)

    def told(fault: RunTimeFault) -> RunTimeFault:
        fault = explain(searched, fault, limits.seconds)
        if fault.run is not None:
            fault = replace(fault, run=_whole_run(model, searched, fault.run))
        return fault if search.observer is None else fault_without_observer(network, fault)

    if outcome.fault is not None:
        outcome = replace(outcome, fault=told(outcome.fault))
    verdicts: dict[int, Verdict] = {}
    for task, goal in zip(search.tasks, outcome.goals[: len(targets)], strict=True):
        if goal.fault is not None:
            goal = replace(goal, fault=told(goal.fault))
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


def _whole_run(model: PreparedNetwork, searched: PreparedNetwork, run: TimedTrace) -> TimedTrace | None:
    """A run of the whole network that is a run of the reduced one; None where a spectator meets an error on the way."""
    try:
        return with_spectators(model, searched.network, run)
    except (StepError, EvaluationFault):
        return None


_INEXACT = "the stopwatches make the search inexact, and the run it found is not possible"


def verdict_of(
    model: PreparedNetwork, searched: PreparedNetwork, task: Task, goal: GoalOutcome, outcome: Outcome, trace: bool
) -> Verdict | None:
    """The verdict; None if the run that was found meets a run-time error of a process that was held still."""
    on_reached, otherwise = answers_of(task.query)
    network, reduced = model.network, searched.network
    verdict = Verdict(task.query, Answer.UNKNOWN, outcome.exact, outcome.reason, outcome.statistics)
    if goal.fault is not None:
        return replace(verdict, exact=True, reason=RUN_TIME_ERROR, fault=goal.fault)
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
