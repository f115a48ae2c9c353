"""Captures of the real programs with best-effort streams, and what must not be a run."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.conform import conform
from tachk.recordings.conformance.conform_file import constants_of
from tachk.recordings.conformance.edits import Edit, edited
from tachk.recordings.conformance.events import EventLog, RecordedEvent
from tachk.xrce.conformance.packet_events import read_capture

pytestmark = pytest.mark.drawn

ROOT = Path(__file__).parents[4]
MODELS = ROOT / "models/micro_xrce_dds"
CAPTURES = ROOT / "tests/data/captures"
MILLISECOND = Fraction(1, 10**6)
UP, DOWN = 0, 3
"""The links of the publisher to the Agent, and of the Agent to the subscriber."""


def is_run(recording: EventLog) -> bool | None:
    settings = {"CLIENT_JITTER": 5, "AGENT_JITTER": 5, "MISSED_ROUNDS": 1, "EXACT_BITMAPS": True}
    model = tachk.load(MODELS / "recorded.ta", BEST_EFFORT_STREAMS=True, LARGEST_WORD=2**27 - 1, **settings)
    assert model.loaded.recording is not None
    found = conform(
        model.network,
        model.loaded.recording,
        recording,
        constants_of(model.loaded),
        TimestampUncertainty.of(Fraction(5), Fraction(20)),
        limits=tachk.Limits(states=40_000),
        run=False,
        explain=False,
    )
    return found.accepted


def capture(name: str) -> EventLog:
    return read_capture(CAPTURES / f"{name}.pcap")


def numbers(recording: EventLog, name: str, link: int, number: int) -> list[int]:
    """The events about a message of a best-effort stream."""
    wanted = {"link": link, "kind": "BEST_EFFORT", "number": number}
    return [
        n for n, event in enumerate(recording.events) if event.name == name and wanted.items() <= event.cells.items()
    ]


def changed(recording: EventLog, number: int, change: Callable[[RecordedEvent], RecordedEvent]) -> EventLog:
    events = recording.events
    return replace(recording, events=(*events[:number], change(events[number]), *events[number + 1 :]))


def without(recording: EventLog, gone: Sequence[int]) -> EventLog:
    for number in sorted(gone, reverse=True):
        recording = edited(recording, Edit(number, "lost"), MILLISECOND)
    return recording


def test_the_shipped_model_takes_it_with_its_own_settings() -> None:
    assert tachk.conform(MODELS / "client_3_0.ta", CAPTURES / "later/best_effort.pcap").accepted is True


def test_a_model_without_such_streams_says_so() -> None:
    with pytest.raises(UsageError, match="has no such streams"):
        tachk.conform(MODELS / "recorded.ta", CAPTURES / "later/best_effort.pcap")


def test_what_comes_to_the_agent_twice_is_written_once() -> None:
    recording = capture("later/best_effort")
    (arrived,) = numbers(recording, "arrived", UP, 7)
    assert is_run(edited(recording, Edit(arrived, "doubled"), MILLISECOND)) is True


def test_nothing_is_sent_twice() -> None:
    recording = capture("later/best_effort")
    (sent,) = numbers(recording, "sent", UP, 7)
    assert is_run(edited(recording, Edit(sent, "doubled"), MILLISECOND)) is False


def test_what_was_lost_is_not_delivered() -> None:
    recording = capture("later/best_effort")
    assert is_run(without(recording, numbers(recording, "arrived", UP, 7))) is False


def test_what_was_not_sent_is_not_delivered() -> None:
    recording = capture("later/best_effort")
    (sent,) = numbers(recording, "sent", UP, 7)
    gone = [sent, *numbers(recording, "arrived", UP, 7)]
    gone += [n for n, e in enumerate(recording.events) if e.name == "written_best_effort" and e.cells["detail"] == 7]
    assert is_run(without(recording, gone)) is False


def test_no_number_is_left_out() -> None:
    recording = capture("later/best_effort")
    for number in range(7, 15):
        for name in ("sent", "arrived"):
            for n in numbers(recording, name, UP, 7 + (14 - number)):
                one = recording.events[n].cells
                cells = {**one, "number": int(one["number"]) + 1}
                recording = changed(recording, n, lambda event, cells=cells: replace(event, cells=cells))
    assert is_run(recording) is False


def test_what_is_delivered_was_written() -> None:
    """The Agent sends sample 3 in place of sample 7."""
    recording = capture("later/best_effort")
    (sent,) = (
        n
        for n, event in enumerate(recording.events)
        if event.name == "sent" and event.cells["link"] == DOWN and event.cells.get("detail") == 7
    )
    wrong = changed(recording, sent, lambda event: replace(event, cells={**event.cells, "detail": 3}))
    assert is_run(wrong) is False


def test_what_leaves_a_relay_had_gone_into_it(tmp_path: Path) -> None:
    """A WRITE_DATA is changed behind the relay: to the Agent comes what nobody has sent."""
    octets = (CAPTURES / "later/best_effort.pcap").read_bytes()
    begins = [24]
    while begins[-1] < len(octets):
        begins.append(begins[-1] + 16 + int.from_bytes(octets[begins[-1] + 8 : begins[-1] + 12], "little"))
    packets = [octets[begin:end] for begin, end in pairwise(begins)]
    written = [n for n, packet in enumerate(packets) if packet.endswith(b"\x07\x00\x00\x00") and b"\x81\x01" in packet]
    assert len(written) == 2
    packets[written[1]] = packets[written[1]][:-4] + b"\x63\x00\x00\x00"
    path = tmp_path / "made_up.pcap"
    path.write_bytes(octets[:24] + b"".join(packets))
    assert is_run(read_capture(path)) is False
