"""Serial lines: frames, their CRC, and what is between them."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path

import pytest
from click.testing import CliRunner
from hypothesis import given
from hypothesis import strategies as st

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.cli.main import app
from tachk.recordings.traces.trace_files import open_trace
from tachk.xrce.events import SubmessageEvent, decode_serial
from tachk.xrce.packets import CaptureError
from tachk.xrce.serial_framing import FrameReader, SerialFrame, crc16
from tachk.xrce.wire import SubmessageKind
from tests.unit.xrce.captures import ACKNACK, HEARTBEAT, WRITE_DATA, framed, pcap

PING = bytes.fromhex("8000000002010800000AFFFD02000000")


def decoded(octets: bytes) -> list[SubmessageEvent]:
    return list(decode_serial(BytesIO(octets)))


def told(octets: bytes) -> list[tuple[int, str]]:
    return [(event.packet, event.problem or event.kind.name) for event in decoded(octets)]


def test_a_frame_that_was_seen_on_a_real_line():
    assert crc16(PING) == 0x12CF
    assert framed(0, 1, PING) == b"\x7e\x00\x01\x10\x00" + PING + b"\xcf\x12"


def test_the_check_value_of_the_crc():
    assert crc16(b"123456789") == 0xBB3D


@given(st.lists(st.binary(max_size=30), max_size=5), st.integers(1, 7))
def test_frames_come_back_whatever_pieces_they_come_in(messages: list[bytes], size: int):
    line = b"".join(framed(1, 0, message) for message in messages)
    reader = FrameReader()
    found = [frame for at in range(0, len(line), size) for frame in reader.push(line[at : at + size])]
    assert found == [SerialFrame(1, 0, message) for message in messages]
    assert reader.close() == []


def test_who_says_what():
    to, from_ = decoded(framed(1, 0, HEARTBEAT) + framed(0, 1, ACKNACK))
    assert (to.packet, to.time, to.kind, to.to_agent) == (1, 0, SubmessageKind.HEARTBEAT, True)
    assert (str(to.client), str(to.agent)) == ("serial:1", "serial:0")
    assert (from_.packet, from_.kind, from_.to_agent, str(from_.client)) == (
        2,
        SubmessageKind.ACKNACK,
        False,
        "serial:1",
    )


def test_what_a_receiver_drops_is_malformed():
    good = framed(1, 0, HEARTBEAT)
    flipped = bytearray(good)
    flipped[-3] ^= 1
    assert told(bytes(flipped) + good) == [
        (1, f"the CRC of a frame is {crc16(HEARTBEAT):#06x}, but should be {crc16(flipped[5:-2]):#06x}"),
        (2, "HEARTBEAT"),
    ]
    assert told(good[:9] + good) == [(1, "of a frame with 13 bytes only 4 came"), (2, "HEARTBEAT")]
    assert told(b"\x7e\x01" + good) == [(1, "a frame ends after 1 bytes, inside its header"), (2, "HEARTBEAT")]
    assert told(b"boot\r\n" + good + b"?") == [
        (1, "6 bytes belong to no frame"),
        (2, "HEARTBEAT"),
        (3, "1 bytes belong to no frame"),
    ]
    event, _ = decoded(b"boot" + good)
    assert (event.client, event.agent) == (None, None)


def test_captures_of_serial_lines_have_times():
    line = framed(1, 0, HEARTBEAT) + framed(1, 0, WRITE_DATA)
    events = decoded(pcap([line[:10], line[10:25], line[25:]], link=147))
    assert [(event.packet, event.kind) for event in events] == [
        (2, SubmessageKind.HEARTBEAT),
        (3, SubmessageKind.WRITE_DATA),
    ]
    assert events[1].time - events[0].time == 1_000_000
    cut = pcap([framed(1, 0, HEARTBEAT), line], link=147)[:-1]
    assert told(cut) == [(1, "HEARTBEAT"), (2, "the file ends inside packet 2")]


def test_an_empty_log_is_none():
    with pytest.raises(CaptureError, match="empty"):
        decoded(b"")


@given(st.binary(max_size=200))
def test_any_bytes_become_events(octets: bytes):
    for event in decoded(b"\x7e" + octets):
        assert event.kind is not None or event.problem


def test_the_command(tmp_path: Path):
    log = tmp_path / "line.bin"
    log.write_bytes(framed(1, 0, HEARTBEAT))
    result = CliRunner().invoke(app, ["xrce", "decode", "--serial", str(log)])
    assert result.exit_code == 0
    assert "serial:1 -> serial:0" in result.output
    refused = CliRunner().invoke(app, ["xrce", "decode", str(log)])
    assert refused.exit_code == 2
    assert "--serial" in refused.stderr


def test_monitor_sees_that_a_capture_is_of_a_serial_line():
    """The bytes of a real client and Agent, once with some that were changed on the line."""
    root = Path(__file__).parents[3]
    for name in ("serial_line", "serial_line_damaged"):
        recording = open_trace(root / f"tests/data/{name}.pcap")
        trace = recording.read(["client_AAAABBBB.to_agent.sent", "client_AAAABBBB.to_agent.acknowledged"])
        assert [max(values) for values in trace.columns.values()] == [22, 22]
        assert trace.packet(trace.end) is not None


def test_other_captures_without_an_agent_are_still_rejected(tmp_path: Path):
    capture = tmp_path / "other.pcap"
    capture.write_bytes(pcap([b"no frame at all"], link=147))
    with pytest.raises(UsageError, match="no packet to or from port 8888"):
        open_trace(capture)
