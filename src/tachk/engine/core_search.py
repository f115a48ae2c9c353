"""The interface to searches of the core: their inputs, the way they run, and their results."""

from __future__ import annotations

import os
import time
from bisect import bisect_right
from collections.abc import Callable, Sequence
from enum import Enum
from typing import Protocol

from tachk import _core
from tachk.base.diagnostics.diagnostic import InternalError
from tachk.base.job import StoppedError, current_job, is_interrupted, note_interruption
from tachk.base.span import NOWHERE, Span
from tachk.engine.compiler.program import Program
from tachk.engine.options import REDUCTIONS, Limits, Options
from tachk.engine.outcome import INTERRUPTED, MACHINE_OUT_OF_MEMORY, STATE_LIMIT, TIME_LIMIT, Statistics
from tachk.model.fault import RuntimeErrorKind
from tachk.model.run import Participant, RunTimeFault, Transition

_OPTION_NAMES = [name for name in vars(_core.Options) if not name.startswith("_")]
_REASONS = {
    _core.Status.STATE_LIMIT: STATE_LIMIT,
    _core.Status.TIME_LIMIT: TIME_LIMIT,
    _core.Status.MEMORY_LIMIT: "memory limit",
    _core.Status.DEPTH_LIMIT: "depth limit",
    _core.Status.FAULT: "run-time error",
    _core.Status.CONSTANT_LIMIT: "clock values that are too large",
}
RUN_TIME_ERROR = _REASONS[_core.Status.FAULT]


def reason_of(status: _core.Status) -> str:
    """Why a search ended without a result, as reports say it; empty if it has one."""
    return _REASONS.get(status, "")


_SLICE_SECONDS = 0.1


class RunningSearch(Protocol):
    """A search of the core for any kind of goal."""

    def run(
        self, expansions: int, seconds: float | None = None, poll: Callable[[], None] | None = None
    ) -> _core.Status: ...
    def statistics(self) -> tuple[int, int, int, int]: ...


class MeasuredSearch(RunningSearch, Protocol):
    def effort(self) -> int: ...


class CoreSearch(RunningSearch, Protocol):
    """A search that remembers the run-time error that ended it."""

    def fault(self) -> tuple[_core.FaultKind, int, list[list[int]], list[int]] | None: ...


def core_options(options: Options) -> _core.Options:
    """The options of the core: its own have the same names, its enumerations the same members."""
    taken = _core.Options()
    for name in _OPTION_NAMES:
        value = name not in options.without if name in REDUCTIONS else getattr(options, name)
        kind = type(getattr(taken, name))
        setattr(taken, name, kind[value.name] if isinstance(value, Enum) else kind(value))
    return taken


def core_limits(limits: Limits) -> _core.Limits:
    """The limits that the core checks itself. The caller gives it the time that is left for each piece of a search."""
    taken = _core.Limits()
    if limits.states is not None:
        taken.states = min(limits.states, taken.states)
    if limits.memory_bytes is not None:
        taken.memory_bytes = min(limits.memory_bytes, taken.memory_bytes)
    if limits.depth is not None:
        taken.depth = min(limits.depth, taken.depth - 1)  # the largest stands for no limit
    return taken


def user_seconds() -> float:
    """CPU time of this process in user mode so far."""
    try:
        import resource
    except ImportError:  # Windows, where time is counted more coarsely
        return os.times().user
    return resource.getrusage(resource.RUSAGE_SELF).ru_utime


def run_in_slices(search: RunningSearch, start: float) -> tuple[_core.Status, str]:
    """Run a search that began at ``start`` to its end or a limit: its last status, and why it is not FINISHED.

    The time, the memory beside what the search counts, and who follows it are those of the job that is under way.
    """
    if is_interrupted():
        return _core.Status.RUNNING, INTERRUPTED
    job = current_job()
    slice_size = 256
    while True:
        begun = time.perf_counter()
        try:
            status = search.run(slice_size, job.seconds_left, job.check_memory)
            if status is _core.Status.RUNNING:
                job.check()
                if job.progress is not None:
                    job.progress(statistics_of(search, start), job.about)
        except KeyboardInterrupt:
            note_interruption()
            return _core.Status.RUNNING, INTERRUPTED
        except StoppedError as error:
            return _core.Status.RUNNING, error.reason
        except MemoryError:
            return _core.Status.RUNNING, MACHINE_OUT_OF_MEMORY
        if status is not _core.Status.RUNNING:
            return status, reason_of(status)
        now = time.perf_counter()
        if now - begun < _SLICE_SECONDS / 2:
            slice_size *= 2
        elif now - begun > 2 * _SLICE_SECONDS:
            slice_size = max(slice_size // 2, 1)


class _Counting(Protocol):
    def statistics(self) -> tuple[int, int, int, int]: ...


def statistics_of(search: _Counting, start: float) -> Statistics:
    """The statistics of a search that began at ``start`` so far."""
    explored, stored, transitions, peak = search.statistics()
    return Statistics(explored, stored, transitions, time.perf_counter() - start, peak)


def fault_of(program: Program, search: CoreSearch) -> RunTimeFault:
    """The run-time error that ended a search with the status FAULT."""
    fault = search.fault()
    if fault is None:
        raise InternalError("the search stopped at a run-time error that it does not remember")
    kind, position, path, edges = fault
    transition = transition_of(program, edges) if edges else None
    site = site_of(program, position)
    return RunTimeFault(RuntimeErrorKind[kind.name], site, transitions_of(program, path), transition)


def fault_of_goal(program: Program, search: _core.Explorer, goal: int) -> RunTimeFault | None:
    """The run-time error in the predicate of a goal, if there was one."""
    failure = search.failure(goal)
    if failure is None:
        return None
    kind, position, path = failure
    site = site_of(program, position)
    return RunTimeFault(RuntimeErrorKind[kind.name], site, transitions_of(program, path), None, of_query=True)


def site_of(program: Program, position: int) -> Span:
    """The place in the text of a position of the code."""
    found = bisect_right(program.sites, position, key=lambda site: site[0])
    return program.sites[found - 1][1] if found else NOWHERE


def transitions_of(program: Program, path: Sequence[Sequence[int]]) -> tuple[Transition, ...]:
    """The transitions of a path of edge numbers; those with the same edges are the same object."""
    known: dict[tuple[int, ...], Transition] = {}
    found = []
    for edges in map(tuple, path):
        transition = known.get(edges)
        if transition is None:
            transition = known[edges] = transition_of(program, edges)
        found.append(transition)
    return tuple(found)


def transition_of(program: Program, edges: Sequence[int]) -> Transition:
    chosen = (program.edges[number] for number in edges)
    return Transition(tuple(Participant(edge.process, edge.edge, edge.selects) for edge in chosen))
