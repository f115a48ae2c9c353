"""From runs that avoid a goal to runs with delays, judged by replay; and what the judge does not accept."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from random import Random

import pytest

from tachk.engine.exact.concretise import concretise
from tachk.engine.lasso import lasso
from tachk.engine.options import Limits
from tachk.engine.outcome import AvoidingRun, Obligation, RunEnd
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.replay import ReplayError
from tachk.meaning.judge.replay_lasso import replay_lasso
from tachk.meaning.step import initial_state
from tachk.model.builder import NetworkBuilder, Term, deadlock
from tachk.model.run import Ending, Participant, TimedTrace, Transition
from tests.support import Shape, random_case
from tests.support.obligations import random_obligations
from tests.support.oracles.liveness_reference import check_by_zones
from tests.support.seeds import enough, seeds

Step = Transition


def step(edge: int) -> Step:
    """The internal transition by an edge of the only process."""
    return Transition((Participant(0, edge),))


def found(network: NetworkBuilder, run: AvoidingRun, goal: Term, trigger: Term | None = None) -> TimedTrace | None:
    """The run with delays; judged, if there is one."""
    model = prepare(network.build())
    obligation = Obligation(goal.expression, None if trigger is None else trigger.expression)
    trace = lasso(model, run, obligation)
    if trace is not None:
        replay_lasso(model, trace, obligation.goal, obligation.trigger)
    return trace


def circle(guard: Callable[[Term, Term], Term], invariant: Callable[[Term, Term], Term] | None = None):  # type: ignore[no-untyped-def]
    """A location that an edge leaves for itself, resetting x and not y; and a second one, which is the goal."""
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    process = network.process("P")
    a, b = process.location("A", invariant=None if invariant is None else invariant(x, y)), process.location("B")
    process.edge(a, a, guard=guard(x, y), updates=[x.assign(0)])
    process.edge(a, b, guard=x >= 3, updates=[y.assign(0)])
    return network, b.reached


LOOP = AvoidingRun(RunEnd.LOOP, (), 0, (step(0),))


def test_a_loop_is_taken_with_the_same_delays_in_every_round() -> None:
    network, goal = circle(lambda x, y: x >= 2)
    trace = found(network, LOOP, goal)
    assert trace is not None and trace.ending is Ending.PERIODIC and trace.loop_start is not None
    assert [s.delay for s in trace.steps[trace.loop_start :]] == [2]


def test_a_loop_that_can_take_time_takes_time() -> None:
    network, goal = circle(lambda x, y: x <= 2)
    trace = found(network, LOOP, goal)
    assert trace is not None and trace.ending is Ending.PERIODIC
    assert trace.steps[-1].delay >= 1


def test_a_loop_that_no_time_may_pass_in_takes_none() -> None:
    network, goal = circle(lambda x, y: y <= 2, lambda x, y: y <= 2)
    trace = found(network, LOOP, goal)
    assert trace is not None and trace.ending is Ending.PERIODIC
    assert trace.steps[-1].delay == 0


def test_a_loop_returns_by_a_copy_of_a_clock_that_stood_still() -> None:
    network = NetworkBuilder()
    x, y, s = (network.clock(name) for name in "xys")
    process = network.process("P")
    a, b = process.location("A", rates=[(s, 0)]), process.location("B", rates=[(y, 0)])
    process.edge(a, b, guard=x >= 3, updates=[y.assign(s), x.assign(0)])
    process.edge(b, a, guard=s >= 2, updates=[s.assign(y), x.assign(0)])
    trace = found(network, AvoidingRun(RunEnd.LOOP, (), 0, (step(0), step(1))), s > 2)
    assert trace is not None and trace.ending is Ending.PERIODIC and trace.loop_start is not None
    stands, runs = (step.delay for step in trace.steps[trace.loop_start :])
    assert stands >= 3 and runs == 2


def test_rounds_that_differ_come_before_the_loop() -> None:
    network, goal = circle(lambda x, y: y > 5)
    trace = found(network, LOOP, goal)
    assert trace is not None and trace.ending is Ending.PERIODIC and trace.loop_start == 1
    assert trace.initial.clocks[1] == 0 and trace.states[1].clocks[1] > 5


def test_delays_that_must_grow_shorter_and_shorter_recur_without_a_period() -> None:
    network, goal = circle(lambda x, y: x > 0, lambda x, y: y < 2)
    trace = found(network, LOOP, goal)
    assert trace is not None and trace.ending is Ending.RECURRENT
    assert 0 < trace.steps[-1].delay < 2


def test_a_loop_that_ends_after_some_rounds_is_none() -> None:
    network, goal = circle(lambda x, y: x >= 1, lambda x, y: y <= 4)
    assert found(network, LOOP, goal) is None


def test_a_period_may_be_no_multiple_of_a_half() -> None:
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    process = network.process("P")
    a = process.location("A")
    b = process.location("B")
    for source, target in ((a, b), (b, a)):
        process.edge(source, target, guard=(x > 0) & (x < 1), updates=[x.assign(0)])
    process.edge(a, a, guard=(x > 0) & (y < 1), updates=[x.assign(0), y.assign(0)])
    run = AvoidingRun(RunEnd.LOOP, (), 0, (step(0), step(1), step(2)))
    trace = found(network, run, y >= 2)
    assert trace is not None and trace.ending is Ending.PERIODIC


def test_the_goal_is_not_met_during_the_delays_of_a_loop() -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    process = network.process("P")
    a = process.location("A")
    process.edge(a, a, guard=x >= 2, updates=[x.assign(0)])
    trace = found(network, LOOP, x == 3)
    assert trace is not None and trace.steps[-1].delay < 3
    assert found(network, LOOP, x == 1) is None
    assert found(network, LOOP, (x > 1) & (x < 2)) is None


def test_an_idle_run_ends_where_time_cannot_meet_the_goal_any_more() -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    process = network.process("P")
    a, b = process.location("A"), process.location("B")
    process.edge(a, b, updates=[x.assign(4)])
    trace = found(network, AvoidingRun(RunEnd.IDLE, (step(0),), 0), x == 3)
    assert trace is not None and trace.ending is Ending.IDLE
    assert found(network, AvoidingRun(RunEnd.IDLE, (), 0), x == 3) is None


def test_a_stuck_run_waits_until_nothing_is_possible_any_more() -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    process = network.process("P")
    a, b = process.location("A", invariant=x <= 5), process.location("B")
    process.edge(a, b, guard=x <= 3)
    trace = found(network, AvoidingRun(RunEnd.STUCK, (), 0), b.reached)
    assert trace is not None and trace.ending is Ending.STUCK
    assert trace.states[-1].time > 3


def test_the_trigger_may_come_to_hold_during_a_delay() -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    process = network.process("P")
    a, b = process.location("A"), process.location("B")
    process.edge(a, b, guard=x >= 1)
    process.edge(b, a, guard=x >= 5)
    # True before, the goal is false from 4 on.
    trace = found(network, AvoidingRun(RunEnd.IDLE, (), 0), x < 4, trigger=(x >= 2) & (x <= 4))
    assert trace is not None and trace.states[-1].time >= 4
    assert found(network, AvoidingRun(RunEnd.IDLE, (), 0), x < 4, trigger=x <= 3) is None
    loop = AvoidingRun(RunEnd.LOOP, (step(0),), 1, (step(1), step(0)))
    trace = found(network, loop, x < 4, trigger=x == 7)
    assert trace is not None and trace.ending is Ending.PERIODIC


def test_deadlock_may_be_what_is_avoided() -> None:
    network, _ = circle(lambda x, y: x >= 1)
    trace = found(network, LOOP, deadlock())
    assert trace is not None and trace.ending is Ending.PERIODIC


def test_the_judge_knows_what_ends_idling() -> None:
    network = NetworkBuilder()
    x, hurry = network.clock("x"), network.channel("hurry", urgent=True)
    sender, receiver = network.process("S"), network.process("R")
    a, c = sender.location("A"), receiver.location("C")
    sender.edge(a, a, send=hurry)
    receiver.edge(c, c, receive=hurry)
    model = prepare(network.build())
    start = initial_state(model)
    with pytest.raises(ReplayError, match="time cannot pass for ever"):
        replay_lasso(model, TimedTrace(start, (), Ending.IDLE), (x > 3).expression, None)
    with pytest.raises(ReplayError, match="still possible"):
        replay_lasso(model, TimedTrace(start, (), Ending.STUCK), (x > 3).expression, None)


def test_the_judge_looks_at_the_goal_during_delays() -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    process = network.process("P")
    a = process.location("A")
    process.edge(a, a, guard=x >= 2, updates=[x.assign(0)])
    trace = found(network, LOOP, x > 9)
    assert trace is not None
    for moment in (x == 1, (x > 1) & (x < 2)):
        with pytest.raises(ReplayError, match="meets the goal"):
            replay_lasso(prepare(network.build()), trace, moment.expression, None)


def test_a_loop_that_recurs_from_elsewhere_does_not_recur_from_here() -> None:
    network = NetworkBuilder()
    x, z = network.clock("x"), network.clock("z")
    process = network.process("P")
    a, b = process.location("A", invariant=x <= 1), process.location("B")
    process.edge(a, a, guard=(x >= 1) & ((z <= 1) | (z >= 5)), updates=[x.assign(0)])
    model = prepare(network.build())
    once = concretise(model, LOOP.loop)
    assert once is not None and once.states[-1].time == 1
    with pytest.raises(ReplayError, match="again and again"):
        replay_lasso(model, replace(once, ending=Ending.RECURRENT, loop_start=0), b.reached.expression, None)


def test_a_loop_that_has_to_take_time_takes_some() -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    process = network.process("P")
    a, b = process.location("A"), process.location("B")
    process.edge(a, a, updates=[x.assign(0)])
    model = prepare(network.build())
    once = concretise(model, LOOP.loop)
    assert once is not None and once.states[-1].time == 0
    still = replace(once, ending=Ending.PERIODIC, loop_start=0)
    replay_lasso(model, still, b.reached.expression, None)
    with pytest.raises(ReplayError, match="takes no time"):
        replay_lasso(model, still, b.reached.expression, None, diverges=True)
    taking = found(network, LOOP, b.reached)
    assert taking is not None
    replay_lasso(model, taking, b.reached.expression, None, diverges=True)


def test_a_loop_meets_what_it_has_to_meet_and_a_run_ends_where_it_may() -> None:
    network = NetworkBuilder()
    process = network.process("P")
    a, b, c = process.location("A"), process.location("B"), process.location("C")
    process.edge(a, b)
    process.edge(b, b)
    model = prepare(network.build())
    trace = found(network, AvoidingRun(RunEnd.LOOP, (step(0),), 0, (step(1),)), c.reached)
    assert trace is not None
    never = c.reached.expression
    replay_lasso(model, trace, never, None, again=[b.reached.expression])
    with pytest.raises(ReplayError, match="has to meet again and again"):
        replay_lasso(model, trace, never, None, again=[b.reached.expression, a.reached.expression])
    waiting = found(network, AvoidingRun(RunEnd.IDLE, (step(0),), 0), c.reached)
    assert waiting is not None
    replay_lasso(model, waiting, never, None, ends=b.reached.expression)
    with pytest.raises(ReplayError, match="ends where it may not"):
        replay_lasso(model, waiting, never, None, ends=a.reached.expression)


def _tampered(trace: TimedTrace) -> dict[str, TimedTrace]:
    """Lies about a periodic run."""
    last = trace.steps[-1]
    early = replace(last, delay=last.delay - Fraction(1, 4))
    return {
        "it says nothing of its end": replace(trace, ending=Ending.OPEN),
        "it says that time passes for ever": replace(trace, ending=Ending.IDLE, loop_start=None),
        "it says that it is stuck": replace(trace, ending=Ending.STUCK, loop_start=None),
        "it has no loop": replace(trace, loop_start=None),
        "its loop is empty": replace(trace, loop_start=len(trace.steps)),
        "a delay is another": replace(trace, steps=(*trace.steps[:-1], early)),
        "its last step is missing": replace(trace, steps=trace.steps[:-1]),
    }


def test_the_judge_accepts_no_tampered_run() -> None:
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    process = network.process("P")
    a, b = process.location("A", invariant=x <= 4), process.location("B", invariant=y <= 2)
    process.edge(a, b, guard=x >= 3, updates=[y.assign(0)])
    process.edge(b, a, guard=y >= 2, updates=[x.assign(0)])
    model = prepare(network.build())
    obligation = Obligation((x > 10).expression)
    trace = lasso(model, AvoidingRun(RunEnd.LOOP, (), 0, (step(0), step(1))), obligation)
    assert trace is not None
    replay_lasso(model, trace, obligation.goal, None)
    for wrong in _tampered(trace).values():
        with pytest.raises(ReplayError):
            replay_lasso(model, wrong, obligation.goal, None)
    with pytest.raises(ReplayError, match="meets the goal"):
        replay_lasso(model, trace, (x > 2).expression, None)
    with pytest.raises(ReplayError, match=r"trigger|never"):
        replay_lasso(model, trace, obligation.goal, (x > 20).expression)


def test_the_judge_wants_the_clocks_that_count_to_return() -> None:
    network, goal = circle(lambda x, y: x >= 1, lambda x, y: y <= 9)
    model = prepare(network.build())
    bounded = lasso(model, AvoidingRun(RunEnd.IDLE, (), 0), Obligation(goal.expression))
    assert bounded is None
    unbounded, _ = circle(lambda x, y: x >= 1)
    trace = lasso(prepare(unbounded.build()), LOOP, Obligation(goal.expression))
    assert trace is not None
    for ending in (Ending.PERIODIC, Ending.RECURRENT):
        with pytest.raises(ReplayError, match=r"return|again"):
            replay_lasso(model, replace(trace, ending=ending), goal.expression, None)


@pytest.mark.parametrize(
    "shape",
    [
        Shape(clocks=2),
        Shape(clocks=2, copies=0.5),
        Shape(clocks=2, priorities=True, diagonals=True, constant=2),
        Shape(language=True, exact=0.3, processes=2, locations=3, clocks=2, constant=3),
    ],
)
def test_every_run_of_the_oracle_becomes_one_that_is_accepted(shape: Shape) -> None:
    endings = set()
    for seed in seeds(range(12)):
        case = random_case(Random(seed), shape)
        model = prepare(case.network)
        for obligation in random_obligations(Random(seed), case):
            run = check_by_zones(case.network, obligation, Limits(states=200)).run
            if run is None:
                continue
            trace = lasso(model, run, obligation)
            assert trace is not None, f"seed {seed}"
            replay_lasso(model, trace, obligation.goal, obligation.trigger)
            endings.add(trace.ending)
    assert enough(len(endings) > 1)
