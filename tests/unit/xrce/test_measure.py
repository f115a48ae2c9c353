"""`tachk xrce measure`: what captures say of periods, laws, windows and sleeps."""

from __future__ import annotations

import json
import struct
from functools import cache
from pathlib import Path

import jsonschema
import pytest
from click.testing import CliRunner

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.cli.main import app
from tachk.xrce.measuring.measure import Measurement, measure
from tachk.xrce.measuring.quantity import Confidence, roundest
from tachk.xrce.transmissions import read_transmissions
from tests.unit.xrce.captures import CREATE_CLIENT, RECORDED, needs_recorded, pcap, udp

ROOT = Path(__file__).resolve().parents[3]
SCHEMA = json.loads((ROOT / "docs/schema/measure.schema.json").read_text(encoding="utf-8"))

AT_RELAY, FROM_RELAY, AGENT, CLIENT = 9001, 9101, 8888, 40000


def write(number: int) -> bytes:
    return struct.pack("<BBH", 0x81, 0x80, number) + bytes.fromhex("070108000011001503000000")


def heartbeat(first: int, last: int) -> bytes:
    return bytes.fromhex("810000000B010500") + struct.pack("<HHB", first, last, 0x80)


def acknack(first: int, bitmap: int = 0) -> bytes:
    return bytes.fromhex("810000000A010500") + struct.pack("<H", first) + struct.pack(">HB", bitmap, 0x80)


