"""Strategies that search a network for states of a set, and the verdicts about what they find."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from tachk.base.diagnostics.diagnostic import InternalError
from tachk.base.job import unhurried
from tachk.base.records import replace
from tachk.engine.compiler.program import Goal, Program
from tachk.engine.core_search import RUN_TIME_ERROR
from tachk.engine.exact.concretise import concretise
from tachk.engine.options import Limits, Options, SearchOrder
from tachk.engine.outcome import GoalOutcome, Outcome, Status
from tachk.engine.symmetry.coarse_partition import coarse_partition
from tachk.engine.zone import explore, short_runs
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.replay import ReplayError, replay
from tachk.model.expressions import Expression
from tachk.model.run import RunTimeFault, TimedTrace, Transition
from tachk.transform.observed import ObservedNetwork
from tachk.transform.transformation import Transformation
from tachk.verify.fault_explanation import explain
from tachk.verify.over_approximations import can_be_abstracted, can_be_symmetrised, lowered, reduced_for
from tachk.verify.plan import Task
from tachk.verify.strategy import Findings, Problem
from tachk.verify.unexamined import unexamined
from tachk.verify.vacuity import triggers_of, with_notes
from tachk.verify.verdict import Answer, Verdict, answers_of

_MANY_EDGES = 64
"""To find out which processes of so many edges are interchangeable takes longer than the first attempts."""


def equal_parts(problem: Problem) -> Iterator[Problem]:
    """The problem in parts of targets with which the same processes are interchangeable."""
    if not problem.options.symmetry or len(problem.tasks) < 2:
        yield problem
        return
    from tachk.engine.symmetry.tables import by_interchangeable_processes  # of no use to a single target

    for part in by_interchangeable_processes(problem.network, problem.targets):
        yield replace(problem, tasks=tuple(problem.tasks[number] for number in part))


def explored(problem: Problem) -> Findings:
    """Searches the cone of influence of the targets."""
    return Findings(_explored(problem, explore))


def first_runs(problem: Problem) -> Findings:
    """Looks for a short run where it takes long to find out which processes are interchangeable: the first attempts do
    not need to know."""
    conditions = [trigger.condition for trigger in triggers_of(problem.tasks, problem.network)]
    network = reduced_for(problem.network, [*problem.targets, *conditions], problem.options).network
    edges = sum(len(process.edges) for process in network.processes)
    if not problem.options.symmetry or edges < _MANY_EDGES or not coarse_partition(network).repeats:
        return Findings({})
    found = _explored(replace(problem, options=problem.options.off("symmetry")), short_runs)
    return Findings({n: each for n, each in found.items() if each.answer is not Answer.UNKNOWN or each.reason})


def few_states(problem: Problem) -> Findings:
    """Searches few states, where a search for the symmetrised targets comes next."""
    some = problem.about([task.number for task in problem.tasks if can_be_symmetrised(problem, task)])
    return explored(some) if some.tasks else Findings({})


def first_states(problem: Problem) -> Findings:
    """Searches some states, where a search with abstracted variables comes next."""
    return explored(problem) if can_be_abstracted(problem) else Findings({})


def depth_first(problem: Problem) -> Findings:
    """Searches some states depth first, where a search with abstracted variables came before: it finds a run that
    nothing hinders fast. If it finds none, that decides nothing."""
    options = problem.options
    if options.order is not SearchOrder.AUTO or options.shortest or not can_be_abstracted(problem):
        return Findings({})
    return explored(replace(problem, options=replace(options, order=SearchOrder.DFS)))


def _explored(
    problem: Problem, search: Callable[[Program, Sequence[Goal], Options, Limits], Outcome]
) -> dict[int, Verdict]:
    network, targets, options = problem.network, problem.targets, problem.options
    triggers = triggers_of(problem.tasks, network)
    conditions = [trigger.condition for trigger in triggers]
    reduced = reduced_for(network, [*targets, *conditions], options)
    program, goals = lowered(reduced.network, targets, conditions, options)
    outcome = search(program, goals, options, problem.limits)
    searched, whole = prepare(reduced.network), problem.observed.then(reduced)

    def of_the_model(fault: RunTimeFault) -> RunTimeFault:
        explained = explain(searched, fault)
        with unhurried():
            return whole.lift_fault(explained)

    if outcome.fault is not None:
        outcome = replace(outcome, fault=of_the_model(outcome.fault))
    verdicts: dict[int, Verdict] = {}
    for task, goal in zip(problem.tasks, outcome.goals[: len(targets)], strict=True):
        if goal.fault is not None:
            goal = replace(goal, fault=of_the_model(goal.fault))
        verdict = verdict_of(problem.observed, reduced, task, goal, outcome, problem.trace)
        if verdict is None:
            everything = options.off("cone")
            verdicts |= _explored(replace(problem, tasks=(task,), options=everything), search)
        else:
            verdicts[task.number] = verdict
    return with_notes(verdicts, triggers, outcome.goals[len(targets) :])


_NOT_SUFFICIENT = "a condition that would be enough for the formula is false in some state"
_INEXACT = "the stopwatches make the search inexact, and the run it found is not possible"


@unhurried()
def verdict_of(
    watched: ObservedNetwork, reduced: Transformation, task: Task, goal: GoalOutcome, outcome: Outcome, trace: bool
) -> Verdict | None:
    """The verdict; None if the run that was found meets a run-time error of a process that was frozen.

    Args:
        reduced: what was made of the network with the observer, and searched.
    """
    on_reached, otherwise = answers_of(task.query)
    verdict = Verdict(task.query, Answer.UNKNOWN, outcome.exact, outcome.reason, outcome.statistics)
    if goal.fault is not None:
        return replace(verdict, exact=True, reason=RUN_TIME_ERROR, fault=goal.fault)
    if goal.status is Status.UNDECIDED:
        return replace(verdict, exact=True, fault=outcome.fault)
    if goal.status is Status.UNREACHABLE:
        # An over-approximation that does not reach the target proves that nothing does.
        return replace(
            verdict, answer=otherwise, exact=True, reason="", unexamined=unexamined(watched.network, reduced.network)
        )
    verdict = replace(verdict, strategy=outcome.found_by)
    if task.condition is not None:
        return replace(verdict, reason=_NOT_SUFFICIENT)
    if not trace and outcome.exact:
        return replace(verdict, answer=on_reached, reason="", unexamined=unexamined(watched.network, reduced.network))
    run, possible = witness(reduced, goal.path or (), task.target, outcome.exact, repr(task.query.text))
    if run is None:
        return None if outcome.exact and not possible else replace(verdict, reason=_INEXACT)
    return replace(
        verdict,
        answer=on_reached,
        exact=True,
        reason="",
        trace=watched.lift(run),
        moves=watched.moves(run),
        path=run.path,
    )


@unhurried()
def witness(
    reduced: Transformation, path: Sequence[Transition], target: Expression, exact: bool, what: str
) -> tuple[TimedTrace | None, bool]:
    """A replayed run to the target, in the network from which the searched one was made; None if there is none.

    Args:
        path: in the searched network.
        exact: whether each path that the search finds has a run.
        what: the path leads to, for messages.

    Returns:
        The run, and False where a process that was frozen meets a run-time error on the way.

    Raises InternalError if there is no run, or none that replays, although the search is exact.
    """
    run = concretise(prepare(reduced.network), path, target)
    if run is None:
        if exact:
            raise InternalError(f"the path found for {what} has no timed run")
        return None, True
    whole = reduced.lift(run)
    if whole is None:
        return None, False
    try:
        replay(prepare(reduced.original), whole, target)
    except ReplayError as error:
        if exact:
            raise InternalError(f"the run found for {what} does not replay: {error}") from error
        return None, True
    return whole, True
