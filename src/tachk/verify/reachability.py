"""Strategies that search a network for states of a set, and the verdicts about what they find."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import inf

from tachk.base.diagnostics.diagnostic import InternalError
from tachk.base.job import unhurried
from tachk.engine.core_search import RUN_TIME_ERROR
from tachk.engine.exact.concretise import concretise
from tachk.engine.guided_search import explore_along, states_along
from tachk.engine.options import SearchOrder
from tachk.engine.outcome import INTERRUPTED, GoalOutcome, Outcome, Status
from tachk.engine.symmetry.tables import in_equal_parts
from tachk.engine.zone import explore
from tachk.meaning.discrete import PreparedNetwork, prepare
from tachk.meaning.judge.replay import ReplayError, replay
from tachk.meaning.step import StepError
from tachk.model.fault import EvaluationFault
from tachk.model.run import RunTimeFault, TimedTrace
from tachk.transform.cone_of_influence import with_spectators
from tachk.transform.guided import guided
from tachk.transform.observed import ObserverMove, fault_without_observer, without_observer
from tachk.verify.fault_explanation import explain
from tachk.verify.over_approximations import can_be_abstracted, can_be_symmetrised, held, lowered
from tachk.verify.plan import Task
from tachk.verify.strategy import Findings, Problem, ReachedInAbstraction
from tachk.verify.unanswered import none_begun
from tachk.verify.unexamined import unexamined
from tachk.verify.vacuity import triggers_of, with_notes
from tachk.verify.verdict import Answer, Verdict, answers_of


def equal_parts(problem: Problem) -> Iterator[Problem]:
    """The problem in parts of targets with which the same processes are interchangeable."""
    if not problem.options.symmetry or not problem.tasks:
        yield problem
        return
    for part in in_equal_parts(problem.network, problem.targets):
        yield replace(problem, tasks=tuple(problem.tasks[number] for number in part))


def explored(problem: Problem) -> Findings:
    """A search of the network, without the processes and variables on which no target depends."""
    return Findings(_explored(problem))


def few_states(problem: Problem) -> Findings:
    """A search for few states, before targets are asked of all interchangeable processes."""
    some = problem.about([task.number for task in problem.tasks if can_be_symmetrised(problem, task)])
    return explored(some) if some.tasks else Findings({})


def first_states(problem: Problem) -> Findings:
    """A search for some states, before variables are abstracted."""
    return explored(problem) if can_be_abstracted(problem) else Findings({})


def depth_first(problem: Problem) -> Findings:
    """A depth-first search for some states, where variables could be abstracted: a run that nothing hinders is found
    fast. What this order does not find decides nothing."""
    options = problem.options
    if options.order is not SearchOrder.AUTO or options.shortest or not can_be_abstracted(problem):
        return Findings({})
    return explored(replace(problem, options=replace(options, order=SearchOrder.DFS)))


def along_path(problem: Problem) -> Findings:
    """A search along the paths that an over-approximation has found."""
    verdicts: dict[int, Verdict] = {}
    for task in problem.tasks:
        if task.number in problem.reached:
            verdicts |= _along(problem, task, problem.reached[task.number])
    return Findings(verdicts)


def _along(problem: Problem, task: Task, found: ReachedInAbstraction) -> dict[int, Verdict]:
    """The verdict about a target that is reached in an over-approximation, if it is reached in the same way without."""
    model, options = problem.model, problem.options
    members = {number for number, process in enumerate(found.within.network.processes) if process.edges}
    network = held(model.network, [task.target], options)
    if any(not network.processes[number].edges for number in members):
        return {}
    along = guided(network, found.path, members, found.within.spared)
    bounded = problem.limits.of_states(states_along(found.path, found.statistics.states_stored))
    outcome = explore_along(along, network, task.target, options, bounded)
    outcome = replace(outcome, statistics=found.statistics.then(outcome.statistics))
    if outcome.reason == INTERRUPTED:
        return none_begun([task], INTERRUPTED)
    if outcome.goals[0].status is not Status.REACHED:
        return {}
    verdict = verdict_of(model, prepare(network), task, outcome.goals[0], outcome, problem.trace)
    return {} if verdict is None else {task.number: verdict}


def _explored(problem: Problem) -> dict[int, Verdict]:
    model, options = problem.model, problem.options
    network, targets = problem.network, problem.targets
    triggers = triggers_of(problem.tasks, network)
    conditions = [trigger.condition for trigger in triggers]
    reduced = held(network, [*targets, *conditions], options)
    program, goals = lowered(reduced, targets, conditions, options)
    outcome = explore(program, goals, options, problem.limits)
    searched = model if reduced == network else prepare(reduced)

    def of_the_model(fault: RunTimeFault) -> RunTimeFault:
        fault = explain(searched, fault)
        if fault.run is not None:
            fault = replace(fault, run=_whole_run(model, searched, fault.run))
        return fault if problem.observer is None else fault_without_observer(network, fault)

    if outcome.fault is not None:
        outcome = replace(outcome, fault=of_the_model(outcome.fault))
    verdicts: dict[int, Verdict] = {}
    for task, goal in zip(problem.tasks, outcome.goals[: len(targets)], strict=True):
        if goal.fault is not None:
            goal = replace(goal, fault=of_the_model(goal.fault))
        verdict = verdict_of(model, searched, task, goal, outcome, problem.trace)
        if verdict is None:
            everything = options.off("cone")
            verdicts |= _explored(replace(problem, tasks=(task,), options=everything))
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
    with unhurried(inf):
        return _with_run(model, searched, task, goal, outcome, verdict)


def _with_run(
    model: PreparedNetwork,
    searched: PreparedNetwork,
    task: Task,
    goal: GoalOutcome,
    outcome: Outcome,
    verdict: Verdict,
) -> Verdict | None:
    """The verdict with the run along the path that was found, replayed; None as `verdict_of`."""
    network, (on_reached, _) = model.network, answers_of(task.query)
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
