"""Which transitions there are: synchronisation, broadcast, committed locations, priorities, order of updates."""

from __future__ import annotations

import pytest

from tachk.engine import zone
from tachk.engine.compiler.lower import lower
from tachk.engine.outcome import Status
from tachk.meaning.discrete import prepare
from tachk.meaning.step import initial_state, successors
from tachk.model.builder import NetworkBuilder, bound_variable, deadlock
from tachk.model.fault import RuntimeErrorKind
from tachk.model.run import Participant, Transition
from tachk.model.types import ArrayType, IntType
from tests.support.oracles import reference


def enabled(network: NetworkBuilder) -> list[tuple[tuple[int, int], ...]]:
    """The transitions of the initial state as (process, edge) pairs."""
    model = prepare(network.build())
    found = successors(model, initial_state(model))
    return [tuple((p.process, p.edge) for p in t.participants) for t, _ in found]


def test_a_handshake_needs_two_different_processes() -> None:
    network = NetworkBuilder()
    c = network.channel("c")
    for name in "PQR":
        process = network.process(name)
        a = process.location("A")
        process.edge(a, a, send=c)
        process.edge(a, a, receive=c)
    pairs = [(i, j) for i in range(3) for j in range(3) if i != j]
    assert enabled(network) == [((i, 0), (j, 1)) for i, j in pairs]


def test_a_sender_without_receiver_waits_but_a_broadcast_does_not() -> None:
    network = NetworkBuilder()
    c, d = network.channel("c"), network.channel("d", broadcast=True)
    process = network.process("P")
    a = process.location("A")
    process.edge(a, a, send=c)
    process.edge(a, a, send=d)
    assert enabled(network) == [((0, 1),)]


def test_channels_of_an_array_are_different_channels() -> None:
    network = NetworkBuilder()
    c = network.channel("c", size=2)
    p, q = network.process("P"), network.process("Q")
    a, b = p.location("A"), q.location("B")
    i = bound_variable("i", IntType(0, 1))
    p.edge(a, a, send=c[i], selects=[i])
    q.edge(b, b, receive=c[1])
    model = prepare(network.build())
    ((transition, _),) = successors(model, initial_state(model))
    assert transition == Transition((Participant(0, 0, (1,)), Participant(1, 0)))


def test_a_broadcast_takes_everyone_who_can_receive_with_one_of_their_edges() -> None:
    network = NetworkBuilder()
    x, c = network.clock("x"), network.channel("c", broadcast=True)
    p, q, r, s = (network.process(name) for name in "PQRS")
    a = p.location("A")
    p.edge(a, a, send=c)
    b = q.location("B")
    q.edge(b, b, receive=c)
    q.edge(b, b, receive=c, guard=x <= 0)
    q.edge(b, b, receive=c, guard=x > 0)
    d = r.location("D")
    r.edge(d, d, receive=c, guard=x >= 1)
    e = s.location("E")
    s.edge(e, e, receive=c)
    assert enabled(network) == [((0, 0), (1, 0), (3, 0)), ((0, 0), (1, 1), (3, 0))]


def test_a_receiver_stays_out_of_a_broadcast_only_while_its_clock_guard_is_false(reaches) -> None:
    network = NetworkBuilder()
    x, since, c = network.clock("x"), network.clock("since"), network.channel("c", broadcast=True)
    p, q = network.process("P"), network.process("Q")
    a, b = p.location("A"), p.location("B")
    p.edge(a, b, send=c, updates=[since.assign(0)])
    d, e = q.location("D"), q.location("E")
    q.edge(d, e, receive=c, guard=(x >= 1) & (x < 2))
    just_sent = b.reached & (since == 0)
    assert reaches(network, just_sent & d.reached & (x < 1))
    assert reaches(network, just_sent & d.reached & (x == 2))
    assert reaches(network, just_sent & e.reached & (x == 1))
    assert not reaches(network, just_sent & d.reached & (x >= 1) & (x < 2))
    assert not reaches(network, just_sent & e.reached & (x < 1))


def test_a_forced_receiver_that_breaks_its_invariant_disables_the_broadcast(reaches) -> None:
    network = NetworkBuilder()
    x, c = network.clock("x"), network.channel("c", broadcast=True)
    p, q = network.process("P"), network.process("Q")
    a, b = p.location("A"), p.location("B")
    p.edge(a, b, send=c)
    d, e = q.location("D"), q.location("E", invariant=x <= 2)
    q.edge(d, e, receive=c)
    assert reaches(network, b.reached & e.reached)
    assert not reaches(network, b.reached & d.reached)
    assert reaches(network, deadlock() & a.reached & (x > 2))


