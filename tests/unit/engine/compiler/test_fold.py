"""Folding replaces what is known and keeps what can go wrong."""

from __future__ import annotations

from itertools import product

import pytest

from tachk.analysis.fold import Known, apply_binary, cannot_fail, fold, known_values
from tachk.base.operators import BinaryOperator, UnaryOperator
from tachk.model.builder import NetworkBuilder, Term, bound_variable, conditional, quantifier
from tachk.model.evaluate import Environment, evaluate
from tachk.model.expressions import (
    BOOL,
    INT,
    Assign,
    Binary,
    Block,
    Call,
    Constant,
    Evaluate,
    Expression,
    Function,
    QuantifierKind,
    Reference,
    Unary,
    Variable,
    VariableKind,
)
from tachk.model.fault import EvaluationFault
from tachk.model.types import ArrayType, IntType, VoidType
from tachk.model.variable_layout import variable_layout

NETWORK = NetworkBuilder()
N = NETWORK.integer("n", 0, 9)
FLAG = NETWORK.boolean("flag")
TABLE = NETWORK.declare("table", ArrayType(IntType(), IntType(1, 3)), (10, 20, 30))
CELLS = NETWORK.declare("cells", ArrayType(IntType(0, 9), IntType(0, 1)), (4, 5))
PROCESS = NETWORK.process("P")
A = PROCESS.location("a")
PROCESS.edge(A, A, updates=[N.assign(1), FLAG.assign(1), CELLS[N].assign(2)])
KNOWN = known_values(NETWORK.build(), [])


def folded(term: Term) -> Expression:
    return fold(term.expression, KNOWN)


def test_only_what_nothing_writes_is_known() -> None:
    assert folded(TABLE[2] + 1) == Constant(21)
    assert folded(CELLS[0] + 1) == (CELLS[0] + 1).expression
    assert folded(TABLE[N]) == TABLE[N].expression


def test_a_variable_written_through_a_reference_parameter_is_not_known() -> None:
    network = NetworkBuilder()
    read, written = network.integer("read", 0, 9), network.integer("written", 0, 9)
    parameters = tuple(Variable(name, IntType(0, 9), VariableKind.FRAME, reference=True) for name in ("a", "b"))
    body = Block((Evaluate(Assign(Reference(parameters[1]), Reference(parameters[0]), INT)),))
    function = Function("copy", parameters, VoidType(), body)
    p = network.process("P")
    a = p.location("a")
    p.edge(a, a, updates=[Term(Call(function, (read.expression, written.expression), VoidType()))])
    built = network.build()
    assert set(known_values(built, []).values) == {built.variables[0]}


@pytest.mark.parametrize(
    ("operator", "left", "right"),
    [
        (BinaryOperator.DIVIDE, 1, 0),
        (BinaryOperator.MODULO, 1, 0),
        (BinaryOperator.SHIFT_LEFT, 1, 32),
        (BinaryOperator.SHIFT_RIGHT, 1, -1),
        (BinaryOperator.POWER, 2, -1),
    ],
)
def test_an_operation_that_fails_is_kept(operator: BinaryOperator, left: int, right: int) -> None:
    failing = Binary(operator, Constant(left), Constant(right), INT)
    assert fold(failing, KNOWN) == failing


def test_arithmetic_wraps_around() -> None:
    assert fold(Unary(UnaryOperator.MINUS, Constant(-(2**31)), INT), KNOWN) == Constant(-(2**31))
    for operator, left, right, value in (
        (BinaryOperator.ADD, 2**31 - 1, 1, -(2**31)),
        (BinaryOperator.MULTIPLY, 2**16, 2**16, 0),
        (BinaryOperator.POWER, 10, 10**6, 0),
    ):
        assert fold(Binary(operator, Constant(left), Constant(right), INT), KNOWN) == Constant(value)


@pytest.mark.parametrize("operator", list(BinaryOperator))
def test_every_operator_means_what_the_evaluator_says(operator: BinaryOperator) -> None:
    layout = variable_layout(NETWORK.build())
    for left, right in product((-8, -1, 0, 1, 7), (-3, 0, 1, 2, 31)):
        try:
            expected = evaluate(Binary(operator, Constant(left), Constant(right), INT), Environment(layout, []))
        except EvaluationFault:
            expected = None
        assert apply_binary(operator, left, right) == expected, (left, right)


def test_an_index_outside_the_array_is_kept() -> None:
    assert folded(TABLE[0]) == TABLE[0].expression


def test_connectives_drop_what_is_never_evaluated() -> None:
    failing = CELLS[N] == 1
    false, true = Constant(0, BOOL), Constant(1, BOOL)
    assert folded(Term(false) & failing) == false
    assert folded(Term(true) | failing) == true
    assert folded(Term(false).implies(failing)) == true
    assert folded(failing & Term(false)) == (failing & Term(false)).expression
    assert folded((N == 1) & Term(false)) == false
    assert folded(failing & Term(true)) == failing.expression


def test_conditionals_and_quantifiers() -> None:
    i = bound_variable("i", IntType(1, 3))
    assert folded(conditional(TABLE[1] == 10, N, 3)) == N.expression
    assert folded(quantifier(QuantifierKind.FORALL, i, TABLE[1] > 3)) == Constant(1, BOOL)


def test_bound_variables_are_replaced() -> None:
    i = bound_variable("i", IntType(1, 3))
    assert isinstance(i.expression, Reference)
    assert fold((TABLE[i] + i).expression, KNOWN.with_bound(i.expression.variable, 3)) == Constant(33)


@pytest.mark.parametrize(
    ("term", "expected"),
    [
        ((N == 1) & ~FLAG, True),
        (CELLS[1] > N, True),
        (CELLS[N] > 1, False),
        (CELLS[2] > 1, False),
        (N + 1 > 2, True),
        (N // CELLS[1] > 2, False),
        (A.reached | FLAG, True),
    ],
)
def test_cannot_fail(term: Term, expected: bool) -> None:
    assert cannot_fail(term.expression) is expected


def test_nothing_is_known_without_a_network() -> None:
    assert fold(TABLE[2].expression, Known()) == TABLE[2].expression
