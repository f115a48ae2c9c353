"""The symbolic engine: a program goes to the C++ explorer, its findings come back as an `Outcome`."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace

from tachk import _core
from tachk.base.job import OutOfMemoryError
from tachk.base.records import dataclass
from tachk.engine import attempts
from tachk.engine.compiler.program import Goal, Program
from tachk.engine.core_search import (
    RUN_TIME_ERROR,
    core_limits,
    core_options,
    fault_of,
    fault_of_goal,
    run_in_slices,
    statistics_of,
    transitions_of,
    user_seconds,
)
from tachk.engine.exchanged import with_exchanges
from tachk.engine.local_times import explore_locally
from tachk.engine.options import Extrapolation, Limits, Options
from tachk.engine.outcome import INTERRUPTED, MACHINE_OUT_OF_MEMORY, GoalOutcome, Outcome, Statistics, Status
from tachk.engine.program_image import encode


def explore(
    program: Program,
    goals: Sequence[Goal],
    options: Options = Options(),
    limits: Limits = Limits(),
) -> Outcome:
    """Search the zone graph until every goal is decided or a limit is hit.

    Ctrl-C ends the search with the reason INTERRUPTED. The time is that of the job.

    LU bounds do not preserve deadlock: a widened zone holds valuations that can do less than those they stand for, so
    that some may be stuck where no true one is. But every true valuation is in a stored zone, so that a search that
    finds no deadlock has proved that there is none, and it is much smaller than one with MAX, which does preserve it.
    A deadlock found this way is replayed without extrapolation; if that does not confirm it, a search with MAX decides.
    Priorities and broadcast guards also depend on an action being impossible; their bounds are already the maximum (see
    `tachk.engine.compiler.bounds`).
    """
    outcome, doubtful = _search(program, goals, options, limits)
    if not doubtful:
        return outcome
    if outcome.reason == INTERRUPTED:
        goals_left = dict.fromkeys(doubtful, GoalOutcome(Status.UNDECIDED))
        return replace(outcome, goals=_with_goals(outcome, goals_left))
    finer = replace(options, extrapolation=Extrapolation.MAX)
    second, _ = _search(program, [goals[number] for number in doubtful], finer, limits)
    return _joined(outcome, second, doubtful)


def explore_everything(
    program: Program,
    goals: Sequence[Goal],
    options: Options = Options(),
    limits: Limits = Limits(),
) -> tuple[Outcome, frozenset[tuple[int, int]]]:
    """Search as `explore` does, but go on when every goal is decided, until nothing is left or a limit is hit.

    Returns the outcome, and the edges that were taken, each as (process, edge of the process). If the search has gone
    through everything (the outcome has no reason), no other edge can be taken. It is the reason of the first search
    that counts: one that decides doubtful goals comes after it.
    """
    never = Goal(())
    options = replace(options.off("attempts"), partial_order=False)
    explorer = _explorer(program, [*goals, never], options, limits)
    begun = time.perf_counter(), user_seconds()
    ran = _ran(program, [*goals, never], explorer, options, limits, begun)
    outcome, doubtful = _told(program, [*goals, never], options, ran)
    outcome = replace(outcome, goals=outcome.goals[:-1])
    taken = frozenset((program.edges[n].process, program.edges[n].edge) for n in explorer.taken())
    if doubtful:
        finer = replace(options, extrapolation=Extrapolation.MAX)
        second = explore(program, [goals[n] for n in doubtful], finer, limits)
        reason = outcome.reason
        outcome = replace(_joined(outcome, second, doubtful), reason=reason)
    return outcome, taken


def leads_to(
    program: Program, goals: Sequence[Goal], options: Options, actions: Sequence[Sequence[int]], goal: int
) -> bool:
    """Whether a path of edges of the program, by their numbers, leads to a goal. Zones are exact."""
    exact = replace(options, extrapolation=Extrapolation.NONE)
    return _explorer(program, goals, exact, Limits()).leads_to(actions, goal)


def _search(program: Program, goals: Sequence[Goal], options: Options, limits: Limits) -> tuple[Outcome, list[int]]:
    """The outcome of one exploration, and the goals that may be REACHED only seemingly."""
    begun = time.perf_counter(), user_seconds()
    explorer = _explorer(program, goals, options, limits)
    try:
        found = explore_locally(program, goals, explorer, options, limits)
    except (MemoryError, OutOfMemoryError) as error:
        # In the midst of the first states: the search cannot go on from there.
        reason = error.reason if isinstance(error, OutOfMemoryError) else MACHINE_OUT_OF_MEMORY
        ran = _Ran(explorer, _core.Status.RUNNING, reason, statistics_of(explorer, begun[0]))
        return _told(program, goals, options, ran)
    if found is not None:
        return replace(found, goals=_noted(goals, found.goals)), []
    return _told(program, goals, options, _ran(program, goals, explorer, options, limits, begun))


@dataclass(frozen=True, slots=True)
class _Ran:
    """A search that has ended, with its last status and why that is not FINISHED."""

    explorer: _core.Explorer
    status: _core.Status
    reason: str
    statistics: Statistics


def _ran(
    program: Program,
    goals: Sequence[Goal],
    explorer: _core.Explorer,
    options: Options,
    limits: Limits,
    begun: tuple[float, float],
) -> _Ran:
    """Runs an explorer; or, if that decides the goals, another one for a while.

    Args:
        begun: the time, and the time in user mode, when the search began.
    """
    start, user = begun

    def statistics(search: _core.Explorer) -> Statistics:
        used = user_seconds() - user
        return replace(statistics_of(search, start), user_seconds=used)

    status, reason = _core.Status.STATE_LIMIT, ""
    if attempts.are_made(options, limits):
        stretch = attempts.BudgetedSearch(explorer, stored=attempts.STORED)
        status, reason = run_in_slices(stretch, start)
        others = (attempts.in_one_order, attempts.depth_first) if status is _core.Status.STATE_LIMIT else ()
        reason = "" if others else reason
        for attempt in others:
            if reason:
                break
            first = statistics(explorer)
            other, reason = attempt(program, goals, options, limits)
            if other is not None and not _doubtful(program, goals, options, other):
                # The clock of the other one has run since the first one began.
                both = replace(first, seconds=0.0, user_seconds=0.0).then(statistics(other))
                return _Ran(other, _core.Status.FINISHED, "", both)
    if status is _core.Status.STATE_LIMIT and not reason:
        status, reason = run_in_slices(explorer, start)
    return _Ran(explorer, status, reason, statistics(explorer))


def _told(program: Program, goals: Sequence[Goal], options: Options, ran: _Ran) -> tuple[Outcome, list[int]]:
    """What comes of a search; and the goals REACHED only seemingly."""
    explorer = ran.explorer
    fault = fault_of(program, explorer) if ran.status is _core.Status.FAULT else None
    outcomes = tuple(goal_outcome(program, explorer, number, goal, ran.status) for number, goal in enumerate(goals))
    outcomes = _noted(goals, outcomes)
    statistics = with_exchanges(ran.statistics, program)
    reason = ran.reason
    if fault is None:
        fault = next((o.fault for g, o in zip(goals, outcomes, strict=True) if g.decides and o.fault is not None), None)
        reason = reason or (RUN_TIME_ERROR if fault is not None else "")
    outcome = Outcome(outcomes, statistics, reason, fault, exact=not program.has_stopwatches)
    return outcome, _doubtful(program, goals, options, explorer)


def _doubtful(program: Program, goals: Sequence[Goal], options: Options, explorer: _core.Explorer) -> list[int]:
    """The goals that an explorer has reached, maybe only seemingly: those that a replay does not confirm."""
    if options.extrapolation is not Extrapolation.LU:
        return []
    everybody = replace(program, interchangeable=())
    doubtful = []
    for number, goal in enumerate(goals):
        node = explorer.reached(number)
        if node is not None and goal.asks_deadlock:
            if not leads_to(everybody, goals, options, explorer.path_to_goal(number), number):
                doubtful.append(number)
    return doubtful


def _explorer(program: Program, goals: Sequence[Goal], options: Options, limits: Limits) -> _core.Explorer:
    return _core.Explorer(encode(program, goals), core_options(options), core_limits(limits))


def _joined(first: Outcome, second: Outcome, repeated: Sequence[int]) -> Outcome:
    """The outcome of a search with some of its goals searched for again: the work adds up."""
    return replace(
        first,
        goals=_with_goals(first, dict(zip(repeated, second.goals, strict=True))),
        statistics=first.statistics.then(second.statistics),
        reason=first.reason or second.reason,
        fault=first.fault or second.fault,
    )


def _with_goals(outcome: Outcome, others: Mapping[int, GoalOutcome]) -> tuple[GoalOutcome, ...]:
    return tuple(others.get(number, goal) for number, goal in enumerate(outcome.goals))


def _noted(goals: Sequence[Goal], outcomes: tuple[GoalOutcome, ...]) -> tuple[GoalOutcome, ...]:
    """The outcomes; goals that do not decide are undecided where the search stopped because those that do are met, or
    are errors."""
    pairs = list(zip(goals, outcomes, strict=True))
    if not any(goal.decides for goal in goals) or any(
        goal.decides and found.status is not Status.REACHED and found.fault is None for goal, found in pairs
    ):
        return outcomes
    undecided = GoalOutcome(Status.UNDECIDED)
    return tuple(found if goal.decides or found.status is Status.REACHED else undecided for goal, found in pairs)


def goal_outcome(
    program: Program, explorer: _core.Explorer, number: int, goal: Goal, status: _core.Status
) -> GoalOutcome:
    """What a search that ended with a status has found about a goal."""
    node = explorer.reached(number)
    if node is not None:
        if not goal.decides:
            return GoalOutcome(Status.REACHED)
        actions = explorer.path_to_goal(number)
        return GoalOutcome(Status.REACHED, transitions_of(program, actions), actions)
    fault = fault_of_goal(program, explorer, number)
    if fault is not None:
        return GoalOutcome(Status.UNDECIDED, fault=fault)
    return GoalOutcome(Status.UNREACHABLE if status is _core.Status.FINISHED else Status.UNDECIDED)
