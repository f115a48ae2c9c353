"""The automata are not too wide: wrong constants and changed recordings are refused.

Two publishers and a subscriber with 10 % losses, a run with 2 ms; with what the programs printed it is known when their
applications call the run function.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path

import pytest

import tachk
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.conform import Conformance, conform
from tachk.recordings.conformance.conform_file import constants_of
from tachk.recordings.conformance.edits import Edit, edited
from tachk.recordings.conformance.events import EventLog, RecordedEvent
from tachk.recordings.conformance.nearest_log import smallest_edit
from tachk.xrce.conformance.packet_events import read_capture

pytestmark = pytest.mark.drawn

ROOT = Path(__file__).parents[4]
MODEL = ROOT / "models/micro_xrce_dds/recorded.ta"
CAPTURES = ROOT / "tests/data/captures"
TWO = CAPTURES / "later/two_publishers_losses.pcap"
CALLED, TOLD_ALL, TOLD_SOME = 0, 3, 4
MILLISECOND = Fraction(1, 10**6)
SETTINGS = {"CLIENT_JITTER": 5, "AGENT_JITTER": 5, "EXACT_BITMAPS": 1, "MISSED_ROUNDS": 1}


@cache
def load(**settings: int) -> tachk.Model:
    return tachk.load(MODEL, **SETTINGS, **{"HISTORY": 4, "INPUT_HISTORY": 8} | settings)


def accepted(recording: EventLog, exact: int = 2, late: int = 2, **settings: int) -> bool | None:
    model = load(**settings)
    assert model.loaded.recording is not None
    found = conform(
        model.network,
        model.loaded.recording,
        recording,
        constants_of(model.loaded),
        TimestampUncertainty.of(Fraction(exact), Fraction(late)),
        limits=tachk.Limits(states=60_000),
        run=False,
        explain=False,
    )
    return found.accepted


def with_log(recording: EventLog) -> EventLog:
    """With the calls of the run function: all of them until each publisher has written its last sample."""
    told = []
    for client, log in enumerate(json.loads(TWO.with_suffix(".json").read_text(encoding="utf-8"))["clients"]):
        times = [line["time"] for line in log["printed"] if line["event"] in ("ready", "written")]
        said = [(times[0], TOLD_ALL), *((time, CALLED) for time in times), (times[-1] + 1_000_000, TOLD_SOME)]
        told += [
            RecordedEvent(Fraction(time - recording.epoch), "told", {"client": client, "what": what}, "log")
            for time, what in said
        ]
    numbered = sorted(enumerate([*recording.events, *told]), key=lambda pair: pair[1].time)
    place = {old: new for new, (old, _) in enumerate(numbered)}
    events = tuple(e if e.after is None else replace(e, after=place[e.after]) for _, e in numbered)
    return replace(recording, events=events)


@pytest.fixture(scope="module")
def two() -> EventLog:
    return with_log(read_capture(TWO))


def test_with_a_log_it_is_a_run(two: EventLog) -> None:
    assert accepted(two, CLIENTS=3, HISTORY=8)


@pytest.mark.parametrize(
    "wrong",
    [
        {"HEARTBEAT_LAW": 0},
        {"HEARTBEAT_LAW": 2, "CLIENT_HEARTBEAT": 1, "LOSSES": 12},
        {"CLIENT_HEARTBEAT": 110},
        {"CLIENT_HEARTBEAT": 90},
        {"GO_BACK": 0},
        {"AGENT_HEARTBEAT": 250},
        {"AGENT_HEARTBEAT": 180},
        {"ANSWER_DATA": 0},
    ],
)
def test_wrong_constants(two: EventLog, wrong: dict[str, int]) -> None:
    assert accepted(two, CLIENTS=3, **{"HISTORY": 8} | wrong) is False


def test_a_guarded_acknack() -> None:
    recording = read_capture(CAPTURES / "stale_acknack.pcap")
    assert accepted(recording, 5, 20)
    assert accepted(recording, 5, 20, GUARDED=1) is False


def test_another_dead_time() -> None:
    recording = read_capture(CAPTURES / "sleep_50s.pcap")
    measured = {"SLEEPS": 1, "AGENT_DELAY": 19}
    assert accepted(recording, 5, 20, **measured)
    assert accepted(recording, 5, 20, **measured, DEAD=60_000) is False


# ---- changed recordings ---------------------------------------------------------------------------------------------


def gone(recording: EventLog, number: int) -> EventLog:
    """Without a message and its arrivals."""
    for n in reversed([n for n, e in enumerate(recording.events) if n == number or e.after == number]):
        recording = edited(recording, Edit(n, "lost"), MILLISECOND)
    return recording


def cell(name: str, change: Callable[[int], int]) -> Callable[[EventLog, int], EventLog]:
    def changed(recording: EventLog, number: int) -> EventLog:
        event = recording.events[number]
        other = replace(event, cells={**event.cells, name: change(int(event.cells[name]))})
        return replace(recording, events=(*recording.events[:number], other, *recording.events[number + 1 :]))

    return changed


def early(recording: EventLog, number: int) -> EventLog:
    return edited(recording, Edit(number, "moved", -35), MILLISECOND)


def twice(recording: EventLog, number: int) -> EventLog:
    return edited(recording, Edit(number, "doubled"), MILLISECOND)


@pytest.mark.parametrize(
    ("kind", "link", "change"),
    [
        ("DATA", 0, gone),
        ("DATA", 5, twice),
        ("HEARTBEAT", 0, gone),
        ("HEARTBEAT", 5, early),
        ("HEARTBEAT", 5, cell("number", lambda n: n + 1)),
        ("ACKNACK", 4, gone),
        ("ACKNACK", 1, cell("number", lambda n: n + 1)),
        ("ACKNACK", 3, cell("detail", lambda n: n ^ 1)),
    ],
)
def test_changed_recordings(two: EventLog, kind: str, link: int, change: Callable[[EventLog, int], EventLog]) -> None:
    """The first message of the kind on a link."""
    sent = (n for n, e in enumerate(two.events) if e.name == "sent" and e.cells["kind"] == kind)
    number = next(n for n in sent if two.events[n].cells["link"] == link)
    assert accepted(change(two, number), CLIENTS=3, HISTORY=8) is False


def test_the_last_heartbeat_of_the_agent_is_early(two: EventLog) -> None:
    """No later one says when the round was."""
    sent = (n for n, e in enumerate(two.events) if e.name == "sent" and e.cells["kind"] == "HEARTBEAT")
    last = [n for n in sent if two.events[n].cells["link"] == 5][-1]
    assert accepted(early(two, last), CLIENTS=3, HISTORY=8) is False


def limits() -> tachk.Limits:
    return tachk.Limits(states=60_000)


@pytest.mark.parametrize(
    ("kind", "link", "change", "what"),
    [
        ("HEARTBEAT", 5, cell("number", lambda n: n + 1), "changed"),
        ("ACKNACK", 3, gone, "added"),
    ],
)
def test_the_smallest_edit_undoes_a_change(
    two: EventLog, kind: str, link: int, change: Callable[[EventLog, int], EventLog], what: str
) -> None:
    sent = [n for n, e in enumerate(two.events) if e.name == "sent" and e.cells["kind"] == kind]
    number = [n for n in sent if two.events[n].cells["link"] == link][-1 if what == "added" else 0]
    model, changed = load(CLIENTS=3, HISTORY=8), change(two, number)
    mapping, names = model.loaded.recording, constants_of(model.loaded)
    assert mapping is not None

    def conforms_within(recording: EventLog, explain: bool) -> Conformance:
        two_ms = TimestampUncertainty.of(Fraction(2), Fraction(2))
        return conform(model.network, mapping, recording, names, two_ms, limits=limits(), run=False, explain=explain)

    found = conforms_within(changed, True)
    assert found.refusal is not None and found.refusal.event is not None
    search = smallest_edit(
        model.network,
        mapping,
        changed,
        names,
        found,
        limits(),
        lambda other: conforms_within(other, False).accepted is True,
    )
    edit = search.edit
    assert edit is not None and edit.what == what
    if what in ("changed", "added"):
        said = dict(edit.cells)
        assert (said["number"], said["detail"]) == (
            two.events[number].cells["number"],
            two.events[number].cells["detail"],
        )
