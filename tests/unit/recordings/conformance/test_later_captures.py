"""Captures of the real programs of kinds that nobody had looked at when the automata were made.

Each lies in `tests/data/captures/later`, with what the clients were told to do, what they printed, the rules of the
relay, and the settings of the model, of which nothing is fitted to the capture.
"""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

import tachk
from tachk.api.monitoring import monitor
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.conform import conform
from tachk.recordings.conformance.conform_file import constants_of, with_log
from tachk.recordings.conformance.event_tables import read_events
from tachk.recordings.conformance.events import EventLog
from tachk.recordings.traces.node_signal import Truth
from tachk.xrce.conformance.packet_events import read_capture
from tachk.xrce.events import decode
from tachk.xrce.wire import SubmessageKind

pytestmark = pytest.mark.drawn

ROOT = Path(__file__).parents[4]
MODEL = ROOT / "models/micro_xrce_dds/recorded.ta"
CAPTURES = ROOT / "tests/data/captures/later"


def truth(name: str) -> Any:
    return json.loads((CAPTURES / f"{name}.json").read_text(encoding="utf-8"))


def settings(name: str, **others: object) -> dict[str, Any]:
    given = dict(word.split("=") for word in truth(name)["settings"].split() if "=" in word)
    return {key: value == "true" if value in ("true", "false") else int(value) for key, value in given.items()} | others


def accepted(name: str, late: int = 5, states: int = 80_000, **others: object) -> bool | None:
    model = tachk.load(MODEL, **settings(name, **others))
    assert model.loaded.recording is not None
    found = conform(
        model.network,
        model.loaded.recording,
        read_capture(CAPTURES / f"{name}.pcap"),
        constants_of(model.loaded),
        TimestampUncertainty.of(Fraction(5), Fraction(late)),
        limits=tachk.Limits(states=states),
        run=False,
        explain=False,
    )
    return found.accepted


def in_noise(name: str, exact: int, late: int, **settings: int) -> bool | None:
    """Of a capture that was made on a busy machine."""
    usual = {"HISTORY": 16, "INPUT_HISTORY": 16, "CLIENT_JITTER": 5, "AGENT_JITTER": 5, "MISSED_ROUNDS": 1}
    model = tachk.load(MODEL, EXACT_BITMAPS=True, **usual | settings)
    assert model.loaded.recording is not None
    found = conform(
        model.network,
        model.loaded.recording,
        read_capture(CAPTURES.parent / f"{name}.pcap"),
        constants_of(model.loaded),
        TimestampUncertainty.of(Fraction(exact), Fraction(late)),
        limits=tachk.Limits(states=60_000),
        run=False,
        explain=False,
    )
    return found.accepted


@pytest.mark.parametrize("name", sorted(path.stem for path in CAPTURES.glob("*.pcap")))
def test_everything_decodes_and_agrees_with_what_the_clients_printed(name: str) -> None:
    for client in truth(name)["clients"]:
        with (CAPTURES / f"{name}.pcap").open("rb") as capture:
            events = list(decode(capture, [client["port"]]))
        assert not any(event.problem for event in events)
        begun = {str(event.fields["piece"])[16:24] for event in events if event.kind is SubmessageKind.FRAGMENT}
        for kind, what in ((SubmessageKind.WRITE_DATA, "written"), (SubmessageKind.DATA, "received")):
            printed = {line["index"].to_bytes(4, "little").hex() for line in client["printed"] if line["event"] == what}
            seen = {str(event.fields["sample"])[:8] for event in events if event.kind is kind}
            assert printed <= (seen or begun)


@pytest.mark.parametrize(
    "name",
    [
        "micro_ros_spin_losses",
        "micro_ros_time_losses",
        "two_publishers_losses",
        "restarted",
        "client_2_0",
        "client_2_0_losses",
    ],
)
def test_is_a_run(name: str) -> None:
    assert accepted(name) is True


def test_agent_overtakes_in_its_queue() -> None:
    """A HEARTBEAT right behind the message that it announces is answered first."""
    assert accepted("micro_ros_spin_losses", states=49_000, BUSY=0) is not True


def test_something_keeps_the_heartbeat_thread_from_running() -> None:
    """A round comes 48 ms later than three periods after the last one that sent a HEARTBEAT."""
    assert accepted("input_window", late=20, AGENT_DELAY=49) is True
    assert accepted("input_window", late=20) is False


