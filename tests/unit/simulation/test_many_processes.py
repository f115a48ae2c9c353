"""Runs of more processes than the coarse sets of clocks and slots tell apart."""

from __future__ import annotations

import pytest

import tachk
from tachk.engine.simulation.policy import Policy
from tachk.engine.simulation.simulator import TICKS_PER_UNIT, SimulationEnding, SimulationOptions
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.replay import replay
from tachk.simulation.runs import Runs
from tests.support.simulated.timed import WITH_STATES, state_columns, timed_trace

LAST = 129
CHAIN = f"""
int[0, 1] done[{LAST + 1}];
int[0, 1] also[{4 * LAST + 1}];
clock since[{LAST + 1}];
process P(const int[0, {LAST}] i, const int[0, {LAST}] before) {{
    state waiting, over;
    init waiting;
    trans waiting -> over {{ guard %s; assign done[i] := 1, also[4 * i] := 1, since[i] := 0; }};
}}
{"".join(f"P{i} = P({i}, {max(i - 1, 0)});" for i in range(LAST + 1))}
system {", ".join(f"P{i}" for i in range(LAST + 1))};
"""
"""130 processes with 130 clocks and 777 slots: each waits for the one before it."""


def last_moment(guard: str, policy: Policy) -> int:
    """When the last process acts, in a run in which all do."""
    network = tachk.loads(CHAIN % guard).network
    drawing = SimulationOptions(1, 10_000 * TICKS_PER_UNIT, policy)
    (run,) = Runs(network, state_columns(network)).draw(drawing, range(1), WITH_STATES)
    assert run.ending is SimulationEnding.HORIZON
    assert run.transitions == LAST + 1
    replay(prepare(network), timed_trace(network, run))
    return int(run.times[LAST + 1])


@pytest.mark.parametrize("policy", Policy)
@pytest.mark.parametrize("guard", ["done[before] == 1 || i == 0", "also[4 * before] == 1 || i == 0"])
def test_each_process_notices_that_a_variable_has_changed(guard: str, policy: Policy) -> None:
    moment = last_moment(guard, policy)
    assert moment == 0 if policy is Policy.EARLIEST else moment >= 0


def test_each_process_notices_that_a_clock_is_reset() -> None:
    """Behind the third time unit each has to act at most one after the one before it."""
    guard = "since[i] >= 3 && (since[before] <= 1 || i == 0)"
    assert last_moment(guard, Policy.EARLIEST) == 3 * TICKS_PER_UNIT
