"""Captures of the real programs with several topics, and several readers of a client; and what must not be a run."""

from __future__ import annotations

from dataclasses import replace

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.recordings.conformance.edits import Edit, edited
from tachk.recordings.conformance.events import EventLog
from tachk.xrce.events import SubmessageEvent
from tachk.xrce.objects import Objects
from tachk.xrce.wire import SubmessageKind
from tests.support.recorded_automata import CAPTURES, MILLISECOND, MODEL, capture, is_run_of

NAMES = {"two_topics": {"CLIENTS": 4, "READERS": 2}, "two_readers": {"CLIENTS": 2, "READERS": 2}}


def is_run(recording: EventLog, name: str, late: int = 50) -> bool | None:
    return is_run_of(recording, late, 100_000, TOPICS=2, **NAMES[name])


def sent_to_clients(recording: EventLog, kind: str) -> list[int]:
    """The first transmissions of samples on the way from the Agent."""
    found: dict[tuple[object, object], int] = {}
    for n, event in enumerate(recording.events):
        cells = event.cells
        if event.name == "sent" and cells["kind"] == kind and int(cells["link"]) % 2 and int(cells["detail"]) >= 0:
            found.setdefault((cells["link"], cells["number"]), n)
    return list(found.values())


def with_detail(recording: EventLog, number: int, detail: int) -> EventLog:
    events = recording.events
    one = replace(events[number], cells={**events[number].cells, "detail": detail})
    return replace(recording, events=(*events[:number], one, *events[number + 1 :]))


@pytest.mark.parametrize(("name", "late"), [("two_topics", 5), ("two_readers", 50)])
def test_each_reader_gets_the_samples_of_its_topic(name: str, late: int) -> None:
    assert is_run(capture(name), name, late) is True


@pytest.mark.drawn
@pytest.mark.parametrize(
    ("name", "kind"), [("two_topics", "DATA"), ("two_readers", "DATA"), ("two_readers", "BEST_EFFORT")]
)
def test_no_other_sample_and_none_of_another_topic_and_none_twice(name: str, kind: str) -> None:
    recording = capture(name)
    place = sent_to_clients(recording, kind)[3]
    detail = int(recording.events[place].cells["detail"])
    for other in (detail ^ 1, detail + 2, detail - 2):
        assert is_run(with_detail(recording, place, other), name) is False
    assert is_run(edited(recording, Edit(place, "doubled"), MILLISECOND), name) is False
    gone = [n for n, event in enumerate(recording.events) if n == place or event.after == place]
    for n in reversed(gone):
        recording = edited(recording, Edit(n, "lost"), MILLISECOND)
    assert is_run(recording, name) is False


def test_a_model_with_one_topic_says_what_to_set() -> None:
    with pytest.raises(UsageError, match=r"has 2 topics, .* but the model 1") as refused:
        tachk.conform(MODEL.with_name("client_3_0.ta"), CAPTURES / "two_readers.pcap")
    assert refused.value.help == "set -D TOPICS=2"
    assert tachk.measure(CAPTURES / "two_readers.pcap").recorded_definitions().items() >= {
        ("CLIENTS", 2),
        ("TOPICS", 2),
        ("READERS", 2),
    }


def created(kind: str, made: str, form: str, description: str) -> SubmessageEvent:
    fields = {"object": made, "object_kind": kind, "representation": form, "description": description}
    return replace(_EVENT, kind=SubmessageKind.CREATE, fields=fields)


def read(made: str) -> SubmessageEvent:
    fields = {"object": made, "max_samples": 65535, "max_elapsed_seconds": 0, "max_bytes_per_second": 0}
    return replace(_EVENT, kind=SubmessageKind.READ_DATA, fields=fields)


_EVENT = next(
    event
    for one in tachk.xrce.transmissions.read_transmissions(CAPTURES / "two_topics.pcap").transmissions.where()
    for event in one.events
)


def test_topics_that_nobody_reads_are_one() -> None:
    objects = Objects()
    for number, name in enumerate("ABCD"):
        objects.note(0, created("data writer", f"00{number}5", "reference", f"{name}__dw"))
    objects.note(1, created("data reader", "0016", "reference", "C__dr"))
    objects.note(1, created("data reader", "0026", "XML", "<dds><topic><name>C</name></topic></dds>"))
    assert (objects.read(1, read("0016")), objects.read(1, read("0026")), objects.read(1, read("0016"))) == (0, 1, 0)
    found = objects.numbering([3, 4, 5, 6])
    assert (found.topics, found.readers) == (2, 4)
    assert (found.of_topics, found.before) == ((1, 1, 0, 1), (0, 3, 0, 7))
    assert found.of_readers == {(1, 0): 0, (1, 1): 2}


def test_binary_descriptions_name_the_topic_of_the_client() -> None:
    name = b"Numbers\0"
    objects = Objects()
    objects.note(0, created("topic", "0012", "binary", (len(name).to_bytes(4, "little") + name).hex()))
    objects.note(0, created("data writer", "0015", "binary", "001200"))
    objects.note(0, created("data writer", "0025", "reference", "Letters__dw"))
    objects.note(1, created("data reader", "0016", "reference", "Numbers__dr"))
    assert [objects.topic(0, "0015"), objects.topic(0, "0025"), objects.topic(1, "0016")] == [0, 1, 0]
