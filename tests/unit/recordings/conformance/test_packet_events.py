"""Captures as recordings: what was sent, what arrived of it, in the words of the automata."""

from __future__ import annotations

import struct
from fractions import Fraction
from pathlib import Path

import pytest

import tachk
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.conform import conform
from tachk.recordings.conformance.conform_file import constants_of
from tachk.recordings.conformance.edits import Edit, edited
from tachk.xrce.conformance.packet_events import read_capture
from tests.unit.xrce.captures import ACKNACK, CREATE_CLIENT, HEARTBEAT, WRITE_DATA, pcap, udp

MODELS = Path(__file__).parents[4] / "models/micro_xrce_dds"
CAPTURES = Path(__file__).parents[4] / "../shared/captures"


@pytest.fixture
def capture(request: pytest.FixtureRequest) -> Path:
    path = CAPTURES / f"{request.param}.pcap"
    if not path.exists():
        pytest.skip("the captures are not here")
    return path


@pytest.mark.parametrize("capture", ["c1_lose_write5_paced150"], indirect=True)
def test_lost_message_is_sent_and_does_not_arrive(capture: Path) -> None:
    events = read_capture(capture).events
    fifth = [e.name for e in events if e.cells.get("kind") == "DATA" and (e.cells["link"], e.cells["number"]) == (0, 5)]
    assert fifth == ["sent", "sent", "arrived"]
    assert [e.cells["detail"] for e in events if e.name == "written" and e.cells["client"] == 0] == [-4, *range(10)]
    assert [e.cells["detail"] for e in events if e.name == "written" and e.cells["client"] == 1] == [-4, -32]
    assert all(events[e.after].name == "sent" for e in events if e.name == "arrived" and e.after is not None)
    assert [e.time for e in events] == sorted(e.time for e in events)


@pytest.mark.parametrize("capture", ["a4_clean_direct_noproxy"], indirect=True)
def test_nobody_saw_what_arrived(capture: Path) -> None:
    arrived = [e for e in read_capture(capture).events if e.name == "arrived"]
    assert arrived
    assert all(event.optional for event in arrived)


def test_the_delete_of_a_client_ends_what_it_sends() -> None:
    """What the Agent sends, and what comes to the client, ends there, too, but by the hand of somebody else."""
    closings = read_capture(MODELS.parents[1] / "tests/data/captures/later/client_2_0.pcap").closings
    own = {(closing.column, closing.value) for closing in closings if closing.by_sender}
    assert own
    assert own == {(closing.column, closing.value) for closing in closings if closing.column == "link"} - {
        ("link", 1),
        ("link", 3),
    }


def test_what_comes_to_a_participant_passes_where_it_sends() -> None:
    """In the order in which that was recorded; the two sides of a relay are two places."""
    events = read_capture(MODELS.parents[1] / "tests/data/captures/later/client_2_0.pcap").events
    places = {(e.name, e.cells["link"]): e.passes for e in events if e.name in ("sent", "arrived")}
    assert len(places) == 8 and len(set(places.values())) == 4
    for (name, link), place in places.items():
        assert {e.passes for e in events if (e.name, e.cells.get("link")) == (name, link)} == {place}
        if name == "arrived":
            assert place == places["sent", int(link) ^ 1]


@pytest.mark.parametrize("capture", ["f7_late_dup_create_client_sub"], indirect=True)
def test_second_create_client(capture: Path) -> None:
    created = [e.cells for e in read_capture(capture).events if e.name == "created_again"]
    assert created == [{"client": 1}]


@pytest.mark.parametrize("capture", ["b_loss20_burst_seed14"], indirect=True)
@pytest.mark.parametrize(("packet", "expected"), [(None, True), (158, False)])
def test_last_message_of_the_last_repetition(capture: Path, packet: int | None, expected: bool) -> None:
    """It leaves the client 34 µs before the DELETE that ends the recording of it."""
    settings = {"CLIENT_JITTER": 5, "AGENT_JITTER": 5, "EXACT_BITMAPS": True, "MISSED_ROUNDS": 1}
    model, recording = tachk.load(MODELS / "recorded.ta", **settings), read_capture(capture)
    assert model.loaded.recording is not None
    place = f"packet {packet}"
    for number in reversed(range(len(recording.events))):
        if recording.events[number].place == place:
            recording = edited(recording, Edit(number, "lost"), Fraction(1))
    found = conform(
        model.network,
        model.loaded.recording,
        recording,
        constants_of(model.loaded),
        TimestampUncertainty.of(Fraction(5), Fraction(5)),
        limits=tachk.Limits(states=60_000),
        run=False,
        explain=False,
    )
    assert found.accepted is expected


@pytest.mark.parametrize(
    ("capture", "guarded", "expected"),
    [
        ("c1_lose_write5_paced150", False, True),
        ("f4_stale_acknack_no_loss", True, True),  # nothing is lost: both laws fit
        ("f5_reorder_loss10_seed28", False, True),
        ("f5_reorder_loss10_seed28", True, False),
    ],
    indirect=["capture"],
)
def test_real_captures(capture: Path, guarded: bool, expected: bool) -> None:
    """All automata together, set-up included; the client breaks the rule to ignore an older ACKNACK."""
    settings = {"CLIENT_JITTER": 5, "AGENT_JITTER": 5, "EXACT_BITMAPS": True, "GUARDED": guarded}
    model = tachk.load(MODELS / "recorded.ta", **settings)
    assert model.loaded.recording is not None
    found = conform(
        model.network,
        model.loaded.recording,
        read_capture(capture),
        constants_of(model.loaded),
        TimestampUncertainty.of(Fraction(5), Fraction(10)),
        limits=tachk.Limits(states=50_000),
        run=False,
        explain=False,
    )
    assert found.accepted is expected


def test_numbers_go_on_where_those_of_packets_go_round(tmp_path: Path) -> None:
    """Also of what the Agent has, which begins again with a session."""

    def written(number: int) -> bytes:
        return udp(WRITE_DATA[:2] + struct.pack("<H", number % 65536) + WRITE_DATA[4:])

    def announced(first: int, last: int) -> bytes:
        return udp(HEARTBEAT[:-5] + struct.pack("<HHB", first % 65536, last % 65536, 0x80))

    def acknowledged(first: int) -> bytes:
        return udp(ACKNACK[:-5] + struct.pack("<HHB", first % 65536, 0x0100, 0x80), 8888, 40000)

    numbers = [0, 20_000, 40_000, 65_535, 65_536, 65_538]
    packets = [packet for number in numbers for packet in (written(number), acknowledged(number + 1))]
    packets = [udp(CREATE_CLIENT), *packets, announced(65_530, 65_538), udp(CREATE_CLIENT), acknowledged(0)]
    path = tmp_path / "wrapped.pcap"
    path.write_bytes(pcap(packets))
    sent = [event.cells for event in read_capture(path).events if event.name == "sent"]
    assert [cells["number"] for cells in sent if cells["kind"] == "DATA"] == numbers
    assert [cells["number"] for cells in sent if cells["kind"] == "ACKNACK"] == [*(n + 1 for n in numbers), 0]
    assert [(c["number"], c["detail"]) for c in sent if c["kind"] == "HEARTBEAT"] == [(65_530, 65_539)]
