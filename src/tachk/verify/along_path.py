"""The strategy that searches a network along the paths that an over-approximation has found."""

from __future__ import annotations

from tachk.base.records import replace
from tachk.engine.guided_search import explore_along, states_along
from tachk.engine.outcome import INTERRUPTED, Status
from tachk.transform.guided import guided
from tachk.verify.over_approximations import reduced_for
from tachk.verify.plan import Task
from tachk.verify.reachability import verdict_of
from tachk.verify.strategy import Findings, Problem, ReachedInAbstraction
from tachk.verify.verdict import Verdict, none_begun


def along_path(problem: Problem) -> Findings:
    """Searches along the paths that an over-approximation has found."""
    verdicts: dict[int, Verdict] = {}
    for task in problem.tasks:
        if task.number in problem.reached:
            verdicts |= _along(problem, task, problem.reached[task.number])
    return Findings(verdicts)


def _along(problem: Problem, task: Task, found: ReachedInAbstraction) -> dict[int, Verdict]:
    """The verdict about a target that is reached in an over-approximation, if it is reached in the same way without."""
    model, options = problem.model, problem.options
    members = {number for number, process in enumerate(found.within.network.processes) if process.edges}
    reduced = reduced_for(model.network, [task.target], options)
    network = reduced.network
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
    verdict = verdict_of(problem.observed, reduced, task, outcome.goals[0], outcome, problem.trace)
    return {} if verdict is None else {task.number: verdict}
