"""Priorities in simulations: nothing happens while something of higher priority is possible."""

from __future__ import annotations

from math import exp, sqrt

from tachk.base.span import Source
from tachk.engine.simulation.simulator import TICKS_PER_UNIT, RecordedChanges, SimulationOptions
from tachk.formats.loading.load import load_model
from tachk.simulation.columns import chosen_columns
from tachk.simulation.runs import Runs

BLOCKED = """
process Low() { init location A { to B; } location B; }
process High() { init location A { exponential_rate 2; to B; } location B; }
system Low < High;
"""

CHANNELS = """
broadcast chan quick, slow;
chan priority slow < default < quick;
int[0, 3] order = 0;
process P() {
    clock x;
    init location A {
        invariant x <= 5;
        to B { guard x == 5 && order == 0; sync slow!; assign order = 1; }
        to B { guard x == 5 && order == 0; sync quick!; assign order = 2; }
        to B { guard x == 5 && order == 0; assign order = 3; }
    }
    location B;
}
system P;
"""


def _runs(text: str, count: int) -> Runs:
    network = load_model(Source("<text>", text)).network
    return Runs(network, chosen_columns(network, [v.name for v in network.variables if v.name == "order"]))


def test_who_is_blocked_waits_and_then_draws_anew() -> None:
    runs = _runs(BLOCKED, 2000)
    ends = []
    for run in runs.draw(SimulationOptions(7, 100 * TICKS_PER_UNIT), range(2000), RecordedChanges(actions=True)):
        first, second = (action.participants[0].process for action in run.actions)
        assert (first, second) == (1, 0)
        ends.append(int(run.times[-1]) / TICKS_PER_UNIT)
    # The sum of two exponential times, with rates 2 and 1.
    expected = [1 - 2 * exp(-t) + exp(-2 * t) for t in sorted(ends)]
    assert max(abs(e - n / 2000) for n, e in enumerate(expected)) < 1.95 / sqrt(2000)


def test_of_what_is_possible_at_once_the_highest_priority_goes_first() -> None:
    runs = _runs(CHANNELS, 20)
    for run in runs.draw(SimulationOptions(7, 10 * TICKS_PER_UNIT), range(20), RecordedChanges(observed=True)):
        assert run.observed[-1, 0] == 2