def capture(path: Path, *timed: tuple[int, bytes]) -> Path:
    """A file with datagrams at these milliseconds."""
    octets = bytearray(pcap([packet for _, packet in timed]))
    at = 24
    for milliseconds, packet in timed:
        struct.pack_into("<II", octets, at, 1000 + milliseconds // 1000, milliseconds % 1000 * 1_000_000)
        at += 16 + len(packet)
    path.write_bytes(octets)
    return path


def up(payload: bytes) -> bytes:
    return udp(payload, CLIENT, AGENT)


def down(payload: bytes) -> bytes:
    return udp(payload, AGENT, CLIENT)


def direct(tmp_path: Path, *timed: tuple[int, bytes]) -> Measurement:
    return measure(capture(tmp_path / "run.pcap", (0, up(CREATE_CLIENT)), *timed))


def test_waits_that_do_not_change_are_the_period(tmp_path: Path):
    found = direct(tmp_path, (10, up(write(0))), *((10 + 150 * n, up(heartbeat(0, 0))) for n in range(1, 5)))
    period = found.quantity("client_heartbeat")
    assert (period.value, period.minimum, period.maximum, len(period.samples)) == (150, 150, 150, 4)
    assert [place.packet for place in period.samples[0].places] == [2, 3]
    assert found.definitions()["CLIENT_HEARTBEAT"] == 150
    assert found.definitions(50)["CLIENT_HEARTBEAT"] == 3
    assert "HEARTBEAT_LAW" not in found.definitions(), "steady and re-armed timers send alike here"


def test_a_timer_that_other_packets_start_again_is_rearmed(tmp_path: Path):
    found = direct(
        tmp_path,
        (0, up(write(0))),
        *((20 + 40 * n, down(write(n))) for n in range(10)),
        (480, up(heartbeat(0, 0))),
        (580, up(heartbeat(0, 0))),
    )
    assert found.quantity("client_heartbeat").value == 100
    assert found.definitions()["HEARTBEAT_LAW"] == 1
    assert found.definitions()["TRAFFIC"] == 40


def test_a_timer_that_nothing_starts_again_is_steady(tmp_path: Path):
    beats = [(100 * n, up(heartbeat(0, 0))) for n in range(1, 5)]
    others = [(100 * n + 30, down(write(n))) for n in range(1, 5)]
    found = direct(tmp_path, (0, up(write(0))), *sorted([*beats, *others], key=lambda pair: pair[0]))
    assert found.definitions()["HEARTBEAT_LAW"] == 0
    assert found.quantity("client_heartbeat").value == 100


def test_waits_that_double(tmp_path: Path):
    found = direct(tmp_path, (0, up(write(0))), *((100 * (2**n - 1), up(heartbeat(0, 0))) for n in range(1, 6)))
    assert found.definitions()["HEARTBEAT_LAW"] == 2
    assert found.definitions()["CLIENT_HEARTBEAT"] == 100


def test_a_long_wait_of_an_idle_line_says_that_run_calls_are_short(tmp_path: Path):
    found = direct(tmp_path, (0, up(write(0))), (5000, up(heartbeat(0, 0))))
    assert found.quantity("client_heartbeat").value is None
    assert found.quantity("client_heartbeat").confidence is Confidence.BOUND
    assert found.definitions()["SPIN"] == 50


def test_one_wait_is_no_period_but_a_bound(tmp_path: Path):
    """Run calls of 99 ms put the only HEARTBEAT off to 298 ms: the period is not 290."""
    period = direct(tmp_path, (0, up(write(0))), (298, up(heartbeat(0, 0)))).quantity("client_heartbeat")
    assert (period.value, period.confidence) == (None, Confidence.BOUND)
    assert period.how.startswith("at most 298 ms")
    short = direct(tmp_path, (0, up(write(0))), (50, up(heartbeat(0, 0)))).quantity("client_heartbeat")
    assert (short.value, short.confidence) == (50, Confidence.BOUND)
    assert direct(tmp_path, (0, up(write(0))), (100, up(heartbeat(0, 0)))).quantity("client_heartbeat").value == 100


def test_heartbeats_at_the_same_time_are_no_period(tmp_path: Path):
    period = direct(tmp_path, (0, up(write(0))), *((100, up(heartbeat(0, 0))),) * 6).quantity("client_heartbeat")
    assert (period.value, period.minimum, period.confidence) == (None, 0, Confidence.NOT_ENOUGH)


def test_a_client_up_to_2_0_is_known_by_two_heartbeats(tmp_path: Path):
    """Each 1 ms behind the only message that is unacknowledged; with an older one it would be overdue."""
    answered = [(0, up(write(0))), (1, up(heartbeat(0, 0))), (3, down(acknack(1)))]
    more = [(500, up(write(1))), (501, up(heartbeat(1, 1))), (503, down(acknack(2)))]
    settings = direct(tmp_path, *answered, *more).recorded_definitions()
    assert (settings["HEARTBEAT_LAW"], settings["CLIENT_HEARTBEAT"], settings["LOSSES"]) == (2, 1, 14)
    assert "PAUSES" not in settings


def test_a_line_that_was_recorded_twice_is_reported(tmp_path: Path):
    once = [(20 * n, up(write(n))) for n in range(20)]
    assert not direct(tmp_path, *once).problems
    twice = sorted([*once, *((time + 1, packet) for time, packet in once)], key=lambda pair: pair[0])
    (problem,) = direct(tmp_path, *twice).problems
    assert "is there twice" in problem and problem.startswith("run.pcap: ")


def test_a_heartbeat_behind_a_message_says_nothing_of_the_period(tmp_path: Path):
    found = direct(tmp_path, (0, up(write(0))), (3000, up(write(1))), (3001, up(heartbeat(0, 1))))
    assert found.quantity("client_heartbeat").confidence is Confidence.NOT_ENOUGH


def test_the_agent_and_its_dead_time(tmp_path: Path):
    beats = ((60 + 200 * n, down(heartbeat(0, 0))) for n in range(15))
    found = direct(tmp_path, (5, down(write(0))), *beats, (9000, up(write(0))), (9001, down(acknack(1))))
    assert found.definitions()["AGENT_HEARTBEAT"] == 200
    assert found.quantity("agent_first_heartbeat").minimum == 55
    dead = found.quantity("dead_time")
    assert (dead.minimum, dead.maximum, dead.value) == (2860, 3060, 3000)
    assert found.quantity("sleep").minimum == 8995


def test_what_a_relay_loses(tmp_path: Path):
    def passed(at: int, payload: bytes, lost: bool = False, late: int = 1) -> list[tuple[int, bytes]]:
        before = (at, udp(payload, CLIENT, AT_RELAY))
        return [before] if lost else [before, (at + late, udp(payload, FROM_RELAY, AGENT))]

    def back(at: int, payload: bytes) -> list[tuple[int, bytes]]:
        return [(at, udp(payload, AGENT, FROM_RELAY)), (at + 1, udp(payload, AT_RELAY, CLIENT))]

    path = capture(
        tmp_path / "relay.pcap",
        *passed(0, CREATE_CLIENT),
        *passed(10, write(0)),
        *back(12, acknack(1)),
        *passed(20, write(1), lost=True),
        *passed(120, heartbeat(1, 1)),
        *back(122, acknack(1, 1)),
        *passed(124, write(1)),
        *back(126, acknack(2)),
    )
    recording = read_transmissions(path)
    assert [link.relay is not None for link in recording.links] == [True]
    assert [t.is_lost for t in recording.transmissions] == [False] * 3 + [True] + [False] * 4
    found = measure(path)
    assert found.quantity("repair_to_agent").value == 105
    assert found.quantity("loss_to_agent").value == 20
    assert [place.packet for place in found.quantity("loss_to_agent").places] == [7]
    assert found.quantity("client_round_trip").value == 3
    assert found.definitions()["LOSSES"] == 1


@pytest.mark.parametrize(
    ("low", "high", "samples", "round_number"),
    [
        (100.2, 100.6, 40, 100),
        (103.1, 103.1, 1, 100),
        (199.9, 200.4, 20, 200),
        (29857, 30057, 9, 30000),
        (77, 77, 9, 77),
    ],
)
def test_round_numbers(low: float, high: float, samples: int, round_number: float):
    assert roundest(low, high, samples) == round_number


def test_the_reports(tmp_path: Path):
    path = capture(
        tmp_path / "run.pcap",
        (0, up(CREATE_CLIENT)),
        (9, up(write(0))),
        (109, up(heartbeat(0, 0))),
        (209, up(heartbeat(0, 0))),
    )
    result = CliRunner().invoke(app, ["xrce", "measure", str(path), "--format", "json"])
    assert result.exit_code == 0
    jsonschema.validate(json.loads(result.output), SCHEMA)
    model = tmp_path / "m.ta"
    process = "process P() { init location A; } system P;"
    model.write_text(f"time_unit = 20 ms; const int CLIENT_HEARTBEAT = 1; {process}", encoding="utf-8")
    result = CliRunner().invoke(app, ["xrce", "measure", str(path), "--for", str(model), "--format", "settings"])
    assert result.output == "-D CLIENT_HEARTBEAT=5\n"
    assert (
        "has no constant MESSAGES"
        in CliRunner().invoke(app, ["xrce", "measure", str(path), "--for", str(model)]).output
    )
    model.write_text(f"time_unit = 500 ms; const int CLIENT_HEARTBEAT = 1; {process}", encoding="utf-8")
    told = CliRunner().invoke(app, ["xrce", "measure", str(path), "--for", str(model)]).output
    assert "the unit of 500 ms is too coarse: CLIENT_HEARTBEAT is 100 ms" in told
    model.write_text(process, encoding="utf-8")
    result = CliRunner().invoke(app, ["xrce", "measure", str(path), "--for", str(model)])
    assert (result.exit_code, "does not say how long its unit of time is" in result.stderr) == (2, True)


def test_a_file_that_is_no_capture(tmp_path: Path):
    path = tmp_path / "notes.txt"
    path.write_text("a text")
    with pytest.raises(UsageError, match="neither a pcap nor a pcapng"):
        tachk.measure(path)


@cache
def recorded(name: str) -> Measurement:
    return measure(next(RECORDED.glob(f"{name}*.pcap")))


@needs_recorded
@pytest.mark.parametrize("name", ["b_loss20_paced150_seed4", "c1_", "c3_", "d1_", "e3_", "f3a_", "g1_", "g3_", "i2_"])
def test_the_clients_beat_every_100_ms(name: str):
    assert recorded(name).quantity("client_heartbeat").value == pytest.approx(100, rel=0.02)


@needs_recorded
@pytest.mark.parametrize("name", ["b_loss20_burst_seed13", "d4_", "e4_", "e6_", "h4_", "h6_", "h8_"])
def test_the_agent_beats_every_200_ms(name: str):
    assert recorded(name).quantity("agent_heartbeat").value == pytest.approx(200, rel=0.02)


@needs_recorded
def test_what_else_recorded_captures_say():
    for name in ("b_loss20_burst_seed13", "e3_", "g1_", "g3_", "i1_", "i2_"):
        assert recorded(name).definitions()["HEARTBEAT_LAW"] == 1
    for name in ("h6_", "h8_"):
        dead = recorded(name).quantity("dead_time")
        assert (dead.value, round(dead.minimum or 0, -2)) == (30000, 29900 if name == "h6_" else 29800)
    assert recorded("i1_").definitions()["SPIN"] < 100
    assert recorded("i2_").definitions()["TRAFFIC"] < 100 <= recorded("i2_").definitions()["SPIN"]
    assert recorded("c3_").definitions()["SPIN"] == 100
    assert recorded("h5_").definitions()["AGENT_WINDOW"] == 16
    assert recorded("a5_").definitions()["HISTORY"] == 8
    assert recorded("h7_").definitions()["SUBSCRIPTION"] == 1


@needs_recorded
@pytest.mark.parametrize(("name", "answer"), [("c1_", "holds"), ("h7_", "holds"), ("i1_", "fails"), ("i2_", "fails")])
def test_models_with_measured_constants_answer_as_the_captures_show(name: str, answer: str):
    model = tachk.load(str(ROOT / "models/micro_xrce_dds/client_3_0.ta"), **recorded(name).definitions())
    (verdict,) = model.verify(property="ECFS", trace=False).record.verdicts
    assert verdict.answer.value == answer
