"""The monitors of lines and of robustness in time in the core against the oracle."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import pairwise
from random import Random

import numpy as np

from tachk.recordings.traces.linear_monitor import (
    LinearSignal,
    Measure,
    parts_of_tick,
    robustness,
    robustness_signal,
    truth_on_lines,
    truth_signals_on_lines,
)
from tachk.recordings.traces.monitor_program import MonitorAtom, ValueOperator
from tests.support.exact_lines import InTime, OnLines, Worth, above, is_worth
from tests.support.exact_trace import Number
from tests.support.formulas import MonitoringCase
from tests.support.monitor_input import MonitorInput, monitor_input, truth_of

_TOLERANCE = Fraction(1, 1_000_003)


def line_problems(case: MonitoringCase, refinement: int = 1, seed: int = 0) -> tuple[str, ...]:
    """Where the monitors of lines and the oracle differ: in the truth at any instant, or in the robustness at the
    first instant and at one drawn with the seed."""
    given = monitor_input(case, refinement)
    return (*_truth_problems(case, given), *_space_problems(case, given, seed))


def time_problems(case: MonitoringCase, refinement: int = 1, seed: int = 0) -> tuple[str, ...]:
    """Where the robustness in time and the oracle differ, at the first instant and at one drawn with the seed."""
    return tuple(_time_problems(case, monitor_input(case, refinement), seed))


def _truth_problems(case: MonitoringCase, given: MonitorInput) -> Iterator[str]:
    exact = above(case.formula, OnLines(case.trace))
    found = truth_on_lines(given.program, given.trace).verdict
    expected = truth_of(exact.value(Fraction(0)))
    if found is not expected:
        yield f"truth on lines: {found.word}, not {expected.word}"
    parts = parts_of_tick([given.program], given.trace)
    (signal,) = truth_signals_on_lines(given.program, given.trace, [len(given.program.nodes) - 1], parts)
    points = [point for point in exact.points if point <= case.trace.end]
    between = [(left + right) / 2 for left, right in pairwise([*points, case.trace.end]) if left < right]
    for instant in sorted({*points, *between, case.trace.end}):
        cell = _cell(instant, given.trace.ticks_per_unit, parts)
        seen, wanted = signal.at(cell), truth_of(exact.value(instant))
        if seen is not wanted:
            yield f"truth on lines at {instant}: {seen.word}, not {wanted.word}"
            return


def _cell(instant: Fraction, ticks_per_unit: int, parts: int) -> int:
    """The cell of an instant; crossings are rounded to parts of a tick, but not onto or over a tick."""
    ticks = instant * ticks_per_unit
    whole = ticks.numerator // ticks.denominator
    rest = ticks - whole
    return 2 * (whole * parts + (min(max(round(rest * parts), 1), parts - 1) if rest else 0))


def _space_problems(case: MonitoringCase, given: MonitorInput, seed: int) -> Iterator[str]:
    low, high = robustness_signal(given.program, given.trace, len(given.program.nodes) - 1, Measure.SPACE)
    start = robustness(given.program, given.trace, Measure.SPACE)
    if (start.low, start.high) != (_value(low, 0), _value(high, 0)):
        yield f"robustness on lines: {start} is not the first value of its signal"
    yield from _worth_problems(case, given, OnLines(case.trace), "robustness on lines", (low, high), seed, 1)


def _time_problems(case: MonitoringCase, given: MonitorInput, seed: int) -> Iterator[str]:
    """The oracle shifts atoms as a whole, which is the same where each reads one column."""
    if any(len(_columns(atom)) > 1 for atom in given.program.atoms):
        return
    for name, measure in (("time ahead", Measure.AHEAD), ("time behind", Measure.BEHIND)):
        first = robustness(given.program, given.trace, measure)
        signals = robustness_signal(given.program, given.trace, len(given.program.nodes) - 1, measure)
        if not np.allclose((first.low, first.high), [_value(signal, 0) for signal in signals], rtol=0, atol=1e-6):
            yield f"{name}: {first} is not the first value of its signal"
        yield from _worth_problems(
            case, given, InTime(case.trace, measure is Measure.AHEAD), name, signals, seed, given.trace.ticks_per_unit
        )


def _columns(atom: MonitorAtom) -> set[float]:
    code = (*atom.left, *atom.right)
    return {instruction.operand for instruction in code if instruction.operator is ValueOperator.COLUMN}


def _worth_problems(
    case: MonitoringCase,
    given: MonitorInput,
    worth: Worth,
    name: str,
    bounds: tuple[LinearSignal, LinearSignal],
    seed: int,
    scale: int,
) -> Iterator[str]:
    """Args:
    scale: what the core counts where the oracle counts one.
    """
    for half in sorted({0, Random(seed).randint(0, 2 * given.trace.end)}):
        instant = given.instant(half)
        low, high = (_exact(_value(signal, half / 2), scale) for signal in bounds)
        if not is_worth(case.formula, worth, instant, low, high, _TOLERANCE):
            yield f"{name} at {instant}: [{float(low)}, {float(high)}] is wrong"


def _value(signal: LinearSignal, time: float) -> float:
    piece = int(np.searchsorted(signal.starts, time, side="right")) - 1
    start = float(signal.starts[piece])
    if start == time:
        return float(signal.at[piece]) + 0.0
    after, before = float(signal.after[piece]), float(signal.before[piece])
    if after == before or piece + 1 == len(signal.starts):
        return after + 0.0
    return after + (before - after) * ((time - start) / (float(signal.starts[piece + 1]) - start))


def _exact(value: float, scale: int) -> Number:
    return value if np.isinf(value) else Fraction(value) / scale
