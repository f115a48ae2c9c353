"""A system that is followed event by event is as its model says exactly where a second definition says so."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import combinations
from random import Random

import pytest

import tachk
from tachk.engine.options import Limits
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.conform_file import constants_of
from tachk.recordings.conformance.events import RecordedEvent
from tachk.simulation.testing.followed_system import FollowedSystem
from tachk.simulation.testing.instrumented_network import instrumented_network
from tests.support.seeds import seeds
from tests.unit.recordings.conformance.small_models import (
    KEYS,
    Event,
    Machine,
    is_run,
    mutated,
    random_machine,
    random_run,
    text_of,
)


def with_anyone(text: str, machines: int) -> str:
    """The model with a process that sends whatever it likes whenever it likes, which recordings replace."""
    anyone = f"""process Anyone() {{
    init location There {{
        to There {{ select m : int[0, {machines - 1}], k : int[0, {KEYS - 1}]; sync hear[m][k]!; }}
    }}
}}
system """
    return (
        text.replace("system ", anyone)
        .replace("recording {", "recording {\n    replaces Anyone;")
        .replace(";\nrecording", ", Anyone;\nrecording")
    )


def followed(model: tachk.Model, uncertainty: TimestampUncertainty) -> FollowedSystem:
    assert model.loaded.recording is not None
    mapping = model.loaded.recording
    observed = instrumented_network(model.network, mapping)
    return FollowedSystem(observed, mapping, constants_of(model.loaded), uncertainty, Limits(states=100_000))


def recorded(event: Event) -> RecordedEvent:
    cells: dict[str, int | str] = {"m": event.machine, "k": event.key}
    if event.label == "out":
        cells["number"] = event.number
    return RecordedEvent(Fraction(event.time), event.label, cells, "here")


def goes_along(random: Random, system: FollowedSystem, events: list[Event], end: int) -> bool:
    """Whether the system is as modelled up to the end; events and the passing of time are told in pieces."""
    for event in events:
        if random.random() < 0.5:
            system.advance(Fraction(event.time))
        assert system.observe(recorded(event))
        if random.random() < 0.5:
            system.advance(Fraction(event.time))
        if not system.is_as_modelled:
            return False
    return system.ends_as_modelled(Fraction(end))


@pytest.mark.parametrize("seed", seeds(range(6)))
def test_following_agrees_with_a_second_definition(seed: int) -> None:
    random = Random(seed)
    machines: tuple[Machine, ...] = tuple(random_machine(random) for _ in range(random.randint(1, 2)))
    model = tachk.loads(with_anyone(text_of(machines, hidden=False), len(machines)))
    for case in range(12):
        events, end = random_run(random, machines, 14, hidden=False)
        tolerance, late = random.randrange(3), (random.randrange(4), random.randrange(4))
        if case % 4:
            events = mutated(random, events, end)
        if not any(edge.label == "out" for machine in machines for edge in machine.edges):
            continue  # then outputs come from outside, where nobody sends them
        expected = is_run(machines, events, end, tolerance, late, hidden=False)
        system = followed(model, TimestampUncertainty(Fraction(tolerance), *map(Fraction, late)))
        assert goes_along(random, system, events, end) is expected, f"seed {seed}, case {case}"


@pytest.mark.parametrize("seed", seeds(range(4)))
def test_events_that_may_have_happened(seed: int) -> None:
    """A recording with them is a run if one with some of them is, by the second definition."""
    random = Random(seed)
    machines = (random_machine(random),)
    while not any(edge.label == "out" for edge in machines[0].edges):
        machines = (random_machine(random),)
    model = tachk.loads(with_anyone(text_of(machines, hidden=False), 1))
    for case in range(6):
        events, end = random_run(random, machines, 8, hidden=False)
        if case % 2:
            events = mutated(random, events, end)
        tolerance, late = random.randrange(2), (random.randrange(3), random.randrange(3))
        uncertain = random.sample(range(len(events)), min(len(events), 4))
        expected = any(
            is_run(machines, [e for n, e in enumerate(events) if n not in left_out], end, tolerance, late, hidden=False)
            for size in range(len(uncertain) + 1)
            for left_out in combinations(uncertain, size)
        )
        system = followed(model, TimestampUncertainty(Fraction(tolerance), *map(Fraction, late)))
        for number, event in enumerate(events):
            system.observe(replace(recorded(event), optional=number in uncertain))
            system.advance(Fraction(event.time))
        found = system.is_as_modelled and system.ends_as_modelled(Fraction(end))
        assert found is expected, f"seed {seed}, case {case}"


@pytest.mark.parametrize("seed", seeds(range(4)))
def test_events_are_allowed_exactly_in_their_windows(seed: int) -> None:
    """With an event within a window it is still a run, with one outside of all windows it is not."""
    random = Random(seed)
    machines = (random_machine(random),)
    while not any(edge.label == "out" for edge in machines[0].edges):
        machines = (random_machine(random),)
    model = tachk.loads(with_anyone(text_of(machines, hidden=False), 1))
    for _ in range(6):
        events, end = random_run(random, machines, random.randint(2, 8), hidden=False)
        system = followed(model, TimestampUncertainty.of(Fraction(0), Fraction(0)))
        for event in events:
            system.observe(recorded(event))
        system.advance(Fraction(end))
        until = end + 5
        allowed = system.allowed(until)
        windows = {(each.name, *each.cells.values()): each.windows for each in allowed.events}
        for time in range(end, until + 1):
            for number in range(3):
                for key in range(KEYS):
                    made = Event(time, 0, "out", key, number)
                    inside = any(low <= time <= high for low, high in windows.get(("out", 0, key, number), ()))
                    assert is_run(machines, [*events, made], time, 0, 0, hidden=False) is inside
            for key in range(KEYS):
                heard = Event(time, 0, "in", key, 0)
                inside = any(low <= time <= high for low, high in windows.get(("in", 0, key), ()))
                assert is_run(machines, [*events, heard], time, 0, 0, hidden=False) is inside
            silent = is_run(machines, events, time, 0, 0, hidden=False)
            assert silent is (time <= allowed.silent_until), "how long nothing may be seen"
