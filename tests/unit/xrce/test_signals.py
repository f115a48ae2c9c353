"""Signals of captures: what relays did to messages, and signals as files."""

from __future__ import annotations

import csv
from collections import Counter
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.cli.main import app
from tachk.recordings.traces.trace import Trace
from tachk.recordings.traces.trace_files import open_trace
from tachk.xrce.streams import StreamState
from tachk.xrce.traces.signal_files import table_of, write_signals
from tachk.xrce.traces.trace_packets import HOP_SIGNALS, hop_changes
from tachk.xrce.transmissions import read_transmissions
from tests.unit.xrce.captures import RECORDED, needs_recorded, pcap, tcp, timed, udp
from tests.unit.xrce.test_properties_on_packets import Talk, acknack, created, data, heartbeat, write

KEYS = {"pub": "AAAABBBB", "sub": "CCCCDDDD", "pub2": "11112222"}


def last(path: Path) -> dict[str, float]:
    return {name: float(values[-1]) for name, values in open_trace(path).read().columns.items()}


@needs_recorded
@pytest.mark.parametrize(
    "name", ["f1_reorder_dup_seed1", "f2_duplicate_everything", "b_loss20_burst_seed11", "f5_reorder_loss10_seed28"]
)
def test_losses_and_copies_are_those_in_the_log_of_the_relay(name: str):
    expected: Counter[tuple[str, bool, str]] = Counter()
    with (RECORDED / f"{name}.proxy.csv").open(newline="") as log:
        rows = list(csv.DictReader(log))
    left = Counter(row["rx_id"] for row in rows if row["event"] == "tx")
    for row in rows:
        if row["event"] == "rx":
            direction = KEYS[row["link"]], row["dir"] == "c2a"
            expected[*direction, "lost"] += left[row["event_id"]] == 0
            expected[*direction, "copies"] += max(left[row["event_id"]] - 1, 0)
    found = last(RECORDED / f"{name}.pcap")
    for (key, to_agent, signal), count in expected.items():
        assert found[f"client_{key}.{'to' if to_agent else 'from'}_agent.{signal}"] == count


def test_a_message_that_comes_after_a_later_one_was_overtaken(tmp_path: Path):
    talk = Talk().up(0, created()).up(10, write(0, 1), lost=True).up(11, write(1, 2))
    talk.packets.append((14, udp(write(0, 1), 9101, 8888)))
    found = open_trace(talk.capture(tmp_path)).read()
    assert found.columns["client_CCCCDDDD.to_agent.overtaken"].tolist() == [0, 0, 0, 0, 0, 1]
    assert found.columns["client_CCCCDDDD.to_agent.delay_ms"].tolist() == [0, 1, 1, 1, 1, 4]
    assert found.columns["client_CCCCDDDD.to_agent.lost"].tolist() == [0] * 6


def test_a_lost_message_counts_when_it_was_sent(tmp_path: Path):
    found = open_trace(Talk().up(0, created()).up(10, write(0, 1), lost=True).capture(tmp_path)).read()
    assert found.columns["client_CCCCDDDD.to_agent.lost"].tolist() == [0, 0, 1]


def test_ports_are_found_where_sessions_begin(tmp_path: Path):
    path = tmp_path / "run.pcap"
    path.write_bytes(
        timed([(0, udp(write(0, 1), 1, 7000)), (1, udp(created(), 1, 7000)), (2, udp(write(0, 1), 1, 7000))])
    )
    assert open_trace(path).read().rows == 2  # what comes before the session may be of anybody
    assert open_trace(path, ports=[7000]).read().rows == 3
    path.write_bytes(pcap([tcp(len(created()).to_bytes(2, "little") + created(), 5, destination=7001)]))
    assert open_trace(path).read().rows == 1
    path.write_bytes(timed([(0, udp(heartbeat(0, 0), 1, 7000))]))
    with pytest.raises(UsageError, match="no packet to or from port 8888"):
        open_trace(path)


@pytest.fixture
def trace(tmp_path: Path) -> Trace:
    talk = Talk().up(0, created()).down(3000, data(0, 1)).up(4000, acknack(1))
    return open_trace(talk.capture(tmp_path)).read()


