"""When time may pass: delays, urgency, invariants, stopwatches, deadlock."""

from __future__ import annotations

from fractions import Fraction

import pytest

from tachk.engine import zone
from tachk.engine.compiler.lower import lower
from tachk.engine.exact.concretise import concretise
from tachk.engine.outcome import Status
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.replay import replay
from tachk.meaning.step import StepError, deadlocked, delay, initial_state
from tachk.model.builder import NetworkBuilder, deadlock
from tests.support.oracles import digitised, reference


def test_runs_start_in_the_initial_locations_with_initial_values_and_clocks_at_zero() -> None:
    network = NetworkBuilder()
    network.clock("x")
    network.integer("n", 2, 5, initial=3)
    process = network.process("P")
    process.location("A")
    b = process.location("B")
    process.starts_in(b)
    state = initial_state(prepare(network.build()))
    assert state.discrete.locations == (1,)
    assert state.discrete.values == (1, 3)
    assert state.clocks == (0,)


def test_a_violated_invariant_in_the_initial_state_is_an_error() -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    network.process("P").location("A", invariant=x >= 1)
    with pytest.raises(StepError, match="initial"):
        initial_state(prepare(network.build()))
    with pytest.raises(ValueError, match="initial"):
        reference.explore(network.build(), [])


def test_an_invariant_bounds_delays(reaches) -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    here = network.process("P").location("A", invariant=x <= 3)
    assert reaches(network, here.reached & (x == 3))
    assert not reaches(network, here.reached & (x > 3))


def test_a_strict_invariant_excludes_its_bound(reaches) -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    network.process("P").location("A", invariant=x < 3)
    assert reaches(network, x > 2)
    assert not reaches(network, x >= 3)


@pytest.mark.parametrize("kind", ["urgent", "committed"])
def test_time_stands_still_in_urgent_and_committed_locations(reaches, kind: str) -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    process = network.process("P")
    a, b = process.location("A"), process.location("B", **{kind: True})
    process.edge(a, b, guard=x >= 2, updates=[x.assign(0)])
    assert reaches(network, b.reached & (x == 0))
    assert not reaches(network, b.reached & (x > 0))


def test_an_urgent_location_lets_others_act_but_no_time_pass(reaches) -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    p, q = network.process("P"), network.process("Q")
    p.location("A", urgent=True)
    a, b = q.location("A"), q.location("B")
    q.edge(a, b)
    assert reaches(network, b.reached)
    assert not reaches(network, b.reached & (x > 0))


def urgent_pair(broadcast: bool = False, partner: bool = True) -> tuple[NetworkBuilder, object, object]:
    network = NetworkBuilder()
    x = network.clock("x")
    go = network.channel("go", broadcast=broadcast, urgent=True)
    p, q = network.process("P"), network.process("Q")
    a, b = p.location("A"), p.location("B")
    p.edge(a, b, send=go)
    c, d = q.location("C"), q.location("D")
    if partner:
        q.edge(c, d, receive=go)
    return network, a, x


def test_time_stops_while_an_urgent_synchronisation_is_enabled(reaches) -> None:
    network, before, x = urgent_pair()
    assert not reaches(network, before.reached & (x > 0))


def test_an_urgent_sender_without_a_partner_does_not_stop_time(reaches) -> None:
    network, before, x = urgent_pair(partner=False)
    assert reaches(network, before.reached & (x > 5))


def test_an_urgent_broadcast_needs_no_partner_to_stop_time(reaches) -> None:
    network, before, x = urgent_pair(broadcast=True, partner=False)
    assert not reaches(network, before.reached & (x > 0))


def test_a_clock_guard_on_an_urgent_channel_stops_time_from_the_moment_it_holds() -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    weak, strict = network.channel("weak", True, True), network.channel("strict", True, True)
    p, q = network.process("P"), network.process("Q")
    a, b = p.location("A"), p.location("B")
    p.edge(a, b, guard=(x >= 2) & (x <= 3), send=weak)
    c = q.location("C")
    q.edge(c, c, guard=x > 4, send=strict)
    goals = [(a.reached & (x == 2)).expression, (a.reached & (x > 2)).expression]
    goals += [(b.reached & (x > 2)).expression]
    for outcome in (reference.explore(network.build(), goals), digitised.explore_regions(network.build(), goals)):
        assert [g.status for g in outcome.goals] == [Status.REACHED, Status.UNREACHABLE, Status.REACHED]
    later = [(b.reached & (x == 4)).expression, (b.reached & (x > 4)).expression]
    for outcome in (reference.explore(network.build(), later), digitised.explore_regions(network.build(), later)):
        assert [g.status for g in outcome.goals] == [Status.REACHED, Status.UNREACHABLE]