def test_a_committed_process_goes_first() -> None:
    network = NetworkBuilder()
    c = network.channel("c")
    p, q, r = network.process("P"), network.process("Q"), network.process("R")
    a = p.location("A", committed=True)
    p.edge(a, a, receive=c)
    b = q.location("B")
    q.edge(b, b, send=c)
    q.edge(b, b)
    d = r.location("D")
    r.edge(d, d, receive=c)
    assert enabled(network) == [((1, 0), (0, 0))]


@pytest.mark.parametrize("committed", ["sender", "receiver"])
def test_one_committed_participant_is_enough_for_a_broadcast(committed: str) -> None:
    network = NetworkBuilder()
    c = network.channel("c", broadcast=True)
    p, q, r = network.process("P"), network.process("Q"), network.process("R")
    a = p.location("A", committed=committed == "sender")
    p.edge(a, a, send=c)
    b = q.location("B", committed=committed == "receiver")
    q.edge(b, b, receive=c)
    d = r.location("D")
    r.edge(d, d, receive=c)
    r.edge(d, d)
    assert enabled(network) == [((0, 0), (1, 0), (2, 0))]


def test_updates_run_sender_first_then_receivers_in_process_order() -> None:
    network = NetworkBuilder()
    c = network.channel("c", broadcast=True)
    n = network.integer("n", 0, 1000)
    q, p, r = network.process("Q"), network.process("P"), network.process("R")
    for process, digit, sync in ((q, 2, {"receive": c}), (p, 1, {"send": c}), (r, 3, {"receive": c})):
        here = process.location("A")
        process.edge(here, here, updates=[n.assign(n * 10), n.assign(n + digit)], **sync)
    model = prepare(network.build())
    state = initial_state(model)
    ((_, after),) = successors(model, state)
    assert after.discrete.values[-1] == 123


def test_guards_are_evaluated_before_any_update(reaches) -> None:
    network = NetworkBuilder()
    c, n = network.channel("c"), network.integer("n", 0, 1)
    p, q = network.process("P"), network.process("Q")
    a, b = p.location("A"), p.location("B")
    p.edge(a, b, send=c, updates=[n.assign(1)])
    d, e = q.location("D"), q.location("E")
    q.edge(d, e, receive=c, guard=n == 1)
    assert not reaches(network, e.reached)


def test_the_target_invariant_is_checked_after_all_updates(reaches) -> None:
    network = NetworkBuilder()
    c, x, n = network.channel("c"), network.clock("x"), network.integer("n", 0, 1)
    p, q = network.process("P"), network.process("Q")
    a, b = p.location("A"), p.location("B", invariant=(n == 1) & (x <= 0))
    p.edge(a, b, guard=x >= 3, send=c)
    d, e = q.location("D"), q.location("E")
    q.edge(d, e, receive=c, updates=[n.assign(1), x.assign(0)])
    assert reaches(network, b.reached & e.reached)


def test_queries_do_not_see_values_between_two_updates(reaches) -> None:
    network = NetworkBuilder()
    c, n = network.channel("c"), network.integer("n", 0, 2)
    p, q = network.process("P"), network.process("Q")
    a, b = p.location("A"), p.location("B")
    p.edge(a, b, send=c, updates=[n.assign(1)])
    d = q.location("D")
    q.edge(d, d, receive=c, updates=[n.assign(2)])
    assert reaches(network, n == 0)
    assert not reaches(network, n == 1)
    assert reaches(network, n == 2)


def test_channel_priority_decides_before_process_priority() -> None:
    network = NetworkBuilder()
    high, low = network.channel("high", True, priority=1), network.channel("low", True, priority=-1)
    p, q = network.process("P", priority=0), network.process("Q", priority=9)
    a = p.location("A")
    p.edge(a, a, send=high)
    b = q.location("B")
    q.edge(b, b, send=low)
    q.edge(b, b)
    assert enabled(network) == [((0, 0),)]


def test_a_synchronisation_has_the_highest_priority_of_its_processes() -> None:
    network = NetworkBuilder()
    c = network.channel("c")
    p, q, r = network.process("P", 1), network.process("Q", 3), network.process("R", 2)
    a = p.location("A")
    p.edge(a, a, send=c)
    b = q.location("B")
    q.edge(b, b, receive=c)
    d = r.location("D")
    r.edge(d, d)
    assert enabled(network) == [((0, 0), (1, 0))]