def test_csv_can_be_read_again(trace: Trace, tmp_path: Path):
    path = tmp_path / "signals.csv"
    write_signals(trace, path)
    again = open_trace(path).read()
    assert (again.unit, list(again.columns)) == ("s", list(trace.columns))
    assert np.array_equal(again.times * (trace.ticks_per_unit // again.ticks_per_unit), trace.times)
    for name, values in trace.columns.items():
        assert np.array_equal(again.columns[name], values), name
    assert tachk.monitor("G (sleep -> !arrive)", path).truth is tachk.Truth.FALSE


def test_a_data_frame_has_a_row_for_each_instant(trace: Trace):
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame(table_of(trace))
    assert frame["arrive"].dtype == bool
    assert frame["time"].iloc[-1].total_seconds() == 4.001
    assert tachk.monitor("G (sleep -> !arrive)", frame).truth is tachk.Truth.FALSE


def test_parquet_can_be_read_again(trace: Trace, tmp_path: Path):
    pytest.importorskip("pyarrow")
    path = tmp_path / "signals.parquet"
    write_signals(trace, path)
    report = tachk.monitor("G (sleep -> F[0, 1 s] !arrive)", path)
    assert report.truth is tachk.monitor("G (sleep -> F[0, 1 s] !arrive)", trace).truth


def test_the_command_writes_signals(tmp_path: Path):
    capture = Talk().up(0, created()).up(1, write(0, 1)).capture(tmp_path)
    out = tmp_path / "signals.csv"
    assert CliRunner().invoke(app, ["xrce", "decode", str(capture), "--signals", str(out)]).exit_code == 0
    assert out.read_text(encoding="utf-8").startswith("time [s],client_CCCCDDDD.to_agent.lost,")
    for more in (["--signals", "x.json"], ["--signals", str(out), "--serial"], ["--signals", str(out), "-o", "lines"]):
        assert CliRunner().invoke(app, ["xrce", "decode", str(capture), *more]).exit_code == 2


def test_a_stream_without_acknacks_is_followed_at_once():
    state = StreamState()
    for number in range(100_000):
        state.message(number % 65536)
    assert (state.sent, state.lacks(0, state.sent)) == (100_000, False)
    assert state.values()[2] == 32768  # more cannot be outstanding


def test_a_capture_that_begins_late_begins_where_it_does(tmp_path: Path):
    path = tmp_path / "late.pcap"
    path.write_bytes(timed([(0, udp(write(40_000, 1))), (1, udp(acknack(40_001), 8888, 40000))]))
    found = last(path)
    assert (found["client_40000.to_agent.sent"], found["client_40000.to_agent.outstanding"]) == (40_001, 0)


def test_repetitions_are_messages_that_were_seen_before():
    state = StreamState()
    for number in (0, 2, 1, 1):
        state.message(number)
    assert state.repetitions == 1


def test_an_empty_piece_changes_nothing():
    from tachk.xrce.capture_decoder import CaptureDecoder
    from tachk.xrce.signals.following import SignalTracker

    tracker = SignalTracker()
    for found in CaptureDecoder(BytesIO(pcap([udp(b"", 1, 2)])), (8888,)).pieces():
        tracker.push(found)
    assert len(tracker.take().times) == 0


def test_a_packet_without_a_row_counts_in_the_next_row(tmp_path: Path):
    """Packets to a port have no row before a session is created there."""
    talk = Talk().up(0, created()).up(10, write(0, 1), lost=True).up(11, write(1, 2)).up(20, write(2, 3), lost=True)
    capture = read_transmissions(talk.capture(tmp_path))
    first, second = (one.packet for one in capture.transmissions if one.is_lost)
    packets = np.array([packet for packet in range(1, second) if packet != first])
    (changes,) = (found for (_, to_agent), found in hop_changes(capture, packets).items() if to_agent)
    expected = [int(packet > first) for packet in packets]
    assert changes.spread(HOP_SIGNALS.index("lost"), len(packets)).tolist() == expected
