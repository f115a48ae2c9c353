"""A capture that is judged while it is made."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner

import tachk
from tachk.base import awaited_pipe
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.cli.main import app
from tachk.recordings.monitors.online import Monitor
from tachk.recordings.traces.trace_csv import Rows
from tachk.recordings.traces.trace_files import open_trace
from tachk.xrce.capture_decoder import CaptureDecoder
from tachk.xrce.packets import read_packets
from tachk.xrce.serial_framing import FrameReader
from tachk.xrce.serial_line import SerialDecoder
from tachk.xrce.signals.following import VANISHED, SignalTracker
from tachk.xrce.traces.live import LivePackets
from tests.unit.xrce.captures import RECORDED, needs_recorded
from tests.unit.xrce.test_properties_on_packets import BOTH_SIDES, QUERIES, Talk, acknack, created, data, write

SECOND = 10**9
LINES = Path(__file__).parents[2] / "data"


class Line:
    """A pipe and a clock: each part of a capture comes at its time, in seconds, and silence lets time pass."""

    def __init__(self, parts: list[tuple[float, bytes]], end: float) -> None:
        self._parts = parts
        self._end = end
        self._now = 0.0

    def clock(self) -> int:
        return int(self._now * SECOND)

    def read1(self, size: int, /) -> bytes | None:
        if self._parts and self._parts[0][0] <= self._now + 0.2:
            self._now, octets = self._parts.pop(0)
            return octets
        if self._now >= self._end:
            return b""
        self._now += 0.2
        return None

    def close(self) -> None:
        self._parts = []


def live(line: Line, ports: tuple[int, ...] = BOTH_SIDES) -> LivePackets:
    return LivePackets("-", line, ports, line.clock)


def followed(line: Line, formulas: list[str]) -> Iterator[tuple[float, Monitor]]:
    """What the monitor says after each piece, and when."""
    packets = live(line)
    monitor = Monitor(formulas, unit="s", packets=packets.packets)
    for rows in packets.blocks(monitor.columns, monitor.decimals):
        monitor.push(rows.times, rows.columns, rows.decimals)
        yield line.clock() / SECOND, monitor


def test_silence_raises_an_alarm(tmp_path: Path):
    capture = Talk().up(0, created()).down(1000, data(0, 1)).capture(tmp_path).read_bytes()
    formulas = ["G (behind -> F[0, 20 s] caughtUp)"]
    verdicts = [(time, monitor.truth) for time, monitor in followed(Line([(1.0, capture)], 60.0), formulas)]
    alarm = next(time for time, truth in verdicts if truth is tachk.Truth.FALSE)
    assert 22.0 <= alarm <= 22.5  # the message at 1 s, 20 s to wait, 1 s that a packet may be late
    *_, (_, last) = followed(Line([(1.0, capture)], 60.0), formulas)
    assert last["p1"].story is not None
    assert last["p1"].story.trace.packet(last["p1"].story.verdicts[0].finding.cell // 2) == 3


def test_an_answer_in_time_prevents_the_alarm(tmp_path: Path):
    talk = Talk().up(0, created()).down(1000, data(0, 1))
    first = talk.capture(tmp_path).read_bytes()
    second = talk.up(18_000, acknack(1)).capture(tmp_path).read_bytes()[len(first) :]
    line = Line([(1.0, first), (18.5, second)], 60.0)
    assert all(
        monitor.truth is not tachk.Truth.FALSE for _, monitor in followed(line, ["G (behind -> F[0, 20 s] caughtUp)"])
    )


def test_a_client_falls_asleep_without_a_packet(tmp_path: Path):
    capture = Talk().up(0, created()).capture(tmp_path).read_bytes()
    times = [time for time, monitor in followed(Line([(0.0, capture)], 9.0), ["G !sleep"]) if monitor.decided]
    assert 3.0 <= times[0] <= 3.5


def test_a_late_packet_does_not_go_back(tmp_path: Path):
    talk = Talk().up(0, created())
    first = talk.capture(tmp_path).read_bytes()
    second = talk.up(500, write(0, 1)).capture(tmp_path).read_bytes()[len(first) :]
    packets = live(Line([(0.0, first), (5.0, second)], 6.0))
    times = np.concatenate([rows.times for rows in packets.blocks(("sleep",), 9)])
    assert (np.diff(times) >= 0).all()


def test_clients_that_have_gone_are_forgotten_and_nothing_else_changes(tmp_path: Path):
    talk = Talk().up(0, created("00000001")).up(1, write(0, 7)).down(2, acknack(1))
    deleted = bytes.fromhex("8000000003010400" + "0002FFFE")
    for number in range(2, 60):
        time = 5000.0 * number
        talk.up(time, created(f"{number:08X}"), client=number).up(time + 10, write(0, number), client=number)
        talk.down(time + 20, acknack(1), client=number)
        if number % 10:
            talk.up(time + 30, deleted, client=number)
    path = talk.capture(tmp_path)
    parts = path.read_bytes()
    cuts = range(0, len(parts), 3000)
    clock = [(number / 100, parts[at : at + 3000]) for number, at in enumerate(cuts)]
    ports = tuple({8888, *(9000 + number for number in range(1, 60))})
    packets = live(Line(clock, 0.0), ports)
    names = ["sleep", "arrive", "allToAgent", "allToClient", "behind", "lost", "unheard"]
    rows = list(packets.blocks(names, 9))
    whole = open_trace(path, ports=ports).read()
    for name in names:
        assert np.array_equal(np.concatenate([one.columns[name] for one in rows]), whole.columns[name]), name
    kept = {side.owner.key for side in packets._tracker.sides}
    assert "00000001" in kept and "0000000A" in kept and "00000003" not in kept
    assert len(packets._tracker._by_endpoints) == len(packets._tracker.sides) < 2 * 59
    assert len(packets._tracker._clients) == len(kept)


@needs_recorded
@pytest.mark.parametrize("name", ["h3_sub_sleeps_open_request", "f3a_stale_acknack_tail_loss"])
def test_columns_are_those_of_the_whole_capture(name: str):
    path = RECORDED / f"{name}.pcap"
    whole = open_trace(path, ports=BOTH_SIDES).read()
    octets = path.read_bytes()
    line = Line([(0.0, octets[at : at + 1000]) for at in range(0, len(octets), 1000)], 0.0)
    names = ["client_CCCCDDDD_at_9002.asleep", "client_AAAABBBB_at_8888.to_agent.outstanding"]
    names += [
        column
        for column in whole.columns
        if not column.startswith(("client_", "unconfirmed", "pending", "acknowledged"))
    ]
    pieces = list(live(line).blocks(names, 9))
    assert np.array_equal(np.concatenate([piece.times for piece in pieces]), whole.times)
    for column in names:
        found = np.concatenate([piece.columns[column] for piece in pieces])
        assert np.array_equal(found, whole.columns[column]), column


def first(name: str, tmp_path: Path) -> Rows:
    capture = Talk().up(0, created()).capture(tmp_path).read_bytes()
    return next(live(Line([(0.0, capture)], 1.0)).blocks([name], 9))


@pytest.mark.parametrize(
    ("name", "problem"),
    [
        ("unconfirmed.Open", "known only when the capture is over"),
        ("pending", "known only when the capture is over"),
        ("beHind", "no column 'beHind'"),
        ("client_CCCCDDDD.asleep", "seen at several ports"),
    ],
)
def test_what_is_no_column_of_a_live_capture(name: str, problem: str, tmp_path: Path):
    with pytest.raises(UsageError, match=problem):
        list(live(Line([(0.0, Talk().up(0, created()).capture(tmp_path).read_bytes())], 9.0)).blocks([name], 9))


def test_times_are_not_rounded():
    with pytest.raises(UsageError, match="nine decimals"):
        list(live(Line([], 0.0)).blocks(["behind"], 6))


def test_what_is_no_capture_is_rejected():
    with pytest.raises(UsageError, match="neither a pcap nor"):
        list(live(Line([(0.0, b"time,x\n0,1\n")], 0.0)).blocks(["behind"], 9))


def test_a_growing_file_has_nothing_for_a_while(tmp_path: Path):
    path = tmp_path / "growing.pcap"
    path.write_bytes(b"ab")
    waited: list[float] = []
    stream = awaited_pipe.GrowingFile(path, waited.append)
    assert (stream.read1(10), stream.read1(10), waited) == (b"ab", None, [awaited_pipe.PATIENCE])
    with path.open("ab") as more:
        more.write(b"c")
    assert stream.read1(10) == b"c"
    stream.close()


def test_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    path = Talk().up(0, created()).down(10, data(0, 1)).up(30_000, acknack(1)).capture(tmp_path)
    with path.open("rb") as stream:
        monkeypatch.setattr(sys, "stdin", SimpleNamespace(fileno=stream.fileno, buffer=BytesIO()))
        monkeypatch.setattr(awaited_pipe.select, "select", lambda readable, *_: (readable, [], []))
        from tachk.cli import monitor_online as action

        opened = action.open_live("-", BOTH_SIDES)
        monitor = Monitor(["G (behind -> F[0, 20 s] caughtUp)"], unit="s")
        for rows in opened.blocks(monitor.columns, monitor.decimals):
            monitor.push(rows.times, rows.columns, rows.decimals)
        assert monitor.truth is tachk.Truth.FALSE
    assert "there is no file" in CliRunner().invoke(app, ["monitor", "G behind", "none.pcap", "--live"]).stderr


def test_formulas_that_need_hindsight_are_left_out(capsys: pytest.CaptureFixture[str]):
    from tachk.cli.monitor_online import without_hindsight
    from tachk.recordings.monitors.formulas import read_formulas

    formulas = read_formulas(QUERIES)
    names = [one.name for one in without_hindsight(formulas, False)]
    assert "FARS" in names
    assert "FARS_each" not in names
    assert "FARS_each" in capsys.readouterr().err
    assert without_hindsight(formulas, True) == formulas


def test_clients_that_vanish_are_forgotten_after_an_hour(tmp_path: Path):
    """None of them closes its session; each leaves a message that is never acknowledged."""
    talk, minutes = Talk(), 99
    for number in range(1, minutes):
        time = 200_000.0 * number
        talk.up(time, created(f"{number:08X}"), client=number).up(time + 10, write(0, number), client=number)
    octets = talk.capture(tmp_path).read_bytes()
    parts = [(number / 100, octets[at : at + 300]) for number, at in enumerate(range(0, len(octets), 300))]
    packets = live(Line(parts, 0.0), (8888, *range(9001, 9000 + minutes)))
    kept = []
    for _ in packets.blocks(["sleep", "allToAgent"], 9):
        tracker = packets._tracker
        assert len(tracker._by_endpoints) == len(tracker.sides)
        kept.append(len(tracker.sides))
    assert 2 * 17 < max(kept) < 2 * 23  # two sides of each, and 18 in an hour
    assert len(packets._tracker._clients) == kept[-1] / 2


def test_who_has_vanished_owes_nothing_any_more(tmp_path: Path):
    talk = Talk().up(0, created("00000001")).up(1, write(0, 7))
    talk.up(10, created("00000002"), client=2).up(20, write(0, 8), client=2).down(30, acknack(1), client=2)
    for minute in range(1, 90):
        time = 60_000.0 * minute
        talk.up(time, write(minute, minute), client=2).down(time + 5, acknack(minute + 1), client=2)
    octets = talk.capture(tmp_path).read_bytes()
    parts = [(number / 100, octets[at : at + 500]) for number, at in enumerate(range(0, len(octets), 500))]
    rows = list(live(Line(parts, 0.0), (8888, 9001, 9002)).blocks(["allToAgent"], 9))
    times = np.concatenate([one.times for one in rows]) / SECOND
    complete = np.concatenate([one.columns["allToAgent"] for one in rows])
    assert (np.diff(times) >= 0).all()
    assert not complete[(times > 1) & (times < 3600)].any()
    assert complete[times > 3760].any()


def test_nobody_waits_for_a_reader_that_has_vanished(tmp_path: Path):
    tracker, reader = SignalTracker(), Talk().up(0, created("00000001")).capture(tmp_path)
    with reader.open("rb") as stream:
        for found in CaptureDecoder(stream, (8888,)).pieces():
            tracker.push(found)
    exchange, owner = tracker._exchange, tracker.sides[0].owner
    exchange.new_writer(("other", 1), "numbers")
    exchange.new_reader((owner, 1), "numbers")
    exchange.written(("other", 1), 7)
    assert not exchange.standing().complete
    tracker.wait(tracker.latest + VANISHED + 1)
    tracker.forget_gone()
    assert exchange.standing().complete
    assert tracker.sides == []


def serial_parts(name: str) -> list[tuple[float, bytes]]:
    """The bytes of a recorded serial line, with the seconds since the first of them."""
    with (LINES / f"{name}.pcap").open("rb") as stream:
        pieces = [
            (int(time), found.octets[start : start + size].tobytes())
            for found in read_packets(stream)
            for time, start, size in zip(found.times, found.starts, found.sizes, strict=True)
        ]
    return [((time - pieces[0][0]) / SECOND, octets) for time, octets in pieces]


@pytest.mark.parametrize("name", ["serial_line", "serial_line_damaged"])
def test_a_serial_line_while_it_is_read(name: str):
    """Its bytes, as they come, give what the capture of the same line gives when it is over."""
    whole = open_trace(LINES / f"{name}.pcap").read()
    names = [
        column
        for column in whole.columns
        if not column.startswith(("client_", "unconfirmed", "pending", "acknowledged"))
    ]
    parts = serial_parts(name)
    packets = LivePackets("-", line := Line(list(parts), parts[-1][0] + 0.1), (), line.clock)
    pieces = list(packets.blocks(names, 9))
    times = np.concatenate([piece.times for piece in pieces]) / SECOND
    for column in names:
        found = np.concatenate([piece.columns[column] for piece in pieces])
        changes, wanted = np.flatnonzero(np.diff(found)) + 1, whole.columns[column]
        expected = np.flatnonzero(np.diff(wanted)) + 1
        assert np.array_equal(found[changes], wanted[expected]), column
        assert np.allclose(times[changes], np.asarray(whole.times)[expected] / SECOND, atol=0.25), column


def test_a_capture_of_a_serial_line_while_it_is_made():
    path = LINES / "serial_line.pcap"
    whole, octets = open_trace(path).read(), path.read_bytes()
    line = Line([(0.0, octets[at : at + 500]) for at in range(0, len(octets), 500)], 0.0)
    pieces = list(LivePackets("-", line, (), line.clock).blocks(["allToAgent", "arrive"], 9))
    for column in ("allToAgent", "arrive"):
        assert np.array_equal(np.concatenate([piece.columns[column] for piece in pieces]), whole.columns[column])


def test_a_serial_line_that_falls_silent_raises_an_alarm():
    """The line is cut behind a WRITE_DATA, before the ACKNACK of the Agent."""
    parts = serial_parts("serial_line")
    reader = FrameReader()
    cut = next(n for n, (_, octets) in enumerate(parts) if any(f.message[4:5] == b"\x07" for f in reader.push(octets)))
    line = Line(parts[: cut + 1], 60.0)
    packets = LivePackets("-", line, (), line.clock)
    formula = "G (client_AAAABBBB.to_agent.outstanding > 0 -> F[0, 20 s] client_AAAABBBB.to_agent.outstanding == 0)"
    monitor = Monitor([formula], unit="s", packets=packets.packets)
    alarm = 0.0
    for rows in packets.blocks(monitor.columns, monitor.decimals):
        monitor.push(rows.times, rows.columns, rows.decimals)
        alarm = alarm or (line.clock() / SECOND if monitor.truth is tachk.Truth.FALSE else 0.0)
    assert 20.0 <= alarm - parts[cut][0] <= 22.0


def test_memory_of_a_serial_line_does_not_grow():
    """Noise, and frames that never end, are not kept."""
    octets = b"".join(octets for _, octets in serial_parts("serial_line"))
    noise = bytes(range(1, 125)) * 600 + b"\x7e\x01\x00\xff\xff" + b"\x11" * 300
    line = Line([(n / 10, part) for n, part in enumerate([octets, *([noise] * 40)])], 5.0)
    packets = LivePackets("-", line, (), line.clock)
    for _ in packets.blocks(["allToAgent"], 9):
        assert isinstance(packets._decoder, SerialDecoder)
        assert len(packets._decoder._frames._plain or b"") < 1 << 17
