"""One exploration that finds the extreme values of integers and clocks in the states of goals."""

from __future__ import annotations

import time
from collections.abc import Sequence

from tachk import _core
from tachk.base.records import dataclass, replace
from tachk.engine.compiler.program import Goal, Measure, Program
from tachk.engine.core_search import (
    RUN_TIME_ERROR,
    core_limits,
    core_options,
    fault_of,
    run_in_slices,
    statistics_of,
    transitions_of,
    user_seconds,
)
from tachk.engine.options import Limits, Options
from tachk.engine.outcome import Outcome
from tachk.engine.program_image import encode
from tachk.engine.zone import goal_outcome
from tachk.model.run import Transition


@dataclass(frozen=True, slots=True)
class ExtremeMeasurement:
    """The extreme value of one measure among the states of a search.

    Attributes:
        value: None where there is no limit.
        strict: the value is approached and not taken.
        path: to a state with this value.
        actions: the same by the numbers of the edges of the program.
    """

    value: int | None
    strict: bool
    path: tuple[Transition, ...]
    actions: Sequence[Sequence[int]] = ()


def measure(
    program: Program,
    goals: Sequence[Goal],
    measures: Sequence[Measure],
    options: Options = Options(),
    limits: Limits = Limits(),
) -> tuple[Outcome, tuple[ExtremeMeasurement | None, ...]]:
    """Explores everything, unless all of some goals are reached or a limit is hit, and measures all states.

    A measurement is None where no state was measured. That of a clock is about the abstraction of the zones beyond its
    time bound, see `tachk.engine.compiler.lower.lower_measures`.
    """
    explorer = _core.Explorer(encode(program, goals, measures), core_options(options), core_limits(limits))
    start, user = time.perf_counter(), user_seconds()
    status, reason = run_in_slices(explorer, start)
    fault = fault_of(program, explorer) if status is _core.Status.FAULT else None
    outcomes = tuple(goal_outcome(program, explorer, number, goal, status) for number, goal in enumerate(goals))
    failed = next((found.fault for found in outcomes if found.fault is not None), None)
    if fault is None and failed is not None:
        fault, reason = failed, reason or RUN_TIME_ERROR
    statistics = replace(statistics_of(explorer, start), user_seconds=user_seconds() - user)
    outcome = Outcome(outcomes, statistics, reason, fault, exact=not program.has_stopwatches)
    return outcome, tuple(_measurement(program, explorer, number) for number in range(len(measures)))


def _measurement(program: Program, explorer: _core.Explorer, number: int) -> ExtremeMeasurement | None:
    found = explorer.extreme(number)
    if found is None:
        return None
    value, strict, node = found
    actions = explorer.path(node)
    return ExtremeMeasurement(value, strict, transitions_of(program, actions), actions)
