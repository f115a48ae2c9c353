"""Networks as programs: slots, numbering, updates, select labels, synchronisations, places of errors."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tachk.base.diagnostics.diagnostic import InputError, UnsupportedError
from tachk.base.operators import BinaryOperator
from tachk.base.span import Source, Span
from tachk.engine.compiler.lower import lower
from tachk.engine.compiler.program import NO_CODE, Comparison, Condition, ProgramEdge, Slot, Update
from tachk.engine.compiler.program import Test as SlotTest
from tachk.model.builder import NetworkBuilder, Term, bound_variable
from tachk.model.expressions import (
    INT,
    Assign,
    Binary,
    Block,
    Call,
    Constant,
    Evaluate,
    Function,
    Index,
    Reference,
    Variable,
    VariableKind,
)
from tachk.model.network import Edge, Location, Network, Process
from tachk.model.types import ArrayType, ClockType, IntType, VoidType
from tests.support.machine import Machine, initial_slots, site


def single(build: Callable[[NetworkBuilder], list[Term]]) -> tuple[Network, ProgramEdge]:
    """A network with one edge that has the updates; every variable is also written by another edge."""
    network = NetworkBuilder()
    updates = build(network)
    p = network.process("P")
    a = p.location("a")
    p.edge(a, a, updates=updates)
    built = network.build()
    return built, lower(built)[0].edges[0]


def test_the_program_of_a_small_network_is_kept_for_the_same_question() -> None:
    builder = NetworkBuilder()
    n = builder.integer("n", 0, 5)
    process = builder.process("P")
    process.location("a")
    network = builder.build()
    first, other = ((n == value).expression for value in (0, 1))
    program, goals = lower(network, [first])
    again, same = lower(network, [(n == 0).expression])
    assert again is program
    assert same is goals
    assert lower(network, [other])[1] != goals


def test_slots_are_locations_then_variables_and_clocks_hold_their_numbers() -> None:
    network = NetworkBuilder()
    n = network.integer("n", 1, 9)
    network.channel("c", size=2)
    network.integer("m", 0, 3, 2, meta=True)
    p, q = network.process("P"), network.process("Q")
    p.clock("x")
    q.declare("t", ArrayType(ClockType(), IntType(5, 6)))
    a = p.location("a")
    p.location("b")
    p.edge(a, a, updates=[n.assign(2)])
    q.location("only")
    program, _ = lower(network.build())
    assert program.slots == (
        Slot("P", 0, 1, 0),
        Slot("Q", 0, 0, 0),
        Slot("n", 1, 9, 1),
        Slot("c[0]", 0, 0, 0),
        Slot("c[1]", 1, 1, 1),
        Slot("m", 2, 2, 2, meta=True),
        Slot("P.x", 1, 1, 1),
        Slot("Q.t[5]", 2, 2, 2),
        Slot("Q.t[6]", 3, 3, 3),
    )
    assert program.clock_names == ("P.x", "Q.t[5]", "Q.t[6]")
    assert [c.name for c in program.channels] == ["c[0]", "c[1]"]


def test_an_initial_value_outside_the_range_is_an_input_error() -> None:
    network = NetworkBuilder()
    n = network.integer("n", 0, 3, 7)
    p = network.process("P")
    a = p.location("a")
    p.edge(a, a, updates=[n.assign(0)])
    with pytest.raises(InputError) as caught:
        lower(network.build())
    assert [d.code for d in caught.value.diagnostics] == ["E0701"]


def test_constant_updates_are_stores_and_resets() -> None:
    def build(network: NetworkBuilder) -> list[Term]:
        n, x = network.integer("n", 0, 3), network.clock("x")
        return [n.assign(3), x.assign(2), n.assign(1), x.assign(0)]

    assert single(build)[1].update == Update(stores=((1, 1),), resets=((1, 0, 0),))


@pytest.mark.parametrize("value", [4, -1])
def test_an_update_outside_the_range_is_code_that_fails(value: int) -> None:
    _, edge = single(lambda network: [network.integer("n", 0, 3).assign(value)])
    assert edge.update.code != NO_CODE


def test_an_update_that_depends_on_the_state_is_code_as_a_whole() -> None:
    def build(network: NetworkBuilder) -> list[Term]:
        n, x = network.integer("n", 0, 3), network.clock("x")
        return [n.assign(3), x.assign(n)]

    network, edge = single(build)
    program, _ = lower(network)
    assert edge.update.stores == edge.update.resets == ()
    machine = Machine(program, initial_slots(program))
    machine.run(edge.update.code)
    assert machine.resets == {1: (0, 3)}


def test_a_select_label_gives_one_edge_for_each_value_that_the_guard_admits() -> None:
    network = NetworkBuilder()
    n = network.integer("n", 0, 3)
    channels = network.channel("c", size=4)
    p = network.process("P")
    a = p.location("a")
    i, j = bound_variable("i", IntType(0, 2)), bound_variable("j", IntType(1, 3))
    p.edge(a, a, selects=[i, j], guard=(i < j) & (n == i), send=channels[j], updates=[n.assign(i)])
    q = network.process("Q")
    b = q.location("b")
    q.edge(b, b, receive=channels[n])
    program, _ = lower(network.build())
    edges = [edge for edge in program.edges if edge.sends]
    assert [edge.selects for edge in edges] == [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]
    assert [edge.channel for edge in edges] == [1, 2, 3, 2, 3, 3]
    assert edges[3].guard == Condition((SlotTest(2, Comparison.EQUAL, 1),))
    assert edges[3].update == Update(stores=((2, 1),))
    assert {edge.edge for edge in edges} == {0}


def test_an_explosion_of_select_values_is_rejected() -> None:
    network = NetworkBuilder()
    p = network.process("P")
    a = p.location("a")
    p.edge(a, a, selects=[bound_variable("i", IntType(0, 2**20))])
    with pytest.raises(UnsupportedError) as caught:
        lower(network.build())
    assert caught.value.diagnostic.code == "E0708"


def test_an_edge_that_no_other_process_has_a_part_for_disappears_with_its_clock_bounds() -> None:
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    alone, shared, loud = network.channel("alone"), network.channel("shared"), network.channel("loud", broadcast=True)
    p, q = network.process("P"), network.process("Q")
    a, b = p.location("a"), q.location("b")
    p.edge(a, a, guard=x <= 7, send=alone)
    p.edge(a, a, guard=x <= 8, receive=alone)  # no process takes both parts
    p.edge(a, a, guard=y <= 2, send=shared)
    p.edge(a, a, send=loud)
    q.edge(b, b, receive=shared)
    q.edge(b, b, guard=x <= 9, receive=network.channel("unheard", broadcast=True))
    program, _ = lower(network.build())
    assert [(edge.process, edge.edge) for edge in program.edges] == [(0, 2), (0, 3), (1, 0)]
    assert program.maximum_constants == (-1, -1, 2)


def test_an_edge_without_a_partner_stays_where_it_can_be_a_run_time_error() -> None:
    network = NetworkBuilder()
    n = network.integer("n", 0, 3)
    p = network.process("P")
    a = p.location("a")
    p.edge(a, a, guard=3 // n == 1, send=network.channel("alone"))
    program, _ = lower(network.build())
    assert len(program.edges) == 1


def test_a_channel_index_that_varies_is_code() -> None:
    network = NetworkBuilder()
    n = network.integer("n", 0, 3)
    channels = network.channel("c", size=4)
    p = network.process("P")
    a = p.location("a")
    p.edge(a, a, receive=channels[n], updates=[n.assign(2)])
    q = network.process("Q")
    b = q.location("b")
    q.edge(b, b, send=channels[1])
    program, _ = lower(network.build())
    edge = program.edges[0]
    machine = Machine(program, initial_slots(program))
    machine.slots[2] = 3
    assert machine.run(edge.channel_code) == 3
    assert not edge.sends


def test_an_edge_whose_guard_is_never_true_disappears_and_such_an_invariant_stays() -> None:
    network = NetworkBuilder()
    never = network.boolean("never")
    p = network.process("P")
    a, b = p.location("a"), p.location("b", invariant=never)
    p.edge(a, b, guard=never)
    program, _ = lower(network.build())
    assert program.edges == ()
    assert Machine(program, initial_slots(program)).run(program.locations[0][1].invariant.code) == 0


def test_rates_of_stopped_clocks() -> None:
    network = NetworkBuilder()
    flag = network.boolean("flag")
    p = network.process("P")
    x, y, z = p.clock("x"), p.clock("y"), p.clock("z")
    a = p.location("a", rates=[(x, 0), (y, flag), (z, 1)])
    p.edge(a, a, updates=[flag.assign(1)])
    program, _ = lower(network.build())
    (first, second) = program.locations[0][0].stopped
    assert first == (1, NO_CODE)
    assert second[0] == 2
    assert Machine(program, initial_slots(program)).run(second[1]) == 0
    assert program.has_stopwatches


def test_another_rate_is_rejected() -> None:
    network = NetworkBuilder()
    p = network.process("P")
    p.location("a", rates=[(p.clock("x"), 2)])
    with pytest.raises(UnsupportedError) as caught:
        lower(network.build())
    assert caught.value.diagnostic.code == "E0710"


def test_a_clock_set_to_a_huge_value_is_rejected() -> None:
    with pytest.raises(UnsupportedError) as caught:
        single(lambda network: [network.clock("x").assign(2**31)])
    assert caught.value.diagnostic.code == "E0704"


def test_priorities() -> None:
    network = NetworkBuilder(default_priority=1)
    network.channel("low", priority=0)
    network.channel("plain")
    network.process("P", priority=3).location("a")
    program, _ = lower(network.build())
    assert [c.priority for c in program.channels] == [0, 1]
    assert (program.default_priority, program.process_priorities, program.has_priorities) == (1, (3,), True)


def test_a_clock_reset_through_a_reference_parameter() -> None:
    clock = Variable("x", ArrayType(ClockType(), IntType(0, 1)), VariableKind.GLOBAL, (0, 0))
    parameter = Variable("c", ClockType(), VariableKind.FRAME, reference=True)
    body = Block((Evaluate(Assign(Reference(parameter), Constant(4), ClockType())),))
    function = Function("set", (parameter,), VoidType(), body)
    second = Index(Reference(clock), Constant(1), ClockType())
    edge = Edge(0, 0, updates=(Call(function, (second,), VoidType()),))
    network = Network((Process("P", "P", (Location("a"),), (edge,)),), (clock,))
    program, _ = lower(network)
    machine = Machine(program, initial_slots(program))
    machine.run(program.edges[0].update.code)
    assert machine.resets == {2: (0, 4)}


def test_every_instruction_that_may_fail_has_its_place() -> None:
    source = Source("model.ta", "n = 10 / n")
    whole, division = Span(source, 0, 10), Span(source, 4, 10)
    n = Variable("n", IntType(0, 3), VariableKind.GLOBAL, (0,))
    quotient = Binary(BinaryOperator.DIVIDE, Constant(10), Reference(n), INT, division)
    update = Assign(Reference(n), quotient, n.type, span=whole)
    network = Network((Process("P", "P", (Location("a"),), (Edge(0, 0, updates=(update,)),)),), (n,))
    program, _ = lower(network)
    start = program.edges[0].update.code
    assert [site(program, start + offset) for offset in (4, 5)] == [division, whole]
    assert list(program.sites) == sorted(program.sites, key=lambda pair: pair[0])
