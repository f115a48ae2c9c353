"""Captures in which READ_DATA is limited in time or in octets, or cancelled; and what must not be a run."""

from __future__ import annotations

from dataclasses import replace

import pytest

import tachk
from tachk.recordings.conformance.edits import Edit, edited
from tachk.recordings.conformance.events import EventLog
from tachk.xrce.conformance.payloads import MessageContents, UnknownContentError
from tachk.xrce.transmission import ReadTransmission
from tachk.xrce.wire import SubmessageKind
from tests.support.recorded_automata import CAPTURES, MILLISECOND, capture, is_run_of

pytestmark = pytest.mark.drawn


def is_run(recording: EventLog, **constants: int) -> bool | None:
    return is_run_of(recording, 20, 50_000, **{**recording.constants, **constants})


def without(recording: EventLog, gone: list[int]) -> EventLog:
    for number in sorted(gone, reverse=True):
        recording = edited(recording, Edit(number, "lost"), MILLISECOND)
    return recording


def outside_streams(recording: EventLog) -> list[int]:
    return [n for n, event in enumerate(recording.events) if event.cells.get("kind") == "BEST_EFFORT"]


@pytest.mark.parametrize(
    "name", ["read_for_one_second", "cancel_while_flowing", "cancel_while_idle", "read_20_bytes_per_second"]
)
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


@pytest.mark.parametrize("rate", [19, 22, 40])
def test_the_agent_sends_at_the_rate_that_was_asked_for(rate: int) -> None:
    """Samples of 16 octets leave 800 ms apart: the Agent looks every 100 ms whether they may."""
    recording = capture("read_20_bytes_per_second")
    assert recording.constants.items() >= {("READ_BYTES", 20), ("SAMPLE_BYTES", 16)}
    assert is_run(recording, READ_BYTES=rate) is False


@pytest.mark.parametrize("change", [Edit(0, "moved", 150), Edit(0, "moved", -150), Edit(0, "doubled")])
def test_no_sample_is_late_or_early_or_sent_twice(change: Edit) -> None:
    recording = capture("read_20_bytes_per_second")
    samples = [
        n
        for n, event in enumerate(recording.events)
        if event.name == "sent" and event.cells["link"] == 3 and event.cells["kind"] == "DATA"
        if int(event.cells["detail"]) >= 0
    ]
    assert is_run(edited(recording, replace(change, event=samples[3]), MILLISECOND)) is False


def test_a_sample_larger_than_the_limit_is_never_sent() -> None:
    assert is_run(capture("read_20_bytes_per_second"), READ_BYTES=15) is False
    recording = capture("limit_too_small")
    assert recording.constants.items() >= {("READ_BYTES", 20), ("SAMPLE_BYTES", 40)}
    assert is_run(recording) is True
    assert is_run(recording, READ_BYTES=40) is False


@pytest.mark.parametrize(
    ("limits", "message"),
    [
        ({"max_bytes_per_second": 4097}, "max_bytes_per_second 4097: the automata know at most 4096"),
        ({"max_bytes_per_second": 30}, "max_bytes_per_second 30, one before had 20"),
        ({"max_elapsed_seconds": 3}, "max_elapsed_time 3, one before had 2"),
        ({"object": "0018"}, "READ_DATA is for the replier 0018: the automata know one for a data reader"),
        ({"object": "0010"}, "READ_DATA is for the object 0010: the automata know one for a data reader"),
    ],
)
def test_what_the_automata_do_not_speak_of_is_named(limits: dict[str, int | str], message: str) -> None:
    found = next(
        one
        for one in tachk.xrce.transmissions.read_transmissions(CAPTURES / "two_topics.pcap").transmissions.where()
        if one.events[0].kind is SubmessageKind.READ_DATA
    )
    contents = MessageContents()
    if limits.get("max_bytes_per_second") != 4097:
        contents.objects.rate, contents.objects.seconds = 20, 2
    read = replace(found.events[0], fields={**found.events[0].fields, **limits})
    one = ReadTransmission(found.link, True, found.sent, found.packet, found.arrivals, (read,))
    with pytest.raises(UnknownContentError, match=message):
        contents.payload(one, 1)


@pytest.mark.parametrize("limited_first", [True, False])
def test_a_sample_of_another_size_that_was_never_sent_is_named(limited_first: bool) -> None:
    found = list(tachk.xrce.transmissions.read_transmissions(CAPTURES / "limit_too_small.pcap").transmissions.where())
    read = next(one for one in found if one.events[0].kind is SubmessageKind.READ_DATA)
    first, second = [one for one in found if one.events[0].kind is SubmessageKind.WRITE_DATA][:2]
    event = second.events[0]
    smaller = replace(event, fields={**event.fields, "sample": str(event.fields["sample"])[:32]})
    shorter = ReadTransmission(second.link, True, second.sent, second.packet, second.arrivals, (smaller,))
    contents = MessageContents()
    order = (read, first, shorter) if limited_first else (first, shorter, read)
    for one in order[:2]:
        contents.payload(one, 0)
    with pytest.raises(UnknownContentError, match=r"another size than|20 beside samples of several sizes"):
        contents.payload(order[2], 0)


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
