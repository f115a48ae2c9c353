"""Captures in which READ_DATA is limited in time, or cancelled; and what must not be a run."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

import tachk
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.conform import conform
from tachk.recordings.conformance.conform_file import constants_of
from tachk.recordings.conformance.edits import Edit, edited
from tachk.recordings.conformance.events import EventLog
from tachk.xrce.conformance.packet_events import read_capture

pytestmark = pytest.mark.drawn

ROOT = Path(__file__).parents[4]
CAPTURES = ROOT / "tests/data/captures/unusual"
MILLISECOND = Fraction(1, 10**6)
SETTINGS = {
    "MESSAGES": 64,
    "EXACT_BITMAPS": True,
    "CLIENT_JITTER": 5,
    "AGENT_JITTER": 5,
    "MISSED_ROUNDS": 1,
    "BEST_EFFORT_STREAMS": True,
    "READER_DELAY": 5,
    "SMALLEST_WORD": -(2**27),
}


def is_run(recording: EventLog, **constants: int) -> bool | None:
    model = tachk.load(ROOT / "models/micro_xrce_dds/recorded.ta", **{**SETTINGS, **recording.constants, **constants})
    assert model.loaded.recording is not None
    mapping, names = model.loaded.recording, constants_of(model.loaded)
    uncertainty = TimestampUncertainty.of(Fraction(5), Fraction(20))
    limits = tachk.Limits(states=50_000)
    return conform(
        model.network, mapping, recording, names, uncertainty, limits=limits, run=False, explain=False
    ).accepted


def capture(name: str) -> EventLog:
    return read_capture(CAPTURES / f"{name}.pcap")


def without(recording: EventLog, gone: list[int]) -> EventLog:
    for number in sorted(gone, reverse=True):
        recording = edited(recording, Edit(number, "lost"), MILLISECOND)
    return recording


def outside_streams(recording: EventLog) -> list[int]:
    return [n for n, event in enumerate(recording.events) if event.cells.get("kind") == "BEST_EFFORT"]


@pytest.mark.parametrize("name", ["read_for_one_second", "cancel_while_flowing", "cancel_while_idle"])
def test_it_is_a_run(name: str) -> None:
    assert is_run(capture(name)) is True


def test_the_agent_stops_when_the_time_is_over_and_neither_before_nor_later() -> None:
    recording = capture("read_for_one_second")
    assert recording.constants["READ_SECONDS"] == 1
    assert is_run(recording, READ_SECONDS=2) is False
    samples = [
        n
        for n, event in enumerate(recording.events)
        if event.name == "sent" and event.cells["link"] == 3 and int(event.cells["detail"] or 0) >= 0
        if event.cells["kind"] == "DATA"
    ]
    last = samples[-1]
    assert (
        is_run(without(recording, [n for n, e in enumerate(recording.events) if n == last or e.after == last])) is False
    )


def test_a_cancel_ends_what_does_not_flow() -> None:
    recording = capture("cancel_while_idle")
    assert recording.constants["CANCELS"] == 1 and not outside_streams(recording)
    assert is_run(recording, CANCELS=0) is False


def test_a_cancel_does_not_end_what_flows() -> None:
    recording = capture("cancel_while_flowing")
    beyond = outside_streams(recording)
    assert len(beyond) > 4
    last = [n for n in beyond if n == beyond[-1] or recording.events[n].after == beyond[-1] or n == beyond[-2]]
    assert is_run(without(recording, last)) is False
    assert is_run(without(recording, beyond)) is False
