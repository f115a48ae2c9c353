"""Transformations of random networks: their runs as those of the original, and what their answers are worth."""

from __future__ import annotations

from random import Random

import pytest

from tachk.base.span import NOWHERE
from tachk.engine.compiler.lower import lower, lower_obligation
from tachk.engine.liveness import find_avoiding_run
from tachk.engine.options import Limits
from tachk.engine.outcome import LivenessStatus, Status
from tachk.engine.zone import explore
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.replay import replay
from tachk.model.fault import RuntimeErrorKind
from tachk.model.run import RunTimeFault, TimedTrace
from tachk.model.traversal import asks_deadlock
from tachk.transform.transformation import Exactness, Transformation
from tests.support import RandomCase, Shape, random_case
from tests.support.seeds import enough, seeds
from tests.support.transformations import TRANSFORMATIONS, random_run

pytestmark = pytest.mark.drawn

SHAPES = (
    Shape(processes=2, locations=3, clocks=2, constant=3),
    Shape(processes=2, locations=3, clocks=1, receivers=1, blockers=1, deadlocks=False),
    Shape(processes=2, locations=3, clocks=2, priorities=True, receivers=1),
    Shape(processes=2, locations=3, clocks=1, language=True, receivers=1, blockers=1, hurried=0.4),
)
LIMITS = Limits(states=2_000)


def drawn(seed: int) -> tuple[Random, RandomCase]:
    random = Random(seed)
    return random, random_case(random, SHAPES[seed % len(SHAPES)])


def is_lifted(transformation: Transformation, run: TimedTrace) -> bool:
    """Whether a run has one of the original, which is replayed, with its path as a run-time error has it."""
    lifted = transformation.lift(run)
    if lifted is None:
        return False
    replay(prepare(transformation.original), lifted)
    assert lifted.states[-1].time == run.states[-1].time
    fault = RunTimeFault(RuntimeErrorKind.RANGE, NOWHERE, run.path, None, run=run)
    failed = transformation.lift_fault(fault)
    assert failed.run == lifted
    acting = zip(failed.path, lifted.path, strict=True)
    assert all(set(one.participants) <= set(other.participants) for one, other in acting)
    return True


@pytest.mark.parametrize("name", TRANSFORMATIONS)
def test_a_run_is_one_of_the_original(name: str) -> None:
    found = 0
    for seed in seeds(range(40)):
        random, case = drawn(seed)
        transformation = TRANSFORMATIONS[name](random, case.network, case.predicates[0])
        if transformation is None:
            continue
        assert transformation.original is case.network
        for _ in range(3):
            run = random_run(random, transformation.network)
            if run is not None:
                lifts = is_lifted(transformation, run)
                assert lifts or Exactness.REACHABLE not in transformation.exactness, f"seed {seed}"
                found += lifts and bool(run.path)
    assert enough(found > 5)


@pytest.mark.parametrize("second", TRANSFORMATIONS)
def test_transformations_compose(second: str) -> None:
    found = 0
    for seed in seeds(range(40)):
        random, case = drawn(seed)
        first = random.choice(list(TRANSFORMATIONS))
        target = case.predicates[0]
        one = TRANSFORMATIONS[first](random, case.network, target)
        other = None if one is None else TRANSFORMATIONS[second](random, one.network, target)
        if one is None or other is None:
            continue
        both = one.then(other)
        assert (both.original, both.network) == (case.network, other.network)
        assert both.exactness == one.exactness & other.exactness
        run = random_run(random, both.network)
        if run is not None:
            lifts = is_lifted(both, run)
            assert lifts or Exactness.REACHABLE not in both.exactness, f"seed {seed}: {first}"
            found += lifts
    assert enough(found > 2)


@pytest.mark.parametrize("name", TRANSFORMATIONS)
def test_answers_are_worth_what_is_said(name: str) -> None:
    compared = 0
    for seed in seeds(range(30)):
        random, case = drawn(seed)
        target = case.predicates[0]
        transformation = TRANSFORMATIONS[name](random, case.network, target)
        if transformation is None or asks_deadlock(target):
            continue
        pairs = (transformation.original, transformation.network)
        before, after = (explore(*lower(each, [target]), limits=LIMITS).goals[0].status for each in pairs)
        if Status.UNDECIDED in (before, after):
            continue
        compared += 1
        if Exactness.REACHABLE in transformation.exactness and after is Status.REACHED:
            assert before is Status.REACHED, f"seed {seed}"
        if Exactness.UNREACHABLE in transformation.exactness and after is Status.UNREACHABLE:
            assert before is Status.UNREACHABLE, f"seed {seed}"
        if Exactness.INFINITE_RUNS in transformation.exactness:
            lowered = (lower_obligation(each, target, None) for each in pairs)
            found = {find_avoiding_run(*each, limits=LIMITS).status for each in lowered}
            assert len(found - {LivenessStatus.UNDECIDED}) <= 1, f"seed {seed}"
    assert enough(compared > 3)
