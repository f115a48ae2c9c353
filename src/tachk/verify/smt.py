"""Strategies that ask z3 about the runs of a network. Nothing is left out of it."""

from __future__ import annotations

from tachk.base.diagnostics.diagnostic import UnsupportedError
from tachk.base.job import unhurried
from tachk.base.optional_packages import optional_packages
from tachk.base.records import replace
from tachk.engine.outcome import Outcome
from tachk.meaning.discrete import prepare
from tachk.model.run import RunTimeFault
from tachk.transform.transformation import unchanged
from tachk.verify.fault_explanation import explain
from tachk.verify.reachability import verdict_of
from tachk.verify.strategy import Findings, Problem
from tachk.verify.verdict import unsupported


def induction(problem: Problem) -> Findings:
    """Unrolls runs step after step; after each of the first ones it tries to prove that no longer run reaches a
    target."""
    return _searched(problem, proves=True)


def bounded(problem: Problem) -> Findings:
    """Unrolls runs step after step."""
    return _searched(problem, proves=False)


def _searched(problem: Problem, proves: bool) -> Findings:
    with optional_packages():
        from tachk.engine.smt import search
    try:
        outcome = _explained(problem, search.explore(problem.network, problem.targets, problem.limits, proves))
    except UnsupportedError as error:
        return Findings({task.number: unsupported(task.query, error.diagnostic) for task in problem.tasks})
    whole, verdicts = unchanged(problem.network), {}
    for task, goal in zip(problem.tasks, outcome.goals, strict=True):
        verdict = verdict_of(problem.observed, whole, task, goal, outcome, problem.trace)
        assert verdict is not None  # no process was frozen
        verdicts[task.number] = verdict
    return Findings(verdicts)


def _explained(problem: Problem, outcome: Outcome) -> Outcome:
    def of_the_model(fault: RunTimeFault | None) -> RunTimeFault | None:
        if fault is None:
            return None
        explained = explain(prepare(problem.network), fault)
        with unhurried():
            return problem.observed.lift_fault(explained)

    goals = tuple(replace(goal, fault=of_the_model(goal.fault)) for goal in outcome.goals)
    return replace(outcome, goals=goals, fault=of_the_model(outcome.fault))
