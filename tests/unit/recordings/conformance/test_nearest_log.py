"""Edits are tried on what is near, from a state in which the model was before: what is found so is a run."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from random import Random

import pytest

import tachk
from tachk.engine.compiler.lower import lower
from tachk.engine.options import Options
from tachk.engine.zone import explore
from tachk.model.expressions import LocationTest
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance import nearest_log
from tachk.recordings.conformance.components import restricted
from tachk.recordings.conformance.conform import Conformance, conform
from tachk.recordings.conformance.conform_file import constants_of
from tachk.recordings.conformance.edits import edited, edits
from tachk.recordings.conformance.event_streams import make_streams
from tachk.recordings.conformance.event_tables import read_events
from tachk.recordings.conformance.events import EventLog
from tachk.recordings.conformance.rejection import end_of
from tachk.recordings.conformance.resumed import resumed
from tachk.recordings.conformance.trace_product import trace_product
from tests.unit.recordings.conformance.small_models import (
    Event,
    csv_of,
    is_run,
    mutated,
    random_machine,
    random_run,
    text_of,
)

ROOT = Path(__file__).parents[4]


def _near(model: tachk.Model, recording: EventLog, found: Conformance) -> nearest_log.NearestLogSearch:
    assert model.loaded.recording is not None
    names = constants_of(model.loaded)
    return nearest_log.NearestLogSearch(model.network, model.loaded.recording, recording, names, found, tachk.Limits())


def _events(recording: EventLog) -> list[Event]:
    rows = [event for event in recording.events if event.name != "end"]
    return [
        Event(int(e.time), int(e.cells["m"]), e.name, int(e.cells["k"]), int(e.cells.get("number") or 0)) for e in rows
    ]


def _clocks_go_on(near: nearest_log.NearestLogSearch) -> None:
    """Where the processes wake, the clocks have just the values with which the run came there."""
    streams = make_streams(near.network, near.mapping, near.recording, near.constants, near.uncertainty)
    for start in near.starts:
        if start.end is not None:
            component, before = start.reached.component, start.reached.product
            later = resumed(
                trace_product(near.network, near.mapping, restricted(streams, component), component.processes),
                before,
                start.end,
            )
            assert later is not None
            setter = later.network.processes[-1]
            awake = LocationTest(len(later.network.processes) - 1, len(setter.locations) - 1)
            program, goals = lower(later.network, [awake], later.tables)
            found = explore(program, goals, Options(), tachk.Limits()).goals[0]
            assert found.path is not None and found.actions is not None
            assert end_of(later, program, found.path, found.actions).zones == start.end.zones


def test_what_is_found_near_is_a_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By a second definition of what a run is; and most of the edits that make one are found."""
    monkeypatch.setattr(nearest_log, "_BEFORE", 3)
    random, file, one = Random(0), tmp_path / "events.csv", Fraction(1)
    said = {(near, truth): 0 for near in (True, False) for truth in (True, False)}
    begun_later = 0
    while begun_later < 8:
        machines = tuple(random_machine(random) for _ in range(random.randint(1, 2)))
        events, end = random_run(random, machines, 24, hidden=False)
        if len(events) < 8 or {event.label for event in events} != {"in", "out"}:
            continue
        model = tachk.loads(text_of(machines, hidden=False))
        changed = sorted([*events[:-5], *mutated(random, events[-5:], end)], key=lambda event: event.time)
        file.write_text(csv_of(changed, end), encoding="utf-8")
        recording = read_events(file, None)
        assert model.loaded.recording is not None
        found = conform(
            model.network,
            model.loaded.recording,
            recording,
            constants_of(model.loaded),
            TimestampUncertainty(one, one, 2 * one),
        )
        if found.refusal is None or found.refusal.event is None:
            continue
        near = _near(model, recording, found)
        begun_later += any(start.end is not None for start in near.starts)
        _clocks_go_on(near)
        place = near.numbers.index(found.refusal.event)
        for edit in list(edits(near.recording, place, found.refusal.enabled_events, Fraction(0), one))[:10]:
            whole = edited(recording, replace(edit, event=near.numbers[edit.event]), one)
            if all(0 <= event.time <= end for event in whole.events):
                truth = is_run(machines, _events(whole), end, 1, (1, 2), False)
                said[near.accepts(edited(near.recording, edit, one)), truth] += 1
    assert said[True, False] == 0
    assert said[True, True] > 10
    assert said[False, True] <= 2


def test_the_whole_recording_decides() -> None:
    """What is found near is not an answer yet."""
    model = tachk.load(ROOT / "examples/dimmer/dimmer.ta")
    mapping, names = model.loaded.recording, constants_of(model.loaded)
    assert mapping is not None
    recording = read_events(ROOT / "examples/dimmer/too_soon.csv", None)
    found = conform(model.network, mapping, recording, names)
    first, none = (
        nearest_log.smallest_edit(
            model.network, mapping, recording, names, found, tachk.Limits(), lambda _, said=said: said
        )
        for said in (True, False)
    )
    assert first.edit is not None and first.edit.what == "lost" and not first.untried
    assert none.edit is None and not none.untried


def test_a_short_search_for_an_edit_says_how_many_were_not_tried() -> None:
    model = tachk.load(ROOT / "examples/dimmer/dimmer.ta")
    mapping, names = model.loaded.recording, constants_of(model.loaded)
    assert mapping is not None
    recording = read_events(ROOT / "examples/dimmer/too_soon.csv", None)
    found = conform(model.network, mapping, recording, names)
    question: list[int] = []

    def search(work: int | None) -> nearest_log.Found:
        question.append(0)

        def refuse(_: EventLog) -> bool:
            question[-1] += 1
            return False

        return nearest_log.smallest_edit(model.network, mapping, recording, names, found, tachk.Limits(), refuse, work)

    none_tried, few_tried, all_tried = search(0), search(30), search(None)
    assert none_tried.untried > few_tried.untried > all_tried.untried == 0
    assert question[0] == 0 < question[1] < question[2]
