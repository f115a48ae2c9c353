"""Tests that a property gives the goal: they lead there, and the report says so."""

from __future__ import annotations

from fractions import Fraction
from random import Random

import pytest

import tachk
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.engine.options import Limits
from tachk.engine.simulation.policy import Policy
from tachk.model.timestamp_uncertainty import TimestampUncertainty
from tachk.recordings.conformance.conform import Conformance, ConformingRun, conform
from tachk.recordings.conformance.conform_file import constants_of
from tachk.simulation.testing.modelled_system import ModelledSystem
from tachk.simulation.testing.tested_model import TestRequest, run_test_of_model
from tachk.simulation.testing.tester import TestedModel, TestResult, TestSettings, TestVerdict, confirmed, follow
from tachk.verify.property_goal import property_goal
from tests.support.seeds import enough, seeds
from tests.unit.recordings.conformance.small_models import random_machine, text_of
from tests.unit.simulation.testing.test_followed_system import with_anyone
from tests.unit.simulation.testing.test_tester import LOCK

PROPERTIES = """
property shut : A[] !Lock.L3;
property last_moment : E<> Lock.L3 && Lock.x >= 5;
property beyond : E<> Lock.L3 && Lock.x > 5;
property stops : E<> deadlock;
property again : Lock.L1 --> Lock.L0;
property soon : G (Lock.L0 -> F[0, 300] Lock.L2);
"""
LIMITS = Limits(states=10_000)


def enters(model: tachk.Model, found: Conformance, target: int, until: Fraction) -> bool:
    """Whether the first machine enters a location up to a moment, in the run that was found for the recording."""
    if target == model.network.processes[0].initial:
        return True
    for run in found.runs:
        assert isinstance(run, ConformingRun) and run.moments is not None
        for transition, moment in zip(run.path, run.moments, strict=False):
            lifted = run.product.lift_transition(transition)
            for participant in () if lifted is None else lifted.participants:
                edge = model.network.processes[participant.process].edges[participant.edge]
                if participant.process == 0 and edge.target == target and moment <= until:
                    return True
    return False


def outcome(goal: str, seed: int, system: str = LOCK) -> TestResult:
    model = tachk.loads(LOCK + PROPERTIES).loaded
    request = TestRequest(tachk.loads(system).loaded, "5s", seed, goal=property_goal(model, "lock", goal, LIMITS))
    return run_test_of_model(model, "lock", request, LIMITS)[0]


@pytest.mark.parametrize("goal", ["shut", "last_moment"])
def test_the_lock_is_opened(goal: str) -> None:
    for seed in range(4):
        result = outcome(goal, seed)
        assert result.verdict is TestVerdict.PASS
        opened = [event.time for event in result.recording.events if event.name == "opens"]
        assert opened and result.reached is not None
        if goal == "shut":
            assert result.reached <= opened[0] + 1


def test_a_formula_is_violated() -> None:
    """Nothing opens the lock for 300 ms, which random inputs do not do either; the run has the time for it."""
    result = outcome("soon", 1)
    assert result.verdict is TestVerdict.PASS and result.reached is not None and result.reached >= 300


def test_a_system_that_cannot_go_there_does_not_reach_it() -> None:
    """The third key of this lock does nothing: that is no fault that shows before the lock should open."""
    broken = LOCK.replace("to L3 { guard x >= 90 && x <= 91; sync key[3]?; assign x = 0; } ", "")
    result = outcome("last_moment", 1, broken)
    assert result.verdict is TestVerdict.FAIL


@pytest.mark.parametrize(
    ("goal", "message"),
    [
        ("beyond", "no run of it leads"),
        ("stops", "decided by no single state"),
        ("again", "decided by no single state"),
        ("open", "has no property 'open'"),
    ],
)
def test_a_goal_has_to_be_one(goal: str, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        outcome(goal, 0)


@pytest.mark.drawn
def test_what_the_run_of_a_recording_reaches_is_reached() -> None:
    """The search of `tachk conform` finds a run of the recording by itself. Where it enters the location early enough
    to be followed, the test says that the system may have been there."""
    entered = 0
    for seed in seeds(range(12)):
        random = Random(seed)
        machine = random_machine(random)
        while not any(edge.label == "out" for edge in machine.edges):
            machine = random_machine(random)
        target = random.randrange(len(machine.invariants))
        text = with_anyone(text_of((machine,), hidden=False), 1) + f"property there : E<> M0.L{target};"
        model = tachk.loads(text)
        try:
            goal = property_goal(model.loaded, "model", "there", LIMITS)
        except UsageError:
            continue
        mapping, constants = model.loaded.recording, constants_of(model.loaded)
        assert mapping is not None
        tested = TestedModel.of(model.network, mapping, constants, goal.query)
        for case in range(3):
            late = Fraction(random.randrange(3))
            exact = TimestampUncertainty.of(Fraction(0), late)
            settings = TestSettings(Fraction(20), case, exact, limits=LIMITS, goal=goal)
            system = ModelledSystem(model.network, mapping, constants, case, Policy.BOUNDARY)
            run = follow(tested, system, settings, tested.inputs(settings))
            result = confirmed(tested, run)
            assert result.verdict is not TestVerdict.FAIL, (seed, case)
            if result.verdict is TestVerdict.PASS:
                found = conform(model.network, mapping, run.recording, constants, exact)
                if enters(model, found, target, run.recording.end - late - 1):
                    entered += 1
                    assert result.reached is not None, (seed, case)
    assert enough(entered)
