"""Units of parts of a network, coupled, do what the network does."""

from __future__ import annotations

from pathlib import Path

import pytest
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave
from fmpy.validation import validate_fmu

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.engine.simulation.policy import Policy
from tachk.engine.simulation.simulator import TICKS_PER_UNIT, SimulationOptions
from tachk.model.network import Network
from tachk.simulation.columns import all_columns
from tachk.simulation.fmi.description import FmiVersion
from tachk.simulation.fmi.resource_file import resource_file
from tachk.simulation.fmi.unit import CoSimulationUnit, Role, open_unit
from tests.support.simulated.cosimulated import extract, lasting, native_rows
from tests.support.simulated.coupled import Values, coupled, not_a_run

LINK = """
time_unit = 1 ms;
broadcast chan ask, up, down, answer;
meta int[0, 100] number = 0;
int[0, 100] asked = 0, answered = 0;
bool busy = false;
process Client() {
    clock x;
    init location Idle {
        invariant x <= 7;
        to Waits {
            guard x >= 7 && asked < 90;
            sync ask!;
            assign x = 0, asked = asked + 1, number = asked, busy = true;
        }
    }
    location Waits {
        invariant x <= 11;
        to Idle { sync answer?; assign x = 0, answered = number, busy = false; }
        to Idle { guard x >= 11; assign x = 0, busy = false; }
    }
}
process Link() {
    clock y;
    int[0, 100] carried = 0;
    init location Empty {
        to Up { sync ask?; assign y = 0, carried = number; }
        to Down { sync down?; assign y = 0, carried = number; }
    }
    location Up { invariant y <= 3; to Empty { guard y >= 2; sync up!; assign number = carried; } }
    location Down { invariant y <= 3; to Empty { guard y >= 2; sync answer!; assign number = carried; } }
}
process Agent() {
    clock z;
    int[0, 100] seen = 0;
    init location Free { to Works { sync up?; assign z = 0, seen = number; } }
    location Works { invariant z <= 5; to Done { guard z >= 1; } }
    committed location Done { to Free { sync down!; assign number = seen; } }
}
system Client, Link, Agent;
"""
PARTS = (["Client"], ["Link"], ["Agent"])


@pytest.fixture(scope="module")
def link() -> Network:
    return tachk.loads(LINK).network


def run_coupled(
    network: Network, parts: tuple[list[str], ...], drawing: SimulationOptions, folder: Path
) -> list[tuple[int, Values]]:
    units = [open_unit(network, part, f"unit{number}", clocks=True) for number, part in enumerate(parts)]
    return list(coupled(units, folder, drawing, 0, float(drawing.until / units[0].second)))


def test_three_units_have_the_trace_of_the_network(link: Network, tmp_path: Path) -> None:
    drawing = SimulationOptions(1, 200 * TICKS_PER_UNIT, Policy.EARLIEST)
    rows = run_coupled(link, PARTS, drawing, tmp_path)
    native, *_ = native_rows(link, drawing, 0)
    names = [column.name for column in all_columns(link)]
    together = [(time, tuple(values[name] for name in names)) for time, values in rows]
    assert lasting(together) == lasting(native)
    assert len(rows) > 80


@pytest.mark.parametrize("policy", [Policy.STOCHASTIC, Policy.LATEST])
def test_coupled_units_have_runs_of_the_network(policy: Policy, link: Network, tmp_path: Path) -> None:
    rows = run_coupled(link, PARTS, SimulationOptions(5, 100 * TICKS_PER_UNIT, policy), tmp_path)
    assert len(rows) > 20
    assert not_a_run(link, rows) == ""
    wrong = [*rows[:10], (rows[10][0] + 1, rows[10][1]), *rows[11:]]
    assert not_a_run(link, wrong), "the judge accepts anything"


def test_clients_links_and_agents_of_the_protocol_run_as_units_of_their_own(tmp_path: Path) -> None:
    """Arrays of channels, values that go along with messages, broadcasts with receivers in several units."""
    network = tachk.load("models/micro_xrce_dds/paper.ta").network
    parts = (
        ["application", "ClientPublisher", "ClientSubscriber"],
        ["InstantLink", "Duplicate", "LossTracker", "HeardTracker", "DownLossTracker", "UnconfirmedTracker"],
        ["ProxyPublisher", "agent", "ProxySubscriber"],
    )
    rows = run_coupled(network, parts, SimulationOptions(0, 4 * TICKS_PER_UNIT), tmp_path)
    assert len(rows) > 12
    assert not_a_run(network, rows) == ""


# ---- one unit -------------------------------------------------------------------------------------------------------


def reference(unit: CoSimulationUnit, name: str) -> int:
    (found,) = [number for number, variable in enumerate(unit.variables) if variable.name == name]
    return found


def agent(unit: CoSimulationUnit, folder: Path) -> FMU3Slave:
    extracted = extract(unit, FmiVersion.THREE, folder)
    assert validate_fmu(extracted) == []
    slave = FMU3Slave(
        guid=resource_file(unit).token, unzipDirectory=extracted, modelIdentifier=unit.name, instanceName="agent"
    )
    slave.instantiate(eventModeUsed=True, earlyReturnAllowed=True, logMessage=lambda *told: None)
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    return slave


