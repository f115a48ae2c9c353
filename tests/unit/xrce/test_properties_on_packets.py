"""The properties of the reliable stream on captures: what their packets say, and what is known to be true."""

from __future__ import annotations

import csv
import json
import struct
from pathlib import Path

import jsonschema
import pytest
from click.testing import CliRunner

import tachk
from tachk.cli.main import app
from tachk.recordings.traces.trace_files import open_trace
from tests.unit.xrce.captures import RECORDED, needs_recorded, timed, udp

ROOT = Path(__file__).resolve().parents[3]
QUERIES = ROOT / "queries/micro_xrce_dds.ta"
BOTH_SIDES = (8888, 9001, 9002, 9003)

EXPECTED = {
    row["capture"]: row
    for row in csv.DictReader((ROOT / "tests/data/packet_verdicts.csv").read_text(encoding="utf-8").splitlines())
}
"""What the logs of the relay and of the applications imply, written down before any capture was judged. One was
corrected afterwards: the relay stamps a packet after it has sent it, and so h7 seemed to be disturbed by a packet
that it had received."""

TESTED = [
    name
    for name, row in EXPECTED.items()
    if any(row[verdict] != "true" for verdict in row if verdict not in ("capture", "reason"))
    or name.startswith(("a2", "b_loss20_burst_seed15", "d4", "i1", "i2"))
]
"""bench/packet_verdicts.py judges all of them."""


@needs_recorded
@pytest.mark.parametrize("name", TESTED)
def test_verdicts_are_those_that_the_ground_truth_implies(name: str):
    report = tachk.monitor(QUERIES, RECORDED / f"{name}.pcap", robustness=False)
    found = {verdict.name: verdict.truth.word for verdict in report}
    for verdict in ("ECFS", "ECRA", "NIWS", "RMIO", "RMIO2", "TMRK", "TMRK2", "FARS"):
        assert found[verdict] == EXPECTED[name][verdict], verdict
    assert found["FARS_each"] == EXPECTED[name]["FARS"]


KEY, OTHER_KEY = "CCCCDDDD", "AAAABBBB"


class Talk:
    """A conversation between clients and the Agent, with a relay between them that is recorded on both sides."""

    def __init__(self) -> None:
        self.packets: list[tuple[float, bytes]] = []

    def up(self, time: float, message: bytes, client: int = 1, lost: bool = False) -> Talk:
        self.packets.append((time, udp(message, 40000 + client, 9000 + client)))
        if not lost:
            self.packets.append((time + 1, udp(message, 9100 + client, 8888)))
        return self

    def down(self, time: float, message: bytes, client: int = 1, lost: bool = False) -> Talk:
        self.packets.append((time, udp(message, 8888, 9100 + client)))
        if not lost:
            self.packets.append((time + 1, udp(message, 9000 + client, 40000 + client)))
        return self

    def capture(self, folder: Path) -> Path:
        path = folder / "talk.pcap"
        path.write_bytes(timed(sorted(self.packets, key=lambda packet: packet[0])))
        return path

    def columns(self, folder: Path) -> dict[str, list[float]]:
        trace = open_trace(self.capture(folder), ports=BOTH_SIDES).read()
        return {name: values.tolist() for name, values in trace.columns.items()}

    def verdicts(self, folder: Path) -> dict[str, str]:
        report = tachk.monitor(QUERIES, self.capture(folder), ports=BOTH_SIDES)
        return {verdict.name: verdict.truth.word for verdict in report}


def created(key: str = KEY) -> bytes:
    return bytes.fromhex(f"8000000000011000585243450100010F{key}8100FC01")


def write(number: int, sample: int) -> bytes:
    return struct.pack("<BBH", 0x81, 0x80, number) + bytes.fromhex("0701080000110015") + struct.pack("<I", sample)


def data(number: int, sample: int) -> bytes:
    return struct.pack("<BBH", 0x81, 0x80, number) + bytes.fromhex("09010800000E0016") + struct.pack("<I", sample)


