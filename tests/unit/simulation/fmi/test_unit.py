"""What masters may do with a unit beside running it, and what they are told."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave

import tachk
from tachk.base.span import Source
from tachk.engine.simulation.simulator import TICKS_PER_UNIT
from tachk.formats.loading.load import load_model
from tachk.simulation.fmi.description import FmiVersion
from tachk.simulation.fmi.resource_file import resource_file
from tachk.simulation.fmi.unit import CoSimulationUnit, closed_unit, identifier, ticks_of_a_second
from tests.support.simulated.cosimulated import extract

PULSES = """
time_unit = 10 ms;
int[0, 1000] count = 0;
process P() {
    clock x;
    init location Low { invariant x <= 3; to High { guard x >= 1; assign x = 0, count = count + 1; } }
    location High { invariant x <= 1; to Low { guard x >= 1; assign x = 0; } }
}
signal high = P.High;
system P;
"""


@pytest.fixture
def unit() -> CoSimulationUnit:
    return closed_unit(tachk.loads(PULSES).network, "pulses")


def reference(unit: CoSimulationUnit, name: str) -> int:
    (found,) = [number for number, variable in enumerate(unit.variables) if variable.name == name]
    return found


@pytest.fixture
def running(unit: CoSimulationUnit, tmp_path: Path) -> Iterator[FMU3Slave]:
    """In event mode, at the beginning of a run."""
    slave = instance(unit, tmp_path)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    yield slave
    slave.freeInstance()


def instance(unit: CoSimulationUnit, folder: Path, early: bool = True) -> FMU3Slave:
    slave = FMU3Slave(
        guid=resource_file(unit).token,
        unzipDirectory=extract(unit, FmiVersion.THREE, folder),
        modelIdentifier=unit.name,
        instanceName="unit",
    )
    slave.instantiate(eventModeUsed=True, earlyReturnAllowed=early, logMessage=lambda *told: None)
    return slave


def events(slave: FMU3Slave, until: float) -> list[float]:
    """The times of the next events, each of which is handled; from event mode to event mode."""
    found: list[float] = []
    while True:
        again = True
        while again:
            again, *_ = slave.updateDiscreteStates()
        slave.enterStepMode()
        time = found[-1] if found else now(slave)
        event, _, early, last = slave.doStep(time, until - time)
        slave.enterEventMode()
        if not early:
            return found
        assert event
        found.append(last)


def now(slave: FMU3Slave) -> float:
    return float(slave.getFloat64([0])[0])


def test_a_step_ends_at_the_very_moment_of_an_event(unit: CoSimulationUnit, running: FMU3Slave) -> None:
    count, high = reference(unit, "count"), reference(unit, "high")
    *_, known, next_time = running.updateDiscreteStates()
    running.enterStepMode()
    event, over, early, last = running.doStep(0.0, 1.0)
    assert (event, over, early) == (True, False, True)
    assert known and last == next_time and 0.01 <= last <= 0.03
    assert running.getInt32([count])[0] == 0, "what was before the event is still to be seen"
    running.enterEventMode()
    running.updateDiscreteStates()
    assert running.getInt32([count])[0] == 1
    assert running.getBoolean([high])[0]
    running.enterStepMode()
    *_, last_of_pulse = running.doStep(last, 1.0)
    assert round(Fraction(last_of_pulse) * unit.second) - round(Fraction(last) * unit.second) == TICKS_PER_UNIT


def test_without_early_return_only_an_event_at_the_end_of_a_step_is_left(
    unit: CoSimulationUnit, tmp_path: Path
) -> None:
    slave = instance(unit, tmp_path, early=False)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    count = [reference(unit, "count")]
    first = slave.updateDiscreteStates()[-1]
    slave.enterStepMode()
    assert slave.doStep(0.0, first) == (True, False, False, first)
    assert slave.getInt32(count) == [0]
    slave.enterEventMode()
    slave.updateDiscreteStates()
    assert slave.getInt32(count) == [1]
    slave.enterStepMode()
    _, _, early, last = slave.doStep(first, 1.0)
    assert not early and last == first + 1.0
    assert slave.getInt32(count)[0] > 20
    slave.freeInstance()


def test_a_state_is_taken_up_again(running: FMU3Slave) -> None:
    events(running, 0.5)
    state = running.getFMUState()
    first = events(running, 2.0)
    running.setFMUState(state)
    assert now(running) == 0.5
    assert events(running, 2.0) == first
    assert len(first) > 50
    running.freeFMUState(state)


THROWS = """
double drawn = 0.0;
int[0, 1000] count = 0;
process P() {
    clock x;
    init location A { invariant x <= 1; to A {
        guard x >= 1; assign x = 0, drawn = random(4), count = (count + 1) % 1000;
    } }
}
system P;
"""


def test_a_state_that_is_taken_up_again_draws_the_same_numbers(tmp_path: Path) -> None:
    # What code draws comes from the run that goes on, not from the one whose copy it is.
    network = load_model(Source("<text>", THROWS), keeps_doubles=True).network
    unit = closed_unit(network, "throws")
    slave = instance(unit, tmp_path)
    slave.enterInitializationMode()
    slave.exitInitializationMode()

    def throws() -> list[float]:
        found = []
        for until in range(6, 20):
            events(slave, until + 0.5)
            found += slave.getFloat64([reference(unit, "drawn")])
        return found

    events(slave, 5.5)
    state = slave.getFMUState()
    first = throws()
    slave.setFMUState(state)
    assert throws() == first
    assert len(set(first)) == 14
    slave.freeFMUState(state)
    slave.freeInstance()


def test_a_state_is_taken_up_in_another_process(unit: CoSimulationUnit, running: FMU3Slave, tmp_path: Path) -> None:
    events(running, 0.5)
    state = running.getFMUState()
    written = running.serializeFMUState(state)
    first = events(running, 2.0)
    other = instance(unit, tmp_path)
    other.setFMUState(other.deserializeFMUState(written))
    assert events(other, 2.0) == first
    with pytest.raises(FMICallException):
        other.deserializeFMUState(written[:-8])
    other.freeInstance()


def test_seed_and_run_choose_the_run(unit: CoSimulationUnit, tmp_path: Path) -> None:
    def run(seed: int, number: int) -> list[float]:
        slave = instance(unit, tmp_path)
        slave.setUInt64([reference(unit, "seed"), reference(unit, "run")], [seed, number])
        slave.enterInitializationMode()
        slave.exitInitializationMode()
        found = events(slave, 1.0)
        slave.freeInstance()
        return found

    assert run(1, 2) == run(1, 2)
    assert run(1, 2) != run(1, 3) != run(2, 3)


@pytest.mark.parametrize(
    "wrong",
    [
        lambda slave: slave.doStep(0.0, 1.0),
        lambda slave: slave.getInt32([77]),
        lambda slave: slave.getInt32([1]),
        lambda slave: slave.getString([1]),
        lambda slave: slave.setInt64([3], [9]),
        lambda slave: (slave.enterStepMode(), slave.doStep(0.4, 1.0)),
        lambda slave: (slave.enterStepMode(), slave.doStep(0.0, -1.0)),
        lambda slave: (slave.enterStepMode(), slave.doStep(0.0, float("nan"))),
        lambda slave: slave.enterInitializationMode(),
    ],
)
def test_what_a_master_may_not_do_is_an_error(running: FMU3Slave, wrong: Any) -> None:
    with pytest.raises(FMICallException):
        wrong(running)


def test_a_description_of_another_network_is_rejected(unit: CoSimulationUnit, tmp_path: Path) -> None:
    slave = FMU3Slave(
        guid="0" * 32,
        unzipDirectory=extract(unit, FmiVersion.THREE, tmp_path),
        modelIdentifier=unit.name,
        instanceName="unit",
    )
    with pytest.raises(Exception, match="instantiate"):
        slave.instantiate(logMessage=lambda *told: None)


def test_states_and_errors_in_version_2(unit: CoSimulationUnit, tmp_path: Path) -> None:
    slave = FMU2Slave(
        guid=resource_file(unit).token,
        unzipDirectory=extract(unit, FmiVersion.TWO, tmp_path),
        modelIdentifier=unit.name,
        instanceName="unit",
    )
    slave.instantiate()
    slave.setupExperiment(startTime=5.0)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    count = [reference(unit, "count")]
    slave.doStep(5.0, 0.5)
    state = slave.getFMUstate()
    slave.doStep(5.5, 1.0)
    after = slave.getInteger(count)
    slave.setFMUstate(slave.deSerializeFMUstate(slave.serializeFMUstate(state)))
    assert slave.getInteger(count) < after
    slave.doStep(5.5, 1.0)
    assert slave.getInteger(count) == after
    assert slave.getReal([0]) == [6.5]
    with pytest.raises(FMICallException):
        slave.doStep(5.5, 1.0)
    slave.freeInstance()


@pytest.mark.parametrize(
    ("unit_of_time", "ticks"),
    [("", 10**9), ("1 s", 10**9), ("10 ms", 10**11), ("1 min", Fraction(10**9, 60)), ("1 ns", 10**18)],
)
def test_time_is_in_seconds(unit_of_time: str, ticks: Fraction) -> None:
    head = f"time_unit = {unit_of_time};\n" if unit_of_time else ""
    network = tachk.loads(f"{head}process P() {{ init location A {{ }} }}\nsystem P;\n").network
    assert ticks_of_a_second(network) == ticks


@pytest.mark.parametrize(("name", "plain"), [("a-b.c", "a_b_c"), ("2nd", "model_2nd"), ("gate", "gate")])
def test_the_name_is_an_identifier(name: str, plain: str) -> None:
    assert identifier(name) == plain
