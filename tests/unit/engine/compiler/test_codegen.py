"""Compiled code against the reference evaluator: same values, same effects, same run-time errors at the same place."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tachk.analysis.failures import can_fail, edge_can_fail
from tachk.analysis.fold import known_values
from tachk.base.operators import BinaryOperator, OperandGroup, UnaryOperator
from tachk.base.span import Source, Span
from tachk.engine.compiler.codegen import CodeGenerator
from tachk.engine.compiler.lower import lower
from tachk.engine.compiler.program import Program
from tachk.engine.compiler.slot_layout import SlotLayout
from tachk.engine.outcome import Status
from tachk.engine.zone import explore
from tachk.model.cell_layout import cell_layout
from tachk.model.evaluate import Environment, composed, evaluate, execute
from tachk.model.expressions import (
    BOOL,
    INT,
    Aggregate,
    Assert,
    Assign,
    Binary,
    Block,
    Call,
    Comma,
    Conditional,
    Constant,
    Declare,
    Evaluate,
    Expression,
    Field,
    Function,
    If,
    Increment,
    Index,
    Iterate,
    LocationTest,
    Quantifier,
    QuantifierKind,
    Reference,
    Return,
    Statement,
    Unary,
    Variable,
    VariableKind,
    While,
)
from tachk.model.fault import EvaluationFault, RuntimeErrorKind
from tachk.model.network import Edge, Location, Network, Process
from tachk.model.types import ArrayType, BoolType, ClockType, IntType, RecordType, Type
from tests.support.machine import Machine, initial_slots

SMALL = IntType(-3, 6)
RECORD = RecordType("pair", (("p", SMALL), ("q", ArrayType(SMALL, IntType(1, 2)))))

COUNT = Variable("count", SMALL, VariableKind.GLOBAL, (1,))
WIDE = Variable("wide", IntType(-(2**31), 2**31 - 1), VariableKind.GLOBAL, (2**31 - 1,))
FLAG = Variable("flag", BoolType(), VariableKind.GLOBAL, (1,))
TABLE = Variable("table", ArrayType(SMALL, IntType(0, 3)), VariableKind.GLOBAL, (3, 0, -1, 2))
FIXED = Variable("fixed", ArrayType(IntType(), IntType(0, 2)), VariableKind.GLOBAL, (100, 200, 1))
ONE = Variable("one", RECORD, VariableKind.GLOBAL, (1, 2, 3))
MANY = Variable("many", ArrayType(RECORD, IntType(-1, 0)), VariableKind.GLOBAL, (0, 1, 2, 3, 4, 5))
CLOCKS = Variable("clocks", ArrayType(ClockType(), IntType(0, 2)), VariableKind.GLOBAL, (0, 0, 0))
VARIABLES = (COUNT, WIDE, FLAG, TABLE, FIXED, ONE, MANY, CLOCKS)

_SOURCE = Source("test", "x" * 10)
_numbers = itertools.count()


def span() -> Span:
    """A place of its own for every node, so that the place of an error can be compared."""
    number = next(_numbers)
    return Span(_SOURCE, number, number + 1)


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
    environment = Environment(cell_layout(net), list(cell_layout(net).initial), locations=(0,))
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
    layout = cell_layout(net)
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

ARITHMETIC = [each for each in BinaryOperator if each.group is OperandGroup.ARITHMETIC]
COMPARISONS = [each for each in BinaryOperator if each.group is OperandGroup.COMPARISON]
LOGIC = [each for each in BinaryOperator if each.group is OperandGroup.CONNECTIVE]


class Drawer:
    """Draws expressions over the variables above and those in scope."""

    def __init__(self, draw: st.DrawFn, effects: bool = True, functions: int = 2) -> None:
        self.draw = draw
        self.effects = effects
        self.scope: list[Variable] = []
        self.functions = functions

    def pick(self, choices: Sequence[str]) -> str:
        return self.draw(st.sampled_from(list(choices)))

    def integer(self, depth: int) -> Expression:
        kinds = ["constant", "place"]
        if depth > 0:
            kinds += ["arithmetic", "minus", "conditional", "sum", "boolean", "place"]
            if self.effects:
                kinds += ["assign", "increment", "comma"]
                if self.functions:
                    kinds += ["call"]
        match self.pick(kinds):
            case "constant":
                return Constant(self.draw(st.integers(-3, 5) | st.sampled_from([31, 32, 2**31 - 1, -(2**31)])), INT)
            case "place":
                return self.place(depth - 1)
            case "arithmetic":
                operator = self.draw(st.sampled_from(ARITHMETIC))
                return Binary(operator, self.integer(depth - 1), self.integer(depth - 1), INT, span())
            case "minus":
                return Unary(UnaryOperator.MINUS, self.integer(depth - 1), INT, span())
            case "conditional":
                return Conditional(
                    self.boolean(depth - 1), self.integer(depth - 1), self.integer(depth - 1), INT, span()
                )
            case "sum":
                return self.quantifier(QuantifierKind.SUM, depth)
            case "assign":
                return self.assign(depth)
            case "increment":
                prefix = self.draw(st.booleans())
                return Increment(self.place(depth - 1), self.draw(st.sampled_from([1, -1])), prefix, INT, span())
            case "comma":
                return Comma((self.effect(depth - 1), self.integer(depth - 1)), INT, span())
            case "call":
                return self.call(depth)
            case _:
                return self.boolean(depth - 1)

    def boolean(self, depth: int) -> Expression:
        kinds = ["flag", "location", "comparison"]
        if depth > 0:
            kinds += ["logic", "logic", "not", "forall", "exists", "aggregates", "integer"]
        match self.pick(kinds):
            case "flag":
                return Reference(FLAG, span())
            case "location":
                return LocationTest(0, self.draw(st.integers(0, 1)))
            case "logic":
                operator = self.draw(st.sampled_from(LOGIC))
                return Binary(operator, self.boolean(depth - 1), self.boolean(depth - 1), BOOL, span())
            case "not":
                return Unary(UnaryOperator.NOT, self.boolean(depth - 1), BOOL, span())
            case "forall":
                return self.quantifier(QuantifierKind.FORALL, depth)
            case "exists":
                return self.quantifier(QuantifierKind.EXISTS, depth)
            case "aggregates":
                operator = self.draw(st.sampled_from(COMPARISONS[:2]))
                return Binary(operator, self.record(depth - 1), self.record(depth - 1), BOOL, span())
            case "integer":
                return self.integer(depth - 1)
            case _:
                operator = self.draw(st.sampled_from(COMPARISONS))
                return Binary(operator, self.integer(depth - 1), self.integer(depth - 1), BOOL, span())

    def quantifier(self, kind: QuantifierKind, depth: int) -> Expression:
        low = self.draw(st.integers(-1, 2))
        variable = Variable("q", IntType(low, low + self.draw(st.integers(0, 3))), VariableKind.BOUND)
        self.scope.append(variable)
        body = self.integer(depth - 1) if kind is QuantifierKind.SUM else self.boolean(depth - 1)
        self.scope.pop()
        return Quantifier(kind, variable, body, INT if kind is QuantifierKind.SUM else BOOL, span())

    def read_only(self, depth: int) -> Expression:
        choices: list[Expression] = [Constant(self.draw(st.integers(-1, 3)))]
        choices += [Reference(v) for v in self.scope if not isinstance(v.type, ArrayType | RecordType)]
        return self.draw(st.sampled_from(choices)) if depth <= 0 else self.integer(depth - 1)

    def place(self, depth: int) -> Expression:
        """An assignable place that holds an integer."""
        arrays = [v for v in self.scope if isinstance(v.type, ArrayType) and v.kind is VariableKind.FRAME]
        scalars = [v for v in self.scope if v.type == SMALL and v.kind is VariableKind.FRAME]
        records = [v for v in self.scope if isinstance(v.type, RecordType)]
        match self.pick(["count", "table", "one", "many", "wide", "conditional", "frame", "fixed"]):
            case "wide":
                return Reference(WIDE)
            case "table":
                return Index(Reference(TABLE), self.read_only(depth), SMALL, span())
            case "fixed" if not self.effects:
                return Index(Reference(FIXED), self.read_only(depth), INT, span())
            case "one":
                return Field(Reference(self.draw(st.sampled_from([ONE, *records]))), "p", SMALL, span())
            case "many":
                inner = Index(Reference(MANY), self.read_only(depth), RECORD, span())
                fields = Field(inner, "q", ArrayType(SMALL, IntType(1, 2)), span())
                return Index(fields, self.read_only(depth), SMALL, span())
            case "conditional" if depth > 0:
                return Conditional(self.boolean(0), self.place(depth - 1), self.place(depth - 1), SMALL, span())
            case "frame" if arrays:
                return Index(Reference(self.draw(st.sampled_from(arrays))), self.read_only(depth), SMALL, span())
            case "frame" if scalars:
                return Reference(self.draw(st.sampled_from(scalars)))
            case _:
                return Reference(COUNT)

    def record_place(self, depth: int) -> Expression:
        records = [v for v in self.scope if isinstance(v.type, RecordType)]
        match self.pick(["one", "many", "conditional"]):
            case "many":
                return Index(Reference(MANY), self.read_only(depth), RECORD, span())
            case "conditional" if depth > 0:
                return Conditional(
                    self.boolean(0), self.record_place(depth - 1), self.record_place(depth - 1), RECORD, span()
                )
            case _:
                return Reference(self.draw(st.sampled_from([ONE, *records])))

    def record(self, depth: int) -> Expression:
        kinds = ["place"]
        if depth > 0:
            kinds += ["literal"]
            if self.effects:
                kinds += ["assign", "comma"]
                if self.functions:
                    kinds += ["call"]
        match self.pick(kinds):
            case "literal":
                pair = Aggregate((self.integer(depth - 1), self.integer(depth - 1)), ArrayType(SMALL, IntType(1, 2)))
                return Aggregate((self.integer(depth - 1), pair), RECORD, span())
            case "assign":
                return Assign(self.record_place(depth - 1), self.record(depth - 1), RECORD, span=span())
            case "comma":
                return Comma((self.effect(depth - 1), self.record(depth - 1)), RECORD, span())
            case "call":
                return self.call(depth, RECORD)
            case _:
                return self.record_place(depth)

    def assign(self, depth: int) -> Expression:
        operator = self.draw(st.none() | st.sampled_from(ARITHMETIC))
        return Assign(self.place(depth - 1), self.integer(depth - 1), SMALL, operator, span())

    def effect(self, depth: int) -> Expression:
        match self.pick(["assign", "record", "clock", "increment", "integer"]):
            case "record":
                return Assign(self.record_place(depth - 1), self.record(depth - 1), RECORD, span=span())
            case "clock":
                clock = Index(Reference(CLOCKS), self.read_only(depth - 1), ClockType(), span())
                value: Expression = Binary(BinaryOperator.MINIMUM, self.integer(depth - 1), Constant(1000), INT, span())
                source = Index(Reference(CLOCKS), self.read_only(depth - 1), ClockType(), span())
                match self.pick(["number", "clock", "sum"]):
                    case "clock":
                        value = source
                    case "sum":
                        value = Binary(BinaryOperator.ADD, source, value, ClockType(), span())
                return Assign(clock, value, ClockType(), span=span())
            case "increment":
                return Increment(self.place(depth - 1), 1, self.draw(st.booleans()), INT, span())
            case "integer":
                return self.integer(depth)
            case _:
                return self.assign(depth)

    def call(self, depth: int, result: Type = SMALL) -> Expression:
        self.functions -= 1
        outer, self.scope = self.scope, []
        array = ArrayType(SMALL, IntType(0, 3))
        parameters = (
            Variable("n", SMALL, VariableKind.FRAME),
            Variable("a", array, VariableKind.FRAME, reference=True),
            Variable("b", array, VariableKind.FRAME),
            Variable("r", RECORD, VariableKind.FRAME, reference=self.draw(st.booleans())),
            Variable("s", SMALL, VariableKind.FRAME, reference=True),
        )
        self.scope = list(parameters)
        value = self.record(depth - 1) if result == RECORD else self.integer(depth - 1)
        body = Block((*self.statements(depth - 1, result), Return(value)))
        function = Function("f", parameters, result, body, span())
        self.scope = outer
        # Folding may replace a conditional by its branch; the sum keeps the place of the argument.
        first = Binary(BinaryOperator.ADD, self.integer(depth - 1), Constant(0), INT, span())
        arguments = (
            first,
            Reference(TABLE),
            Reference(TABLE),
            self.record_place(depth - 1),
            self.place(depth - 1),
        )
        call = Call(function, arguments, result, span())
        if result == SMALL and self.draw(st.booleans()):
            nested = (call, *arguments[1:])
            return Call(function, nested, result, span())
        return call

    def statements(self, depth: int, result: Type) -> tuple[Statement, ...]:
        return tuple(self.statement(depth, result) for _ in range(self.draw(st.integers(0, 2))))

    def statement(self, depth: int, result: Type) -> Statement:
        kinds = ["effect", "declare"] + (["if", "while", "iterate", "return", "assert"] if depth > 0 else [])
        match self.pick(kinds):
            case "declare":
                type_ = self.draw(st.sampled_from([SMALL, RECORD]))
                local = Variable("local", type_, VariableKind.FRAME)
                initial: Expression | None = None
                if self.draw(st.booleans()):
                    initial = self.record(depth - 1) if type_ == RECORD else self.integer(depth - 1)
                self.scope.append(local)
                return Declare(local, initial if initial is None else replace(initial, span=span()))
            case "if":
                return If(self.boolean(depth - 1), self.block(depth - 1, result), self.block(depth - 1, result))
            case "while":
                step = Evaluate(Increment(Reference(COUNT), 1, True, INT, span()))
                test = Binary(BinaryOperator.LESS, Reference(COUNT), self.read_only(0), BOOL, span())
                return While(test, Block((step, self.block(depth - 1, result))), self.draw(st.booleans()))
            case "iterate":
                variable = Variable("i", IntType(0, self.draw(st.integers(0, 3))), VariableKind.BOUND)
                self.scope.append(variable)
                body = self.block(depth - 1, result)
                self.scope.remove(variable)
                return Iterate(variable, body)
            case "return":
                value = self.record(depth - 1) if result == RECORD else self.integer(depth - 1)
                return If(self.boolean(depth - 1), Return(replace(value, span=span())))
            case "assert":
                return Assert(replace(self.boolean(depth - 1), span=span()))
            case _:
                return Evaluate(self.effect(depth))

    def block(self, depth: int, result: Type) -> Block:
        outer = list(self.scope)
        statements = self.statements(depth, result)
        self.scope = outer
        return Block(statements)


@st.composite
def values(draw: st.DrawFn, effects: bool) -> Expression:
    return Drawer(draw, effects).integer(4)


@st.composite
def update_lists(draw: st.DrawFn) -> list[Expression]:
    drawer = Drawer(draw)
    return [drawer.effect(3) for _ in range(draw(st.integers(1, 3)))]


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
    """The cells of a place, as places."""
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
    layout = cell_layout(net)
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


@pytest.mark.parametrize("left", [0, 1, 2])
@pytest.mark.parametrize("right", [0, 1, 2])
def test_exclusive_or_compares_truths(left: int, right: int) -> None:
    first = Assign(Reference(COUNT), Constant(left), SMALL)
    second = Assign(Reference(WIDE), Constant(right), WIDE.type)
    compare_value(Binary(BinaryOperator.XOR, first, second, BOOL, span()))
