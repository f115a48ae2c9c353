"""What the domains of the interpreter find, against the reference evaluator on random expressions in random states."""

from __future__ import annotations

from collections.abc import Sequence

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tachk.analysis.failures import can_fail, edge_can_fail
from tachk.analysis.fold import Known, known_values
from tachk.analysis.intervals import interval
from tachk.base.diagnostics.diagnostic import UnsupportedError
from tachk.base.operators import BinaryOperator
from tachk.base.span import Span
from tachk.model.evaluate import Environment, evaluate, execute
from tachk.model.expressions import BOOL, Assign, Binary, Constant, Expression, Reference
from tachk.model.fault import EvaluationFault, RuntimeErrorKind
from tachk.model.network import Edge, Location, Network, Process
from tachk.model.variable_layout import variable_layout
from tests.support.drawn_expressions import COUNT, SMALL, VARIABLES, update_lists, values

NETWORK = Network((Process("P", "P", (Location("a"), Location("b")), ()),), VARIABLES)
LAYOUT = variable_layout(NETWORK)
RANDOM = settings(max_examples=200, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)
STATES = st.tuples(*(st.integers(low, high) for low, high in LAYOUT.ranges)).map(list)
PREDICATES = st.sampled_from([BinaryOperator.LESS, BinaryOperator.GREATER_EQUAL, BinaryOperator.EQUAL])

Outcome = tuple[RuntimeErrorKind, Span] | None


def known_in(state: list[int], expressions: Sequence[Expression]) -> Known:
    """What is known where these are all that writes variables; the state gets it."""
    process = Process("P", "P", (Location("a"), Location("b")), (Edge(0, 1, updates=tuple(expressions)),))
    known = known_values(Network((process,), VARIABLES), [])
    for variable, slots in known.values.items():
        first = LAYOUT.first[variable]
        state[first : first + len(slots)] = slots
    return known


def environment(state: list[int]) -> Environment:
    return Environment(LAYOUT, state, locations=(0,))


def outcome(updates: Sequence[Expression], scratch: Environment) -> Outcome:
    try:
        execute(updates, scratch)
    except EvaluationFault as fault:
        return fault.kind, fault.span
    return None


@RANDOM
@given(values(effects=True) | values(effects=False), STATES)
def test_values_lie_in_their_intervals(expression: Expression, state: list[int]) -> None:
    known = known_in(state, [expression])
    low, high = interval(expression, known)
    try:
        assert low <= evaluate(expression, environment(state)) <= high
    except EvaluationFault:
        assert can_fail(expression, known)


@RANDOM
@given(update_lists(), STATES, PREDICATES, st.integers(SMALL.low, SMALL.high))
def test_updates_behind_a_guard_fail_only_if_they_can(
    updates: list[Expression], state: list[int], operator: BinaryOperator, number: int
) -> None:
    guard = Binary(operator, Reference(COUNT), Constant(number), BOOL)
    known = known_in(state, [*updates, Assign(Reference(COUNT), Constant(0), SMALL)])
    if evaluate(guard, environment(state)) and outcome(updates, environment(state)) is not None:
        assert edge_can_fail(Edge(0, 1, guard=guard, updates=tuple(updates)), known)


@RANDOM
@given(update_lists(), STATES)
def test_terms_of_known_numbers_are_what_the_evaluator_computes(updates: list[Expression], state: list[int]) -> None:
    pytest.importorskip("z3")
    from tachk.engine.smt.machine import Machine
    from tachk.engine.smt.storage import CLOCK_SOURCE, CLOCK_VALUE, STATE, Storage
    from tachk.engine.smt.terms import constant

    slots = {(STATE, position): constant(value) for position, value in enumerate(state)}
    clocks = range(1, len(LAYOUT.clock_slots) + 1)
    for clock in clocks:
        slots[CLOCK_SOURCE, clock], slots[CLOCK_VALUE, clock] = constant(clock), constant(0)
    machine = Machine(LAYOUT, (constant(0),), Storage(slots, {STATE: LAYOUT.ranges}), lambda *_: False)
    scratch = environment(list(state))
    expected = outcome(updates, scratch)
    try:
        machine.execute(updates)
    except UnsupportedError:
        return
    faults = [(fault.condition, fault.kind, fault.span) for fault in machine.faults[:1]]
    assert faults == ([] if expected is None else [(True, *expected)])
    if expected is None:
        assert [slots[STATE, position].low for position in range(len(state))] == scratch.values
        for clock in clocks:
            found = slots[CLOCK_SOURCE, clock].low, slots[CLOCK_VALUE, clock].low
            assert found == scratch.resets.get(clock, (clock, 0))
