"""A system that is as its model says passes where it is reached late, and seen late, by what a test allows for each."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from fractions import Fraction
from random import Random

import pytest

import tachk
from tachk.engine.options import Limits
from tachk.engine.simulation.policy import Policy
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.conform_file import constants_of
from tachk.recordings.conformance.events import Cell
from tachk.simulation.testing.goals import TestGoal
from tachk.simulation.testing.modelled_system import ModelledSystem
from tachk.simulation.testing.system_adapter import SeenOutput
from tachk.simulation.testing.tester import TestedModel, TestResult, TestSettings, TestVerdict, confirmed, follow
from tests.support.seeds import seeds
from tests.unit.recordings.conformance.small_models import answering_machine, random_machine, text_of
from tests.unit.simulation.testing.test_followed_system import with_anyone

pytestmark = pytest.mark.drawn


class DelayedSystem:
    """A system behind a line: inputs come to it, and its outputs are seen, up to some time later, in their order."""

    def __init__(self, system: ModelledSystem, random: Random, input_late: Fraction, output_late: Fraction) -> None:
        self.system, self.random = system, random
        self.input_late, self.output_late = input_late, output_late
        self.now = Fraction(0)
        self.coming: deque[tuple[Fraction, str, Mapping[str, Cell]]] = deque()
        self.seen: deque[SeenOutput] = deque()
        self.last = {True: Fraction(0), False: Fraction(0)}

    def _later(self, time: Fraction, late: Fraction, is_input: bool) -> Fraction:
        delay = late * self.random.choice((0, 4, self.random.randrange(5))) / 4
        self.last[is_input] = max(self.last[is_input], time + delay)
        return self.last[is_input]

    def start(self) -> None:
        self.system.start()

    def time(self) -> Fraction:
        return self.now

    def send(self, name: str, cells: Mapping[str, Cell]) -> Fraction:
        self.coming.append((self._later(self.now, self.input_late, True), name, cells))
        return self.now

    def next_output(self, until: Fraction) -> SeenOutput | None:
        while True:
            shown = self.seen[0].time if self.seen else until
            arrives = self.coming[0][0] if self.coming else until
            moment = min(until, shown, arrives)
            output = self.system.next_output(moment)
            if output is not None:
                time = self._later(output.time, self.output_late, False)
                self.seen.append(SeenOutput(time, output.name, output.cells))
            elif self.coming and arrives == moment:
                self.system.send(*self.coming.popleft()[1:])
            elif self.seen and shown == moment:
                self.now = shown
                return self.seen.popleft()
            else:
                self.now = until
                return None

    def waited(self) -> Fraction:
        return Fraction(0)

    def close(self) -> None:
        self.system.close()

    def abandon(self) -> None:
        self.system.abandon()


def outcome_of(
    random: Random, model: tachk.Model, used: TimestampUncertainty, allowed: TimestampUncertainty
) -> TestResult:
    mapping, constants = model.loaded.recording, constants_of(model.loaded)
    assert mapping is not None
    prepared = TestedModel.of(model.network, mapping, constants)
    policy = random.choice((Policy.STOCHASTIC, Policy.UNIFORM, Policy.BOUNDARY))
    inner = ModelledSystem(model.network, mapping, constants, random.randrange(1_000), policy)
    system = DelayedSystem(inner, random, used.input_late, used.output_late)
    goal, limits = random.choice(list(TestGoal)), Limits(states=5_000)
    settings = TestSettings(Fraction(15), random.randrange(1_000), allowed, limits=limits, goal=goal)
    return confirmed(prepared, follow(prepared, system, settings, prepared.inputs(settings)))


@pytest.mark.parametrize("seed", seeds(range(8)))
def test_a_delayed_system_passes(seed: int) -> None:
    random = Random(seed)
    machines = (random_machine(random), answering_machine(random))
    model = tachk.loads(with_anyone(text_of(machines, hidden=False), len(machines)))
    for case in range(5):
        latenesses = random.sample((random.randrange(5), random.randrange(3)), 2)
        delays = TimestampUncertainty(Fraction(random.randrange(3)), *map(Fraction, latenesses))
        result = outcome_of(random, model, delays, delays)
        assert result.verdict is not TestVerdict.FAIL, f"seed {seed}, case {case}"
        assert "environment" not in result.reason, f"seed {seed}, case {case}: following and searching differ"


def test_a_delay_that_is_not_allowed_fails() -> None:
    random = Random(2)
    none, long = Fraction(0), Fraction(3)
    delays = TimestampUncertainty(none, long, none), TimestampUncertainty(none, none, long)
    exact = TimestampUncertainty.of(none, none)
    failed = [0, 0]
    for case in range(24):
        machines = (answering_machine(random),)
        model = tachk.loads(with_anyone(text_of(machines, hidden=False), 1))
        failed[case % 2] += outcome_of(random, model, delays[case % 2], exact).verdict is TestVerdict.FAIL
    assert min(failed) > 2