def test_radio_is_off() -> None:
    """What came during the sleep is gone, though nothing was lost on the way."""
    assert accepted("dead_time_3s") is True
    assert accepted("dead_time_3s", SLEEPS=False) is False


def test_read_data_stops_the_agent() -> None:
    """The Agent has heard the client, and its heartbeat thread goes on, while a READ_DATA waits for the old reader."""
    assert accepted("dead_time_3s_read", late=20) is True
    assert accepted("dead_time_3s_read", late=20, READER_STOP=0) is False


def log(clients: list[list[dict[str, Any]]], path: Path) -> EventLog:
    """What clients printed, as the log of an application: the first one writes samples, the second one sleeps."""
    what = {"ready": ("TOLD_ALL", "CALLED"), "written": ("CALLED",), "asleep": ("LEFT",), "awake": ("BACK",)}
    rows = [
        (line["time"], client, line["event"] == "written", words)
        for client, printed in enumerate(clients)
        for line in printed
        if (words := what.get(line["event"]))
    ]
    lines = ["time [ns],event,client,what"]
    for time, client, writes, words in sorted(rows):
        lines += [f"{time},written,{client},"] if writes else []
        lines += [f"{time},told,{client},{word}" for word in words]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return read_events(path)


def second_read(name: str, late: int, clients: list[list[dict[str, Any]]], path: Path, **settings: int) -> bool | None:
    usual = {"HISTORY": 16, "INPUT_HISTORY": 16, "CLIENT_JITTER": 5, "AGENT_JITTER": 5, "MISSED_ROUNDS": 1}
    model = tachk.load(MODEL, EXACT_BITMAPS=True, SLEEPS=True, **usual | settings)
    assert model.loaded.recording is not None
    recording = with_log(read_capture(CAPTURES.parent / f"{name}.pcap"), log(clients, path))
    found = conform(
        model.network,
        model.loaded.recording,
        recording,
        constants_of(model.loaded),
        TimestampUncertainty.of(Fraction(10), Fraction(late)),
        limits=tachk.Limits(states=60_000),
        run=False,
        explain=False,
    )
    return found.accepted


def test_a_second_read_data_loses_a_sample(tmp_path: Path) -> None:
    """The sample that the reading thread has in its hand is gone, though nothing was lost on the way."""
    clients = [client["printed"] for client in truth("second_read_undisturbed")["clients"]]
    received = [line["index"] for line in clients[1] if line["event"] == "received"]
    assert received == [n for n in range(1, 21) if n != 18]
    name, path = "later/second_read_undisturbed", tmp_path / "log.csv"
    assert second_read(name, 60, clients, path) is True
    assert second_read(name, 60, clients, path, READER_DELAY=5) is True


def test_the_reading_thread_is_another_one(tmp_path: Path) -> None:
    """It sends its sample behind an answer of the processing thread, which has made room for that sample before.

    In the storm that follows the relay is up to 1.5 s behind.
    """
    printed = json.loads((CAPTURES.parent / "second_read.json").read_text(encoding="utf-8"))
    clients = [printed["publisher"], printed["subscriber"]]
    assert second_read("second_read", 1500, clients, tmp_path / "log.csv", READER_DELAY=5) is True
    assert second_read("second_read", 1500, clients, tmp_path / "log.csv") is False


def test_read_data_of_one_client_stops_the_packets_of_another() -> None:
    """A WRITE_DATA waits, a HEARTBEAT overtakes it and is answered with a NACK for it."""
    assert in_noise("needless_nack", 10, 60) is True
    assert in_noise("needless_nack", 10, 60, READER_STOP=0) is False


def test_a_relay_on_a_busy_machine() -> None:
    """It reads packets late, and records when they came."""
    assert in_noise("losses_and_delays", 5, 5) is True


def test_heartbeats_of_the_old_client() -> None:
    assert accepted("client_2_0", HEARTBEAT_LAW=1, CLIENT_HEARTBEAT=100) is False


def test_an_old_client_on_a_busy_machine() -> None:
    """A HEARTBEAT that is due after 1 ms comes after 14."""
    assert accepted("client_2_0_busy", late=20) is True
    assert accepted("client_2_0_busy", late=20, HEARTBEAT_LAW=1, CLIENT_HEARTBEAT=100) is False


def test_a_write_is_seen_late() -> None:
    """The relay stood still for 100 ms: it saw a READ_DATA 3 ms before the HEARTBEAT that follows 100 ms later."""
    settings = {"HISTORY": 8, "INPUT_HISTORY": 8, "CLIENT_JITTER": 20, "AGENT_JITTER": 20, "SLEEPS": 1}
    assert in_noise("push_sleep", 10, 150, **settings) is True


