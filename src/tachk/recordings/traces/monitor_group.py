"""Several formulas watched on one growing trace, by the engine in src/core, which also counts times and checks rows."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import IntEnum
from typing import Any

from tachk import _core
from tachk.recordings.traces.monitor_program import MonitorProgram
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.verdict_explanation import horizon, memory

MOST_RETAINED_ROWS = 1 << 16
"""Rows that are kept to explain a violation, where the bounds of the formulas would ask for more."""


class RowFault(IntEnum):
    """The reason why a row is refused; the numbers are those of `RowFault` in monitor_group.hpp."""

    NONE = 0
    FINISHED = 1
    BACKWARDS = 2
    TOO_FAR = 3
    MERGED = 4
    NOT_A_TIME = 5
    MISSING = 6
    NO_TRUTH = 7
    NOT_A_VALUE = 8


def open_group(
    programs: Sequence[MonitorProgram],
    columns: Sequence[str],
    *,
    robustness: bool = False,
    all_violations: bool = False,
    decimals: int,
    parts: int,
    exact: Callable[[Any], int],
) -> _core.MonitorGroup:
    """Programs that count the same ticks.

    Args:
        columns: of a row, in the order in which faults number them.
        robustness: keep bounds of the robustness too.
        all_violations: of a formula ``G f``, go on after the first one.
        decimals, parts: a unit of time has ``10 ** decimals * parts`` ticks.
        exact: counts a time that is neither int nor float in ticks, or raises.

    Raises ValueError if so many ticks do not fit.
    """
    return _core.MonitorGroup(
        programs=programs,
        columns=columns,
        quantitative=robustness,
        all_violations=all_violations,
        decimals=decimals,
        parts=parts,
        reach=max(horizon(program) + memory(program) for program in programs),
        most_rows=MOST_RETAINED_ROWS,
        exact=exact,
        truths=(Truth.FALSE, Truth.TRUE, Truth.UNDETERMINED),
    )
