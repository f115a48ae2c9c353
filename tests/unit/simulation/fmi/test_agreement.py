"""A unit for co-simulation does what the simulator does, and FMPy finds nothing wrong with it."""

from __future__ import annotations

from pathlib import Path
from random import Random

import fmpy
import pytest

import tachk
from tachk.base.diagnostics.diagnostic import InputError, UnsupportedError
from tachk.engine.simulation.policy import Policy
from tachk.engine.simulation.simulator import TICKS_PER_UNIT, SimulationOptions
from tachk.simulation.fmi.description import FmiVersion
from tachk.simulation.fmi.unit import closed_unit
from tests.support import Shape, random_case
from tests.support.simulated.cosimulated import Driving, disagreements, extract, native_rows

SHAPES = (
    Shape(clocks=2),
    Shape(clocks=2, copies=0.5),
    Shape(exact=0.4, processes=3, clocks=2, constant=3),
    Shape(language=True, clocks_on_broadcast=True, locations=3, clocks=2),
    Shape(stopwatches=True),
)


def drivings(step: int) -> list[Driving]:
    return [Driving(FmiVersion.THREE, step, True), *(Driving(version, step, False) for version in FmiVersion)]


def test_random_networks_run_as_in_the_simulator(tmp_path: Path) -> None:
    compared = 0
    for number in range(6):
        random = Random(5200 + number)
        network = random_case(random, SHAPES[number % len(SHAPES)]).network
        drawing = SimulationOptions(number, 12 * TICKS_PER_UNIT, list(Policy)[number % 4], steps=60)
        step = random.choice((TICKS_PER_UNIT, 3 * TICKS_PER_UNIT // 10, 7 * TICKS_PER_UNIT // 5))
        try:
            assert list(disagreements(network, drawing, number, drivings(step), tmp_path)) == []
        except (UnsupportedError, InputError):
            continue
        compared += 1
    assert compared >= 4


TIES = """
time_unit = 10 ms;
broadcast chan go;
int[0, 9] won = 0;
bool odd = false;
process Runner(const int[1, 4] number) {
    clock x;
    init location Waits {
        invariant x <= 2;
        to Done { guard x >= 2; sync go!; assign won = number, odd = !odd; }
        to Waits { sync go?; assign x = 0; }
    }
    location Done {
        invariant x <= 3;
        to Waits { guard x >= 3; assign x = 0; }
    }
}
signal early = won == 1 || won == 2;
signal twice = 2 * won;
system Runner;
"""


@pytest.mark.parametrize("policy", [Policy.EARLIEST, Policy.LATEST, Policy.STOCHASTIC])
def test_who_wins_a_tie_does_not_depend_on_the_steps(policy: Policy, tmp_path: Path) -> None:
    network = tachk.loads(TIES).network
    drawing = SimulationOptions(3, 40 * TICKS_PER_UNIT, policy)
    wanted = drivings(TICKS_PER_UNIT // 4)
    assert list(disagreements(network, drawing, 5, wanted, tmp_path)) == []


@pytest.mark.parametrize("time_unit", ["", "time_unit = 7 ms;", "time_unit = 3 h;"])
def test_the_time_of_an_event_is_the_nearest_double(time_unit: str, tmp_path: Path) -> None:
    text = f"{time_unit} bool b; process P() {{ init location A {{ to A {{ assign b = !b; }} }} }} system P;"
    network = tachk.loads(text).network
    unit = closed_unit(network, "events")
    rows, end, stop = native_rows(network, SimulationOptions(2, 200 * TICKS_PER_UNIT), 0)
    extracted = extract(unit, FmiVersion.THREE, tmp_path)
    told = fmpy.simulate_fmu(
        extracted,
        stop_time=float(stop / unit.second),
        output_interval=float(stop / unit.second),
        start_values={"seed": 2},
        use_event_mode=True,
        early_return_allowed=True,
    )
    known = [float(moment / unit.second) for moment, _ in rows[1:] if moment < end]
    assert len(known) > 150
    assert set(known) <= set(told["time"].tolist())
