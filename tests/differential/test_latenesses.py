"""Inputs and outputs that are late by different times: what a recorder with such times notes of a run is accepted,
larger times accept no less, and the search along a recording says what following it event by event says."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from random import Random

import pytest

import tachk
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.conform import conform
from tachk.recordings.conformance.conform_file import constants_of
from tachk.recordings.conformance.events import EventLog, RecordedEvent
from tests.support.seeds import seeds
from tests.unit.recordings.conformance.small_models import (
    Event,
    Machine,
    answering_machine,
    mutated,
    random_machine,
    random_run,
    text_of,
)
from tests.unit.simulation.testing.test_followed_system import followed, recorded, with_anyone

pytestmark = pytest.mark.drawn

HALF = Fraction(1, 2)


def speaking_machines(random: Random) -> tuple[Machine, ...]:
    """One machine or two, of which one has an output."""
    while True:
        kinds = (random_machine, answering_machine)
        machines = tuple(random.choice(kinds)(random) for _ in range(random.randint(1, 2)))
        if any(edge.label == "out" for machine in machines for edge in machine.edges):
            return machines


def random_uncertainty(random: Random) -> TimestampUncertainty:
    """Half of the time one of the latenesses is none."""
    latenesses = random.choice((0, random.randrange(7))), random.randrange(7)
    return TimestampUncertainty(HALF * random.randrange(3), *(HALF * late for late in random.sample(latenesses, 2)))


def noted(random: Random, run: list[Event], end: int, uncertainty: TimestampUncertainty) -> EventLog:
    """What a recorder notes of a run: each event some time before or after it happens, those of a stream in order."""
    last: dict[tuple[str, int], Fraction] = {}
    events = []
    for event in run:
        latest_end = end + uncertainty.output_late
        if event.label == "out":
            low, high = event.time - uncertainty.tolerance, event.time + uncertainty.output_late
        else:
            low, high = event.time - uncertainty.input_late, min(event.time + uncertainty.tolerance, latest_end)
        drawn = random.choice((low, high, low + (high - low) * random.randrange(5) / 4))
        time = max(drawn, last.get((event.label, event.machine), Fraction(0)))
        last[event.label, event.machine] = time
        events.append(replace(recorded(event), time=time))
    ends = max([Fraction(end), *last.values()])
    return _log(events, random.choice((ends, max(ends, end + uncertainty.output_late))))


def _log(events: list[RecordedEvent], end: Fraction) -> EventLog:
    return EventLog("a recording", sorted(events, key=lambda event: event.time), None, Fraction(0), end)


def accepted(model: tachk.Model, log: EventLog, uncertainty: TimestampUncertainty) -> bool | None:
    mapping = model.loaded.recording
    assert mapping is not None
    names = constants_of(model.loaded)
    return conform(model.network, mapping, log, names, uncertainty, run=False, explain=False).accepted


def goes_along(random: Random, model: tachk.Model, log: EventLog, uncertainty: TimestampUncertainty) -> bool:
    system = followed(model, uncertainty)
    for event in log.events:
        if random.random() < 0.5:
            system.advance(event.time)
        system.observe(event)
        if not system.is_as_modelled:
            return False
    return system.ends_as_modelled(log.end)


@pytest.mark.parametrize("seed", seeds(range(8)))
def test_what_a_late_recorder_notes_is_a_run(seed: int) -> None:
    random = Random(seed)
    machines = speaking_machines(random)
    model = tachk.loads(with_anyone(text_of(machines, hidden=False), len(machines)))
    for case in range(10):
        uncertainty = random_uncertainty(random)
        log = noted(random, *random_run(random, machines, 12, hidden=False), uncertainty)
        assert accepted(model, log, uncertainty) is True, f"seed {seed}, case {case}"
        assert goes_along(random, model, log, uncertainty), f"seed {seed}, case {case}"


def test_the_directions_matter() -> None:
    """Where only inputs are late, or only outputs, the lateness of the others does not explain all recordings."""
    random = Random(1)
    none, long = Fraction(0), Fraction(3)
    apart = TimestampUncertainty(none, long, none), TimestampUncertainty(none, none, long)
    refused = [0, 0]
    for _ in range(8):
        machines = (answering_machine(random),)
        model = tachk.loads(with_anyone(text_of(machines, hidden=False), 1))
        for case in range(8):
            used, other = apart[case % 2], apart[1 - case % 2]
            log = noted(random, *random_run(random, machines, 12, hidden=False), used)
            refused[case % 2] += accepted(model, log, other) is False
    assert min(refused) > 2


@pytest.mark.parametrize("seed", seeds(range(8)))
def test_search_and_following_agree_and_larger_times_accept_no_less(seed: int) -> None:
    random = Random(seed)
    machines = speaking_machines(random)
    model = tachk.loads(with_anyone(text_of(machines, hidden=False), len(machines)))
    for case in range(10):
        run, end = random_run(random, machines, 12, hidden=False)
        log = noted(random, mutated(random, run, end), end, random_uncertainty(random))
        smaller = random_uncertainty(random)
        larger = TimestampUncertainty(
            smaller.tolerance + HALF * random.randrange(3),
            smaller.input_late + HALF * random.randrange(4),
            smaller.output_late + HALF * random.randrange(4),
        )
        first, second = (accepted(model, log, each) for each in (smaller, larger))
        assert first is not None and second is not None
        assert goes_along(random, model, log, smaller) is first, f"seed {seed}, case {case}"
        assert goes_along(random, model, log, larger) is second, f"seed {seed}, case {case}"
        assert second or not first, f"seed {seed}, case {case}"
