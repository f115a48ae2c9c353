"""Runs made and judged by the core, against those of the reference meaning of networks."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from random import Random

import numpy as np
import pytest

from tachk import _core
from tachk.engine import zone
from tachk.engine.compiler.lower import lower
from tachk.engine.compiler.program import Goal, Program
from tachk.engine.exact.concretise import requirements_of, timed_trace
from tachk.engine.exact.exact_run import exact_run
from tachk.engine.options import Limits
from tachk.engine.outcome import GoalOutcome, Status
from tachk.engine.program_image import encode
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.replay import ReplayError, replay
from tachk.model.builder import NetworkBuilder
from tachk.model.expressions import Expression
from tachk.model.fault import EvaluationFault
from tachk.model.network import Network
from tests.support import Shape, random_case
from tests.support.seeds import enough, seeds

SHAPE = Shape(clocks=2, locations=3, processes=3, urgent_channels=False, deadlocks=False)


def found_by_the_search(seed: int, shape: Shape) -> tuple[Network, list[tuple[Program, Goal, Expression, GoalOutcome]]]:
    case = random_case(Random(seed), shape)
    program, goals = lower(case.network, case.predicates)
    outcome = zone.explore(program, goals, limits=Limits(states=400))
    found = zip(goals, case.predicates, outcome.goals, strict=True)
    return case.network, [(program, g, p, o) for g, p, o in found if o.status is Status.REACHED]


def accepted_by_reference(
    network: Network, outcome: GoalOutcome, predicate: Expression, moments: list[Fraction]
) -> bool:
    model = prepare(network)
    try:
        states, phases, _ = requirements_of(model, outcome.path or (), predicate)
        durations = [after - before for before, after in pairwise([Fraction(0), *moments])]
        if durations[-1] < 0:  # which `timed_trace` leaves out
            return False
        replay(model, timed_trace(model, states, phases, outcome.path or (), durations), predicate)
    except (ReplayError, EvaluationFault):
        return False
    return True


@pytest.mark.parametrize("shape", [SHAPE, replace(SHAPE, language=True), replace(SHAPE, copies=0.5)])
def test_judges_agree_on_runs_with_other_times(shape: Shape) -> None:
    random = Random(7)
    said = {True: 0, False: 0}
    made = 0
    for seed in seeds(range(40)):
        network, reached = found_by_the_search(seed, shape)
        for program, goal, predicate, outcome in reached:
            path = _core.PathOfRun(encode(program, [goal]), outcome.actions or ())
            moments = [Fraction(random.randrange(6)) for _ in range(len(outcome.path or ()) + 1)]
            earliest = path.earliest()
            if earliest is not None:
                made += 1
                moments = [Fraction(tick, earliest[0]) for tick in earliest[1]]
            for case in range(6):
                changed = list(moments)
                if case:
                    place = random.randrange(len(changed))
                    shift = random.choice((Fraction(1, 2), Fraction(1), Fraction(3)))
                    changed[place:] = [time + shift for time in changed[place:]]
                    if case % 2:
                        changed[place] += random.choice((-shift, Fraction(0), -2 * shift))
                ticks = np.array([int(time * 2**20 * (earliest or (1,))[0]) for time in changed], dtype=np.int64)
                objection = path.objection(2**20 * (earliest or (1,))[0], ticks)
                if objection is not None and objection[1].startswith(("there are", "clocks can stop")):
                    continue
                expected = accepted_by_reference(network, outcome, predicate, changed)
                assert (objection is None) is expected, f"seed {seed}, {objection}"
                said[expected] += 1
    assert enough(min(said.values()) > 25)
    assert enough(made > 25)


@pytest.mark.parametrize(
    ("shape", "why"),
    [
        (replace(SHAPE, urgent_channels=True), "step 0: there are urgent channels"),
        (replace(SHAPE, priorities=True), "step 0: there are priorities"),
        (replace(SHAPE, stopwatches=True), "no times were found"),
    ],
)
def test_core_does_not_judge_what_it_does_not_know(shape: Shape, why: str) -> None:
    """It says so, and then nothing is made of the run."""
    said = set()
    for seed in seeds(range(12)):
        _, reached = found_by_the_search(seed, shape)
        said |= {exact_run(program, goal, outcome.actions or ())[1] for program, goal, _, outcome in reached}
    assert enough(why in said)


@pytest.mark.parametrize("language", [False, True])
def test_what_is_made_is_accepted(language: bool) -> None:
    """Where no transition depends on another one being impossible."""
    made = 0
    for seed in seeds(range(30)):
        shape = replace(SHAPE, clocks_on_broadcast=False, language=language)
        _, reached = found_by_the_search(seed, shape)
        for program, goal, _, outcome in reached:
            moments, objection = exact_run(program, goal, outcome.actions or ())
            assert objection == "", f"seed {seed}"
            made += moments is not None
    assert enough(made > 15)


def test_whoever_can_receive_a_broadcast_does() -> None:
    network = NetworkBuilder()
    call = network.channel("call", broadcast=True)
    speaker, receiver = network.process("Speaker"), network.process("Listener")
    a, b = speaker.location("A"), speaker.location("B")
    c, d = receiver.location("C"), receiver.location("D")
    speaker.edge(a, b, send=call)
    receiver.edge(c, d, receive=call)
    program, (goal,) = lower(network.build(), [b.reached.expression])
    (found,) = zone.explore(program, [goal]).goals
    assert found.actions is not None
    assert exact_run(program, goal, found.actions)[1] == ""
    alone = [edges[:1] for edges in found.actions]
    assert exact_run(program, goal, alone)[1] == "step 1: somebody who can receive a broadcast stays out"
    assert exact_run(program, goal, [list(reversed(edges)) for edges in found.actions])[1] == "step 1: nobody sends"


def test_no_run_waits_beyond_an_invariant() -> None:
    """The first step must come late, though nothing asks for it when it is made."""
    network = NetworkBuilder()
    process = network.process("P")
    old, young = process.clock("old"), process.clock("young")
    a, b, c = process.location("A"), process.location("B", invariant=young <= 3), process.location("C")
    process.edge(a, b, updates=[young.assign(0)])
    process.edge(b, c, guard=old >= 5)
    program, (goal,) = lower(network.build(), [c.reached.expression])
    (found,) = zone.explore(program, [goal]).goals
    assert found.actions is not None
    moments, objection = exact_run(program, goal, found.actions)
    assert objection == ""
    assert moments is not None


@pytest.mark.parametrize(("moment", "accepted"), [(1, False), (2, False), (3, True), (4, True), (5, False)])
def test_strict_bounds_are_strict(moment: int, accepted: bool) -> None:
    network = NetworkBuilder()
    process = network.process("P")
    clock = process.clock("x")
    a, b = process.location("A"), process.location("B")
    process.edge(a, b, guard=(clock > 2) & (clock < 5))
    program, (goal,) = lower(network.build(), [b.reached.expression])
    (found,) = zone.explore(program, [goal]).goals
    path = _core.PathOfRun(encode(program, [goal]), found.actions or ())
    assert (path.objection(1, np.array([moment, moment], dtype=np.int64)) is None) is accepted


def test_a_copy_counts_from_when_its_source_was_set() -> None:
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    process = network.process("P")
    a, b, c = (process.location(name) for name in "ABC")
    process.edge(a, b, guard=x >= 3, updates=[y.assign(x)])
    process.edge(b, c, guard=(y >= 4) & (y <= 5))
    program, (goal,) = lower(network.build(), [c.reached.expression])
    moments, why = exact_run(program, goal, [[0], [1]])
    assert moments is not None, why
    assert [moments[0], moments[1]] == [3, 4]
