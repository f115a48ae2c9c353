"""Recordings cut from random runs are accepted; of changed ones the engine says what a second definition says."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from random import Random

import pytest

import tachk
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.conform import conform
from tachk.recordings.conformance.conform_file import constants_of
from tachk.recordings.conformance.event_tables import read_events
from tests.support.seeds import seeds
from tests.unit.recordings.conformance.small_models import (
    Event,
    answering_machine,
    csv_of,
    is_run,
    mutated,
    random_machine,
    random_run,
    text_of,
)

pytestmark = pytest.mark.drawn


@pytest.mark.parametrize("seed", seeds(range(6)))
def test_engine_agrees_with_judge(seed: int, tmp_path: Path) -> None:
    random = Random(seed)
    hidden = seed % 3 == 2
    machines = tuple(random_machine(random) for _ in range(random.randint(1, 2)))
    model = tachk.loads(text_of(machines, hidden))
    file = tmp_path / "events.csv"
    for case in range(8):
        events, end = random_run(random, machines, 14, hidden)
        tolerance, late = random.randrange(2), (random.randrange(3), random.randrange(3))
        if case % 4:
            events = mutated(random, events, end)
        expected = is_run(machines, events, end, tolerance, late, hidden)
        assert expected or case % 4, "a run of the model"
        file.write_text(csv_of(events, end), encoding="utf-8")
        found = tachk.conform(model, file, str(tolerance), {"input": str(late[0]), "output": str(late[1])})
        assert found.accepted is expected, f"seed {seed}, case {case}"


def _exchanged(random: Random, events: list[Event]) -> list[Event]:
    """With an input and the output behind it in the other order."""
    pairs = [n for n in range(1, len(events)) if (events[n - 1].label, events[n].label) == ("in", "out")]
    if not pairs:
        return events
    place = random.choice(pairs)
    first, second = events[place - 1 : place + 1]
    swapped = replace(second, time=first.time), replace(first, time=second.time)
    return [*events[: place - 1], *swapped, *events[place + 1 :]]


def test_one_observer_of_a_machine(tmp_path: Path) -> None:
    """What it was seen to send before something came to it has happened before that, however late it was recorded."""
    random, file = Random(0), tmp_path / "events.csv"
    differ = 0
    for case in range(40):
        machines = tuple(
            random.choice((random_machine, answering_machine))(random) for _ in range(random.randint(1, 2))
        )
        run, end = random_run(random, machines, 14, hidden=False)
        if {event.label for event in run} != {"in", "out"}:
            continue
        events = _exchanged(random, run) if case % 4 else run
        expected = [is_run(machines, events, end, 2, 3, False, ordered) for ordered in (False, True)]
        assert expected[1] or case % 4, "a run of the model"
        model = tachk.loads(text_of(machines, hidden=False))
        assert model.loaded.recording is not None
        file.write_text(csv_of(events, end), encoding="utf-8")
        free = read_events(file, None)
        seen = replace(free, events=tuple(replace(e, passes=int(e.cells["m"] or 0)) for e in free.events))
        names = constants_of(model.loaded)
        found = [
            conform(
                model.network,
                model.loaded.recording,
                recording,
                names,
                TimestampUncertainty.of(Fraction(2), Fraction(3)),
            ).accepted
            for recording in (free, seen)
        ]
        assert found == expected, f"case {case}"
        differ += expected[0] is not expected[1]
    assert differ
