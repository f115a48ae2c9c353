"""A run as a recording: columns of values over time."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import lcm

from tachk.base.records import dataclass
from tachk.meaning.discrete import environment
from tachk.meaning.run_view import RunNames
from tachk.meaning.step import time_passes
from tachk.model.evaluate import evaluate, evaluate_slots
from tachk.model.run import TimedState, TimedTrace
from tachk.recordings.traces.trace import LARGEST_TICK, Trace
from tachk.simulation.columns import Column
from tachk.simulation.runs import recording

_DECIMAL_TICKS = 10**9


@dataclass(frozen=True, slots=True)
class RunSignals:
    """Attributes:
    exact: whether no time was rounded.
    """

    trace: Trace
    exact: bool


def signals_of(
    names: RunNames,
    columns: Sequence[Column],
    run: TimedTrace,
    name: str,
    end: Fraction = Fraction(0),
    decimal_times: bool = False,
) -> RunSignals:
    """The columns in the states of a run. Times that do not fit are rounded down.

    Args:
        end: until when the last state lasts, if that is later than the run.
        decimal_times: count times in 1e-9 units, as files of decimal numbers do, whether that is exact or not.
    """
    states = run.states
    last = max(states[-1].time, end)
    finest = lcm(_DECIMAL_TICKS, *(state.time.denominator for state in states))
    fits = last * finest <= LARGEST_TICK // 1000
    ticks = finest if fits and not decimal_times else _DECIMAL_TICKS
    times = [int(state.time * ticks) for state in states]
    rows = [[_value(names, state, column) for column in columns] for state in states]
    lasts = end > states[-1].time or time_passes(names.model, states[-1])
    trace = recording(names.network, columns, name, times, rows, int(last * ticks), ticks, lasts)
    return RunSignals(trace, ticks % finest == 0)


def _value(names: RunNames, state: TimedState, column: Column) -> int:
    match column.value:
        case int(slot):
            processes = len(state.discrete.locations)
            return state.discrete.locations[slot] if slot < processes else state.discrete.values[slot - processes]
        case expression:
            scratch = environment(names.model, state.discrete, state.clocks)
            if not column.floating:
                return evaluate(expression, scratch)
            high, low = evaluate_slots(expression, scratch)
            return (high << 32) | (low & 0xFFFFFFFF)
