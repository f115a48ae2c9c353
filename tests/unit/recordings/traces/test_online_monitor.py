"""The online monitor: when verdicts come, what the bounds of the robustness say meanwhile, memory, refusals."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tachk.recordings.monitors.compiler import compile as compile_formula
from tachk.recordings.traces.core_monitor import monitor_truth
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.online_monitor import OnlineMonitor, ViolatedCells
from tachk.recordings.traces.trace import Trace
from tests.support.tricky import read_formula


def online(formula: str, *, robustness: bool = True) -> OnlineMonitor:
    return OnlineMonitor(compile_formula(read_formula(formula), ("x", "y"), 1), robustness=robustness)


def test_a_response_fails_when_time_passes_its_deadline() -> None:
    monitor = online("G (x > 0 -> F[0,20] y > 0)")
    for time, values in ((0, (0, 0)), (10, (1, 0)), (11, (0, 0)), (30, (0, 0))):
        assert monitor.update(time, values) is Truth.UNDETERMINED
    assert monitor.update(31, (0, 1)) is Truth.FALSE
    assert monitor.decided_at == 31
    assert monitor.violation == ViolatedCells(20, 21, settled=True)


def test_a_later_sample_for_the_same_instant_replaces_the_earlier_one() -> None:
    monitor = online("G !(x > 0)")
    monitor.update(0, (0,))
    monitor.update(5, (1,))
    assert monitor.update(5, (0,)) is Truth.UNDETERMINED
    assert monitor.finish(5) is Truth.TRUE


def test_a_bounded_formula_is_decided_before_its_window_is_over() -> None:
    monitor = online("F[0,100] (x > 0 && G[0,5] y > 0)")
    monitor.update(0, (1, 1))
    assert monitor.update(5, (1, 1)) is Truth.UNDETERMINED
    assert monitor.advance(6) is Truth.TRUE
    assert monitor.violation is None


def test_what_is_known_of_the_past_decides_the_future() -> None:
    monitor = online("F[0,10] G[0,1000] O[0,2000] x > 0")
    monitor.update(0, (1,))
    assert monitor.advance(1) is Truth.TRUE


def test_a_violation_can_turn_up_before_one_that_was_found_first() -> None:
    monitor = online("G ((x > 0 -> F[0,20] y > 0) && !(x > 5))")
    for time, values in ((0, (0, 0)), (4, (1, 0)), (5, (0, 0)), (8, (9, 0))):
        monitor.update(time, values)
    assert monitor.advance(9) is Truth.FALSE
    assert monitor.decided_at == 9
    assert monitor.violation == ViolatedCells(16, 17, settled=False)
    monitor.update(12, (0, 0))
    monitor.advance(40)
    assert monitor.violation == ViolatedCells(8, 9, settled=True)


@pytest.mark.parametrize("chunk", [1, 2, 1024, 5000])
def test_chunks_change_nothing(chunk: int) -> None:
    random = np.random.default_rng(5)
    times = np.cumsum(random.integers(0, 3, 5000)).astype(np.int64)
    times -= times[0]
    x, y = random.integers(-4, 5, 5000) / 2, random.integers(0, 2, 5000).astype(np.uint8)
    x[3000:] += 3  # from here on nothing answers
    monitor = online("G (x > 1.5 -> F[2,200) (y == 1 && x < 0))")
    for first in range(0, len(times), chunk):
        part = slice(first, first + chunk)
        monitor.push(times[part], [x[part], y[part]])
    monitor.finish(int(times[-1]))
    offline = monitor_truth(monitor.program, Trace("random", times, {"x": x, "y": y}, int(times[-1]))).violation
    assert offline is not None
    assert monitor.violation == ViolatedCells(offline.first, offline.last, settled=True)
    last_of_window = offline.first + (399 if offline.first % 2 == 0 else 400)
    assert monitor.decided_at == times[2 * times > last_of_window][0]


def test_the_upper_bound_of_an_invariant_falls_at_once() -> None:
    monitor = online("G (x < 4 && y < 3)")
    monitor.update(0, (1, 1))
    monitor.update(1, (3.5, 0))
    assert monitor.robustness == (-math.inf, 2.0)
    monitor.update(2, (5, 0))
    assert monitor.robustness == (-math.inf, 0.5)
    monitor.finish(2)
    assert monitor.robustness == (-1.0, -1.0)


def test_a_bound_under_a_window_ahead_falls_when_it_is_seen() -> None:
    monitor = online("G (x > 0 -> G[0,1000] y < 3)")
    monitor.update(0, (2, 1))
    monitor.update(1, (-2, 2.5))
    monitor.advance(2)
    assert monitor.robustness == (-math.inf, 0.5)


def test_the_end_leaves_open_what_a_window_has_not_seen() -> None:
    monitor = online("G (x > 0 -> G[0,10] y < 3)")
    monitor.update(0, (2, 1))
    assert monitor.finish(5) is Truth.UNDETERMINED
    assert monitor.robustness == (-2.0, 2.0)


def test_the_verdict_bounds_the_robustness_without_numbers() -> None:
    monitor = online("G x", robustness=False)
    monitor.update(0, (1,))
    assert monitor.robustness == (-math.inf, math.inf)
    monitor.update(1, (0,))
    monitor.advance(2)
    assert monitor.robustness == (-math.inf, 0.0)


def test_the_trace_begins_with_the_first_sample() -> None:
    monitor = online("G[0,10] x > 0")
    monitor.update(1000, (1,))
    assert (monitor.beginning, monitor.now, monitor.finished) == (1000, 1000, False)
    assert monitor.advance(1010) is Truth.UNDETERMINED
    assert monitor.finish(1010) is Truth.TRUE
    assert (monitor.decided_at, monitor.finished) == (1010, True)


@pytest.mark.parametrize("window", [180, 18_000])
def test_memory_does_not_grow_with_the_trace(window: int) -> None:
    random = np.random.default_rng(1)
    monitor = online(f"G (x > 0 -> F[0,{window}] (y > 0 && O[0,{window}] x < 0))")
    sizes = []
    for part in range(60):
        times = np.sort(random.integers(0, 1000, 1000)) + part * 1000
        monitor.push(times, [random.normal(size=1000), random.normal(size=1000)])
        sizes.append(monitor.bytes_used)
    assert monitor.verdict is Truth.UNDETERMINED
    assert sizes[-1] <= 1.5 * sizes[30]


def test_a_rejected_call_changes_nothing() -> None:
    monitor = online("G x > 0")
    with pytest.raises(ValueError, match="not begun"):
        monitor.finish(0)
    monitor.update(5, (1,))
    with pytest.raises(ValueError, match="time goes back"):
        monitor.update(4, (-1,))
    with pytest.raises(ValueError, match="time goes back"):
        monitor.push(np.array([6, 8, 7]), [np.full(3, -1.0)])
    with pytest.raises(ValueError, match="every column"):
        monitor.update(6, (1, 0))
    with pytest.raises(TypeError):
        monitor.update(6, ("one",))
    assert monitor.now == 5
    assert monitor.finish(9) is Truth.TRUE
    with pytest.raises(ValueError, match="over"):
        monitor.update(10, (1,))
