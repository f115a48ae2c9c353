"""Cases on which monitors are known to differ, through everything that judges traces."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import pytest

import tachk
from tachk.recordings.traces.node_signal import Truth
from tests.support.exact_monitor import verdict
from tests.support.formulas import MonitoringCase
from tests.support.lines_agreement import line_problems, time_problems
from tests.support.monitor_input import in_ticks, monitor_input, truth_of
from tests.support.offline_agreement import offline_problems
from tests.support.online_agreement import online_problems
from tests.support.tricky import TRICKY_CASES, TrickyCase, read_formula

each_case = pytest.mark.parametrize("case", TRICKY_CASES, ids=lambda case: case.name)


def expected(case: TrickyCase) -> Truth:
    return Truth.UNDETERMINED if case.truth is None else Truth(case.truth)


@each_case
def test_oracle(case: TrickyCase) -> None:
    assert truth_of(verdict(read_formula(case.at_start), case.trace)) is expected(case)


@each_case
@pytest.mark.parametrize("formula", [lambda case: case.formula, lambda case: case.at_start], ids=["there", "at 0"])
def test_core(case: TrickyCase, formula: Callable[[TrickyCase], str]) -> None:
    """Also the whole signal of the formula, its robustness, and every prefix online."""
    whole = MonitoringCase(read_formula(formula(case)), case.trace)
    assert offline_problems(whole) == ()
    assert online_problems(whole) == ()


@each_case
def test_offline(case: TrickyCase) -> None:
    ticks = monitor_input(MonitoringCase(read_formula(case.at_start), case.trace)).trace.ticks_per_unit
    (judged,) = tachk.monitor(case.at_start, in_ticks(case.trace, ticks))
    assert judged.truth is expected(case)


@each_case
def test_lines(case: TrickyCase) -> None:
    """Truth values do not move between rows, so that only C19 has another answer."""
    given = MonitoringCase(read_formula(case.at_start), case.trace)
    assert line_problems(given) == ()
    (judged,) = tachk.monitor(case.at_start, in_ticks(case.trace, monitor_input(given).trace.ticks_per_unit))
    (on_lines,) = tachk.monitor(
        case.at_start, in_ticks(case.trace, monitor_input(given).trace.ticks_per_unit), interpolation="linear"
    )
    assert on_lines.truth is (Truth.TRUE if case.name == "C19" else judged.truth)


@each_case
def test_robustness_in_time(case: TrickyCase) -> None:
    assert time_problems(MonitoringCase(read_formula(case.at_start), case.trace)) == ()


@each_case
def test_online(case: TrickyCase) -> None:
    monitor = tachk.Monitor(case.at_start)
    for row, time in enumerate(case.trace.times):
        monitor.update(time, {name: float(values[row]) for name, values in case.trace.columns.items()})
    (judged,) = monitor.finish(case.trace.end)
    assert judged.truth is expected(case)


def test_the_end_of_a_trace_can_be_given_a_meaning() -> None:
    case = next(case for case in TRICKY_CASES if case.name == "C05")
    trace = in_ticks(case.trace, 1)
    assert tachk.monitor(case.at_start, trace, end="weak").truth is Truth.TRUE
    assert tachk.monitor(case.at_start, trace, end="strong").truth is Truth.FALSE


def test_instants_between_ticks_count() -> None:
    case = next(case for case in TRICKY_CASES if case.name == "C10")
    assert case.trace.times[1] == Fraction(41, 4)
    assert tachk.monitor(case.formula, in_ticks(case.trace, 4)).truth is Truth.TRUE
