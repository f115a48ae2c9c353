"""Guards, invariants and predicates: what they are split into, and that the parts mean the same as the whole."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tachk.base.diagnostics.diagnostic import UnsupportedError
from tachk.engine.compiler.lower import lower
from tachk.engine.compiler.program import (
    NO_CODE,
    ClockConstraint,
    Comparison,
    Condition,
    DeadlockLiteral,
    Goal,
    Program,
)
from tachk.engine.compiler.program import Test as SlotTest
from tachk.model.builder import NetworkBuilder, ProcessBuilder, Term, bound_variable, conditional, deadlock, quantifier
from tachk.model.evaluate import Environment, evaluate
from tachk.model.expressions import BOOL, Conditional, Constant, Expression, QuantifierKind
from tachk.model.network import Network
from tachk.model.types import ArrayType, ClockType, IntType
from tachk.model.variable_layout import variable_layout
from tests.support.machine import Machine, initial_slots


class Model:
    """One process with a guarded edge, some variables and clocks."""

    def __init__(self) -> None:
        self.network = NetworkBuilder()
        self.n = self.network.integer("n", -2, 4)
        self.flag = self.network.boolean("flag")
        self.table = self.network.declare("table", ArrayType(IntType(0, 9), IntType(0, 2)), (3, 1, 4))
        self.process: ProcessBuilder = self.network.process("P")
        self.x, self.y = self.process.clock("x"), self.process.clock("y")
        self.clocks = self.process.declare("c", ArrayType(ClockType(), IntType(0, 1)))
        self.a = self.process.location("a")
        self.b = self.process.location("b")
        # Everything is written somewhere, so nothing counts as known.
        self.process.edge(self.b, self.a, updates=[self.n.assign(1), self.flag.assign(1), self.table[0].assign(1)])

    def guard(self, guard: Term) -> tuple[Program, Condition]:
        """The compiled guard of an edge; the edge must not be dropped."""
        self.process.edge(self.a, self.b, guard=guard)
        program, _ = lower(self.network.build())
        return program, program.edges[1].guard

    def goal(self, predicate: Term) -> tuple[Program, Goal]:
        program, goals = lower(self.network.build(), [predicate.expression])
        return program, goals[0]

    def slot(self, term: Term) -> int:
        layout = variable_layout(self.network.build())
        (variable,) = (v for v in layout.first if v is getattr(term.expression, "variable", None))
        return 1 + layout.first[variable]


X, Y, C0, C1 = 1, 2, 3, 4


def upper(clock: int, bound: int, strict: bool = False) -> ClockConstraint:
    return ClockConstraint(clock, 0, strict, bound)


def lower_constraint(clock: int, bound: int, strict: bool = False) -> ClockConstraint:
    return ClockConstraint(0, clock, strict, -bound)


def test_conjuncts_become_tests_code_and_constraints() -> None:
    m = Model()
    _, guard = m.guard((m.n == 2) & m.flag & (m.x <= 5) & (m.n * 2 > 3) & (m.y > 1))
    assert guard.tests == (
        SlotTest(m.slot(m.n), Comparison.EQUAL, 2),
        SlotTest(m.slot(m.flag), Comparison.NOT_EQUAL, 0),
    )
    assert guard.code != NO_CODE
    assert guard.constraints == (upper(X, 5), lower_constraint(Y, 1, strict=True))


def test_negations_are_pushed_inwards() -> None:
    m = Model()
    _, guard = m.guard(~((m.x > 5) | ~m.flag | (m.n < 1)))
    assert guard.tests == (
        SlotTest(m.slot(m.flag), Comparison.NOT_EQUAL, 0),
        SlotTest(m.slot(m.n), Comparison.GREATER_EQUAL, 1),
    )
    assert guard.constraints == (upper(X, 5),)


@pytest.mark.parametrize(
    ("comparison", "expected"),
    [
        (lambda m: m.x == 5, (upper(X, 5), lower_constraint(X, 5))),
        (lambda m: m.x < 5, (upper(X, 5, strict=True),)),
        (lambda m: m.x - m.y < 3, (ClockConstraint(X, Y, True, 3),)),
        (lambda m: m.x < m.y, (ClockConstraint(X, Y, True, 0),)),
        (lambda m: m.x >= m.y + 2, (ClockConstraint(Y, X, False, -2),)),
        (lambda m: 3 - m.x <= 1, (lower_constraint(X, 2),)),
        (lambda m: m.clocks[1] <= 3, (upper(C1, 3),)),
        (lambda m: m.x >= 0, ()),
        (lambda m: m.x - m.x < 3, ()),
    ],
)
def test_forms_of_clock_comparisons(comparison: object, expected: tuple[ClockConstraint, ...]) -> None:
    m = Model()
    assert callable(comparison)
    assert m.guard(comparison(m))[1] == Condition(constraints=expected)


def test_a_variable_bound_becomes_code() -> None:
    m = Model()
    program, guard = m.guard(m.x <= m.table[m.n] + 2)
    (constraint,) = guard.constraints
    machine = Machine(program, initial_slots(program))
    assert (constraint.left, constraint.right) == (X, 0)
    assert machine.run(constraint.bound_code) == 5


def test_a_variable_index_becomes_code() -> None:
    m = Model()
    program, guard = m.guard(m.clocks[m.n] <= 3)
    (constraint,) = guard.constraints
    machine = Machine(program, initial_slots(program))
    machine.slots[m.slot(m.n)] = 1
    assert machine.run(constraint.left_code) == C1


@pytest.mark.parametrize(
    "guard",
    [
        lambda m: m.flag | (m.x <= 5),
        lambda m: (m.x <= 5) | m.flag,
        lambda m: (~m.flag).implies(m.x <= 5),
        lambda m: conditional(m.flag, True, m.x <= 5),
    ],
)
def test_a_disjunction_with_one_clock_side_is_a_conditional_constraint(guard: object) -> None:
    m = Model()
    assert callable(guard)
    program, condition = m.guard(guard(m))
    (constraint,) = condition.constraints
    assert constraint.bound == 5
    machine = Machine(program, initial_slots(program))
    assert machine.run(constraint.condition) == 1
    machine.slots[m.slot(m.flag)] = 1
    assert machine.run(constraint.condition) == 0


def test_forall_over_clocks_is_expanded() -> None:
    m = Model()
    i = bound_variable("i", IntType(0, 1))
    _, guard = m.guard(quantifier(QuantifierKind.FORALL, i, (m.clocks[i] <= 3) & (m.table[i] != 2)))
    assert guard.constraints == (upper(C0, 3), upper(C1, 3))
    first = m.slot(m.table)
    assert guard.tests == (SlotTest(first, Comparison.NOT_EQUAL, 2), SlotTest(first + 1, Comparison.NOT_EQUAL, 2))
    assert guard.code == NO_CODE


def test_a_test_that_the_range_decides_disappears() -> None:
    m = Model()
    _, guard = m.guard((m.n <= 4) & (m.n >= -2) & (m.flag != 7))
    assert guard == Condition()


def test_conditions_that_may_fail_keep_their_order() -> None:
    m = Model()
    program, guard = m.guard((m.n >= 0) & (m.table[m.n] == 3) & (m.n % 2 == 0))
    machine = Machine(program, initial_slots(program))
    machine.slots[m.slot(m.n)] = -1
    assert guard.tests == (SlotTest(m.slot(m.n), Comparison.GREATER_EQUAL, 0),)
    machine.slots[m.slot(m.n)] = 0
    assert machine.run(guard.code) == 1


@pytest.mark.parametrize(
    ("code", "guard"),
    [
        ("E0705", lambda m: (m.x >= 1) | (m.y >= 1)),
        ("E0705", lambda m: m.x != 1),
        ("E0705", lambda m: ~(m.x == 1)),
        ("E0706", lambda m: m.x + m.y <= 3),
        ("E0704", lambda m: m.x <= -(2**31)),
        ("E0704", lambda m: m.x <= m.table[0] * 2**30),
    ],
)
def test_what_cannot_be_a_guard_is_rejected(code: str, guard: object) -> None:
    m = Model()
    assert callable(guard)
    with pytest.raises(UnsupportedError) as caught:
        m.guard(guard(m))
    assert caught.value.diagnostic.code == code


# ---- goals ----------------------------------------------------------------------------------------------------------


def test_integer_parts_of_a_goal_stay_one_piece() -> None:
    m = Model()
    _, goal = m.goal((m.a.reached | (m.n > 2)) & (m.flag | (m.n < 1)))
    (disjunct,) = goal.disjuncts
    assert disjunct.condition.code != NO_CODE
    assert disjunct.deadlock is DeadlockLiteral.ABSENT


def test_clock_comparisons_are_multiplied_out() -> None:
    m = Model()
    _, goal = m.goal(((m.x < 1) | (m.y < 2)) & ((m.x > 3) | m.b.reached))
    assert [d.condition for d in goal.disjuncts] == [
        Condition(constraints=(upper(X, 1, True), lower_constraint(X, 3, True))),
        Condition((SlotTest(0, Comparison.EQUAL, 1),), constraints=(upper(X, 1, True),)),
        Condition(constraints=(upper(Y, 2, True), lower_constraint(X, 3, True))),
        Condition((SlotTest(0, Comparison.EQUAL, 1),), constraints=(upper(Y, 2, True),)),
    ]


def test_a_conjunction_of_thousands_of_parts_is_compiled() -> None:
    m = Model()
    everywhere = [(m.n * m.n < 100 + i) & (m.n * m.n != 50 + i) for i in range(2000)]
    while len(everywhere) > 1:
        everywhere = [a & b for a, b in zip(everywhere[::2], everywhere[1::2], strict=False)] + everywhere[
            len(everywhere) // 2 * 2 :
        ]
    program, goal = m.goal(everywhere[0])
    (disjunct,) = goal.disjuncts
    assert Machine(program, initial_slots(program)).run(disjunct.condition.code) == 1


def test_inequality_of_a_clock_has_two_disjuncts() -> None:
    m = Model()
    _, goal = m.goal(m.x != 4)
    assert [d.condition.constraints for d in goal.disjuncts] == [
        (upper(X, 4, True),),
        (lower_constraint(X, 4, True),),
    ]


def test_deadlock_literals() -> None:
    m = Model()
    _, goal = m.goal((deadlock() & m.a.reached) | (~deadlock() & (m.x > 2)) | (deadlock() & ~deadlock()))
    assert [d.deadlock for d in goal.disjuncts] == [DeadlockLiteral.REQUIRED, DeadlockLiteral.FORBIDDEN]


def test_a_false_predicate_has_no_disjuncts() -> None:
    m = Model()
    assert m.goal((m.n > 4) & (m.x > 1))[1] == Goal(())


def test_a_right_side_that_may_fail_is_evaluated_only_where_the_left_is_false() -> None:
    m = Model()
    _, goal = m.goal((m.n < 0) | (m.x <= m.table[m.n]))
    assert len(goal.disjuncts) == 2
    assert goal.disjuncts[1].condition.tests == (SlotTest(m.slot(m.n), Comparison.GREATER_EQUAL, 0),)


def test_too_many_disjuncts_are_rejected() -> None:
    m = Model()
    predicate = (m.x < 0) | (m.y > 0)
    for i in range(1, 13):
        predicate = predicate & ((m.x < i) | (m.y > i))
    with pytest.raises(UnsupportedError) as caught:
        m.goal(predicate)
    assert caught.value.diagnostic.code == "E0707"


# ---- random conditions ----------------------------------------------------------------------------------------------


def constraint_holds(constraint: ClockConstraint, machine: Machine, clocks: Sequence[Fraction]) -> bool:
    def number(code: int, otherwise: int) -> int:
        if code == NO_CODE:
            return otherwise
        value = machine.run(code)
        assert value is not None
        return value

    if number(constraint.condition, 1) == 0:
        return True
    value = [Fraction(0), *clocks]
    left, right = number(constraint.left_code, constraint.left), number(constraint.right_code, constraint.right)
    bound = number(constraint.bound_code, constraint.bound)
    difference = value[left] - value[right]
    return difference < bound if constraint.strict else difference <= bound


_COMPARE = {
    Comparison.EQUAL: lambda a, b: a == b,
    Comparison.NOT_EQUAL: lambda a, b: a != b,
    Comparison.LESS: lambda a, b: a < b,
    Comparison.LESS_EQUAL: lambda a, b: a <= b,
    Comparison.GREATER: lambda a, b: a > b,
    Comparison.GREATER_EQUAL: lambda a, b: a >= b,
}


def condition_holds(condition: Condition, machine: Machine, clocks: Sequence[Fraction]) -> bool:
    if not all(_COMPARE[t.comparison](machine.slots[t.slot], t.constant) for t in condition.tests):
        return False
    if condition.code != NO_CODE and not machine.run(condition.code):
        return False
    return all(constraint_holds(c, machine, clocks) for c in condition.constraints)


MODEL = Model()


def integers(depth: int) -> st.SearchStrategy[Term]:
    simple = st.sampled_from([MODEL.n, MODEL.table[0], MODEL.table[2]]) | st.integers(-2, 5).map(Constant).map(Term)
    if depth == 0:
        return simple
    smaller = integers(depth - 1)
    return simple | st.tuples(smaller, smaller).map(lambda p: p[0] + p[1]) | smaller.map(lambda t: t % 3)


def comparisons(left: st.SearchStrategy[Term], right: st.SearchStrategy[Term]) -> st.SearchStrategy[Term]:
    def compare(parts: tuple[int, Term, Term]) -> Term:
        kind, a, b = parts
        return [a == b, a != b, a < b, a <= b, a > b, a >= b][kind]

    return st.tuples(st.integers(0, 5), left, right).map(compare)


def discrete(depth: int) -> st.SearchStrategy[Term]:
    simple = comparisons(integers(1), integers(1)) | st.sampled_from([MODEL.flag, MODEL.a.reached, MODEL.b.reached])
    if depth == 0:
        return simple
    return simple | connected(discrete(depth - 1), discrete(depth - 1))


def connected(left: st.SearchStrategy[Term], right: st.SearchStrategy[Term]) -> st.SearchStrategy[Term]:
    def connect(parts: tuple[int, Term, Term]) -> Term:
        kind, a, b = parts
        return [a & b, a | b, a.implies(b), ~a][kind]

    return st.tuples(st.integers(0, 3), left, right).map(connect)


INDEX = bound_variable("i", IntType(0, 1))
CLOCK = st.sampled_from([MODEL.x, MODEL.y, MODEL.clocks[0], MODEL.clocks[conditional(MODEL.flag, 0, 1)]])
DIFFERENCE = st.tuples(CLOCK, CLOCK).map(lambda p: p[0] - p[1])
TIMED = comparisons(CLOCK | DIFFERENCE, integers(1)) | comparisons(integers(1), CLOCK) | comparisons(CLOCK, CLOCK)


def predicates(depth: int) -> st.SearchStrategy[Term]:
    simple = TIMED | discrete(1) | st.just(deadlock())
    if depth == 0:
        return simple
    smaller = predicates(depth - 1)
    quantified = st.tuples(
        st.sampled_from([QuantifierKind.FORALL, QuantifierKind.EXISTS]),
        smaller,
        comparisons(st.just(MODEL.clocks[INDEX]), integers(1) | st.just(INDEX)),
    ).map(lambda p: quantifier(p[0], INDEX, p[1] & p[2]))
    chosen = st.tuples(discrete(1), smaller, smaller).map(
        lambda p: Term(Conditional(p[0].expression, p[1].expression, p[2].expression, BOOL))
    )
    return simple | connected(smaller, smaller) | quantified | chosen


def guards(depth: int) -> st.SearchStrategy[Term]:
    """Conditions that are convex in the clocks in every discrete state."""
    convex = comparisons(CLOCK | DIFFERENCE, integers(1)).filter(lambda t: _operator(t) != "!=")
    simple = convex | discrete(1)
    if depth == 0:
        return simple
    smaller = guards(depth - 1)
    return (
        simple
        | st.tuples(smaller, smaller).map(lambda p: p[0] & p[1])
        | st.tuples(discrete(1), smaller).map(lambda p: p[0] | p[1])
        | st.tuples(smaller, discrete(1)).map(lambda p: p[0] | p[1])
        | st.tuples(discrete(1), smaller).map(lambda p: p[0].implies(p[1]))
        | st.tuples(discrete(1), smaller, smaller).map(
            lambda p: Term(Conditional(p[0].expression, p[1].expression, p[2].expression, BOOL))
        )
        | smaller.map(lambda g: quantifier(QuantifierKind.FORALL, INDEX, g & (MODEL.clocks[INDEX] <= INDEX + 1)))
        | convex.filter(lambda t: _operator(t) != "==").map(lambda t: ~t)
    )


def _operator(term: Term) -> str:
    return str(getattr(term.expression, "operator", ""))


CLOCK_VALUES = st.lists(st.integers(0, 12).map(lambda n: Fraction(n, 2)), min_size=4, max_size=4)
STATES = st.tuples(
    st.integers(0, 1), st.integers(-2, 4), st.integers(0, 1), st.lists(st.integers(0, 9), min_size=3, max_size=3)
)


def machine_in(program: Program, network: Network, state: tuple[int, int, int, list[int]]) -> tuple[Machine, list[int]]:
    """A machine and the evaluator's slots in the given state."""
    location, n, flag, table = state
    values = list(variable_layout(network).initial)
    values[:5] = [n, flag, *table]
    slots = initial_slots(program)
    slots[: 1 + len(values)] = [location, *values]
    return Machine(program, slots), values


