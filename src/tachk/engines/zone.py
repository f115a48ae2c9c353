"""The symbolic engine: a program goes to the C++ explorer, its findings come back as an `Outcome`."""

from __future__ import annotations

import os
import time
from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from enum import Enum

from tachk import _core
from tachk.compiler.program import (
    ClockConstraint,
    Condition,
    DeadlockLiteral,
    Goal,
    Program,
    ProgramLocation,
    Update,
)
from tachk.diagnostics.diagnostic import InternalError
from tachk.diagnostics.span import NOWHERE, Span
from tachk.engines.options import Extrapolation, Limits, Options
from tachk.engines.outcome import (
    INTERRUPTED,
    TIME_LIMIT,
    GoalOutcome,
    Outcome,
    Progress,
    RunTimeFault,
    Statistics,
    Status,
)
from tachk.model.fault import RuntimeErrorKind
from tachk.semantics.timed_trace import Participant, Transition

_OPTION_NAMES = [name for name in vars(_core.Options) if not name.startswith("_")]
_REASONS = {
    _core.Status.STATE_LIMIT: "state limit",
    _core.Status.MEMORY_LIMIT: "memory limit",
    _core.Status.DEPTH_LIMIT: "depth limit",
    _core.Status.FAULT: "run-time error",
    _core.Status.CONSTANT_LIMIT: "clock values beyond 2**58 without extrapolation",
}
_SLICE_SECONDS = 0.1


def explore(
    program: Program,
    goals: Sequence[Goal],
    options: Options = Options(),
    limits: Limits = Limits(),
    progress: Progress | None = None,
) -> Outcome:
    """Search the zone graph until every goal is decided or a limit is hit.

    Ctrl-C ends the search with the reason INTERRUPTED. ``progress`` is called a few times a second.

    LU bounds do not preserve deadlock: a widened zone holds valuations that can do less than those they stand for, so
    that some may be stuck where no true one is. But every true valuation is in a stored zone, so that a search that
    finds no deadlock has proved that there is none, and it is much smaller than one with MAX, which does preserve it.
    A deadlock found this way is replayed without extrapolation; if that does not confirm it, a search with MAX decides.
    Priorities and broadcast guards also depend on an action being impossible; their bounds are already the maximum (see
    `tachk.compiler.bounds`).
    """
    outcome, doubtful = _search(program, goals, options, limits, progress)
    if not doubtful:
        return outcome
    if outcome.reason == INTERRUPTED:
        goals_left = dict.fromkeys(doubtful, GoalOutcome(Status.UNDECIDED))
        return replace(outcome, goals=_with_goals(outcome, goals_left))
    limits = limits.after(outcome.statistics.seconds)
    finer = replace(options, extrapolation=Extrapolation.MAX)
    second, _ = _search(program, [goals[number] for number in doubtful], finer, limits, progress)
    return _joined(outcome, second, doubtful)


def _search(
    program: Program, goals: Sequence[Goal], options: Options, limits: Limits, progress: Progress | None
) -> tuple[Outcome, list[int]]:
    """The outcome of one exploration, and the goals that may be REACHED only seemingly."""
    explorer = _explorer(program, goals, options, limits)
    start, user = time.perf_counter(), _user_seconds()
    status, reason = _run(explorer, start, limits, progress)
    fault = _fault(program, explorer) if status is _core.Status.FAULT else None
    outcomes = tuple(_goal_outcome(program, explorer, number, status) for number in range(len(goals)))
    statistics = replace(_statistics(explorer, start), user_seconds=_user_seconds() - user)
    outcome = Outcome(outcomes, statistics, reason, fault, exact=not program.has_stopwatches)
    if options.extrapolation is not Extrapolation.LU:
        return outcome, []
    exact = replace(options, extrapolation=Extrapolation.NONE)
    doubtful = []
    for number, goal in enumerate(goals):
        node = explorer.reached(number)
        if node is not None and any(d.deadlock is not DeadlockLiteral.ABSENT for d in goal.disjuncts):
            if not _explorer(program, goals, exact, Limits()).leads_to(explorer.path(node), number):
                doubtful.append(number)
    return outcome, doubtful


def _user_seconds() -> float:
    """CPU time of this process in user mode so far."""
    try:
        import resource
    except ImportError:  # Windows, where time is counted more coarsely
        return os.times().user
    return resource.getrusage(resource.RUSAGE_SELF).ru_utime


def _explorer(program: Program, goals: Sequence[Goal], options: Options, limits: Limits) -> _core.Explorer:
    return _core.Explorer(_encode(program, goals), core_options(options), _core_limits(limits))


def core_options(options: Options) -> _core.Options:
    """What the core takes of the options: its own have the same names, its enumerations the same members."""
    taken = _core.Options()
    for name in _OPTION_NAMES:
        value, kind = getattr(options, name), type(getattr(taken, name))
        setattr(taken, name, kind[value.name] if isinstance(value, Enum) else kind(value))
    return taken


def _core_limits(limits: Limits) -> _core.Limits:
    taken = _core.Limits()
    if limits.states is not None:
        taken.states = min(limits.states, taken.states)
    if limits.memory_bytes is not None:
        taken.memory_bytes = min(limits.memory_bytes, taken.memory_bytes)
    if limits.depth is not None:
        taken.depth = min(limits.depth, taken.depth - 1)  # the largest stands for no limit
    return taken


