"""What `tachk xrce measure` says of faulty links and late readers, and what models and recordings say of that."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest
from click.testing import CliRunner

import tachk
from tachk.cli.main import app
from tachk.xrce.measuring.measure import Measurement, measure
from tachk.xrce.measuring.quantity import Confidence
from tests.unit.xrce.captures import CREATE_CLIENT, udp
from tests.unit.xrce.test_measure import acknack, capture, direct, down, heartbeat, up, write

pytestmark = pytest.mark.drawn

ROOT = Path(__file__).resolve().parents[3]
MODEL = ROOT / "models/micro_xrce_dds/client_3_0.ta"
RECORDED_MODEL = ROOT / "models/micro_xrce_dds/recorded.ta"
CAPTURES = ROOT / "tests/data/captures"

AT_RELAY, FROM_RELAY, AGENT, CLIENT = 9001, 9101, 8888, 40000
READ_DATA = bytes.fromhex("8180010008011000000E001680000001FFFF000000000000")


def data(number: int, sample: int) -> bytes:
    return bytes((0x81, 0x80, number, 0)) + bytes.fromhex("09010800000E0016") + sample.to_bytes(4, "little")


def sample(number: int, content: int) -> bytes:
    return bytes((0x81, 0x80, number, 0)) + bytes.fromhex("0701080000110015") + content.to_bytes(4, "little")


def relayed(at: int, payload: bytes, arrives: int | None) -> list[tuple[int, bytes]]:
    """A message of the client through a relay; it arrives then, or never."""
    behind = [] if arrives is None else [(arrives, udp(payload, FROM_RELAY, AGENT))]
    return [(at, udp(payload, CLIENT, AT_RELAY)), *behind]


def through_relay(path: Path, *messages: list[tuple[int, bytes]]) -> Measurement:
    packets = [packet for message in (relayed(0, CREATE_CLIENT, 1), *messages) for packet in message]
    return measure(capture(path / "run.pcap", *sorted(packets, key=lambda pair: pair[0])))


@cache
def own(name: str) -> Measurement:
    return measure(CAPTURES / f"{name}.pcap")


@pytest.mark.parametrize("name", ["created_again", "needless_nack", "spin_pause", "second_read", "stale_acknack"])
def test_a_busy_machine_does_not_change_the_period_of_the_client(name: str):
    assert own(name).quantity("client_heartbeat").value == pytest.approx(100, rel=0.02)


@pytest.mark.parametrize("name", ["dead_time", "dead_time_ping", "push_sleep", "second_read", "sleep_50s"])
def test_a_busy_machine_does_not_change_the_period_of_the_agent(name: str):
    assert own(name).quantity("agent_heartbeat").value == pytest.approx(200, rel=0.02)


def test_delays_are_not_taken_for_periods():
    found = own("losses_and_delays")
    assert found.quantity("agent_heartbeat").value is None
    assert found.quantity("dead_time").confidence is Confidence.NOT_ENOUGH


def test_one_vote_each_shows_no_law():
    assert own("second_read").quantity("client_heartbeat_law").confidence is Confidence.NOT_ENOUGH


def test_an_older_message_that_comes_later_is_late(tmp_path: Path):
    found = through_relay(tmp_path, relayed(10, write(0), 50), relayed(20, write(1), 21))
    assert found.quantity("overtaking").value == 29
    assert found.definitions()["LATES"] == 1


def test_a_repetition_is_not_late(tmp_path: Path):
    first, second = relayed(10, write(0), None), relayed(20, write(1), 21)
    found = through_relay(tmp_path, first, second, relayed(30, write(0), 31), relayed(32, write(0), None))
    assert "LATES" not in found.definitions()


def test_a_way_on_which_nothing_comes_through_any_more(tmp_path: Path):
    beats = [relayed(110 + 100 * n, heartbeat(1, 1), None) for n in range(4)]
    found = through_relay(tmp_path, relayed(5, write(0), 6), relayed(10, write(1), None), *beats)
    assert (found.definitions()["BREAKS"], found.definitions()["LOSSES"]) == (1, 0)
    assert found.quantity("stopped").value == 400


def test_an_agent_that_answers_no_more(tmp_path: Path):
    beats = [(120 + 100 * n, up(heartbeat(1, 1))) for n in range(5)]
    found = direct(tmp_path, (10, up(write(0))), (11, down(acknack(1))), (20, up(write(1))), *beats)
    assert found.definitions()["BREAKS"] == 1
    assert "answers a client no more" in found.quantity("stopped").how
    assert "BREAKS" not in direct(tmp_path, (10, up(write(0))), (11, down(acknack(1))), *beats[:2]).definitions()


def test_a_client_that_asks_late_gets_what_is_kept(tmp_path: Path):
    reader = 40001
    writes = [(100 * n + 10, up(sample(n, n))) for n in range(30)]
    gets = [(3101 + n, udp(data(n, 14 + n), AGENT, reader)) for n in range(16)]
    packets = [(0, up(CREATE_CLIENT)), (1, udp(CREATE_CLIENT, reader, AGENT)), *writes]
    found = measure(capture(tmp_path / "late.pcap", *packets, (3100, udp(READ_DATA, reader, AGENT)), *gets))
    settings = found.definitions()
    assert (settings["KEEP"], settings["SUBSCRIPTION"], settings["SLEEPS"], settings["SLEEP"]) == (16, 4, 1, 3090)


@pytest.mark.parametrize(("written", "wanted"), [(10, 3), (3, 0xFFFF)])
def test_who_gets_what_it_asks_for_or_all_says_only_that_so_many_are_kept(tmp_path: Path, written: int, wanted: int):
    reader, asks = 40001, READ_DATA[:16] + wanted.to_bytes(2, "little") + READ_DATA[18:]
    writes = [(100 * n + 10, up(sample(n, n))) for n in range(written)]
    gets = [(3101 + n, udp(data(n, n), AGENT, reader)) for n in range(3)]
    packets = [
        (0, up(CREATE_CLIENT)),
        (1, udp(CREATE_CLIENT, reader, AGENT)),
        *writes,
        (3100, udp(asks, reader, AGENT)),
    ]
    found = measure(capture(tmp_path / "asks.pcap", *packets, *gets))
    assert (found.quantity("kept").value, found.quantity("kept").confidence) == (3, Confidence.BOUND)
    assert "KEEP" not in found.definitions()


def test_whose_radio_is_off_and_who_only_answers_late():
    settings = own("push_sleep").recorded_definitions()
    assert (settings["SLEEPS"], settings["CLIENTS"], settings["AGENT_HEARTBEAT"]) == (1, 2, 200)
    assert not {"SLEEPS", "PAUSES"} & set(own("stale_acknack").recorded_definitions())


def verdict(name: str, **settings: int) -> str:
    return str(tachk.load(MODEL, **settings).verify(property=name, trace=False)[name].answer)


def test_a_stale_acknack_is_found_with_measured_settings():
    settings = own("stale_acknack").definitions()
    settings = {name: value for name, value in settings.items() if name != "PLACES"} | {"SLEEPS": 0}
    assert verdict("ECFS", **settings) == "fails"
    assert verdict("ECFS", **settings | {"LATES": 0}) == "holds"


def test_a_link_that_stops_loses_what_follows():
    usual = {"MESSAGES": 1, "SLEEPS": 0, "LOSSES": 0, "SPIN": 100}
    assert [verdict("ECFS", **usual, BREAKS=breaks) for breaks in (1, 4)] == ["fails", "holds"]
    assert verdict("FARS", **usual, BREAKS=4) == "fails"


def test_who_asks_late_gets_only_what_is_kept():
    late = {"MESSAGES": 2, "SLEEPS": 1, "SLEEP": 5000, "LOSSES": 0, "SUBSCRIPTION": 4}
    assert [verdict("ECRA", **late, KEEP=keep) for keep in (1, 2)] == ["fails", "holds"]


def test_a_recording_is_a_run_of_the_model_with_what_was_measured_in_it():
    path = str(CAPTURES / "spin_pause.pcap")
    measured = CliRunner().invoke(app, ["xrce", "measure", path, "--for", str(RECORDED_MODEL), "--format", "settings"])
    assert measured.exit_code == 0
    settings = measured.output.split()
    assert "EXACT_BITMAPS=1" in settings
    assert {"PAUSES=1", "CLIENTS=1"} <= set(settings)
    found = CliRunner().invoke(
        app, ["conform", str(RECORDED_MODEL), path, *settings, "--tolerance", "10ms", "--late", "20ms"]
    )
    assert found.exit_code == 0, found.output