def test_a_message_is_received_with_its_values_and_answered(link: Network, tmp_path: Path) -> None:
    unit = open_unit(link, ["Agent"], "agent", clocks=True)
    down = reference(unit, "down!")
    slave = agent(unit, tmp_path)
    slave.updateDiscreteStates()
    slave.setInt32([reference(unit, "outside.number")], [42])
    slave.setClock([reference(unit, "up?")], [True])
    _, _, _, _, known, answered = slave.updateDiscreteStates()
    assert slave.getInt32([reference(unit, "Agent.seen")]) == [42]
    assert known
    state = slave.serializeFMUState(slave.getFMUState())

    def answer(slave: FMU3Slave) -> list[int]:
        slave.enterStepMode()
        event, _, _, last = slave.doStep(0.0, answered)
        assert event and last == answered
        slave.enterEventMode()
        assert slave.getClock([down]) == [False]
        again, *_ = slave.updateDiscreteStates()
        assert again and slave.getBoolean([reference(unit, "committed")]) == [True]
        again, *_ = slave.updateDiscreteStates()
        assert again and slave.getClock([down]) == [True], "masters come again to see the clock"
        found = list(slave.getInt32([reference(unit, "sent.number")]))
        again, *_ = slave.updateDiscreteStates()
        assert not again and slave.getClock([down]) == [False]
        return found

    assert answer(slave) == [42]
    other = agent(unit, tmp_path)
    other.setFMUState(other.deserializeFMUState(state))
    assert answer(other) == [42], "a saved state knows what the surroundings did"
    other.freeInstance()
    slave.freeInstance()


def test_in_version_2_messages_are_counted(link: Network, tmp_path: Path) -> None:
    unit = open_unit(link, ["Agent"], "agent", clocks=False)
    extracted = extract(unit, FmiVersion.TWO, tmp_path)
    assert validate_fmu(extracted) == []
    slave = FMU2Slave(
        guid=resource_file(unit).token, unzipDirectory=extracted, modelIdentifier=unit.name, instanceName="agent"
    )
    slave.instantiate()
    slave.setupExperiment()
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    slave.doStep(0.0, 1.0)
    assert slave.getInteger([reference(unit, "down!")]) == [0]
    slave.setInteger([reference(unit, "outside.number"), reference(unit, "up?")], [7, 1])
    slave.doStep(1.0, 1.0)
    assert slave.getInteger([reference(unit, "down!"), reference(unit, "sent.number")]) == [1, 7]
    slave.freeInstance()


def test_inputs_are_what_others_write(link: Network) -> None:
    unit = open_unit(link, ["Client"], "client", clocks=True)
    outer = {v.name for v in unit.variables if v.role in (Role.INPUT, Role.RECEIVES, Role.SENDS)}
    assert outer == {"outside.number", "answer?", "ask!"}


def test_only_channels_that_a_part_speaks_of_lead_out_of_it() -> None:
    network = tachk.load("models/micro_xrce_dds/paper.ta").network
    unit = open_unit(network, ["application", "publisher"], "publisher", clocks=True)
    heard = [v.name for v in unit.variables if v.role is Role.RECEIVES]
    assert heard == [f"deliver[1][{kind}]?" for kind in range(4)]


BOUND = """
chan hand;
broadcast chan tell;
clock x;
bool on = false;
process A() {
    init location P { to Q { sync hand!; } to Q { guard x > 1; } }
    location Q { to P { } }
}
process B() {
    init location R { to S { sync hand?; } }
    location S { to R { guard x > 2; sync tell!; } }
}
process C() { init location T { to T { guard x > 3; } } }
process D() { init location U { to U { sync tell?; assign on = !on; } } }
system A, B, C, D;
"""


@pytest.mark.parametrize(
    ("names", "told"),
    [
        (["E"], "no process 'E'"),
        (["A", "B", "C", "D"], "all processes"),
        (["A"], "the clock x"),
        (["C"], "the clock x"),
        (["A", "B"], "the clock x"),
    ],
)
def test_what_cannot_be_taken_apart_is_rejected(names: list[str], told: str) -> None:
    network = tachk.loads(BOUND).network
    with pytest.raises(UsageError, match=told):
        open_unit(network, names, "part", clocks=True)


@pytest.mark.parametrize("name", ["committed", "outside"])
def test_names_of_the_unit_itself_are_not_taken_for_others(name: str) -> None:
    text = LINK.replace("busy", name) if name == "committed" else LINK.replace("Agent", "outside")
    network = tachk.loads(text).network
    with pytest.raises(UsageError, match="something else"):
        open_unit(network, ["Client"], "client", clocks=True)


def test_a_channel_for_two_must_not_lead_out() -> None:
    text = BOUND.replace("clock x;\n", "")
    for bound in (1, 2, 3):
        text = text.replace(f"guard x > {bound};", "")
    network = tachk.loads(text).network
    with pytest.raises(UsageError, match="the channel hand"):
        open_unit(network, ["A"], "part", clocks=True)
    assert open_unit(network, ["A", "B"], "part", clocks=True)
