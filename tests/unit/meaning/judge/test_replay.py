"""The judge accepts a right run and finds each kind of wrong one."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from tachk.meaning.discrete import prepare
from tachk.meaning.judge.replay import ReplayError, replay
from tachk.model.builder import NetworkBuilder, deadlock
from tachk.model.run import DiscreteState, Participant, TimedState, TimedStep, TimedTrace, Transition

GO = Transition((Participant(0, 0),))


def lamp() -> NetworkBuilder:
    """From A to B at 2 <= x <= 4, at the latest at 5; setting y to 0 and n to 1."""
    network = NetworkBuilder()
    x, y, n = network.clock("x"), network.clock("y"), network.integer("n", 0, 3)
    process = network.process("P")
    a, b = process.location("A", invariant=x <= 5), process.location("B")
    process.edge(a, b, guard=(x >= 2) & (x <= 4), updates=[y.assign(0), n.assign(1)])
    return network


def state(location: int, n: int, x: Fraction | int, y: Fraction | int, time: Fraction | int) -> TimedState:
    return TimedState(DiscreteState((location,), (1, 2, n)), (Fraction(x), Fraction(y)), Fraction(time))


def run(delay: Fraction | int = Fraction(5, 2)) -> TimedTrace:
    step = TimedStep(Fraction(delay), GO, state(1, 1, delay, 0, delay))
    return TimedTrace(state(0, 0, 0, 0, 0), (step,))


def test_a_right_run_is_accepted() -> None:
    network = lamp().build()
    replay(prepare(network), run())
    rest = TimedStep(Fraction(1), None, state(1, 1, Fraction(7, 2), 1, Fraction(7, 2)))
    replay(prepare(network), replace(run(), steps=(*run().steps, rest)))


@pytest.mark.parametrize("delay", [Fraction(1), Fraction(9, 2)])
def test_a_transition_whose_guard_is_false_is_rejected(delay: Fraction) -> None:
    with pytest.raises(ReplayError, match="not enabled") as caught:
        replay(prepare(lamp().build()), run(delay))
    assert caught.value.step == 1


def test_a_delay_beyond_the_invariant_is_rejected() -> None:
    with pytest.raises(ReplayError, match="invariant"):
        replay(prepare(lamp().build()), run(6))


def test_a_negative_delay_is_rejected() -> None:
    with pytest.raises(ReplayError, match="negative"):
        replay(prepare(lamp().build()), run(-1))


@pytest.mark.parametrize(
    "wrong",
    [
        state(1, 1, 3, 0, Fraction(5, 2)),
        state(1, 1, Fraction(5, 2), 1, Fraction(5, 2)),
        state(1, 1, Fraction(5, 2), 0, 9),
        state(1, 2, Fraction(5, 2), 0, Fraction(5, 2)),
        state(0, 1, Fraction(5, 2), 0, Fraction(5, 2)),
    ],
)
def test_a_state_that_is_not_the_computed_one_is_rejected(wrong: TimedState) -> None:
    (step,) = run().steps
    with pytest.raises(ReplayError, match="differ"):
        replay(prepare(lamp().build()), replace(run(), steps=(replace(step, state=wrong),)))


def test_a_wrong_initial_state_is_rejected() -> None:
    with pytest.raises(ReplayError) as caught:
        replay(prepare(lamp().build()), replace(run(), initial=state(0, 1, 0, 0, 0)))
    assert caught.value.step == 0


def test_the_predicate_must_hold_in_the_last_state() -> None:
    network = lamp()
    replay(prepare(network.build()), run(), deadlock().expression)
    with pytest.raises(ReplayError, match="predicate"):
        replay(prepare(network.build()), run(), (~deadlock()).expression)


def test_a_transition_of_lower_priority_is_rejected_while_a_higher_one_is_possible() -> None:
    network = NetworkBuilder()
    low, high = network.process("Low"), network.process("High", priority=1)
    a = low.location("A")
    low.edge(a, a)
    b = high.location("B")
    high.edge(b, b)
    start = TimedState(DiscreteState((0, 0), ()), (), Fraction(0))
    with pytest.raises(ReplayError, match="not enabled"):
        replay(prepare(network.build()), TimedTrace(start, (TimedStep(Fraction(0), GO, start),)))
    higher = Transition((Participant(1, 0),))
    replay(prepare(network.build()), TimedTrace(start, (TimedStep(Fraction(0), higher, start),)))


def test_an_update_that_goes_wrong_is_no_matter_where_it_could_block_nothing() -> None:
    network = NetworkBuilder()
    low, high = network.process("Low"), network.process("High", priority=1)
    n = network.integer("n", 0, 3)
    a = low.location("A")
    low.edge(a, a, updates=[n.assign(4)])
    b = high.location("B")
    high.edge(b, b)
    high.edge(b, b, updates=[n.assign(5)])
    start = TimedState(DiscreteState((0, 0), (0,)), (), Fraction(0))
    fine, wrong = (Transition((Participant(1, edge),)) for edge in range(2))
    replay(prepare(network.build()), TimedTrace(start, (TimedStep(Fraction(0), fine, start),)))
    with pytest.raises(ReplayError, match="RANGE"):
        replay(prepare(network.build()), TimedTrace(start, (TimedStep(Fraction(0), wrong, start),)))


def test_an_update_that_goes_wrong_is_rejected() -> None:
    network = NetworkBuilder()
    n = network.integer("n", 0, 3)
    process = network.process("P")
    a = process.location("A")
    process.edge(a, a, updates=[n.assign(4)])
    start = TimedState(DiscreteState((0,), (0,)), (), Fraction(0))
    with pytest.raises(ReplayError, match="RANGE"):
        replay(prepare(network.build()), TimedTrace(start, (TimedStep(Fraction(0), GO, start),)))


@pytest.mark.parametrize("wait", [1, 2])
def test_a_step_into_a_violated_invariant_is_rejected(wait: int) -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    process = network.process("P")
    process.edge(process.location("A"), process.location("B", invariant=x <= 1))
    start = TimedState(DiscreteState((0,), (1,)), (Fraction(0),), Fraction(0))
    end = TimedState(DiscreteState((1,), (1,)), (Fraction(wait),), Fraction(wait))
    trace = TimedTrace(start, (TimedStep(Fraction(wait), GO, end),))
    if wait <= 1:
        replay(prepare(network.build()), trace)
    else:
        with pytest.raises(ReplayError, match="invariant"):
            replay(prepare(network.build()), trace)
