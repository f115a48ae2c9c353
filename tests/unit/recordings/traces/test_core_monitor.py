"""The door to the offline monitors: results, whole signals, portions, refusals."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.recordings.traces import core_monitor, linear_monitor
from tachk.recordings.traces.core_monitor import RobustnessMonitor, RobustnessResult, TruthMonitor, Violation
from tachk.recordings.traces.linear_monitor import LinearViolation, Measure
from tachk.recordings.traces.monitor_program import (
    AtomRelation,
    MonitorAtom,
    MonitorNode,
    MonitorProgram,
    NodeKind,
    ValueInstruction,
    ValueOperator,
)
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.trace import Trace


def column(number: int) -> tuple[ValueInstruction, ...]:
    return (ValueInstruction(ValueOperator.COLUMN, number),)


def constant(value: float) -> tuple[ValueInstruction, ...]:
    return (ValueInstruction(ValueOperator.CONSTANT, value),)


def response(deadline: int) -> MonitorProgram:
    """``G (p -> F[0,deadline] x > 0.5)``"""
    return MonitorProgram(
        ("p", "x"),
        (
            MonitorAtom(AtomRelation.TRUTH, column(0), (), "p"),
            MonitorAtom(AtomRelation.GREATER, column(1), constant(0.5), "x > 0.5"),
        ),
        (
            MonitorNode(NodeKind.ATOM, atom=0),
            MonitorNode(NodeKind.NOT, (0,)),
            MonitorNode(NodeKind.ATOM, atom=1),
            MonitorNode(NodeKind.EVENTUALLY, (2,), upper=deadline),
            MonitorNode(NodeKind.OR, (1, 3)),
            MonitorNode(NodeKind.ALWAYS, (4,)),
        ),
        1,
    )


def trace(end: int = 80) -> Trace:
    return Trace(
        "pulses",
        np.array([0, 10, 11, 30, 31, 40, 60, 61]),
        {"x": np.array([0, 0, 0, 0.75, 0, 0, 0.25, 0]), "p": np.array([0, 1, 0, 0, 0, 1, 0, 0], np.uint8)},
        end,
    )


def test_a_missed_deadline_is_a_violation_while_the_trigger_lasts() -> None:
    result = core_monitor.monitor_truth(response(20), trace())
    assert result.verdict is Truth.FALSE
    assert result.violation == Violation(node=4, first=80, last=119)


def test_a_deadline_after_the_end_is_open() -> None:
    assert core_monitor.monitor_truth(response(50), trace()).verdict is Truth.UNDETERMINED
    assert core_monitor.monitor_robustness(response(50), trace()) == RobustnessResult(-0.25, 0.25)


def test_robustness_is_the_distance_of_the_worst_response() -> None:
    assert core_monitor.monitor_robustness(response(20), trace()) == RobustnessResult(-0.25, -0.25)


def test_signals_of_subformulas() -> None:
    (response_signal,) = core_monitor.truth_signals(response(20), trace(), [3])
    assert response_signal.stretches() == [
        (0, 19, Truth.FALSE),
        (20, 61, Truth.TRUE),
        (62, 120, Truth.FALSE),
        (121, 160, Truth.UNDETERMINED),
    ]
    (trigger,) = core_monitor.robustness_signals(response(20), trace(), [1])
    assert trigger.starts.tolist() == [0, 20, 22, 80, 120]
    assert trigger.low.tolist() == [math.inf, -math.inf, math.inf, -math.inf, math.inf]
    assert trigger.low.tolist() == trigger.high.tolist()


@pytest.mark.parametrize("size", [1, 3, 8])
def test_portions_do_not_matter(size: int) -> None:
    whole = trace()
    truth, robustness = TruthMonitor(response(20)), RobustnessMonitor(response(20))
    for begin in range(0, whole.rows, size):
        rows = slice(begin, begin + size)
        for monitor in (truth, robustness):
            monitor.push(whole.times[rows], [whole.columns["p"][rows], whole.columns["x"][rows]])
    assert truth.finish(80) == core_monitor.monitor_truth(response(20), whole)
    assert robustness.finish(80) == core_monitor.monitor_robustness(response(20), whole)


def test_columns_are_found_by_name() -> None:
    with pytest.raises(UsageError, match="pulses has no column p"):
        core_monitor.monitor_truth(response(20), Trace("pulses", np.array([0]), {"x": np.array([0.0])}, 1))


def test_wrong_input_is_rejected() -> None:
    monitor = TruthMonitor(response(20))
    flags, numbers = np.zeros(2, np.uint8), np.zeros(2)
    with pytest.raises(ValueError, match="must not decrease"):
        monitor.push(np.array([1, 0]), [flags, numbers])
    with pytest.raises(ValueError, match="a column is missing"):
        monitor.push(np.array([0, 1]), [flags])
    with pytest.raises(ValueError, match="a value for every time"):
        monitor.push(np.array([0, 1]), [flags, np.zeros(3)])
    with pytest.raises(ValueError, match="contiguous array"):
        monitor.push(np.array([0, 1]), [flags, np.zeros(2, np.float32)])  # type: ignore[list-item]
    with pytest.raises(ValueError, match="at least one sample"):
        monitor.finish(1)


def test_lines_cross_between_rows() -> None:
    slope = Trace("slope", np.array([0, 8, 16]), {"p": np.ones(3, np.uint8), "x": np.array([0.0, 1.0, 0.0])}, 40)
    result = linear_monitor.truth_on_lines(response(4), slope)
    assert result.verdict is Truth.FALSE
    assert result.violation == LinearViolation(4, 0, 0)
    assert linear_monitor.robustness(response(4), slope, Measure.SPACE) == RobustnessResult(-0.5, -0.5)
    (low, high) = linear_monitor.robustness_signal(response(4), slope, 3, Measure.SPACE)
    assert low.starts.tolist()[:3] == [0, 4, 8]
    assert low.at.tolist()[:2] == [0, 0.5]
    assert high.at[0] == 0


def test_time_robustness_is_the_slack_of_the_response() -> None:
    assert linear_monitor.robustness(response(25), trace(), Measure.AHEAD) == RobustnessResult(-20, -15)
    assert linear_monitor.robustness(response(25), trace(), Measure.BEHIND) == RobustnessResult(-20, -15)


def test_crossings_are_reported_in_parts_of_a_tick() -> None:
    slope = Trace("slope", np.array([0, 3]), {"p": np.ones(2, np.uint8), "x": np.array([0.0, 1.0])}, 3)
    assert linear_monitor.parts_of_tick([response(4)], slope) == 1_000_000
    (signal,) = linear_monitor.truth_signals_on_lines(response(4), slope, [2], 1000)
    assert signal.stretches() == [(0, 3000, Truth.FALSE), (3001, 6000, Truth.TRUE)]


def test_a_trace_can_be_too_long_for_lines() -> None:
    times, values = np.array([0, 2**57]), {"p": np.ones(2, np.uint8), "x": np.array([0.0, 1.0])}
    with pytest.raises(UsageError, match="too long for lines"):
        linear_monitor.parts_of_tick([response(4)], Trace("long", times, values, 2**57))
    shorter = Trace("long", np.array([0, 2**45]), values, 2**45)
    parts = linear_monitor.parts_of_tick([response(4)], shorter)
    assert parts == 100
    assert (
        linear_monitor.truth_signals_on_lines(response(4), shorter, [2], parts)[0].at(parts * 2**45 + 1) is Truth.TRUE
    )


def test_where_lines_of_an_absolute_value_end_rounding_does_not_show() -> None:
    """x >= abs(x) holds up to the crossing of 0 at 4/5 of a tick, included."""
    atom = MonitorAtom(
        AtomRelation.GREATER_EQUAL, column(0), (*column(0), ValueInstruction(ValueOperator.ABSOLUTE)), ""
    )
    program = MonitorProgram(("x",), (atom,), (MonitorNode(NodeKind.ATOM, atom=0),), 1)
    for ends in ([1.0, -0.25], [0.7, -0.1], [3.0, -1e-3]):
        falling = Trace("falling", np.array([0, 1]), {"x": np.array(ends)}, 1)
        crossing = 2 * round(1_000_000 * ends[0] / (ends[0] - ends[1]))
        (signal,) = linear_monitor.truth_signals_on_lines(program, falling, [0], 1_000_000)
        assert signal.stretches()[0] == (0, crossing, Truth.TRUE)


def test_products_are_not_linear() -> None:
    square = MonitorProgram(
        ("x",),
        (
            MonitorAtom(
                AtomRelation.TRUTH, (*column(0), *column(0), ValueInstruction(ValueOperator.MULTIPLY)), (), "x * x"
            ),
        ),
        (MonitorNode(NodeKind.ATOM, atom=0),),
        1,
    )
    with pytest.raises(ValueError, match="a product of columns is not linear"):
        linear_monitor.truth_on_lines(square, trace())