def _joined(first: Outcome, second: Outcome, repeated: Sequence[int]) -> Outcome:
    """The outcome of a search with some of its goals searched for again: the work adds up."""
    a, b = first.statistics, second.statistics
    return replace(
        first,
        goals=_with_goals(first, dict(zip(repeated, second.goals, strict=True))),
        statistics=Statistics(
            a.states_explored + b.states_explored,
            max(a.states_stored, b.states_stored),
            a.transitions + b.transitions,
            a.seconds + b.seconds,
            max(a.peak_bytes, b.peak_bytes),
            a.user_seconds + b.user_seconds,
        ),
        reason=first.reason or second.reason,
        fault=first.fault or second.fault,
    )


def _with_goals(outcome: Outcome, others: Mapping[int, GoalOutcome]) -> tuple[GoalOutcome, ...]:
    return tuple(others.get(number, goal) for number, goal in enumerate(outcome.goals))


def _run(explorer: _core.Explorer, start: float, limits: Limits, progress: Progress | None) -> tuple[_core.Status, str]:
    slice_size = 256
    while True:
        begun = time.perf_counter()
        try:
            status = explorer.run(slice_size)
        except KeyboardInterrupt:
            return _core.Status.RUNNING, INTERRUPTED
        except MemoryError:
            return _core.Status.RUNNING, "the machine is out of memory"
        if status is not _core.Status.RUNNING:
            return status, _REASONS.get(status, "")
        now = time.perf_counter()
        if limits.seconds is not None and now - start >= limits.seconds:
            return _core.Status.RUNNING, TIME_LIMIT
        try:
            if progress is not None:
                progress(_statistics(explorer, start))
        except KeyboardInterrupt:
            return _core.Status.RUNNING, INTERRUPTED
        if now - begun < _SLICE_SECONDS / 2:
            slice_size *= 2
        elif now - begun > 2 * _SLICE_SECONDS:
            slice_size = max(slice_size // 2, 1)


def _statistics(explorer: _core.Explorer, start: float) -> Statistics:
    explored, stored, transitions, peak = explorer.statistics()
    return Statistics(explored, stored, transitions, time.perf_counter() - start, peak)


def _goal_outcome(program: Program, explorer: _core.Explorer, goal: int, status: _core.Status) -> GoalOutcome:
    node = explorer.reached(goal)
    if node is not None:
        return GoalOutcome(Status.REACHED, _path(program, explorer.path(node)))
    return GoalOutcome(Status.UNREACHABLE if status is _core.Status.FINISHED else Status.UNDECIDED)


def _fault(program: Program, explorer: _core.Explorer) -> RunTimeFault:
    fault = explorer.fault()
    if fault is None:
        raise InternalError("the explorer stopped at a run-time error that it does not remember")
    kind, position, path, edges = fault
    transition = _transition(program, edges) if edges else None
    return RunTimeFault(RuntimeErrorKind[kind.name], _site(program, position), _path(program, path), transition)


def _site(program: Program, position: int) -> Span:
    found = bisect_right(program.sites, position, key=lambda site: site[0])
    return program.sites[found - 1][1] if found else NOWHERE


def _path(program: Program, path: Sequence[Sequence[int]]) -> tuple[Transition, ...]:
    return tuple(_transition(program, edges) for edges in path)


def _transition(program: Program, edges: Sequence[int]) -> Transition:
    chosen = (program.edges[number] for number in edges)
    return Transition(tuple(Participant(edge.process, edge.edge, edge.selects) for edge in chosen))


# ---- the flat form of a program, read by src/core/program/program.cpp ----------------------------------------------


def _encode(program: Program, goals: Sequence[Goal]) -> list[int]:
    image = [program.clocks, program.state_slots, len(program.slots)]
    for slot in program.slots:
        image += (slot.low, slot.high, slot.initial, int(slot.meta))
    image += (len(program.code), *program.code)
    image.append(len(program.channels))
    for channel in program.channels:
        image += (int(channel.broadcast), int(channel.urgent), channel.priority)
    image.append(len(program.locations))
    for priority, locations in zip(program.process_priorities, program.locations, strict=True):
        image += (priority, len(locations))
        for location in locations:
            image.extend(_location(location))
    image.append(len(program.edges))
    for edge in program.edges:
        image += (edge.process, edge.source, edge.target)
        image.extend(_condition(edge.guard))
        image += (edge.channel, edge.channels, edge.channel_code, int(edge.sends))
        image.extend(_update(edge.update))
    image.append(len(goals))
    for goal in goals:
        image.append(len(goal.disjuncts))
        for disjunct in goal.disjuncts:
            image.append(int(disjunct.deadlock))
            image.extend(_condition(disjunct.condition))
    image.append(program.default_priority)
    image += (len(program.maximum_constants), *program.maximum_constants)
    image += (len(program.diagonals), *(number for diagonal in program.diagonals for number in diagonal))
    image += (int(program.has_priorities), int(program.has_stopwatches), program.largest_reset, program.computed_unit)
    return image


def _location(location: ProgramLocation) -> Iterator[int]:
    yield from _condition(location.invariant)
    yield from (int(location.urgent), int(location.committed))
    for pairs in (location.stopped, location.lower, location.upper):
        yield len(pairs)
        for pair in pairs:
            yield from pair


def _condition(condition: Condition) -> Iterator[int]:
    yield len(condition.tests)
    for test in condition.tests:
        yield from (test.slot, int(test.comparison), test.constant)
    yield condition.code
    yield len(condition.constraints)
    for constraint in condition.constraints:
        yield from _constraint(constraint)


def _constraint(c: ClockConstraint) -> tuple[int, ...]:
    return (c.left, c.right, int(c.strict), c.bound, c.bound_code, c.condition, c.left_code, c.right_code)


def _update(update: Update) -> Iterator[int]:
    for pairs in (update.stores, update.resets):
        yield len(pairs)
        for pair in pairs:
            yield from pair
    yield update.code
