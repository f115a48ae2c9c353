"""The strategy that leaves independent parts out of a search for runs that go on for ever."""

from __future__ import annotations

from tachk.base.job import unhurried
from tachk.base.records import replace
from tachk.engine.compiler.lower import lower
from tachk.engine.outcome import Statistics, Status
from tachk.engine.symmetry.tables import with_symmetry
from tachk.engine.zone import explore
from tachk.meaning.discrete import prepare
from tachk.model.expressions import Deadlock
from tachk.model.network import Network
from tachk.transform.independent_parts import independent_parts, part_alone, takes_its_time
from tachk.verify.liveness import any_run, conditions_of, outcome_of, searched_for
from tachk.verify.plan import Task
from tachk.verify.strategy import Findings, Problem
from tachk.verify.unexamined import unexamined
from tachk.verify.verdict import Answer, Verdict, answers_of

_FEW = 2_000
"""So many states of the whole network are searched before: most runs are found in them, and small networks decided."""


def decomposed(problem: Problem) -> Findings:
    """Searches the network without the parts that change nothing (see `tachk.transform.independent_parts`).

    Only that there is no run is an answer.
    """
    open_ = {}
    for task in problem.tasks:
        parts = () if task.query.non_zeno else independent_parts(problem.network, conditions_of(task.query))
        timely = [part for part in parts if takes_its_time(problem.network, part)]
        if timely:
            open_[task.number] = timely
    if not open_:
        return Findings({})
    verdicts = _in_few_states(problem.about(open_))
    for task in problem.tasks:
        if task.number in open_ and task.number not in verdicts:
            verdict = _without(problem, task, open_[task.number])
            if verdict is not None:
                verdicts[task.number] = verdict
    return Findings(verdicts)


def _in_few_states(problem: Problem) -> dict[int, Verdict]:
    """The answers that few states of the whole network give."""
    if "any-run" in problem.options.without:
        return {}
    found = any_run(replace(problem, limits=problem.limits.of_states(_FEW))).verdicts
    answered = {number: verdict for number, verdict in found.items() if verdict.answer is not Answer.UNKNOWN}
    return {number: replace(verdict, strategy="any-run") for number, verdict in answered.items()}


def _without(problem: Problem, task: Task, parts: list[frozenset[int]]) -> Verdict | None:
    """The verdict if there is no run without the parts that are never stuck."""
    rest, work = problem.network, Statistics()
    for part in parts:
        is_stuck, statistics = _may_be_stuck(problem, part)
        work = work.then(statistics)
        if not is_stuck:
            rest = part_alone(rest, set(range(len(rest.processes))) - part)
    if rest is problem.network:
        return None
    query = replace(task.query, again=(), ends=None)
    searched = searched_for(prepare(rest), query, problem)
    verdict = replace(outcome_of(query, searched.outcome), query=task.query)
    if verdict.answer is not answers_of(task.query)[1]:
        return None
    with unhurried():
        left_out = unexamined(problem.network, rest)
    return replace(verdict, unexamined=left_out, statistics=work.then(verdict.statistics))


def _may_be_stuck(problem: Problem, part: frozenset[int]) -> tuple[bool, Statistics]:
    """Whether a part by itself may come to where it has no action any more, and the work of finding out."""
    alone: Network = part_alone(problem.network, part)
    stuck = Deadlock()
    program, goals = lower(alone, [stuck])
    if problem.options.symmetry:
        program = with_symmetry(program, alone, [stuck])
    outcome = explore(program, goals, problem.options, problem.limits)
    proved = outcome.goals[0].status is Status.UNREACHABLE and outcome.exact and outcome.fault is None
    return not proved, outcome.statistics
