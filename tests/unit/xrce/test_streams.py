"""What captures say of reliable streams."""

from __future__ import annotations

import json
import struct
from io import BytesIO
from pathlib import Path

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.recordings.traces.node_signal import Truth
from tachk.recordings.traces.trace_files import open_trace
from tachk.xrce.signals.recorded import CaptureSignals, StreamHistory, read_recorded
from tachk.xrce.streams import SIGNALS
from tests.unit.xrce.captures import CREATE_CLIENT, RECORDED, needs_recorded, pcap, udp


def write(number: int, stream: int = 0x80) -> bytes:
    return udp(struct.pack("<BBH", 0x81, stream, number) + bytes.fromhex("070108000011001503000000"))


def heartbeat(first: int, last: int) -> bytes:
    return udp(bytes.fromhex("810000000B010500") + struct.pack("<HHB", first, last, 0x80))


def acknack(first: int, bitmap: int = 0) -> bytes:
    return udp(
        bytes.fromhex("810000000A010500") + struct.pack("<H", first) + struct.pack(">HB", bitmap, 0x80), 8888, 40000
    )


def streams(*packets: bytes) -> CaptureSignals:
    return read_recorded(BytesIO(pcap(list(packets))), [8888])


def told(*packets: bytes) -> list[tuple[int, ...]]:
    """The signals of the only stream behind each packet."""
    found = streams(*packets)
    (history,) = found.streams
    return list(zip(*(history.signal(name, len(found.times)).tolist() for name in SIGNALS[:6]), strict=True))


def test_what_is_sent_acknowledged_and_missing():
    assert told(write(0), write(1), acknack(1), write(2), acknack(1, 0b11), write(1), write(2), acknack(3)) == [
        (1, 0, 1, 0, 0, 0),
        (2, 0, 2, 0, 0, 0),
        (2, 1, 1, 0, 0, 0),
        (3, 1, 2, 0, 0, 0),
        (3, 1, 2, 2, 0, 0),
        (3, 1, 2, 2, 0, 1),
        (3, 1, 2, 2, 0, 2),
        (3, 3, 0, 0, 0, 2),
    ]


def test_a_heartbeat_shows_messages_that_the_capture_has_not_seen():
    assert told(write(0), heartbeat(0, 3), heartbeat(4, 3)) == [
        (1, 0, 1, 0, 0, 0),
        (4, 0, 4, 0, 1, 0),
        (4, 0, 4, 0, 2, 0),
    ]


def test_an_old_acknack_does_not_make_messages_outstanding_again():
    assert told(write(0), write(1), acknack(2), acknack(1)) == [
        (1, 0, 1, 0, 0, 0),
        (2, 0, 2, 0, 0, 0),
        (2, 2, 0, 0, 0, 0),
        (2, 1, 0, 0, 0, 0),
    ]


def test_numbers_go_on_where_they_go_round():
    sent = [write(number % 65536) for number in range(0, 70_000, 1000)]
    *_, last = told(*sent, acknack(69_001 % 65536))
    assert last[:3] == (69_001, 69_001, 0)


def test_numbers_begin_again_with_a_session():
    assert told(write(0), write(1), udp(CREATE_CLIENT), write(0))[-2:] == [(0, 0, 0, 0, 0, 0), (1, 0, 1, 0, 0, 0)]


def test_a_message_of_several_submessages_counts_once():
    message = write(0)[28:] + bytes.fromhex("070108000011001503000000")
    assert told(udp(message)) == [(1, 0, 1, 0, 0, 0)]


def columns(path: Path, *ports: int) -> dict[str, list[float]]:
    trace = open_trace(path, ports=ports).read()
    return {name: values.tolist() for name, values in trace.columns.items()}