def test_more_clients_than_the_model_has() -> None:
    with pytest.raises(UsageError, match=r"has 3 clients .*set -D CLIENTS=3"):
        tachk.conform(str(MODEL), str(CAPTURES / "two_publishers_losses.pcap"))


def test_samples_in_pieces() -> None:
    """Three FRAGMENTs for each sample, in both directions, and 10 % losses."""
    assert in_noise("later/fragments_losses", 5, 5, HISTORY=8, INPUT_HISTORY=8, PIECES=2) is True
    assert in_noise("later/fragments_losses", 5, 5, HISTORY=8, INPUT_HISTORY=8, PIECES=1) is False


def test_pieces_are_put_together() -> None:
    """The last piece is the sample; what the subscriber gets is what the publisher has written."""
    events = read_capture(CAPTURES / "fragments_losses.pcap").events
    data = [e.cells for e in events if e.name == "sent" and e.cells["kind"] == "DATA"]
    up, down = ([e["detail"] for e in data if e["link"] == link] for link in (0, 3))
    assert [detail for detail in dict.fromkeys(up) if int(str(detail)) >= 0] == [*range(8)]
    assert [detail for detail in dict.fromkeys(down) if int(str(detail)) >= 0] == [*range(8)]
    assert up[1:4] == [-17, -17, 0]


def test_several_samples_in_one_message() -> None:
    """The application writes three before it runs the session, and 10 % are lost."""
    assert in_noise("later/batches_losses", 5, 5, HISTORY=8, INPUT_HISTORY=8, LARGEST_WORD=2**27 - 1) is True
    written = [e.cells["detail"] for e in read_capture(CAPTURES / "batches_losses.pcap").events if e.name == "written"]
    assert [detail for detail in written if int(str(detail)) >= 0] == [2 * 2**23 + 3 * n for n in range(8)]


@pytest.mark.parametrize("name", ["serial_line", "serial_line_damaged"])
def test_serial_lines(name: str) -> None:
    """In the second one the address of a frame is damaged, which its CRC does not cover."""
    assert in_noise(f"../{name}", 10, 20, HISTORY=8, INPUT_HISTORY=8, CLIENTS=1) is True


def test_a_damaged_frame_is_named(tmp_path: Path) -> None:
    octets = bytearray((CAPTURES.parents[1] / "serial_line.pcap").read_bytes())
    octets[octets.index(b"Numbers__dw")] ^= 1
    damaged = tmp_path / "line.pcap"
    damaged.write_bytes(octets)
    with pytest.raises(UsageError, match="message is damaged, so what its sender has sent is unknown"):
        read_capture(damaged)


@pytest.mark.parametrize(("name", "constant"), [("fragments_losses", "PIECES=2"), ("batches_losses", "LARGEST_WORD=")])
def test_what_the_model_has_no_room_for_is_named(name: str, constant: str) -> None:
    with pytest.raises(UsageError, match=f"set -D {constant}"):
        tachk.conform(str(MODEL), str(CAPTURES / f"{name}.pcap"))


def test_two_writers_write_the_same_bytes() -> None:
    """The second session writes 1, 2, 3, ... again, and its samples arrive before the Agent acknowledges them."""
    for formula in ("G (allToAgent -> F[0, 100 ms] allToClient)", "G FDDSisSent"):
        assert monitor(formula, CAPTURES / "restarted.pcap").truth is Truth.TRUE


@pytest.mark.parametrize(("acknowledged", "expected"), [(2, True), (3, False)])
def test_pieces_stay_in_their_slots(tmp_path: Path, acknowledged: int, expected: bool) -> None:
    """An input stream with two slots has no room for a third piece."""
    rows = [(10, 0, 1), (20, 1, 2), (30, 2, acknowledged)]
    lines = [
        f"{time},arrived,0,1,DATA,{piece},PIECE\n{time},sent,0,0,ACKNACK,{after},0\n" for time, piece, after in rows
    ]
    file = tmp_path / "pieces.csv"
    file.write_text(f"time [ms],event,client,link,kind,number,detail\n{''.join(lines)}", encoding="utf-8")
    model = tachk.load(MODEL, CLIENTS=1, INPUT_HISTORY=2)
    assert tachk.conform(model, file, tolerance="1ms", late="1ms").accepted is expected
