"""Runs that are too long for the finest ticks have coarser ones, and are as exact in these."""

from __future__ import annotations

import math
from fractions import Fraction
from pathlib import Path

import fmpy
import pytest

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.engine.simulation.simulator import LATEST_END, TICKS_PER_UNIT, SimulationEnding, time_bound
from tachk.recordings.traces.node_signal import Truth
from tachk.simulation.fmi.description import FmiVersion
from tachk.simulation.fmi.unit import closed_unit
from tachk.simulation.statistics.estimate import DrawnRuns, Estimated
from tachk.simulation.tables import run_writer
from tachk.simulation.times import parsed_time_bound
from tests.support.simulated.cosimulated import extract

SECOND = """
time_unit = 1 us;
clock x, age;
int[0, 6] n = 0;
process P() {
    init location a { invariant x <= 60000000; to a { guard x >= 60000000; assign x = 0, n = (n + 1) % 7; } }
}
signal late = n == 5;
system P;
"""


def test_ticks_are_as_fine_as_fits() -> None:
    assert time_bound(Fraction(2**58, 10**9)).ticks_per_unit == TICKS_PER_UNIT
    assert time_bound(Fraction(2**58 + 1, 10**9)).ticks_per_unit == TICKS_PER_UNIT // 10
    assert time_bound(LATEST_END) == parsed_time_bound(str(LATEST_END), "")
    assert time_bound(LATEST_END).ticks == 2**58
    with pytest.raises(UsageError, match="at most 288230376151711 time units"):
        parsed_time_bound(str(LATEST_END + 1), "")


def test_ten_minutes_in_microseconds(tmp_path: Path) -> None:
    network = tachk.loads(SECOND)
    (run,) = tachk.simulate(network, until="10 min")
    assert (run.ending, run.end, run.transitions) == (SimulationEnding.HORIZON, 600_000_000, 10)
    assert run.times.tolist() == [n * 60_000_000.0 for n in range(11)]
    assert run["n"].tolist() == [n % 7 for n in range(11)]
    for name in ("a.csv", "a.vcd"):
        with run_writer(tmp_path / name) as write:
            write(0, run.trace)
    assert (tmp_path / "a.csv").read_text().splitlines()[-1] == "0,600000000,0,a,3"
    dump = (tmp_path / "a.vcd").read_text()
    assert "$timescale 10 fs $end" in dump
    assert f"#{600 * 10**14}\n" in dump
    (verdict,) = tachk.monitor("G (late -> F[0, 1 min] !late)", run.trace)
    assert verdict.truth == Truth.TRUE


def test_a_shorter_run_is_the_beginning_of_a_longer_one_in_other_ticks() -> None:
    edge = "exponential_rate 1 : 10000000; to a { assign n = 1 - n; }"
    text = f"process P() {{ int[0, 1] n; init location a {{ {edge} }} }} system P;"
    (short,) = tachk.simulate(tachk.loads(text), until=288_000_000, seed=3)
    (long,) = tachk.simulate(tachk.loads(text), until=2_880_000_000, seed=3)
    count = len(short.times) - 1
    assert count > 15
    assert short.times[:count] == pytest.approx(long.times[:count].tolist(), rel=1e-9)


def test_probabilities_and_values_of_long_runs() -> None:
    text = "clock x; process P() { init location a { exponential_rate 1 : 1000000000; to b; } location b; } system P;"
    found, drawn = tachk.loads(text).estimate("Pr[<=1e9](<> P.b)", "simulate [<=1e9] {x, P.b}", runs=2000)
    assert isinstance(found, Estimated)
    assert found.low < 1 - math.exp(-1) < found.high
    assert isinstance(drawn, DrawnRuns)
    assert (drawn.runs[0].end, drawn.runs[0].lines[0].values[-1]) == (1e9, 1e9)


SLOW = (
    "clock x; process P() { init location a { RATE to b; } location b; } process Q() { init location q; } system P, Q;"
)


def test_what_happens_behind_all_times_is_unknown() -> None:
    text = SLOW.replace("RATE", "exponential_rate 1 : 2000000000;")
    (found,) = tachk.loads(text).estimate("Pr[#<=1](<> P.b)", runs=200)
    assert isinstance(found, Estimated)
    assert found.sample.unknown == found.sample.endings[SimulationEnding.END_OF_TIME] > 100
    assert found.high == 1


def test_where_nothing_can_happen_any_more_everything_is_known() -> None:
    (found,) = tachk.loads(SLOW.replace("RATE", "exponential_rate 0;")).estimate("Pr[#<=1](<> P.b)", runs=200)
    assert isinstance(found, Estimated)
    assert (found.sample.hits, found.sample.unknown) == (0, 0)


def test_hybrid_clocks_on_long_runs(tmp_path: Path) -> None:
    path = tmp_path / "a.ta"
    path.write_text(
        "hybrid clock h; int n; process P() { init location a "
        "{ invariant h' == 0.000001 && h <= 500; to b { guard h >= 500; assign n = 1; } } location b; } system P;"
    )
    (run,) = tachk.simulate(str(path), until=600_000_000)
    assert run.times[run["n"].tolist().index(1)] == pytest.approx(500_000_000, rel=2e-6)


@pytest.mark.parametrize("version", FmiVersion)
def test_a_unit_whose_end_is_known_goes_as_far(version: FmiVersion, tmp_path: Path) -> None:
    unit = closed_unit(tachk.loads(SECOND).network, "long")
    result = fmpy.simulate_fmu(
        extract(unit, version, tmp_path), stop_time=600.0, output_interval=30.0, output=["n", "transitions"]
    )
    assert result["time"][-1] == 600
    assert result["transitions"][-1] in (9, 10)
    assert [int(n) for n in result["n"]][1:19:2] == [n % 7 for n in range(9)]


@pytest.mark.parametrize("policy", ["earliest", "latest", "boundary", "uniform", "stochastic"])
def test_what_a_target_forbids_does_not_stop_time(policy: str) -> None:
    """The broadcast of L1 that leads to L0 is never possible: the clock is beyond the invariant there."""
    model = tachk.loads("""
broadcast chan say;
process P() {
    clock x;
    init location L0 { invariant x <= 2; to L1 { guard x >= 2; sync say!; assign x = 0; } }
    location L1 {
        to L1 { guard x >= 4 && x <= 5; sync say!; assign x = 0; }
        to L0 { guard x >= 3; sync say!; }
    }
}
system P;
""")
    for run in tachk.simulate(model, until=100, runs=5, policy=policy):
        assert run.ending is SimulationEnding.HORIZON
