"""Guards that are true, or false, in every state that a run reaches."""

from __future__ import annotations

from collections.abc import Iterator
from functools import reduce

from tachk.analysis.conditions import conjuncts
from tachk.analysis.fold import Known, cannot_fail, fold
from tachk.base.diagnostics.diagnostic import Diagnostic, UnsupportedError
from tachk.base.records import dataclass
from tachk.engine.compiler.goal import check_predicate
from tachk.model.connectives import both, negation
from tachk.model.expressions import (
    BOOL,
    Constant,
    Expression,
    LocationTest,
    Quantifier,
    QuantifierKind,
)
from tachk.model.network import Edge, Network
from tachk.model.traversal import reads_clock
from tachk.verify.semantic_lint.reached import in_no_process


@dataclass(frozen=True, slots=True)
class GuardGoal:
    """States in which the process is where the edge begins and its guard has a value (``when``).

    Only what the guard says about integers is looked at: to ask where a comparison of clocks is false would make the
    search distinguish more zones. A guard with clocks is therefore only checked for being true somewhere.
    """

    process: int
    edge: int
    when: bool
    target: Expression


def guard_goals(network: Network, known: Known) -> Iterator[GuardGoal]:
    """The goals to be reached so that guards are neither always true nor always false.

    Guards whose value the constants of the model decide are left out, and those that may be run-time errors.
    """
    for number, process in enumerate(network.processes):
        for place, edge in enumerate(process.edges):
            if edge.guard is None:
                continue
            guard = fold(edge.guard, known)
            parts = [part for part in conjuncts(guard) if not reads_clock(part)]
            if not parts or all(isinstance(part, Constant) for part in parts) or not all(map(cannot_fail, parts)):
                continue
            here = LocationTest(number, edge.source)
            integers = reduce(both, parts)
            yield from _checked(GuardGoal(number, place, True, both(here, _for_some(edge, integers))), known)
            if not reads_clock(guard):
                otherwise = negation(integers)
                yield from _checked(GuardGoal(number, place, False, both(here, _for_some(edge, otherwise))), known)


def _for_some(edge: Edge, condition: Expression) -> Expression:
    for variable in reversed(edge.selects):
        condition = Quantifier(QuantifierKind.EXISTS, variable, condition, BOOL, condition.span)
    return condition


def _checked(goal: GuardGoal, known: Known) -> Iterator[GuardGoal]:
    try:
        check_predicate(goal.target, known)
    except UnsupportedError:
        return
    yield goal


def always_true_findings(network: Network, unmet: list[GuardGoal], goals: list[GuardGoal]) -> tuple[Diagnostic, ...]:
    """Guards that are true whenever a process of the template is where the edge begins.

    Args:
        unmet: the goals that were not reached.
        goals: all goals.
    """
    never_false = {(goal.process, goal.edge) for goal in unmet if not goal.when}
    # A guard that is never evaluated in a process of the template, because it is constant there, is not reported.
    reached = {(goal.process, goal.edge) for goal in goals if goal.when} - {
        (goal.process, goal.edge) for goal in unmet if goal.when
    }
    findings = []
    for process, place in in_no_process(network, never_false):
        guard = process.edges[place].guard
        numbers = [n for n, other in enumerate(network.processes) if other.template == process.template]
        if guard is not None and any((n, place) in reached for n in numbers):
            findings.append(
                Diagnostic(
                    "W0604",
                    "this guard is true in every state in which it is evaluated",
                    guard.span,
                    "remove it, or check whether it says what you mean",
                )
            )
    return tuple(findings)


def never_true(unmet: list[GuardGoal]) -> set[tuple[int, int]]:
    """The edges whose guard is false wherever it is evaluated."""
    return {(goal.process, goal.edge) for goal in unmet if goal.when}