def test_delays_before_an_urgent_synchronisation_pass_only_up_to_it() -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    go = network.channel("go", broadcast=True, urgent=True)
    p = network.process("P")
    a = p.location("A")
    p.edge(a, a, guard=x >= 2, send=go)
    model = prepare(network.build())
    state = initial_state(model)
    assert delay(model, state, Fraction(2)).clocks == (2,)
    with pytest.raises(StepError, match="urgent"):
        delay(model, state, Fraction(21, 10))


def stopwatch() -> tuple[NetworkBuilder, object, object, object]:
    """In A the clock y stands still while x runs to 5; in B both run."""
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    process = network.process("P")
    a = process.location("A", invariant=x <= 5, rates=[(y, 0)])
    b = process.location("B")
    process.edge(a, b, guard=x == 5)
    return network, b, x, y


def test_a_stopped_clock_keeps_its_value() -> None:
    network, b, x, y = stopwatch()
    goals = [(b.reached & (y == 1) & (x == 6)).expression, (b.reached & (y >= 2) & (x < 7)).expression]
    program, lowered = lower(network.build(), goals)
    found = [reference.explore(network.build(), goals), zone.explore(program, lowered)]
    for outcome in found:
        assert not outcome.exact
        assert outcome.goals[0].path is not None
        run = concretise(prepare(network.build()), outcome.goals[0].path, goals[0])
        assert run is not None
        assert run.states[-1].clocks == (6, 1)
        for goal, outcome_of_goal in zip(goals[1:], outcome.goals[1:], strict=True):
            path = outcome_of_goal.path
            assert path is None or concretise(prepare(network.build()), path, goal) is None


def test_deadlock_means_no_action_now_or_later(reaches) -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    process = network.process("P")
    a, b = process.location("A"), process.location("B")
    process.edge(a, b, guard=(x >= 2) & (x <= 4))
    assert not reaches(network, deadlock() & a.reached & (x < 4))
    assert not reaches(network, deadlock() & a.reached & (x == 4))
    assert reaches(network, deadlock() & a.reached & (x > 4))
    assert reaches(network, deadlock() & b.reached)
    assert reaches(network, ~deadlock() & a.reached & (x == 0))


def test_an_invariant_that_ends_time_before_the_guard_makes_a_deadlock(reaches) -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    process = network.process("P")
    a, b = process.location("A", invariant=x <= 2), process.location("B")
    process.edge(a, b, guard=x > 2)
    assert reaches(network, deadlock() & (x == 0))
    assert not reaches(network, b.reached)


def test_the_invariant_that_bounds_the_waiting_counts_in_a_deadlock(reaches) -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    process = network.process("P")
    a, b = process.location("A", invariant=x <= 1), process.location("B")
    process.edge(a, b, guard=x > 0)
    process.edge(a, b, guard=x > 3)
    assert not reaches(network, deadlock() & a.reached)


def test_a_deadlock_only_in_the_widened_zone_is_none(reaches) -> None:
    # With LU bounds nothing keeps y from growing, although it always equals x.
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    process = network.process("P")
    a = process.location("A", invariant=x <= 3)
    process.edge(a, a, guard=y <= 5)
    assert not reaches(network, deadlock())


def test_what_is_possible_only_in_the_widened_zone_ends_no_deadlock(reaches) -> None:
    # With LU bounds x may lie beyond 3, where y could have reached 5 from anywhere.
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    process = network.process("P")
    a, b, c = process.location("A"), process.location("B", invariant=x <= 3), process.location("C")
    process.edge(a, b, updates=[x.assign(0)])
    process.edge(b, c, guard=y >= 5)
    process.edge(c, c)
    assert reaches(network, deadlock() & b.reached)
    assert not reaches(network, deadlock() & b.reached & (y > 5))


