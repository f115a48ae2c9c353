"""Intervals contain every value that an evaluation without an error can have."""

from __future__ import annotations

from itertools import product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tachk.analysis.fold import Known
from tachk.analysis.intervals import interval
from tachk.base.operators import BinaryOperator, UnaryOperator
from tachk.model.builder import NetworkBuilder, Term, bound_variable, conditional, quantifier
from tachk.model.evaluate import Environment, evaluate
from tachk.model.expressions import (
    INT,
    Assign,
    Binary,
    Block,
    Call,
    Constant,
    Evaluate,
    Function,
    If,
    Quantifier,
    QuantifierKind,
    Reference,
    Return,
    Unary,
    Variable,
    VariableKind,
)
from tachk.model.fault import EvaluationFault
from tachk.model.types import ArrayType, IntType
from tachk.model.variable_layout import variable_layout

NETWORK = NetworkBuilder()
A = NETWORK.integer("a", -4, 3)
B = NETWORK.integer("b", 0, 6)
TABLE = NETWORK.declare("table", ArrayType(IntType(), IntType(0, 3)), (10, -40, 30, 20))
NETWORK.process("P").location("only")
MODEL = NETWORK.build()
LAYOUT = variable_layout(MODEL)
KNOWN = Known({MODEL.variables[2]: (10, -40, 30, 20)})

ARITHMETIC = [
    operator
    for operator in BinaryOperator
    if operator not in (BinaryOperator.AND, BinaryOperator.OR, BinaryOperator.IMPLY)
]


def combine(parts: tuple[BinaryOperator, Term, Term]) -> Term:
    operator, left, right = parts
    return Term(Binary(operator, left.expression, right.expression, INT))


def absolute(argument: Term) -> Term:
    parameter = Variable("n", IntType(-50, 50), VariableKind.FRAME)
    n = Reference(parameter)
    test = Binary(BinaryOperator.LESS, n, Constant(0), INT)
    body = Block((If(test, Return(Unary(UnaryOperator.MINUS, n, INT))), Return(n)))
    return Term(Call(Function("absolute", (parameter,), INT, body), (argument.expression,), INT))


def terms(depth: int) -> st.SearchStrategy[Term]:
    simple = st.sampled_from([A, B, TABLE[B]]) | st.integers(-3, 33).map(Constant).map(Term)
    if depth == 0:
        return simple
    smaller = terms(depth - 1)
    i = bound_variable("i", IntType(-1, 2))
    return (
        simple
        | st.tuples(st.sampled_from(ARITHMETIC), smaller, smaller).map(combine)
        | smaller.map(lambda t: Term(Unary(UnaryOperator.MINUS, t.expression, INT)))
        | st.tuples(smaller, smaller, smaller).map(lambda p: conditional(*p))
        | smaller.map(lambda t: quantifier(QuantifierKind.SUM, i, t + i))
        | smaller.map(lambda t: TABLE[t])
        | smaller.map(absolute)
    )


@settings(max_examples=300, deadline=None, derandomize=True)
@given(terms(3))
def test_no_value_lies_outside(term: Term) -> None:
    low, high = interval(term.expression, KNOWN)
    for a in range(-4, 4):
        for b in range(7):
            values = list(LAYOUT.initial)
            values[:2] = [a, b]
            try:
                value = evaluate(term.expression, Environment(LAYOUT, values))
            except EvaluationFault:
                continue
            assert low <= value <= high


def test_a_known_table_counts_with_the_slots_that_the_index_can_reach() -> None:
    assert interval(TABLE[B % 2].expression, KNOWN) == (-40, 10)
    assert interval(TABLE[conditional(A < 0, 2, 3)].expression, KNOWN) == (20, 30)


def test_a_function_counts_with_what_it_can_return_for_its_arguments() -> None:
    parameter = Variable("n", IntType(), VariableKind.FRAME)
    twice = Binary(BinaryOperator.MULTIPLY, Reference(parameter), Constant(2), INT)
    function = Function("twice", (parameter,), INT, Block((Return(twice),)))
    assert interval(Call(function, (B.expression,), INT), KNOWN) == (0, 12)


def test_a_sum_counts_every_value_of_its_variable() -> None:
    i = Variable("i", IntType(1, 4), VariableKind.BOUND)
    assert interval(Quantifier(QuantifierKind.SUM, i, B.expression, INT), KNOWN) == (0, 24)


RANGES = [(-4, 3), (0, 6), (0, 3), (-3, -1)]
PAIRS = NetworkBuilder()
LEFT = [PAIRS.integer(f"left{number}", *bounds) for number, bounds in enumerate(RANGES)]
RIGHT = [PAIRS.integer(f"right{number}", *bounds) for number, bounds in enumerate(RANGES)]
PAIRS.process("P").location("only")
SLOTS = variable_layout(PAIRS.build())


@pytest.mark.parametrize("operator", list(BinaryOperator))
def test_every_operator_on_every_pair_of_ranges(operator: BinaryOperator) -> None:
    for i, j in product(range(4), repeat=2):
        term = Binary(operator, LEFT[i].expression, RIGHT[j].expression, INT)
        low, high = interval(term, Known())
        for a, b in product(_inclusive(RANGES[i]), _inclusive(RANGES[j])):
            values = list(SLOTS.initial)
            values[i], values[4 + j] = a, b
            try:
                value = evaluate(term, Environment(SLOTS, values))
            except EvaluationFault:
                continue
            assert low <= value <= high, (RANGES[i], RANGES[j], a, b)


def _inclusive(bounds: tuple[int, int]) -> range:
    return range(bounds[0], bounds[1] + 1)


def test_a_function_that_writes_its_parameter_does_not_return_the_argument() -> None:
    n = Variable("n", IntType(0, 9), VariableKind.FRAME)
    raised = Binary(BinaryOperator.ADD, Reference(n), Constant(5), INT)
    body = Block((Evaluate(Assign(Reference(n), raised, INT)), Return(Reference(n))))
    low, high = interval(Call(Function("later", (n,), INT, body), (Constant(2),), INT), KNOWN)
    assert low <= 7 <= high