def test_a_capture_is_a_trace(tmp_path: Path):
    path = tmp_path / "run.pcap"
    path.write_bytes(pcap([udp(CREATE_CLIENT), write(0), write(7, 0x81), acknack(1)]))
    found = columns(path)
    assert found["client_CCCCDDDD.to_agent.outstanding"] == [0, 1, 1, 0]
    assert found["client_CCCCDDDD.to_agent_81.sent"] == [0, 0, 8, 8]
    trace = open_trace(path).read(["client_CCCCDDDD.to_agent.sent"])
    assert (trace.unit, trace.end, trace.ticks_per_unit) == ("s", 3_000_000, 10**9)
    assert list(trace.columns) == ["client_CCCCDDDD.to_agent.sent"]
    report = tachk.monitor("G (client_CCCCDDDD.to_agent.outstanding == 0)", path)
    assert report.truth is Truth.FALSE


def test_clients_without_a_key_and_at_several_ports_have_names(tmp_path: Path):
    path = tmp_path / "run.pcapng"
    path.write_bytes(pcap([write(0)]))
    assert list(columns(path))[:10] == [
        *(f"client_40000.to_agent.{signal}" for signal in SIGNALS),
        "client_40000.asleep",
    ]
    relayed = [CREATE_CLIENT, write(0)[28:]]
    path.write_bytes(pcap([udp(one, source, port) for one in relayed for source, port in ((1, 9001), (2, 8888))]))
    names = {name.split(".")[0] for name in columns(path, 8888, 9001) if name.startswith("client_")}
    assert names == {"client_CCCCDDDD", "client_CCCCDDDD_at_8888", "client_CCCCDDDD_at_9001"}


def test_a_capture_that_ends_inside_a_packet_is_read_up_to_it(tmp_path: Path):
    path = tmp_path / "run.pcap"
    path.write_bytes(pcap([write(0), write(1)])[:-1])
    cut = columns(path)
    path.write_bytes(pcap([write(0)]))
    assert cut == columns(path)


def test_what_is_no_trace(tmp_path: Path):
    path = tmp_path / "run.pcap"
    with pytest.raises(UsageError, match="there is no file"):
        open_trace(path)
    path.write_bytes(b"PK\3\4 and so on")
    with pytest.raises(UsageError, match="neither a pcap nor a pcapng"):
        open_trace(path)
    path.write_bytes(pcap([write(0)]))
    with pytest.raises(UsageError, match="no packet to or from port 2018, 2019"):
        open_trace(path, ports=[2018, 2019])
    with pytest.raises(UsageError, match="no column 'client_40000"):
        open_trace(path).read(["client_40000.to_agent.send"])
    with pytest.raises(UsageError, match="neither a time column nor a unit"):
        open_trace(path, time="t")
    with pytest.raises(UsageError, match="captures of packets only"):
        open_trace(tmp_path / "run.csv", ports=[1])


def ups(name: str, port: int) -> tuple[StreamHistory, dict[str, int]]:
    with (RECORDED / f"{name}.pcap").open("rb") as stream:
        found = read_recorded(stream, [port])
    (history,) = [one for one in found.streams if one.to_agent and one.key == "AAAABBBB"]
    return history, dict(zip(SIGNALS, history.changes.values[-1].tolist(), strict=True))


@needs_recorded
@pytest.mark.parametrize("truth", sorted(RECORDED.glob("[ac]*.truth.json")), ids=lambda path: path.name.split(".")[0])
def test_recorded_publishers_have_sent_what_their_application_wrote(truth: Path):
    told = json.loads(truth.read_text(encoding="utf-8"))
    written = len(next(iter(told["publishers"].values()))["sent"]) if "publishers" in told else len(told["sent"])
    name = truth.name.split(".")[0]
    history, last = ups(name, 8888 if name.startswith("a4") else 9001)
    assert last["sent"] == last["acknowledged"] == written + 1  # and the one that creates the objects
    assert last["outstanding"] == 0
    assert history.changes.values[:, SIGNALS.index("outstanding")].max() <= 16


@needs_recorded
def test_an_old_acknack_ends_a_recorded_stream():
    """The client takes an old ACKNACK for a new one and forgets a message that the Agent lacks for ever."""
    _, last = ups("f3a_stale_acknack_tail_loss", 8888)
    assert (last["outstanding"], last["missing"]) == (1, 1)
    assert last["heartbeats"] > 30
