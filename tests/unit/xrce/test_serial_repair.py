"""What was sent in frames of a serial line that came damaged."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from random import Random

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.conform import conform
from tachk.recordings.conformance.conform_file import constants_of
from tachk.xrce.conformance.packet_events import read_capture
from tachk.xrce.packets import read_packets
from tachk.xrce.serial_framing import FrameReader, SerialFrame, crc16
from tachk.xrce.serial_repair import repaired
from tachk.xrce.transmissions import read_transmissions
from tests.support.seeds import some

pytestmark = pytest.mark.drawn

ROOT = Path(__file__).parents[3]
LINE = ROOT / "tests/data/serial_line.pcap"
DAMAGED = ROOT / "tests/data/serial_line_damaged_frames.pcap"
MODEL = ROOT / "models/micro_xrce_dds/client_3_0.ta"


def frames(path: Path) -> list[SerialFrame]:
    reader = FrameReader()
    with path.open("rb") as stream:
        return [
            frame
            for found in read_packets(stream)
            for start, size in zip(found.starts, found.sizes, strict=True)
            for frame in reader.push(found.octets[start : start + size].tobytes())
        ]


def damaged(frame: SerialFrame, places: list[int], random: Random) -> SerialFrame:
    octets = bytearray(frame.message + crc16(frame.message).to_bytes(2, "little"))
    for place in places:
        octets[place] ^= random.randrange(1, 256)
    return SerialFrame(1, 0, bytes(octets[:-2]), "damaged", int.from_bytes(octets[-2:], "little"))


def test_one_damaged_byte_of_a_real_message() -> None:
    """Messages of a real line, damaged at every place: never another message, and mostly the one."""
    random, known, asked = Random(7), 0, 0
    messages = [*{frame.message: frame for frame in frames(LINE)}.values()]
    for message in some(messages, len(messages) // 3):
        for place in range(len(message.message) + 2):
            found = repaired(damaged(message, [place], random))
            assert found in (None, message.message)
            known, asked = known + (found is not None), asked + 1
    assert known > 0.8 * asked


def test_a_frame_that_was_cut_is_not_known() -> None:
    assert repaired(SerialFrame(1, 0, b"\x81\x00\x00", "cut")) is None


def test_damaged_frames_of_the_real_programs() -> None:
    """What the sender had sent before the line damaged it."""
    truth = json.loads(DAMAGED.with_suffix(".json").read_text(encoding="utf-8"))["damaged"]
    sent = [FrameReader().push(bytes.fromhex(one["frame"]))[0].message for one in truth]
    assert [repaired(frame) for frame in frames(DAMAGED) if frame.problem] == sent
    lost = [one for one in read_transmissions(DAMAGED).transmissions if one.is_lost]
    assert [one.packet for one in lost] == [one["packet"] for one in truth]


def test_they_are_lost_in_a_run_of_the_model() -> None:
    assert tachk.conform(MODEL, DAMAGED, "10ms", "20ms").accepted is True


def test_what_was_damaged_did_not_arrive() -> None:
    """A damaged message that had come to its receiver would have been answered."""
    model = tachk.load(
        MODEL.with_name("recorded.ta"), CLIENT_JITTER=5, AGENT_JITTER=5, MISSED_ROUNDS=1, EXACT_BITMAPS=True
    )
    recording = read_capture(DAMAGED)
    events = recording.events
    arrivals = {event.after for event in events}
    answered = [
        number
        for number, event in enumerate(events)
        if event.name == "sent" and number not in arrivals and event.cells["kind"] == "DATA"
    ]
    assert answered
    for number in answered:
        arrived = replace(events[number], name="arrived", after=number, time=events[number].time)
        later = [
            e if e.after is None or e.after <= number else replace(e, after=e.after + 1) for e in events[number + 1 :]
        ]
        changed = replace(recording, events=(*events[: number + 1], arrived, *later))
        assert model.loaded.recording is not None
        found = conform(
            model.network,
            model.loaded.recording,
            changed,
            constants_of(model.loaded),
            TimestampUncertainty.of(Fraction(10), Fraction(20)),
            limits=tachk.Limits(states=40_000),
            run=False,
            explain=False,
        )
        assert found.accepted is False


def test_two_damaged_bytes_are_reported(tmp_path: Path) -> None:
    octets = bytearray(LINE.read_bytes())
    place = octets.index(b"Numbers__dw")
    octets[place], octets[place + 5] = 1, 2
    path = tmp_path / "line.pcap"
    path.write_bytes(octets)
    with pytest.raises(UsageError, match="message is damaged, so what its sender has sent is unknown"):
        tachk.conform(MODEL, path)
