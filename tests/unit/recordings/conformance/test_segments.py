"""Long recordings followed segment by segment: what is accepted so is what a search of the whole accepts."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from random import Random

import pytest

import tachk
from tachk.engine.compiler.lower import lower
from tachk.engine.compiler.program import Program
from tachk.engine.exact.exact_run import exact_run
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance import conform as conformance
from tachk.recordings.conformance import segments
from tachk.recordings.conformance.conform import Conformance, ConformingRun, conform
from tachk.recordings.conformance.conform_file import constants_of
from tachk.recordings.conformance.event_tables import read_events
from tachk.recordings.conformance.events import EventLog
from tachk.recordings.conformance.recorded_scenario import scenario_of_recording
from tachk.recordings.conformance.segments import LongRun
from tachk.recordings.conformance.trace_product import TraceProduct
from tachk.xrce.conformance.packet_events import read_capture
from tests.support.seeds import seeds
from tests.unit.recordings.conformance.small_models import csv_of, is_run, mutated, random_machine, random_run, text_of

pytestmark = pytest.mark.drawn

ROOT = Path(__file__).parents[4]
CAPTURES = ROOT / "tests/data/captures/later"


def held(model: tachk.Model, recording: EventLog, tolerance: int, late: int) -> Conformance:
    return held_within(model, recording, TimestampUncertainty.of(Fraction(tolerance), Fraction(late)))


def held_within(model: tachk.Model, recording: EventLog, exact: TimestampUncertainty) -> Conformance:
    assert model.loaded.recording is not None
    return conform(model.network, model.loaded.recording, recording, constants_of(model.loaded), exact, explain=False)


def in_segments(monkeypatch: pytest.MonkeyPatch, events: int, ahead: int) -> None:
    monkeypatch.setattr(conformance, "LONG", 0)
    monkeypatch.setattr(segments, "SEGMENT", events)
    monkeypatch.setattr(segments, "AHEAD", ahead)


@pytest.mark.parametrize("seed", seeds(range(6)))
def test_segments_agree_with_the_whole(seed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Random models. The verdict is that of a second definition, and most runs are found in segments."""
    random, file = Random(seed), tmp_path / "events.csv"
    hidden = seed % 3 == 2
    long = runs = 0
    for case in range(8):
        machines = tuple(random_machine(random) for _ in range(random.randint(1, 2)))
        events, end = random_run(random, machines, 40, hidden)
        tolerance, late = random.randrange(2), (random.randrange(3), random.randrange(3))
        if case % 4 == 3:
            events = mutated(random, events, end)
        file.write_text(csv_of(events, end), encoding="utf-8")
        model = tachk.loads(text_of(machines, hidden))
        with monkeypatch.context() as patch:
            in_segments(patch, random.randint(1, 8), random.randint(0, 4))
            exact = TimestampUncertainty(Fraction(tolerance), *map(Fraction, late))
            found = held_within(model, read_events(file), exact)
        assert found.accepted is is_run(machines, events, end, tolerance, late, hidden), f"case {case}"
        if found.accepted and len(events) > 1:
            runs += 1
            long += all(isinstance(run, LongRun) for run in found.runs)
    assert 2 * long >= runs


NAMES = ["client_2_0_losses", "best_effort_batches", "two_publishers_losses", "restarted", "heartbeats_wait"]


@pytest.mark.parametrize("name", NAMES)
def test_captures_in_segments(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The paths along segments, put together, are a path of the whole that can be given times."""
    words = json.loads((CAPTURES / f"{name}.json").read_text(encoding="utf-8"))["settings"].split()
    given = {key: json.loads(value) for key, value in (word.split("=") for word in words if "=" in word)}
    model = tachk.load(ROOT / "models/micro_xrce_dds/recorded.ta", **given)
    recording = read_capture(CAPTURES / f"{name}.pcap")
    whole = next(found for late in (5, 20, 60) if (found := held(model, recording, 5, late)).accepted)
    taken: dict[tuple[int, ...], list[list[tuple[int, int, tuple[int, ...]]]]] = {}
    count = segments._count

    def noted(
        counter: Counter[tuple[int, int]], product: TraceProduct, program: Program, actions: Sequence[Sequence[int]]
    ) -> None:
        edges = [[program.edges[number] for number in action] for action in actions]
        path = taken.setdefault(product.modelled, [])
        path += [[(edge.process, edge.edge, edge.selects) for edge in action] for action in edges]
        count(counter, product, program, actions)

    with monkeypatch.context() as patch:
        in_segments(patch, 40, 40)
        patch.setattr(segments, "_count", noted)
        found = held(model, recording, 5, int(whole.uncertainty.output_late))
    assert found.accepted
    assert found.streams.other == whole.streams.other
    assert all(isinstance(run, ConformingRun) for run in whole.runs)
    for run, long in zip(whole.runs, found.runs, strict=True):
        assert isinstance(run, ConformingRun)
        assert isinstance(long, LongRun)
        program, (goal,) = lower(run.product.network, [run.product.done], run.product.tables)
        number = {(edge.process, edge.edge, edge.selects): n for n, edge in enumerate(program.edges)}
        path = [[number[edge] for edge in action] for action in taken[long.modelled]]
        assert len(path) == long.transitions
        moments, why = exact_run(program, goal, path)
        assert moments is not None, why


def test_a_long_recording_makes_no_scenario(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its streams are not held, so a scenario of them would be one of the last events alone."""
    dimmer = ROOT / "examples/dimmer"
    model = tachk.load(dimmer / "dimmer.ta")
    in_segments(monkeypatch, 2, 2)
    found = held(model, read_events(dimmer / "pressed.csv"), 1, 1)
    assert found.accepted and any(isinstance(run, LongRun) for run in found.runs)
    with pytest.raises(tachk.UsageError, match="too many for a scenario"):
        scenario_of_recording(found, "pressed")