NETWORK = MODEL.network.build()


@settings(max_examples=200, deadline=None, derandomize=True)
@given(predicates(3), STATES, CLOCK_VALUES, st.booleans())
def test_a_goal_means_its_predicate(
    predicate: Term, state: tuple[int, int, int, list[int]], clocks: list[Fraction], stuck: bool
) -> None:
    program, (goal,) = lower(NETWORK, [predicate.expression])
    machine, values = machine_in(program, NETWORK, state)
    environment = Environment(
        variable_layout(NETWORK), values, locations=(state[0],), clocks=clocks, deadlock=lambda: stuck
    )
    reached = any(
        disjunct.deadlock in (DeadlockLiteral.ABSENT, DeadlockLiteral.REQUIRED if stuck else DeadlockLiteral.FORBIDDEN)
        and condition_holds(disjunct.condition, machine, clocks)
        for disjunct in goal.disjuncts
    )
    assert reached == (evaluate(predicate.expression, environment) != 0)


def with_guard(guard: Expression) -> Network:
    """The model with a guard in place of the invariant of its first location, where a false one is kept."""
    process = NETWORK.processes[0]
    locations = (replace(process.locations[0], invariant=guard), *process.locations[1:])
    return replace(NETWORK, processes=(replace(process, locations=locations),))


@settings(max_examples=200, deadline=None, derandomize=True)
@given(guards(3), STATES, CLOCK_VALUES)
def test_a_compiled_condition_means_its_expression(
    guard: Term, state: tuple[int, int, int, list[int]], clocks: list[Fraction]
) -> None:
    network = with_guard(guard.expression)
    program, _ = lower(network)
    machine, values = machine_in(program, network, state)
    environment = Environment(variable_layout(network), values, locations=(state[0],), clocks=clocks)
    actual = condition_holds(program.locations[0][0].invariant, machine, clocks)
    assert actual == (evaluate(guard.expression, environment) != 0)
