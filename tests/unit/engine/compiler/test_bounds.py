"""Clock bounds: small automata with known bounds, and random ones against the definition."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tachk.base.span import Source
from tachk.engine.compiler.bounds import (
    BoundEdge,
    ClockCopy,
    ConstraintRange,
    copied_diagonals,
    joined_copies,
    network_bounds,
    process_bounds,
)
from tachk.engine.compiler.lower import lower
from tachk.engine.compiler.program import NO_CODE, Program
from tachk.formats.loading.load import load_model
from tachk.model.builder import NetworkBuilder
from tachk.model.expressions import Conditional
from tachk.model.types import ArrayType, ClockType, IntType

pytestmark = pytest.mark.drawn

X, Y = 1, 2


def upper_bound(clock: int, constant: int) -> ConstraintRange:
    return ConstraintRange((clock,), (0,), constant, constant)


def lower_bound(clock: int, constant: int) -> ConstraintRange:
    return ConstraintRange((0,), (clock,), -constant, -constant)


def bounds_of(program: Program, process: int, location: int) -> tuple[dict[int, int], dict[int, int]]:
    found = program.locations[process][location]
    return dict(found.lower), dict(found.upper)


def test_a_bound_reaches_backwards_to_the_reset() -> None:
    edges = [
        BoundEdge(0, 1, resets=frozenset({X})),
        BoundEdge(1, 2),
        BoundEdge(2, 3, constraints=(lower_bound(X, 7),)),
    ]
    found = process_bounds([(), (), (), ()], edges)
    assert [b.lower for b in found] == [(), ((X, 7),), ((X, 7),), ()]
    assert [b.upper for b in found] == [(), (), (), ()]


def test_the_larger_of_two_ways_counts() -> None:
    edges = [
        BoundEdge(0, 1),
        BoundEdge(0, 2),
        BoundEdge(1, 0, constraints=(upper_bound(X, 3),)),
        BoundEdge(2, 2, constraints=(upper_bound(X, 9),)),
    ]
    found = process_bounds([(), (), ()], edges)
    assert [dict(b.upper).get(X) for b in found] == [9, 9, 9]


def test_an_invariant_counts_at_its_location_and_before() -> None:
    found = process_bounds([(), (upper_bound(X, 4),), ()], [BoundEdge(0, 1), BoundEdge(1, 2)])
    assert [b.upper for b in found] == [((X, 4),), ((X, 4),), ()]


def test_parallel_edges_stop_a_bound_only_if_both_reset() -> None:
    both = [BoundEdge(0, 1, frozenset({X, Y})), BoundEdge(0, 1, frozenset({Y}))]
    found = process_bounds([(), (upper_bound(X, 4), upper_bound(Y, 4))], both)
    assert found[0].upper == ((X, 4),)


def test_guards_of_broadcast_receivers_count_in_both_directions() -> None:
    edge = BoundEdge(0, 0, constraints=(lower_bound(X, 5),), both_directions=True)
    (found,) = process_bounds([()], [edge])
    assert found.lower == found.upper == ((X, 5),)


def test_a_negative_constant_keeps_the_clock_alive_with_bound_zero() -> None:
    (found,) = process_bounds([(upper_bound(X, -3),)], [])
    assert found.upper == ((X, 0),)


@st.composite
def automata(draw: st.DrawFn) -> tuple[list[tuple[ConstraintRange, ...]], list[BoundEdge]]:
    count = draw(st.integers(1, 5))
    clocks = st.integers(1, 2)
    constraint = st.builds(upper_bound, clocks, st.integers(0, 9)) | st.builds(lower_bound, clocks, st.integers(0, 9))
    few = st.lists(constraint, max_size=2).map(tuple)
    place = st.integers(0, count - 1)
    edge = st.builds(BoundEdge, place, place, st.frozensets(clocks, max_size=2), few)
    return [draw(st.lists(constraint, max_size=1).map(tuple)) for _ in range(count)], draw(st.lists(edge, max_size=8))


def by_definition(
    invariants: list[tuple[ConstraintRange, ...]], edges: list[BoundEdge], clock: int, upper: bool
) -> list[int]:
    """The least fixpoint, by iterating the inequations until nothing changes."""

    def own(constraints: tuple[ConstraintRange, ...]) -> int:
        relevant = [c for c in constraints if (c.lefts if upper else c.rights) == (clock,)]
        return max((c.high if upper else -c.low for c in relevant), default=-1)

    values = [own(i) for i in invariants]
    for _ in range(len(invariants) + 1):
        for edge in edges:
            after = -1 if clock in edge.resets else values[edge.target]
            values[edge.source] = max(values[edge.source], own(edge.constraints), after)
    return values


@settings(max_examples=300, deadline=None, derandomize=True)
@given(automata())
def test_bounds_are_the_least_fixpoint(automaton: tuple[list[tuple[ConstraintRange, ...]], list[BoundEdge]]) -> None:
    invariants, edges = automaton
    found = process_bounds(invariants, edges)
    for clock in (X, Y):
        lower_values = [dict(b.lower).get(clock, -1) for b in found]
        upper_values = [dict(b.upper).get(clock, -1) for b in found]
        assert lower_values == by_definition(invariants, edges, clock, upper=False)
        assert upper_values == by_definition(invariants, edges, clock, upper=True)


Automaton = tuple[list[tuple[ConstraintRange, ...]], list[BoundEdge]]


@st.composite
def automata_with_copies(draw: st.DrawFn) -> Automaton:
    invariants, edges = draw(automata())
    copies = st.lists(st.builds(ClockCopy, st.integers(1, 3), st.integers(1, 3), st.integers(0, 4)), max_size=2)
    return invariants, [replace(edge, copies=joined_copies(draw(copies))) for edge in edges]


def by_definition_with_copies(automata: list[Automaton], upper: bool) -> list[list[dict[int, int]]]:
    """As above, with what copies pass on, from the target and from all locations of other processes."""
    values = [[dict.fromkeys(range(1, 4), -1) for _ in invariants] for invariants, _ in automata]
    before: object = None
    while before != str(values):
        before = str(values)
        for number, (invariants, edges) in enumerate(automata):
            for place, constraints in enumerate(invariants):
                for clock in (X, Y):
                    own = by_definition([constraints], [], clock, upper)[0]
                    values[number][place][clock] = max(values[number][place][clock], own)
            for edge in edges:
                here, there = values[number][edge.source], values[number][edge.target]
                for clock in here:
                    own = by_definition([edge.constraints], [], clock, upper)[0]
                    here[clock] = max(here[clock], own, -1 if clock in edge.resets else there[clock])
                for copy in edge.copies:
                    others = [place for other, of_other in enumerate(values) if other != number for place in of_other]
                    compared = max(place[copy.clock] for place in (there, *others))
                    if compared >= 0:
                        here[copy.source] = max(here[copy.source], compared - copy.least, 0)
    return values


@settings(max_examples=200, deadline=None, derandomize=True)
@given(st.lists(automata_with_copies(), min_size=1, max_size=2))
def test_bounds_with_copies_are_the_least_fixpoint(automata: list[Automaton]) -> None:
    found = network_bounds([invariants for invariants, _ in automata], [edges for _, edges in automata])
    for upper in (False, True):
        expected = by_definition_with_copies(automata, upper)
        for process, locations in enumerate(found):
            for place, bounds in enumerate(locations):
                own = dict(bounds.upper if upper else bounds.lower)
                assert own == {clock: v for clock, v in expected[process][place].items() if v >= 0}


def test_copies_of_copies_count_in_one_step() -> None:
    found = joined_copies([ClockCopy(2, 1, 3), ClockCopy(3, 2, 1), ClockCopy(3, 1, 9), ClockCopy(1, 1, -2)])
    assert found == (ClockCopy(1, 1, 0), ClockCopy(2, 1, 3), ClockCopy(3, 1, 4), ClockCopy(3, 2, 1))


def test_copies_carry_differences_of_clocks() -> None:
    copies = [ClockCopy(1, 3, 0, 1), ClockCopy(2, 4, 2, 2)]
    found = copied_diagonals([(1, 2, 7)], copies, 100)
    assert found is not None
    assert set(found) == {(1, 2, 7), (3, 2, 7), (3, 2, 5), (1, 4, 11), (3, 4, 11), (3, 4, 9)}
    assert copied_diagonals([(1, 2, 7)], [ClockCopy(1, 2, 0, 5)], 100) == ((1, 2, 7),)
    assert copied_diagonals([(1, 2, 7)], [ClockCopy(1, 1, 1, 1)], 100) is None
    assert copied_diagonals([(1, 2, 7)], [ClockCopy(1, 1, 0, 0)], 100) == ((1, 2, 7),)


# ---- bounds of whole programs ---------------------------------------------------------------------------------------


def test_a_reset_to_a_variable_stops_a_bound_but_a_conditional_one_does_not() -> None:
    network = NetworkBuilder()
    n = network.integer("n", 0, 5)
    p = network.process("P")
    x, y = p.clock("x"), p.clock("y")
    a, b = p.location("a"), p.location("b", invariant=(x <= 8) & (y <= 6))
    chosen = Conditional((n == 0).expression, x.expression, y.expression, ClockType())
    p.edge(a, b, updates=[x.assign(n), type(x)(chosen).assign(0), n.assign(1)])
    program, _ = lower(network.build())
    assert bounds_of(program, 0, 0) == ({}, {Y: 6})


def test_a_variable_bound_counts_with_its_largest_value_and_known_tables_with_their_slots() -> None:
    network = NetworkBuilder()
    n = network.integer("n", 0, 3)
    table = network.declare("table", ArrayType(IntType(), IntType(0, 3)), (10, 40, 30, 20))
    p = network.process("P")
    x, y = p.clock("x"), p.clock("y")
    a = p.location("a", invariant=x <= table[n] + 2)
    p.edge(a, a, guard=y >= 2 * n.expression.type.high - n, updates=[n.assign(n)])
    program, _ = lower(network.build())
    assert bounds_of(program, 0, 0) == ({Y: 6}, {X: 42})
    assert program.maximum_constants == (-1, 42, 6)


def test_every_clock_of_an_array_counts_where_the_index_varies() -> None:
    network = NetworkBuilder()
    n = network.integer("n", 1, 2)
    clocks = network.declare("c", ArrayType(ClockType(), IntType(0, 3)))
    p = network.process("P")
    a = p.location("a")
    p.edge(a, a, guard=clocks[n] >= 5, updates=[clocks[n].assign(0), n.assign(1)])
    program, _ = lower(network.build())
    assert bounds_of(program, 0, 0) == ({2: 5, 3: 5}, {})


def test_a_query_keeps_its_clocks_alive_everywhere() -> None:
    network = NetworkBuilder()
    p, q = network.process("P"), network.process("Q")
    x = p.clock("x")
    a, b = p.location("a"), p.location("b")
    p.edge(a, b, updates=[x.assign(0)])
    q.location("only")
    program, _ = lower(network.build(), [(x > 12).expression])
    assert [bounds_of(program, 0, i) for i in (0, 1)] == [({X: 12}, {})] * 2
    assert bounds_of(program, 1, 0) == ({X: 12}, {})


def test_a_query_about_one_location_of_the_process_that_resets_the_clock_counts_there() -> None:
    network = NetworkBuilder()
    p, q = network.process("P"), network.process("Q")
    x = p.clock("x")
    a, b, c = p.location("a"), p.location("b"), p.location("c")
    p.edge(a, b, updates=[x.assign(0)])
    p.edge(b, c)
    only = q.location("only")
    program, _ = lower(network.build(), [(c.reached & (x > 12)).expression])
    assert [bounds_of(program, 0, i) for i in (0, 1, 2)] == [({}, {}), ({X: 12}, {}), ({X: 12}, {})]
    assert bounds_of(program, 1, 0) == ({}, {})
    program, _ = lower(network.build(), [(only.reached & (x > 12)).expression])
    assert bounds_of(program, 0, 0) == ({X: 12}, {})


def test_a_short_disjunction_of_tests_becomes_disjuncts_without_code() -> None:
    network = NetworkBuilder()
    p, q = network.process("P"), network.process("Q")
    a, b = p.location("a"), q.location("b")
    p.edge(a, p.location("c"))
    q.edge(b, q.location("d"))
    _, (goal,) = lower(network.build(), [(a.reached | b.reached).expression])
    assert [disjunct.condition.code for disjunct in goal.disjuncts] == [NO_CODE, NO_CODE]
    assert [len(disjunct.condition.tests) for disjunct in goal.disjuncts] == [1, 1]


def test_clocks_of_a_difference_have_equal_bounds_of_at_least_its_constant_everywhere() -> None:
    network = NetworkBuilder()
    p = network.process("P")
    x, y, z = p.clock("x"), p.clock("y"), p.clock("z")
    a, b = p.location("a", invariant=z <= 3), p.location("b", invariant=x <= 9)
    p.edge(a, b, guard=x - y > 4, updates=[x.assign(0), y.assign(0)])
    p.edge(b, a, updates=[x.assign(0)])
    program, _ = lower(network.build())
    assert program.diagonals == ((2, 1, -8),)
    assert bounds_of(program, 0, 0) == ({1: 4, 2: 4}, {1: 4, 2: 4, 3: 3})
    assert bounds_of(program, 0, 1) == ({1: 9, 2: 4}, {1: 9, 2: 4, 3: 3})


def test_a_clock_set_to_a_value_shifts_the_bound_that_its_difference_needs() -> None:
    network = NetworkBuilder()
    p = network.process("P")
    x, y = p.clock("x"), p.clock("y")
    a = p.location("a")
    p.edge(a, a, guard=x - y < -3, updates=[x.assign(5)])
    program, _ = lower(network.build())
    # After x = 5 the difference is below -3 where y > 8.
    assert bounds_of(program, 0, 0) == ({1: 8, 2: 8}, {1: 8, 2: 8})


def test_with_priorities_every_constraint_counts_in_both_directions() -> None:
    network = NetworkBuilder()
    network.channel("c", priority=2)
    p = network.process("P")
    x = p.clock("x")
    a = p.location("a")
    p.edge(a, a, guard=x >= 3)
    program, _ = lower(network.build())
    assert program.has_priorities
    assert bounds_of(program, 0, 0) == ({X: 3}, {X: 3})


def test_a_stopped_clock_that_is_not_read_before_its_reset_is_inactive() -> None:
    network = NetworkBuilder()
    p = network.process("P")
    x = p.clock("x")
    a, b = p.location("a", rates=[(x, 0)]), p.location("b", invariant=x <= 5)
    p.edge(a, b, updates=[x.assign(0)])
    p.edge(b, a)
    program, _ = lower(network.build())
    assert program.has_stopwatches
    assert bounds_of(program, 0, 0) == ({}, {})
    assert bounds_of(program, 0, 1) == ({}, {X: 5})


def test_a_chain_of_locations_is_settled_for_every_clock() -> None:
    count, clocks = 300, 20
    edges = [
        BoundEdge(i, i + 1, frozenset({i % clocks + 1}), (lower_bound((7 * i) % clocks + 1, i % 13),))
        for i in range(count - 1)
    ]
    found = process_bounds([()] * count, edges)
    for clock in (1, 8, 20):
        assert [dict(b.lower).get(clock, -1) for b in found] == by_definition([()] * count, edges[::-1], clock, False)


def test_conditional_constraints_count() -> None:
    network = NetworkBuilder()
    flag = network.boolean("flag")
    p = network.process("P")
    x = p.clock("x")
    a = p.location("a", invariant=flag.implies(x <= 5))
    p.edge(a, a, updates=[flag.assign(1)])
    program, _ = lower(network.build())
    assert bounds_of(program, 0, 0) == ({}, {X: 5})
    assert program.locations[0][0].invariant.constraints[0].condition >= 0


def test_a_clock_that_a_function_sets_shifts_the_bound_of_its_differences() -> None:
    text = """
    clock x, y; void f() { x = 5; }
    process P() { init location A { to A { guard x - y < -3; assign f(); } } }
    system P;
    """
    program, _ = lower(load_model(Source("model.ta", text)).network)
    assert program.locations[0][0].upper == ((1, 8), (2, 8))
