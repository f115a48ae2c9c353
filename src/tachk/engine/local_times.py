"""Searches in which each process has a time of its own: where they are sound, where they pay, and what they find.

An ordinary zone knows in which order independent things have happened. A zone over local times does not, so that it
stands for all orders (Govind, Herbreteau, Srivathsan, Walukiewicz 2019). That saves states where processes seldom meet;
elsewhere larger matrices only cost time.
"""

from __future__ import annotations

from collections.abc import Sequence

from tachk import _core
from tachk.base.job import OutOfMemoryError, current_job
from tachk.base.records import replace
from tachk.engine.compiler.program import Goal, Program
from tachk.engine.core_search import core_limits, core_options
from tachk.engine.options import Extrapolation, Limits, LocalTimes, Options
from tachk.engine.program_image import encode

_SAMPLE = 500
"""The number of states that both searches explore before one is chosen."""
_SAMPLE_WORK = 20_000
"""Where those take longer than so much work, fewer are explored: a state of 100 processes takes that of thousands."""
_STEP = 2
_MUCH_MEMORY = 256 << 20
"""A zone over the local times of 100 processes, of which all are kept that wait, takes hundreds of kilobytes."""
_FEW_ZONES = 2.0
"""With fewer zones for each discrete state there are few orders to be saved."""
_MOST_WORK_EACH = 4
_WORTH_IT = 3.0
"""The ratio of zones for each discrete state from which larger matrices pay. On the example families of TChecker it is
below 2.5 or above 5.8."""


def obstacle(image: Sequence[int]) -> str | None:
    """The reason why local times are not sound for a program with its goals, as `encode` writes them, or None."""
    return _core.local_agents(image)[0]


def begin(
    program: Program, goals: Sequence[Goal], ordinary: _core.Explorer, options: Options, limits: Limits
) -> _core.LocalExplorer | None:
    """A search over local times, where the options and the program allow it and it seems to pay; else None.

    Where it meets a run-time error or times out of range an ordinary search has to answer: the order in which things
    happen counts for those.

    Args:
        ordinary: a search of the same that has not run; it may have explored some states behind this.
    """
    counts_steps = options.shortest or limits.depth is not None
    if counts_steps or options.extrapolation is Extrapolation.NONE:
        return None
    samples = options.local_times is LocalTimes.AUTO
    states = 0
    if samples:
        status, states = _explore_sample(ordinary, _SAMPLE, _SAMPLE_WORK)
        if status is not _core.Status.RUNNING:
            return None  # what stops it now stops it again when it goes on
    image = encode(program, goals)
    if obstacle(image) is not None:
        return None
    if samples:
        if ordinary.has_merged():  # which hides how many orders there are
            ordinary = _core.Explorer(image, core_options(options.off("merging")), core_limits(limits))
            status, states = _explore_sample_beside(ordinary, _SAMPLE, _SAMPLE_WORK)
            if status is not _core.Status.RUNNING:
                return None
        if _zones_each(ordinary) < _FEW_ZONES:
            return None
    if any(goal.asks_deadlock for goal in goals):
        # With LU a state may be covered by others that can do more: it may be stuck where they are not.
        options = replace(options, extrapolation=Extrapolation.MAX)
    search = _core.LocalExplorer(image, core_options(options), core_limits(limits))
    if samples:
        # A state takes more work with larger matrices. One that takes many times as much is not worth it.
        status, explored = _explore_sample_beside(search, states, _SAMPLE_WORK)
        if status in _IMPATIENT or (status is _core.Status.RUNNING and explored < states // _MOST_WORK_EACH):
            return None
        if status is _core.Status.RUNNING and _zones_each(ordinary) < _WORTH_IT * _zones_each(search):
            return None
    return search


_IMPATIENT = (_core.Status.TIME_LIMIT, _core.Status.MEMORY_LIMIT)


def _explore_sample(search: _core.Explorer | _core.LocalExplorer, states: int, work: int) -> tuple[_core.Status, int]:
    """The status behind a first look, and how many states it has explored of those that are wanted.

    The status is RUNNING if there is more to explore, also where so much work was done before, and MEMORY_LIMIT also if
    it takes much more memory than a search needs as a rule.
    """
    job = current_job()
    end = search.effort() + work
    explored = 0
    while explored < states and search.effort() < end:
        step = min(_STEP, states - explored)
        status = search.run(step, job.seconds_left, job.check_memory)
        if status is not _core.Status.RUNNING:
            return status, explored
        explored += step
        if search.statistics()[3] > _MUCH_MEMORY:
            return _core.Status.MEMORY_LIMIT, explored
    return _core.Status.RUNNING, explored


def _explore_sample_beside(
    search: _core.Explorer | _core.LocalExplorer, states: int, work: int
) -> tuple[_core.Status, int]:
    """A first look of a search without which another one goes on, with the memory that this one has taken."""
    try:
        return _explore_sample(search, states, work)
    except (MemoryError, OutOfMemoryError):
        return _core.Status.MEMORY_LIMIT, 0


def _zones_each(search: _core.Explorer | _core.LocalExplorer) -> float:
    """The mean number of zones that are stored for a discrete state."""
    return search.statistics()[1] / max(search.discrete_states(), 1)