def reader(number: int) -> bytes:
    """Creates a data reader by the reference T__dr."""
    described = bytes.fromhex("000A0016" + "06010000" + "06000000") + b"T__dr\0" + bytes.fromhex("0014")
    return struct.pack("<BBH", 0x81, 0x80, number) + bytes.fromhex("01011400") + described


def heartbeat(first: int, last: int) -> bytes:
    return bytes.fromhex("810000000B010500") + struct.pack("<HHB", first, last, 0x80)


def acknack(first: int, bitmap: int = 0) -> bytes:
    return bytes.fromhex("810000000A010500") + struct.pack("<H", first) + struct.pack(">HB", bitmap, 0x80)


DELETE_SESSION = bytes.fromhex("81000000030104000002FFFE")


def test_a_lost_message_is_lost_until_it_is_named(tmp_path: Path):
    talk = Talk().up(0, created()).up(10, write(0, 7), lost=True).up(20, heartbeat(0, 0)).down(30, acknack(0, 1))
    found = talk.up(40, write(0, 7)).down(50, acknack(1)).columns(tmp_path)
    assert found["lost"] == [0, 0, 1, 1, 1, 0, 0, 0, 0, 0, 0]
    assert found["unheard"] == [0, 0, 1, 1, 1, 1, 0, 0, 0, 0, 0]
    assert found["allToAgent"] == [1, 1, 0, 0, 0, 0, 0, 0, 0, 1, 1]
    assert found["client_CCCCDDDD_at_8888.to_agent.repaired"][-2:] == [1, 1]
    assert found["client_CCCCDDDD_at_9001.to_agent.confirmed"][-2:] == [0, 1]


def test_without_the_other_side_nothing_is_lost_that_is_seen(tmp_path: Path):
    path = tmp_path / "one.pcap"
    path.write_bytes(timed([(0, udp(created())), (1, udp(write(0, 7))), (1500, udp(heartbeat(0, 1)))]))
    trace = open_trace(path).read(["lost", "allToAgent"])
    assert trace.columns["lost"].tolist() == [0, 0, 1]  # of number 1 only a HEARTBEAT speaks
    assert trace.columns["allToAgent"].tolist() == [1, 0, 0]


def test_a_client_that_answers_at_once_was_only_silent(tmp_path: Path):
    talk = Talk().up(0, created()).down(3000, data(0, 1)).up(3050, acknack(1)).down(6000, data(1, 2))
    assert talk.verdicts(tmp_path)["NIWS"] == "true"
    found = talk.columns(tmp_path)
    # rows: created twice, asleep at both sides, data twice, acknack twice, asleep twice, data twice: nothing follows
    assert found["sleep"] == [0, 0, 1, 1, 1, 1, 0, 0, 1, 1, 1, 1]
    assert found["arrive"] == [0] * 12


