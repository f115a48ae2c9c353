"""Runs made from paths: earliest moments, strict bounds, choices, stopwatches, long paths."""

from __future__ import annotations

from fractions import Fraction

import pytest

from tachk.engine.exact.concretise import concretise
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.replay import replay
from tachk.model.builder import NetworkBuilder, Term, deadlock
from tachk.model.run import Participant, TimedTrace, Transition


def path(*edges: int, process: int = 0) -> list[Transition]:
    return [Transition((Participant(process, edge),)) for edge in edges]


def times(trace: TimedTrace | None) -> list[Fraction]:
    assert trace is not None
    return [step.state.time for step in trace.steps]


def checked(network: NetworkBuilder, transitions: list[Transition], goal: Term | None = None) -> TimedTrace | None:
    predicate = None if goal is None else goal.expression
    trace = concretise(prepare(network.build()), transitions, predicate)
    if trace is not None:
        replay(prepare(network.build()), trace, predicate)
    return trace


def test_transitions_fire_as_early_as_their_lower_bounds_allow() -> None:
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    process = network.process("P")
    a = process.location("A")
    process.edge(a, a, guard=x >= 2, updates=[y.assign(0)])
    process.edge(a, a, guard=y >= 3, updates=[x.assign(1)])
    process.edge(a, a, guard=x == 5)
    assert times(checked(network, path(0, 1, 2))) == [2, 5, 9]


def test_an_upper_bound_pushes_an_earlier_transition_back() -> None:
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    process = network.process("P")
    a = process.location("A")
    process.edge(a, a, updates=[y.assign(0)])
    process.edge(a, a, guard=(x >= 10) & (y <= 3))
    assert times(checked(network, path(0, 1))) == [7, 10]


def test_strict_bounds_cost_a_fraction_with_a_small_denominator() -> None:
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    process = network.process("P")
    a = process.location("A")
    process.edge(a, a, guard=x > 0, updates=[y.assign(0)])
    process.edge(a, a, guard=(y > 0) & (x < 1))
    assert times(checked(network, path(0, 1))) == [Fraction(1, 3), Fraction(2, 3)]


def test_a_path_without_a_run_gives_none() -> None:
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    process = network.process("P")
    a = process.location("A", invariant=x <= 4)
    process.edge(a, a, guard=x >= 2, updates=[y.assign(0)])
    process.edge(a, a, guard=y >= 3)
    assert checked(network, path(0, 1)) is None


def test_a_path_from_the_wrong_location_is_a_mistake_of_the_caller() -> None:
    network = NetworkBuilder()
    process = network.process("P")
    a, b = process.location("A"), process.location("B")
    process.edge(a, b)
    with pytest.raises(ValueError, match="transition 2"):
        concretise(prepare(network.build()), path(0, 0))


def test_a_last_delay_is_added_where_the_predicate_needs_it() -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    process = network.process("P")
    a, b = process.location("A"), process.location("B")
    process.edge(a, b, guard=x >= 1)
    assert times(checked(network, path(0))) == [1]
    assert times(checked(network, path(0), b.reached)) == [1]
    trace = checked(network, path(0), x >= 4)
    assert times(trace) == [1, 4]
    assert trace is not None
    assert trace.steps[-1].transition is None


def test_a_deadlock_that_comes_with_time_is_waited_for() -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    process = network.process("P")
    a, b = process.location("A"), process.location("B", invariant=x <= 5)
    process.edge(a, b)
    process.edge(b, b, guard=x <= 2)
    assert times(checked(network, path(0), deadlock() & b.reached)) == [0, Fraction(5, 2)]


def test_a_process_that_stays_out_of_a_broadcast_says_when_it_can_happen() -> None:
    network = NetworkBuilder()
    x, c = network.clock("x"), network.channel("c", broadcast=True)
    p, q = network.process("P"), network.process("Q")
    a, b = p.location("A"), q.location("B")
    p.edge(a, a, guard=x >= 1, send=c)
    q.edge(b, b, receive=c, guard=(x >= 0) & (x <= 4))
    assert times(checked(network, path(0))) == [Fraction(9, 2)]


def test_a_higher_priority_says_when_a_lower_one_can_happen() -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    p, q = network.process("P"), network.process("Q", priority=1)
    a, b = p.location("A"), q.location("B")
    p.edge(a, a, guard=x >= 1)
    q.edge(b, b, guard=x <= 3)
    assert times(checked(network, path(0))) == [Fraction(7, 2)]


def test_a_choice_that_fails_later_is_taken_back() -> None:
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    process = network.process("P")
    a = process.location("A")
    process.edge(a, a, guard=x != 3, updates=[y.assign(0)])
    process.edge(a, a, guard=(x >= 7) & (y <= 1))
    assert times(checked(network, path(0, 1))) == [6, 7]


@pytest.mark.parametrize(("latest", "exists"), [(9, True), (6, False)])
def test_choices_in_between_do_not_multiply(latest: int, exists: bool) -> None:
    """The wrong first choice shows only behind thirty others that do not matter."""
    network = NetworkBuilder()
    x, since = network.clock("x"), network.clock("since")
    process = network.process("P")
    a = process.location("A")
    process.edge(a, a, guard=(x < 1) | (x > 7), updates=[since.assign(0)])
    for _ in range(30):
        process.edge(a, a, guard=(x <= 50) | (x <= 60))
    process.edge(a, a, guard=(x >= 5) & (x <= latest) & (since <= 1))
    assert (checked(network, path(*range(32))) is not None) == exists


