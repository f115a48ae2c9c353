"""The symbolic engine: a program goes to the C++ explorer, its findings come back as an `Outcome`."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING

from tachk import _core
from tachk.base.job import OutOfMemoryError
from tachk.base.records import replace
from tachk.engine.compiler.program import Goal, Program
from tachk.engine.core_search import (
    RUN_TIME_ERROR,
    core_limits,
    core_options,
    fault_of,
    fault_of_goal,
    run_in_slices,
    transitions_of,
    user_seconds,
)
from tachk.engine.options import Extrapolation, Limits, Options
from tachk.engine.outcome import INTERRUPTED, MACHINE_OUT_OF_MEMORY, FoundPath, GoalOutcome, Outcome, Statistics, Status
from tachk.engine.portfolio import PORTFOLIO, SearchProblem, SearchStrategy
from tachk.engine.program_image import encode
from tachk.engine.reduced_statistics import with_orbits
from tachk.engine.taking_turns import EndedSearch, from_portfolio, measured

if TYPE_CHECKING:
    from tachk.engine.portfolio import GoalSearch


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


_SHORT_RUN = 32
"""A run of so many steps is short enough to be shown, though a search breadth first may find a shorter one."""


def short_runs(
    program: Program, goals: Sequence[Goal], options: Options = Options(), limits: Limits = Limits()
) -> Outcome:
    """Search as those rows of the portfolio do that look for short runs.

    All goals that decide are REACHED by short runs, or none is decided.
    """
    begun = time.perf_counter(), user_seconds()
    problem = SearchProblem(program, goals, options, limits, _explorer(program, goals, options, limits))
    ended = EndedSearch(problem.ordinary, _core.Status.RUNNING, "", Statistics())
    for row in reversed(PORTFOLIO):  # those of `best-first` are shorter than those that are drawn
        search = row.begin(problem) if row.short_work and row.is_allowed(options, limits) else None
        if search is None or isinstance(search, _core.LocalExplorer):
            continue
        status, reason = replace(row, work=row.short_work, longest=_SHORT_RUN).run(search)
        if row.decides(problem, search, status) and _are_short(goals, search):
            if not _doubtful(program, goals, options, search):
                ended = EndedSearch(search, _core.Status.FINISHED, "", measured(search, begun), row.name)
                break
        if SearchStrategy.is_stopped(status, reason):
            ended = EndedSearch(problem.ordinary, status, reason, measured(problem.ordinary, begun))
            break
    return _outcome_of(program, goals, options, ended)[0]


def _are_short(goals: Sequence[Goal], search: GoalSearch) -> bool:
    decisive = [number for number, goal in enumerate(goals) if goal.decides]
    return all(len(search.path_to_goal(number)) <= _SHORT_RUN for number in decisive)


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
    outcome, doubtful = _outcome_of(program, [*goals, never], options, _to_the_end(explorer, begun))
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
    """True if a path of edges of the program, by their numbers, leads to a goal. Zones are exact."""
    exact = replace(options, extrapolation=Extrapolation.NONE)
    return _explorer(program, goals, exact, Limits()).leads_to(actions, goal)


def _search(program: Program, goals: Sequence[Goal], options: Options, limits: Limits) -> tuple[Outcome, list[int]]:
    """The outcome of the first search of the portfolio that decides all goals, else of the ordinary one; and the goals
    that may be REACHED only seemingly."""
    begun = time.perf_counter(), user_seconds()
    problem = SearchProblem(program, goals, options, limits, _explorer(program, goals, options, limits))
    try:
        ended = from_portfolio(problem, begun, lambda search: not _doubtful(program, goals, options, search))
    except (MemoryError, OutOfMemoryError) as error:
        # In the midst of a state: the search cannot go on from there.
        reason = error.reason if isinstance(error, OutOfMemoryError) else MACHINE_OUT_OF_MEMORY
        ended = EndedSearch(problem.ordinary, _core.Status.RUNNING, reason, measured(problem.ordinary, begun))
    return _outcome_of(program, goals, options, ended)


def _to_the_end(explorer: _core.Explorer, begun: tuple[float, float]) -> EndedSearch:
    """Runs a search.

    Args:
        begun: the time, and the time in user mode, when the search began.
    """
    status, reason = run_in_slices(explorer, begun[0])
    return EndedSearch(explorer, status, reason, measured(explorer, begun))


def _outcome_of(
    program: Program, goals: Sequence[Goal], options: Options, ended: EndedSearch
) -> tuple[Outcome, list[int]]:
    """The outcome of a search, and the goals REACHED only seemingly."""
    search, statistics = ended.search, ended.statistics
    fault = None
    if isinstance(search, _core.Explorer):
        fault = fault_of(program, search) if ended.status is _core.Status.FAULT else None
    if isinstance(search, _core.Explorer) or (isinstance(search, _core.LocalExplorer) and search.permutes()):
        statistics = with_orbits(statistics, program)
    outcomes = tuple(goal_outcome(program, search, number, goal, ended.status) for number, goal in enumerate(goals))
    outcomes = _noted(goals, outcomes)
    reason = ended.reason
    if fault is None:
        fault = next((o.fault for g, o in zip(goals, outcomes, strict=True) if g.decides and o.fault is not None), None)
        reason = reason or (RUN_TIME_ERROR if fault is not None else "")
    exact = not program.has_stopwatches
    outcome = Outcome(outcomes, statistics, reason, fault, exact, ended.name)
    return outcome, [] if ended.name else _doubtful(program, goals, options, search)


def _doubtful(program: Program, goals: Sequence[Goal], options: Options, search: GoalSearch) -> list[int]:
    """The goals that a search has reached, maybe only seemingly: those that a replay does not confirm."""
    everybody = replace(program, interchangeable=())
    if not isinstance(search, _core.Explorer | _core.LocalExplorer):
        found = [number for number, _ in enumerate(goals) if search.reached(number) is not None]
        return [n for n in found if not _is_run(everybody, goals, options, search.path_to_goal(n), n)]
    if options.extrapolation.keeps_deadlocks or isinstance(search, _core.LocalExplorer):
        return []
    doubtful = []
    for number, goal in enumerate(goals):
        if goal.asks_deadlock and search.reached(number) is not None:
            if not leads_to(everybody, goals, options, search.path_to_goal(number), number):
                doubtful.append(number)
    return doubtful


def _is_run(
    program: Program, goals: Sequence[Goal], options: Options, actions: Sequence[Sequence[int]], goal: int
) -> bool:
    """True if the judge of runs accepts the path with its earliest times; where it knows no rule, if zones do."""
    from tachk.engine.exact.exact_run import exact_run

    times, _ = exact_run(program, goals[goal], actions)
    return times is not None or leads_to(program, goals, options, actions, goal)


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
    program: Program,
    search: GoalSearch,
    number: int,
    goal: Goal,
    status: _core.Status,
) -> GoalOutcome:
    """The outcome of a search, which ended with a status, for a goal."""
    if search.reached(number) is not None:
        if not goal.decides:
            return GoalOutcome(Status.REACHED)
        path = FoundPath(partial(search.path_to_goal, number), partial(transitions_of, program))
        return GoalOutcome(Status.REACHED, path)
    fault = fault_of_goal(program, search, number) if isinstance(search, _core.Explorer) else None
    if fault is not None:
        return GoalOutcome(Status.UNDECIDED, fault=fault)
    return GoalOutcome(Status.UNREACHABLE if status is _core.Status.FINISHED else Status.UNDECIDED)
