"""Weaker questions: a target that is not reached even if more can happen, or more counts, is unreachable."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace

from tachk.analysis.impossible_edges import without_impossible
from tachk.base.records import dataclass
from tachk.base.time_limit import OutOfTimeError, time_limit
from tachk.engine.compiler.lower import lower
from tachk.engine.compiler.program import Goal, Program
from tachk.engine.options import Limits, Options
from tachk.engine.outcome import INTERRUPTED, Progress, Statistics, Status
from tachk.engine.symmetry.asked_of_all import asked_of_all, names_some
from tachk.engine.symmetry.tables import with_symmetry
from tachk.engine.zone import explore
from tachk.model.expressions import Expression, Variable
from tachk.model.network import Network
from tachk.model.run import Transition
from tachk.transform.blocking_processes import without_bystanders
from tachk.transform.cone_of_influence import without_spectators
from tachk.transform.monotone_counters import budgets
from tachk.verify.plan import Search, Task
from tachk.verify.unanswered import none_begun
from tachk.verify.unexamined import unexamined
from tachk.verify.vacuity import noted, triggers_of, with_notes
from tachk.verify.verdict import Verdict, answers_of

_FIRST_TRY = 1_000_000
"""How many states of a network that can do more than the one in question may be stored: it may have more of them."""
WORTH_CARRYING_OVER = 5_000
"""So many states without bystanders make it worth while to look for the run with them along the one without."""


@dataclass(frozen=True, slots=True)
class Weaker:
    """A network that can do all that another one can, and questions that are true wherever those about it are.

    Attributes:
        targets, conditions: in their order.
        unexamined: what is left out in it and may meet a run-time error.
        less_known: the variables of which it keeps less.
        spared: budgets that need not be followed in it.
        asked_of_all: whether the targets are those of all interchangeable processes.
    """

    network: Network
    targets: Sequence[Expression]
    conditions: Sequence[Expression]
    unexamined: tuple[str, ...] = ()
    less_known: tuple[str, ...] = ()
    spared: frozenset[Variable] = frozenset()
    asked_of_all: bool = False


@dataclass(frozen=True, slots=True)
class ReachedInAbstraction:
    """A target that is reached in a network that can do more.

    Attributes:
        path: the transitions that lead to it there.
    """

    weaker: Weaker
    path: tuple[Transition, ...]
    statistics: Statistics


def settle_without_bystanders(
    network: Network, search: Search, options: Options, limits: Limits, progress: Progress | None
) -> tuple[dict[int, Verdict], dict[int, ReachedInAbstraction]]:
    """The verdicts about targets that are unreachable even if nothing hinders the processes they depend on, and what
    was found about those that are reachable then and worth to be carried over."""

    def relaxed(targets: Sequence[Expression], conditions: Sequence[Expression]) -> Weaker | None:
        possible = without_impossible(network)
        mentioned = [*targets, *conditions]
        rest = without_bystanders(possible, mentioned)
        if rest == possible:
            return None
        spared = budgets(possible, mentioned)
        return Weaker(rest, targets, conditions, unexamined=unexamined(possible, rest), spared=spared)

    settled, found = settle_weaker(relaxed, network, search, options, limits, progress)
    worth = {number: each for number, each in found.items() if each.statistics.states_stored >= WORTH_CARRYING_OVER}
    return settled, {} if options.shortest else worth


def naming_some(unobserved: Network, network: Network, search: Search, options: Options, limits: Limits) -> Search:
    """The search for those targets that name some of several interchangeable processes and can be asked of all.

    Args:
        unobserved: the network without the observer: what is moved in it is found out once for many searches.
    """

    def can_be_asked_of_all(task: Task) -> bool:
        conditions = [trigger.condition for trigger in triggers_of([task], network)]
        return (
            any(names_some(unobserved, question) for question in (task.target, *conditions))
            and _of_all(network, options, [task.target], conditions) is not None
        )

    try:
        with time_limit(limits.seconds):
            return replace(search, tasks=tuple(filter(can_be_asked_of_all, search.tasks)))
    except OutOfTimeError:
        return replace(search, tasks=())


def settle_asked_of_all(
    network: Network, search: Search, options: Options, limits: Limits, progress: Progress | None
) -> dict[int, Verdict]:
    """The verdicts about targets that are unreachable whichever of several interchangeable processes they name: then
    all of these remain interchangeable."""

    def of_all(targets: Sequence[Expression], conditions: Sequence[Expression]) -> Weaker | None:
        return _of_all(network, options, targets, conditions)

    settled, _ = settle_weaker(of_all, network, search, options, limits, progress)
    return settled


def _of_all(
    network: Network, options: Options, targets: Sequence[Expression], conditions: Sequence[Expression]
) -> Weaker | None:
    mentioned = [*targets, *conditions]
    reduced = held(network, mentioned, options)
    asked = asked_of_all(reduced, targets, conditions)
    if asked is None:
        return None
    return Weaker(reduced, *asked, unexamined=unexamined(network, reduced), asked_of_all=True)


def settle_weaker(
    weaker_for: Callable[[Sequence[Expression], Sequence[Expression]], Weaker | None],
    network: Network,
    search: Search,
    options: Options,
    limits: Limits,
    progress: Progress | None,
) -> tuple[dict[int, Verdict], dict[int, ReachedInAbstraction]]:
    """The verdicts about targets that are unreachable by weaker questions, and what was found about those that are not.

    Args:
        weaker_for: the weaker questions for targets and for conditions that are asked on the way; None if there are
            none.
    """
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
            weaker = weaker_for(targets, [trigger.condition for trigger in triggers])
            if weaker is None:
                return {}, {}
            program, goals = lowered(weaker.network, weaker.targets, weaker.conditions, options)
    except OutOfTimeError:
        return {}, {}
    outcome = explore(program, goals, options, first_try.after(time.monotonic() - started), progress)
    if outcome.reason == INTERRUPTED:
        return none_begun(search.tasks, INTERRUPTED), {}
    statistics = replace(outcome.statistics, less_known=weaker.less_known, asked_of_all=weaker.asked_of_all)
    of_targets = list(zip(search.tasks, outcome.goals[: len(targets)], strict=True))
    settled = {
        task.number: Verdict(task.query, answers_of(task.query)[1], True, "", statistics, unexamined=weaker.unexamined)
        for task, goal in of_targets
        if goal.status is Status.UNREACHABLE
    }
    found = {
        task.number: ReachedInAbstraction(weaker, goal.path, statistics)
        for task, goal in of_targets
        if goal.status is Status.REACHED and goal.path is not None and outcome.exact
    }
    return with_notes(settled, triggers, outcome.goals[len(targets) :]), found


def held(network: Network, mentioned: Sequence[Expression], options: Options) -> Network:
    """The network as it is searched for what is mentioned."""
    return without_spectators(network, mentioned) if options.hold_spectators else network


def lowered(
    network: Network, targets: Sequence[Expression], conditions: Sequence[Expression], options: Options
) -> tuple[Program, tuple[Goal, ...]]:
    """The program, the goals of the targets, and behind them those of conditions, for which no search goes on."""
    predicates = [*targets, *conditions]
    program, goals = lower(network, predicates)
    if options.symmetry:
        program = with_symmetry(program, network, predicates)
    return program, (*goals[: len(targets)], *noted(goals[len(targets) :]))