def test_no_time_passes_while_an_urgent_synchronisation_is_enabled() -> None:
    network = NetworkBuilder()
    x, n = network.clock("x"), network.integer("n", 0, 1)
    go = network.channel("go", broadcast=True, urgent=True)
    p, q = network.process("P"), network.process("Q")
    a, b = p.location("A"), q.location("B")
    p.edge(a, a, guard=x >= 3, updates=[n.assign(1)])
    p.edge(a, a, guard=x >= 4)
    q.edge(b, b, guard=n == 1, send=go)
    assert times(checked(network, path(0))) == [3]
    assert times(checked(network, path(0, 1))) == [4, 4]
    assert times(checked(network, path(0), x >= 5)) == [5]


def test_clocks_that_stop_are_solved_exactly() -> None:
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    process = network.process("P")
    a, b = process.location("A"), process.location("B", rates=[(y, 0)])
    process.edge(a, b, guard=y > 1)
    process.edge(b, a, guard=(x >= 5) & (y < 2))
    process.edge(a, a, guard=(y == 3) & (x <= 7))
    process.edge(a, a, guard=(y == 3) & (x < 6))
    assert checked(network, path(0, 1, 2)) is not None
    assert checked(network, path(0, 1, 3)) is None


def test_copies_of_clocks_that_stop_are_solved_exactly() -> None:
    """y is x as it is behind a while in which it stood, and stands a while itself; z is a copy of that copy."""
    network = NetworkBuilder()
    x, y, z, w = (network.clock(name) for name in "xyzw")
    process = network.process("P")
    a, b, c = process.location("A"), process.location("B", rates=[(x, 0)]), process.location("C", rates=[(y, 0)])
    process.edge(a, b, guard=x == 2, updates=[w.assign(0)])
    process.edge(b, c, guard=w == 3, updates=[y.assign(x + 1), x.assign(0), w.assign(0)])
    process.edge(c, b, guard=w == 4, updates=[z.assign(y), y.assign(x), x.assign(z + 1), w.assign(0)])
    process.edge(b, a, guard=w == 5)
    end = (x == 4) & (y == 9) & (z == 8) & (w == 5)
    assert times(checked(network, path(0, 1, 2, 3), a.reached & end)) == [2, 5, 9, 14]
    for wrong in (x - w > -1, x - w < -1, y - w > 4, y - w < 4, z - w > 3, z - w < 3):
        assert checked(network, path(0, 1, 2, 3), a.reached & wrong) is None


def test_a_clock_that_is_set_to_itself_or_to_a_number_has_stood_as_before_or_not() -> None:
    network = NetworkBuilder()
    x, y, w = (network.clock(name) for name in "xyw")
    process = network.process("P")
    a = process.location("A", rates=[(x, 0), (y, 0)])
    b = process.location("B")
    process.edge(a, a, guard=w == 3, updates=[x.assign(x + 1), w.assign(0)])
    process.edge(a, b, guard=w == 3, updates=[y.assign(7), w.assign(0)])
    process.edge(b, b, guard=(w == 2) & (x == 3) & (y == 9), updates=[w.assign(0)])
    assert times(checked(network, path(0, 1, 2))) == [3, 6, 8]


def test_a_clock_that_stood_still_is_set_to_one_that_ran() -> None:
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    process = network.process("P")
    a, b = process.location("A", rates=[(y, 0)]), process.location("B")
    process.edge(a, b, guard=x == 3, updates=[y.assign(x)])
    process.edge(b, b, guard=(x == 4) & (y == 4))
    assert times(checked(network, path(0, 1))) == [3, 4]


def test_a_path_of_a_thousand_transitions() -> None:
    network = NetworkBuilder()
    clocks = [network.clock(f"x{i}") for i in range(5)]
    process = network.process("P")
    a = process.location("A", invariant=clocks[0] <= 4)
    for i, clock in enumerate(clocks):
        process.edge(a, a, guard=(clocks[i - 1] > 0) & (clock >= 3), updates=[clock.assign(0)])
    trace = checked(network, path(*(i % 5 for i in range(1000))))
    assert trace is not None
    assert len(trace.steps) == 1000


def test_a_deadlock_among_many_clocks_is_searched_for_where_the_path_ends() -> None:
    network = NetworkBuilder()
    for number in range(20):  # the deadlocks among all valuations make up a million zones
        c, d = network.clock(f"c{number}"), network.clock(f"d{number}")
        process = network.process(f"P{number}")
        a = process.location("A")
        process.edge(a, a, guard=(c <= 1) & (d <= 2))
    assert times(checked(network, path(0), deadlock())) == [0, Fraction(3, 2)]


def test_a_path_does_not_wait_beyond_the_moment_an_urgent_guard_becomes_true() -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    go = network.channel("go", broadcast=True, urgent=True)
    p, q = network.process("P"), network.process("Q")
    p.edge(p.location("A"), p.location("B"), guard=x >= 3, send=go)
    left, right = q.location("L"), q.location("M")
    at_three = q.edge(left, right, guard=x >= 3)
    too_late = q.edge(left, right, guard=x >= 4)
    assert times(checked(network, path(at_three, process=1))) == [3]
    assert concretise(prepare(network.build()), path(too_late, process=1)) is None


def test_a_location_with_a_lower_invariant_is_entered_when_it_holds() -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    process = network.process("P")
    process.edge(process.location("A"), process.location("B", invariant=x >= 2))
    assert times(checked(network, path(0))) == [2]