def test_a_target_invariant_that_cannot_hold_makes_a_deadlock(reaches) -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    process = network.process("P")
    a, b = process.location("A"), process.location("B", invariant=x <= 2)
    process.edge(a, b, guard=x >= 1)
    assert reaches(network, deadlock() & a.reached & (x > 2))
    assert not reaches(network, deadlock() & a.reached & (x <= 2))


def test_a_committed_state_that_cannot_move_is_a_deadlock() -> None:
    network = NetworkBuilder()
    p, q = network.process("P"), network.process("Q")
    p.location("A", committed=True)
    b = q.location("B")
    q.edge(b, b)
    model = prepare(network.build())
    assert deadlocked(model, initial_state(model))


def test_time_that_does_not_move_a_stopped_clock_does_not_end_a_deadlock() -> None:
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    process = network.process("P")
    a, b, c = process.location("A"), process.location("B", rates=[(y, 0)]), process.location("C")
    process.edge(a, b)
    process.edge(b, c, guard=(y == 3) & (x >= 5))
    goals = [
        (deadlock() & b.reached & (y < 2)).expression,
        (~deadlock() & b.reached & (y == 3) & (x < 5)).expression,
    ]
    program, lowered = lower(network.build(), goals)
    for outcome in (reference.explore(network.build(), goals), zone.explore(program, lowered)):
        for goal, found in zip(goals, outcome.goals, strict=True):
            assert found.path is not None
            run = concretise(prepare(network.build()), found.path, goal)
            assert run is not None
            replay(prepare(network.build()), run, goal)


def test_an_invariant_on_a_difference_lets_time_pass(reaches) -> None:
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    process = network.process("P")
    a, b = process.location("A", invariant=x - y <= 0), process.location("B")
    process.edge(a, b, guard=x >= 5)
    assert reaches(network, b.reached)


def test_a_stopped_clock_does_not_come_to_a_guard() -> None:
    network = NetworkBuilder()
    y = network.clock("y")
    process = network.process("P")
    a, b, c = process.location("A"), process.location("B", rates=[(y, 0)]), process.location("C")
    process.edge(a, b)
    process.edge(b, c, guard=y >= 5)
    process.edge(c, c)
    goal = deadlock().expression
    program, lowered = lower(network.build(), [goal])
    for outcome in (reference.explore(network.build(), [goal]), zone.explore(program, lowered)):
        path = outcome.goals[0].path
        assert path is not None
        run = concretise(prepare(network.build()), path, goal)
        assert run is not None
        replay(prepare(network.build()), run, goal)


def test_an_urgent_channel_waits_for_the_guard_of_its_receiver(reaches) -> None:
    network = NetworkBuilder()
    x, n = network.clock("x"), network.integer("n", 0, 1)
    go = network.channel("go", urgent=True)
    p, q, r = network.process("P"), network.process("Q"), network.process("R")
    p.edge(p.location("A"), p.location("B"), send=go)
    received = q.location("L"), q.location("M")
    q.edge(*received, guard=n == 1, receive=go)
    r.edge(r.location("U"), r.location("V"), guard=x >= 3, updates=[n.assign(1)])
    assert reaches(network, received[1].reached)


def test_a_process_is_no_partner_of_itself(reaches) -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    go = network.channel("go", urgent=True)
    process = network.process("P")
    a, b = process.location("A"), process.location("B")
    process.edge(a, b, send=go)
    process.edge(a, b, receive=go)
    assert reaches(network, a.reached & (x > 5))


def test_an_urgent_sender_whose_guard_is_false_does_not_stop_time(reaches) -> None:
    network = NetworkBuilder()
    x, n = network.clock("x"), network.integer("n", 0, 1)
    go = network.channel("go", urgent=True)
    p, q = network.process("P"), network.process("Q")
    a = p.location("A")
    p.edge(a, p.location("B"), guard=n == 1, send=go)
    q.edge(q.location("C"), q.location("D"), receive=go)
    assert reaches(network, a.reached & (x > 5))