def test_priority_blocks_actions_only_while_the_higher_one_is_possible_and_never_delay(reaches) -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    p, q = network.process("P", priority=1), network.process("Q")
    a, b = p.location("A"), p.location("B")
    p.edge(a, b, guard=(x >= 1) & (x <= 2))
    d, e = q.location("D"), q.location("E")
    q.edge(d, e, updates=[x.assign(5)])
    assert reaches(network, a.reached & d.reached & (x == 2))
    y = network.clock("y")
    assert reaches(network, a.reached & e.reached & (y < 1))
    assert reaches(network, a.reached & e.reached & (x == 5) & (y > 2))
    assert not reaches(network, a.reached & e.reached & (x == 5) & (y >= 1) & (y <= 2))


def test_an_impossible_action_of_higher_priority_blocks_nothing(reaches) -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    p, q = network.process("P", priority=1), network.process("Q")
    a, b = p.location("A"), p.location("B", invariant=x < 0)
    p.edge(a, b)
    d, e = q.location("D"), q.location("E")
    q.edge(d, e)
    assert reaches(network, e.reached)


def test_meta_variables_are_back_at_their_initial_value_before_every_transition(reaches) -> None:
    network = NetworkBuilder()
    scratch, n = network.integer("scratch", 0, 9, initial=4, meta=True), network.integer("n", 0, 9)
    process = network.process("P")
    a, b, c = process.location("A"), process.location("B"), process.location("C")
    process.edge(a, b, updates=[scratch.assign(7), n.assign(scratch)])
    process.edge(b, c, guard=scratch == 4, updates=[n.assign(scratch)])
    assert reaches(network, b.reached & (n == 7))
    assert reaches(network, c.reached & (n == 4))
    assert not reaches(network, c.reached & (n == 7))


@pytest.mark.parametrize(
    ("kind", "update"),
    [
        (RuntimeErrorKind.RANGE, lambda n, a, x: n.assign(n + 3)),
        (RuntimeErrorKind.INDEX, lambda n, a, x: a[n + 2].assign(0)),
        (RuntimeErrorKind.DIVISION, lambda n, a, x: n.assign(1 // (n - 1))),
        (RuntimeErrorKind.NEGATIVE_CLOCK, lambda n, a, x: x.assign(n - 2)),
    ],
)
def test_a_run_time_error_ends_the_search_with_the_path_to_it(kind: RuntimeErrorKind, update) -> None:
    network = NetworkBuilder()
    x, n = network.clock("x"), network.integer("n", 0, 3)
    slots = network.declare("a", ArrayType(IntType(0, 5), IntType(0, 2)))
    process = network.process("P")
    a, b, c = process.location("A"), process.location("B"), process.location("C")
    process.edge(a, b, updates=[n.assign(1)])
    process.edge(b, c, updates=[update(n, slots, x)])
    goal = c.reached.expression
    program, goals = lower(network.build(), [goal])
    for outcome in (reference.explore(network.build(), [goal]), zone.explore(program, goals)):
        assert outcome.goals[0].status is Status.UNDECIDED
        assert outcome.reason == "run-time error"
        assert outcome.fault is not None
        assert outcome.fault.kind is kind
        assert outcome.fault.path == (Transition((Participant(0, 0),)),)
        assert outcome.fault.transition == Transition((Participant(0, 1),))


def test_a_fault_behind_a_guard_that_no_clock_value_meets_is_not_met(reaches) -> None:
    network = NetworkBuilder()
    x, n = network.clock("x"), network.integer("n", 0, 1)
    process = network.process("P")
    a, b = process.location("A", invariant=x <= 1), process.location("B")
    process.edge(a, b, guard=x >= 2, updates=[n.assign(7)])
    assert not reaches(network, b.reached)


def test_updates_of_one_edge_run_left_to_right(reaches) -> None:
    network = NetworkBuilder()
    n, m = network.integer("n", 0, 5), network.integer("m", 0, 5)
    process = network.process("P")
    a, b = process.location("A"), process.location("B")
    process.edge(a, b, updates=[n.assign(2), m.assign(n + 1), n.assign(m + 1)])
    assert reaches(network, b.reached & (n == 4) & (m == 3))
    assert not reaches(network, b.reached & (n != 4))


def test_a_receiver_that_is_committed_lets_a_sender_synchronise_that_is_not(reaches) -> None:
    network = NetworkBuilder()
    go = network.channel("go")
    p, q = network.process("P"), network.process("Q")
    p.edge(p.location("A"), p.location("B"), send=go)
    after = q.location("C", committed=True), q.location("D")
    q.edge(*after, receive=go)
    assert reaches(network, after[1].reached)


def test_priorities_end_no_state_from_which_something_is_possible(reaches) -> None:
    network = NetworkBuilder()
    n = network.integer("n", 0, 1)
    p, q = network.process("P", 1), network.process("Q")
    a, b = p.location("A"), q.location("B")
    p.edge(a, a, updates=[n.assign(1)])
    q.edge(b, b)
    assert not reaches(network, deadlock())