def test_what_a_silent_client_does_not_answer_came_while_it_slept(tmp_path: Path):
    talk = Talk().up(0, created()).down(3000, data(0, 1)).up(4000, acknack(1))
    trace = open_trace(talk.capture(tmp_path), ports=BOTH_SIDES).read()
    milliseconds = [time // 1_000_000 for time in trace.times.tolist()]
    assert milliseconds == [0, 1, 2000, 2001, 3000, 3001, 3100, 3101, 4000, 4001]  # at both sides
    assert trace.columns["arrive"].tolist() == [0, 0, 0, 0, 0, 0, 0, 1, 0, 0]
    report = tachk.monitor(QUERIES, talk.capture(tmp_path), ports=BOTH_SIDES, select=["NIWS"])
    assert report["NIWS"].finding is not None
    assert report.to_dict()["results"][0]["finding"]["packet"] == 4


def test_a_short_sleep_shows_by_what_is_not_answered(tmp_path: Path):
    talk = Talk().up(0, created()).down(300, data(0, 1)).up(1200, acknack(1))
    trace = open_trace(talk.capture(tmp_path), ports=BOTH_SIDES).read()
    assert [time // 1_000_000 for time in trace.times.tolist()] == [0, 1, 300, 301, 801, 1200, 1201]
    assert trace.columns["sleep"].tolist() == trace.columns["arrive"].tolist() == [0, 0, 0, 0, 1, 0, 0]
    report = tachk.monitor(QUERIES, talk.capture(tmp_path), ports=BOTH_SIDES, select=["NIWS"])
    assert report.to_dict()["results"][0]["finding"]["packet"] == 4


def test_a_slow_answer_is_no_sleep(tmp_path: Path):
    assert set(Talk().up(0, created()).down(300, data(0, 1)).up(790, acknack(1)).columns(tmp_path)["sleep"]) == {0}


def test_silence_that_begins_to_count_as_sleep_while_an_answer_is_owed(tmp_path: Path):
    talk = Talk().up(0, created()).down(1950, data(0, 1)).up(2020, acknack(1))
    found = talk.columns(tmp_path)
    assert 1 in found["sleep"]
    assert set(found["arrive"]) == {0}


def test_seen_from_the_agent_what_is_not_answered_may_have_been_lost(tmp_path: Path):
    packets = [(0, created(), True), (300, data(0, 1), False), (1200, acknack(1), True)]
    capture = tmp_path / "agent.pcap"
    capture.write_bytes(
        timed([(time, udp(message, *((40001, 8888) if up else (8888, 40001)))) for time, message, up in packets])
    )
    assert set(open_trace(capture).read(["sleep"]).columns["sleep"].tolist()) == {0}


def test_an_acknack_needs_no_answer(tmp_path: Path):
    talk = Talk().up(0, created()).down(3000, acknack(0)).up(5000, heartbeat(1, 0))
    assert talk.verdicts(tmp_path)["NIWS"] == "true"


def test_whoever_has_closed_its_session_does_not_sleep(tmp_path: Path):
    talk = Talk().up(0, created()).up(10, DELETE_SESSION).up(9000, created(OTHER_KEY), client=2)
    assert talk.columns(tmp_path)["sleep"] == [0] * 6


def test_what_readers_lack(tmp_path: Path):
    talk = Talk().up(0, created()).up(2, created(OTHER_KEY), client=2)
    talk.up(4, reader(0), client=2).down(6, acknack(1), client=2)
    talk.up(10, write(0, 1)).down(12, acknack(1)).up(14, write(1, 2)).down(16, acknack(2))
    assert talk.columns(tmp_path)["allToClient"][-1] == 0
    talk.down(20, data(0, 1), client=2).up(22, acknack(1), client=2)
    assert talk.columns(tmp_path)["allToClient"][-1] == 0
    talk.down(24, data(1, 2), client=2).up(26, acknack(2), client=2)
    found = talk.columns(tmp_path)
    assert (found["allToClient"][-1], found["FDDSisSent"][-1]) == (1, 1)
    assert talk.verdicts(tmp_path)["ECRA"] == "true"
    repeated = talk.down(30, data(2, 1), client=2).up(32, acknack(3), client=2)
    assert repeated.columns(tmp_path)["FDDSisSent"][-1] == 0
    assert repeated.verdicts(tmp_path)["RMIO2"] == "false"


def test_a_sample_that_was_passed_over_is_missing_for_ever(tmp_path: Path):
    talk = Talk().up(0, created()).up(2, created(OTHER_KEY), client=2)
    talk.up(4, reader(0), client=2).down(6, acknack(1), client=2)
    talk.up(10, write(0, 1)).up(11, write(1, 2)).down(14, acknack(2))
    talk.down(20, data(0, 2), client=2).up(22, acknack(1), client=2)
    assert talk.columns(tmp_path)["allToClient"][-1] == 0
    assert talk.verdicts(tmp_path)["ECRA"] == "undetermined"


def test_an_altered_message_is_not_what_was_sent(tmp_path: Path):
    talk = Talk().up(0, created()).up(10, write(0, 1)).down(20, acknack(1))
    time, packet = talk.packets[3]
    talk.packets[3] = (time, packet.replace(struct.pack("<I", 1), struct.pack("<I", 3)))
    assert talk.columns(tmp_path)["TDDSisSent"][-1] == 0


def test_the_agent_waits_for_each_message(tmp_path: Path):
    """There is always something unconfirmed, but each message is confirmed within 15 s."""
    talk = Talk().up(0, created()).down(10, data(0, 0))
    for number in range(1, 5):
        talk.down(10_000 * number, data(number, number)).up(10_000 * number + 5_000, acknack(number))
    talk.up(46_000, acknack(5))
    found = talk.verdicts(tmp_path)
    assert (found["FARS"], found["FARS_each"]) == ("false", "true")
    talk.down(47_000, data(5, 5)).up(47_100, heartbeat(1, 0))
    assert talk.verdicts(tmp_path)["FARS_each"] == "undetermined"
    assert (
        Talk().up(0, created()).down(10, data(0, 0)).up(30_000, heartbeat(1, 0)).verdicts(tmp_path)["FARS_each"]
        == "false"
    )
    talk.up(68_000, heartbeat(1, 0))
    assert talk.verdicts(tmp_path)["FARS_each"] == "false"


def test_a_message_that_waits_to_the_end_counts_from_when_it_was_sent(tmp_path: Path):
    talk = Talk().up(0, created()).down(10, data(0, 0)).down(1_000, data(1, 1))
    talk.up(10_000, acknack(1)).up(25_000, heartbeat(1, 0))
    assert talk.verdicts(tmp_path)["FARS_each"] == "false"


def test_an_acknack_of_what_was_never_sent_confirms_nothing(tmp_path: Path):
    talk = Talk().up(0, created()).down(10, data(0, 0)).up(20, acknack(9))
    assert talk.columns(tmp_path)["behind"][-1] == 1


def test_a_client_that_comes_again_from_another_port_is_the_same(tmp_path: Path):
    path = tmp_path / "again.pcap"
    path.write_bytes(
        timed([(0, udp(created())), (1, udp(write(0, 7))), (5, udp(created(), 40009)), (6, udp(write(0, 7), 40009))])
    )
    trace = open_trace(path).read(["client_CCCCDDDD.to_agent.sent"])
    assert trace.columns["client_CCCCDDDD.to_agent.sent"].tolist() == [0, 1, 0, 1]


def test_reports_name_packets(tmp_path: Path):
    talk = Talk().up(0, created()).down(3000, data(0, 1)).up(4000, acknack(1)).capture(tmp_path)
    arguments = ["monitor", str(QUERIES), str(talk), "--property", "NIWS"]
    arguments += [part for port in BOTH_SIDES for part in ("--port", str(port))]
    told = CliRunner().invoke(app, arguments)
    assert told.exit_code == 10
    assert "`arrive` is true at 3.101 s (packet 4)" in told.output
    made = CliRunner().invoke(app, [*arguments, "--format", "json", "--all-violations"])
    schema = json.loads((ROOT / "docs/schema/monitor.schema.json").read_text(encoding="utf-8"))
    report = json.loads(made.output)
    jsonschema.validate(report, schema)
    assert report["results"][0]["violations"]["listed"][0]["packet"] == 4


def test_robustness_in_time_is_reported_in_milliseconds() -> None:
    """How late a repair may come: seconds in the report for programs, milliseconds for people."""
    capture = str(ROOT / "tests/data/captures/stale_acknack.pcap")
    asked = ["monitor", str(QUERIES), capture, "--property", "TMRK", "--time-robustness"]
    text = CliRunner().invoke(app, asked).stdout
    found = json.loads(CliRunner().invoke(app, [*asked, "--format", "json"]).stdout)["results"][0]["time_robustness"]
    assert "ahead [ms]" in text and "behind [ms]" in text
    low = found["behind"][0]
    assert low is not None and f"{low * 1000:.6g} .." in text
