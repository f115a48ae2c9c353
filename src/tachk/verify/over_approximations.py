"""Strategies that search a network which can do more: a target that is not reached there is unreachable.

Existential abstraction (Clarke, Grumberg, Long, Model checking and abstraction, TOPLAS 16(5), 1994), of processes that
only block others, of variables that distinguish processes, and of which process a target names. What is reached there
need not be reachable; a path to it is a hint (`tachk.verify.along_path`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from tachk.analysis.impossible_edges import without_impossible
from tachk.base.records import replace
from tachk.engine.compiler.lower import lower
from tachk.engine.compiler.program import Goal, Program
from tachk.engine.options import Options
from tachk.engine.outcome import INTERRUPTED, Status
from tachk.engine.symmetry.coarse_partition import coarse_partition
from tachk.engine.symmetry.variable_abstraction import with_abstracted_variables
from tachk.engine.zone import explore
from tachk.model.expressions import Expression
from tachk.model.network import Network
from tachk.model.remembered import by_network
from tachk.transform.blocking_processes import without_blocking
from tachk.transform.cone_of_influence import cone_of_influence
from tachk.transform.transformation import Transformation, unchanged
from tachk.verify.plan import Task
from tachk.verify.strategy import Findings, OverApproximation, Problem, ReachedInAbstraction
from tachk.verify.unexamined import unexamined
from tachk.verify.vacuity import noted, triggers_of, with_notes
from tachk.verify.verdict import Verdict, answers_of, none_begun

WORTH_CARRYING_OVER = 5_000
"""So many states without blocking processes make it worth while to look for the run with them along the one without."""

Relaxing = Callable[[Sequence[Expression], Sequence[Expression]], OverApproximation | None]
"""From targets, and conditions that are looked for on the way, to an over-approximation; None if there is none."""


def unblocked(problem: Problem) -> Findings:
    """Searches the network without the processes that can only block those on which the targets depend."""
    network = problem.network

    def approximation(targets: Sequence[Expression], conditions: Sequence[Expression]) -> OverApproximation | None:
        possible = without_impossible(network)
        mentioned = [*targets, *conditions]
        rest = without_blocking(possible, mentioned)
        if rest.network is possible:
            return None
        from tachk.transform.monotone_counters import monotone_counters

        spared = monotone_counters(possible, mentioned)
        left_out = unexamined(possible, rest.network)
        return OverApproximation(rest.network, targets, conditions, unexamined=left_out, spared=spared)

    found = _searched(problem, approximation)
    worth = {n: each for n, each in found.reached.items() if each.statistics.states_stored >= WORTH_CARRYING_OVER}
    return replace(found, reached={} if problem.options.shortest else worth)


def symmetrised(problem: Problem) -> Findings:
    """Searches for the symmetrised targets: for each target, the disjunction over the orbit of the processes that it
    names. These processes then remain interchangeable."""

    def of_all(targets: Sequence[Expression], conditions: Sequence[Expression]) -> OverApproximation | None:
        return _of_all(problem.network, tuple(targets), tuple(conditions), problem.options.cone)

    symmetric = problem.about([task.number for task in problem.tasks if can_be_symmetrised(problem, task)])
    return _searched(symmetric, of_all) if symmetric.tasks else Findings({})


def can_be_symmetrised(problem: Problem, task: Task) -> bool:
    """True if a target names some, but not all, of several interchangeable processes and its orbit is small enough."""
    original = problem.observed.original
    if not coarse_partition(original).repeats:
        return False
    from tachk.engine.symmetry.symmetrised_query import is_asymmetric  # of no use where all processes differ

    conditions = tuple(trigger.condition for trigger in triggers_of([task], problem.network))
    # Symmetries of the network without the observer are found once for many problems.
    return (
        any(is_asymmetric(original, question) for question in (task.target, *conditions))
        and _of_all(problem.network, (task.target,), conditions, problem.options.cone) is not None
    )


@by_network
def _of_all(
    network: Network, targets: tuple[Expression, ...], conditions: tuple[Expression, ...], hold: bool
) -> OverApproximation | None:
    from tachk.engine.symmetry.symmetrised_query import symmetrised_query

    reduced = cone_of_influence(network, [*targets, *conditions]).network if hold else network
    symmetric = symmetrised_query(reduced, targets, conditions)
    if symmetric is None:
        return None
    return OverApproximation(reduced, *symmetric, unexamined=unexamined(network, reduced), symmetrised=True)


def abstracted(problem: Problem) -> Findings:
    """Searches the network with an abstraction of the variables that count through processes by number, where the
    processes then are interchangeable."""

    def coarser(targets: Sequence[Expression], conditions: Sequence[Expression]) -> OverApproximation | None:
        return _less_known(problem.network, tuple(targets), tuple(conditions), problem.options.cone)

    return _searched(problem, coarser)


def can_be_abstracted(problem: Problem) -> bool:
    """True if an abstraction of variables makes processes interchangeable."""
    conditions = tuple(trigger.condition for trigger in triggers_of(problem.tasks, problem.network))
    hold = problem.options.cone
    return _less_known(problem.network, tuple(problem.targets), conditions, hold) is not None


@by_network
def _less_known(
    network: Network, targets: tuple[Expression, ...], conditions: tuple[Expression, ...], hold: bool
) -> OverApproximation | None:
    mentioned = [*targets, *conditions]
    reduced = cone_of_influence(network, mentioned).network if hold else network
    less = with_abstracted_variables(reduced, mentioned)
    if less is None:
        return None
    names = tuple(variable.name for variable in less.variables)
    left_out = unexamined(network, reduced)
    return OverApproximation(less.network, targets, conditions, unexamined=left_out, less_known=names)


def _searched(problem: Problem, relaxing: Relaxing) -> Findings:
    """The verdicts about targets that are unreachable in an over-approximation, and what was found about those that are
    reached there."""
    targets = problem.targets
    triggers = triggers_of(problem.tasks, problem.network)
    approximation = relaxing(targets, [trigger.condition for trigger in triggers])
    if approximation is None:
        return Findings({})
    program, goals = lowered(approximation.network, approximation.targets, approximation.conditions, problem.options)
    outcome = explore(program, goals, problem.options, problem.limits)
    if outcome.reason == INTERRUPTED:
        return Findings(none_begun(problem.tasks, INTERRUPTED))
    statistics = replace(
        outcome.statistics, less_known=approximation.less_known, asked_of_all=approximation.symmetrised
    )
    of_targets = list(zip(problem.tasks, outcome.goals[: len(targets)], strict=True))
    settled = {
        task.number: Verdict(
            task.query, answers_of(task.query)[1], True, "", statistics, unexamined=approximation.unexamined
        )
        for task, goal in of_targets
        if goal.status is Status.UNREACHABLE
    }
    found = {
        task.number: ReachedInAbstraction(approximation, tuple(goal.path), statistics)
        for task, goal in of_targets
        if goal.status is Status.REACHED and goal.path is not None and outcome.exact
    }
    return Findings(with_notes(settled, triggers, outcome.goals[len(targets) :]), found)


def reduced_for(network: Network, mentioned: Sequence[Expression], options: Options) -> Transformation:
    """The network as it is searched for the mentioned variables."""
    return cone_of_influence(network, mentioned) if options.cone else unchanged(network)


def lowered(
    network: Network, targets: Sequence[Expression], conditions: Sequence[Expression], options: Options
) -> tuple[Program, tuple[Goal, ...]]:
    """The program, the goals of the targets, and behind them those of conditions, for which no search goes on."""
    predicates = [*targets, *conditions]
    program, goals = lower(network, predicates)
    if options.symmetry and coarse_partition(network).repeats:
        from tachk.engine.symmetry.tables import with_symmetry  # of no use where all processes differ

        program = with_symmetry(program, network, predicates)
    return program, (*goals[: len(targets)], *noted(goals[len(targets) :]))
