"""Compiled code against the reference evaluator: same values, same effects, same run-time errors at the same place."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import pytest
from hypothesis import HealthCheck, given, settings

from tachk.analysis.failures import can_fail, edge_can_fail
from tachk.analysis.fold import known_values
from tachk.base.operators import BinaryOperator
from tachk.base.span import Span
from tachk.engine.compiler.codegen import CodeGenerator
from tachk.engine.compiler.lower import lower
from tachk.engine.compiler.program import Program
from tachk.engine.compiler.slot_layout import SlotLayout
from tachk.engine.outcome import Status
from tachk.engine.zone import explore
from tachk.model.evaluate import Environment, composed, evaluate, execute
from tachk.model.expressions import (
    BOOL,
    INT,
    Assign,
    Binary,
    Comma,
    Conditional,
    Constant,
    Expression,
    Field,
    Index,
    LocationTest,
    Reference,
)
from tachk.model.fault import EvaluationFault, RuntimeErrorKind
from tachk.model.network import Edge, Location, Network, Process
from tachk.model.types import ArrayType, ClockType, RecordType
from tachk.model.variable_layout import variable_layout
from tests.support.drawn_expressions import CLOCKS, COUNT, FLAG, SMALL, VARIABLES, WIDE, span, update_lists, values
from tests.support.machine import Machine, initial_slots


def network(updates: Sequence[Expression] = (), guard: Expression | None = None) -> Network:
    edge = Edge(0, 1, guard=guard, updates=tuple(updates))
    return Network((Process("P", "P", (Location("a"), Location("b")), (edge,)),), VARIABLES)


def run_program(program: Program, code: int) -> tuple[object, Machine]:
    machine = Machine(program, initial_slots(program))
    try:
        return machine.run(code), machine
    except EvaluationFault as fault:
        return (fault.kind, fault.span), machine


def compare_value(expression: Expression, effects: bool = True) -> None:
    """Compiles and evaluates an expression and asserts that the outcomes are equal."""
    net = network([expression] if effects else [])
    known = known_values(net, [])
    layout = SlotLayout(net, known)
    generator = CodeGenerator(layout, known)
    start = generator.value_code(expression)
    generator.finish()
    program = replace(
        lower(network())[0],
        slots=tuple(layout.slots),
        code=tuple(generator.assembler.code),
        sites=tuple(generator.assembler.sites),
    )
    environment = Environment(variable_layout(net), list(variable_layout(net).initial), locations=(0,))
    expected: object
    try:
        expected = evaluate(expression, environment)
    except EvaluationFault as fault:
        expected = (fault.kind, fault.span)
        assert can_fail(expression, known)
    actual, machine = run_program(program, start)
    assert actual == expected
    if not isinstance(expected, tuple):
        assert machine.slots[1 : layout.state_slots] == environment.values


def compare_updates(updates: Sequence[Expression]) -> None:
    """Runs the updates of an edge both ways and asserts equal states, resets and errors."""
    net = network(updates)
    layout = variable_layout(net)
    environment = Environment(layout, list(layout.initial), locations=(0,))
    fault: tuple[RuntimeErrorKind, Span] | None = None
    try:
        execute(updates, environment)
    except EvaluationFault as caught:
        fault = (caught.kind, caught.span)
        assert edge_can_fail(net.processes[0].edges[0], known_values(net, []))
    program, _ = lower(net)
    update = program.edges[0].update
    machine = Machine(program, initial_slots(program))
    outcome: object = None
    if update.code >= 0:
        outcome, machine = run_program(program, update.code)
    else:
        for slot, value in update.stores:
            assert program.slots[slot].low <= value <= program.slots[slot].high
            machine.slots[slot] = value
        for clock, value, source in update.resets:
            machine.resets |= composed(machine.resets, {clock: (source, value)})
    assert outcome == fault
    if fault is None:
        assert machine.slots[1 : program.state_slots] == environment.values
        assert machine.resets == environment.resets


# ---- random expressions ---------------------------------------------------------------------------------------------

RANDOM = settings(max_examples=200, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True)


@RANDOM
@given(values(effects=True))
def test_values_agree_with_the_evaluator(expression: Expression) -> None:
    compare_value(expression)


@RANDOM
@given(values(effects=False))
def test_values_without_effects_agree_when_variables_are_known(expression: Expression) -> None:
    compare_value(expression, effects=False)


@RANDOM
@given(update_lists())
def test_updates_agree_with_the_evaluator(updates: list[Expression]) -> None:
    compare_updates(updates)


def leaf_places(place: Expression) -> list[Expression]:
    """The slots of a place, as places."""
    match place.type:
        case ArrayType(element) as array:
            numbers = range(array.low, array.low + array.size)
            return [p for i in numbers for p in leaf_places(Index(place, Constant(i), element))]
        case RecordType(_, fields):
            return [p for name, type_ in fields for p in leaf_places(Field(place, name, type_))]
    return [place]


def compare_with_engine(updates: list[Expression]) -> None:
    """Lets the engine take an edge with the updates and asserts the state behind it, or the error and its place."""
    plain = network(updates)
    urgent = tuple(replace(location, urgent=True) for location in plain.processes[0].locations)
    net = replace(plain, processes=(replace(plain.processes[0], locations=urgent),))
    layout = variable_layout(net)
    environment = Environment(layout, list(layout.initial), locations=(0,))
    fault: tuple[RuntimeErrorKind, Span] | None = None
    try:
        execute(updates, environment)
    except EvaluationFault as caught:
        fault = (caught.kind, caught.span)
    places = [p for v in VARIABLES for p in leaf_places(Reference(v))]
    after: Expression = LocationTest(0, 1)
    for place, value in zip(places, environment.values, strict=True):
        expected = environment.resets.get(value, (0, 0))[1] if isinstance(place.type, ClockType) else value
        equal = Binary(BinaryOperator.EQUAL, place, Constant(expected), BOOL)
        after = Binary(BinaryOperator.AND, after, equal, BOOL)
    outcome = explore(*lower(net, [after]))
    if fault is None:
        assert outcome.goals[0].status is Status.REACHED
    else:
        assert outcome.fault is not None
        assert (outcome.fault.kind, outcome.fault.span) == fault


@settings(RANDOM, max_examples=80)
@given(update_lists())
def test_updates_agree_with_the_engine(updates: list[Expression]) -> None:
    compare_with_engine(updates)


@pytest.mark.parametrize("value", [-(2**31), -1])
@pytest.mark.parametrize("chosen", [False, True])
def test_a_clock_set_to_a_negative_constant_is_an_error_in_the_engine(value: int, chosen: bool) -> None:
    clock = Index(Reference(CLOCKS), Constant(1), ClockType())
    number: Expression = Constant(value)
    if chosen:
        number = Conditional(Reference(FLAG), number, Constant(3), INT)
    compare_with_engine([Assign(clock, number, ClockType(), span=span())])


@pytest.mark.parametrize("inside", [0, 1, 2])
@pytest.mark.parametrize("target", [0, 1])
@pytest.mark.parametrize("before", [0, 2])
def test_what_the_sum_that_a_clock_is_set_to_sets_is_set_before(target: int, inside: int, before: int) -> None:
    clocks = [Index(Reference(CLOCKS), Constant(number), ClockType()) for number in range(3)]
    first = Assign(clocks[before], Constant(7), ClockType(), span=span())
    offset = Comma((Assign(clocks[inside], Constant(4), ClockType(), span=span()), Constant(2)), INT, span())
    whole = Binary(BinaryOperator.ADD, clocks[1], offset, ClockType(), span())
    compare_updates([first, Assign(clocks[target], whole, ClockType(), span=span())])
    compare_with_engine([first, Assign(clocks[target], whole, ClockType(), span=span())])


@pytest.mark.parametrize("left", [0, 1, 2])
@pytest.mark.parametrize("right", [0, 1, 2])
def test_exclusive_or_compares_truths(left: int, right: int) -> None:
    first = Assign(Reference(COUNT), Constant(left), SMALL)
    second = Assign(Reference(WIDE), Constant(right), WIDE.type)
    compare_value(Binary(BinaryOperator.XOR, first, second, BOOL, span()))
