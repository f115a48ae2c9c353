"""The search for runs that avoid a predicate for ever: a program goes to the core, what it finds comes back."""

from __future__ import annotations

import time
from collections.abc import Sequence

from tachk import _core
from tachk.base.records import replace
from tachk.engine.compiler.program import Goal, Program
from tachk.engine.core_search import (
    core_limits,
    core_options,
    fault_of,
    run_in_slices,
    statistics_of,
    transitions_of,
    user_seconds,
)
from tachk.engine.options import Extrapolation, Limits, Options
from tachk.engine.outcome import AvoidingRun, LivenessOutcome, LivenessStatus, RunEnd
from tachk.engine.program_image import encode
from tachk.engine.reduced_statistics import with_orbits


def find_avoiding_run(
    program: Program,
    avoided: Goal,
    begins: Goal | None = None,
    options: Options = Options(),
    limits: Limits = Limits(),
) -> LivenessOutcome:
    """Look for a run that never meets ``avoided``: from the initial state, or from any reachable state of ``begins``
    that is none of ``avoided``.

    Where processes of the program are interchangeable, which must leave both predicates as they are, one state stands
    for all that exchanges make of it. A loop that leads to an exchange of where it began can be gone round again,
    exchanged, and comes back to where it began after some rounds. If there is no run, that is the answer; a run is
    searched again among all states, to have its states.

    The clock bounds of the program must count the constants of both predicates as lower and as upper bounds, so that
    a zone is never widened across the border of one. Ctrl-C ends the search with the reason INTERRUPTED.

    LU bounds keep infinite runs, and those in which time passes for ever: what a widened valuation can do a true one
    can do. They do not keep runs that get stuck, because a widened valuation may be able to do less. Such a run is
    tried without extrapolation; if it proves not to be one, a search with MAX decides.
    """
    if not program.interchangeable:
        return _avoiding_run(program, avoided, begins, options, limits)
    first = _avoiding_run(program, avoided, begins, options, limits)
    if first.status is LivenessStatus.NONE or (first.status is LivenessStatus.UNDECIDED and first.fault is None):
        return replace(first, statistics=with_orbits(first.statistics, program))
    everybody = replace(program, interchangeable=())
    second = _avoiding_run(everybody, avoided, begins, options, limits)
    return replace(second, statistics=first.statistics.then(second.statistics))


def _avoiding_run(
    program: Program, avoided: Goal, begins: Goal | None, options: Options, limits: Limits
) -> LivenessOutcome:
    """As `find_avoiding_run`, by one search; where processes are interchangeable a run is one up to exchanges."""
    goals = [avoided] if begins is None else [avoided, begins]
    if not options.extrapolation.keeps_deadlocks and any(goal.asks_deadlock for goal in goals):
        # A widened valuation may be stuck where the true ones are not, and so on one side of the goal only.
        options = replace(options, extrapolation=Extrapolation.MAX)
    first, stands = _search(program, goals, options, limits)
    if stands:
        return first
    finer = replace(options, extrapolation=Extrapolation.MAX)
    second, _ = _search(program, goals, finer, limits)
    return replace(second, statistics=first.statistics.then(second.statistics))


def find_recurring_run(
    program: Program,
    goals: Sequence[Goal],
    begins: bool = False,
    options: Options = Options(),
    limits: Limits = Limits(),
) -> LivenessOutcome:
    """Look for a run that avoids a predicate, and that meets others again and again or ends where it may.

    MAX is used in place of LU: then a run that seems stuck is stuck.

    Args:
        program, goals: as `tachk.engine.compiler.lower.lower_recurrence` gives them.
        begins: whether one of the goals says where runs begin to avoid the predicate.
    """
    if not options.extrapolation.keeps_deadlocks:
        options = replace(options, extrapolation=Extrapolation.MAX)
    image = encode(program, goals)
    search = _core.RecurrenceSearch(image, begins, core_options(options), core_limits(limits))
    return _outcome(program, search, limits)


def _search(program: Program, goals: Sequence[Goal], options: Options, limits: Limits) -> tuple[LivenessOutcome, bool]:
    """The outcome of one search, and whether it stands."""
    image = encode(program, goals)
    search = _core.LivenessSearch(image, core_options(options), core_limits(limits))
    outcome = _outcome(program, search, limits)
    violation = search.violation()
    if violation is None or violation[0] is not _core.ViolationKind.STUCK:
        return outcome, True
    if options.extrapolation.keeps_deadlocks:
        return outcome, True
    without = replace(options, extrapolation=Extrapolation.NONE)
    probe = _core.LivenessSearch(image, core_options(without), core_limits(Limits()))
    return outcome, probe.gets_stuck(violation[1], violation[2])


def _outcome(
    program: Program,
    search: _core.LivenessSearch | _core.RecurrenceSearch,
    limits: Limits,
) -> LivenessOutcome:
    """The outcome of a search that has not begun."""
    start, user = time.perf_counter(), user_seconds()
    status, reason = run_in_slices(search, start)
    fault = fault_of(program, search) if status is _core.Status.FAULT else None
    statistics = replace(statistics_of(search, start), user_seconds=user_seconds() - user)
    violation = search.violation()
    if violation is None:
        finished = status is _core.Status.FINISHED
        answer = LivenessStatus.NONE if finished else LivenessStatus.UNDECIDED
        return LivenessOutcome(answer, statistics, None, reason, fault, begins=not finished or search.begins())
    kind, stem, begins, loop = violation
    run = AvoidingRun(RunEnd[kind.name], transitions_of(program, stem), begins, transitions_of(program, loop))
    return LivenessOutcome(LivenessStatus.FOUND, statistics, run, exact=not program.has_stopwatches)
