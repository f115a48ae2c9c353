"""Walking over expressions: order, functions, what is written."""

from __future__ import annotations

from tachk.model.expressions import (
    INT,
    Assign,
    Binary,
    Block,
    Call,
    Conditional,
    Constant,
    Evaluate,
    Expression,
    Function,
    If,
    Increment,
    Reference,
    Return,
    Variable,
    VariableKind,
)
from tachk.model.traversal import called_functions, returned, roots, statement_expressions, walk, written_variables
from tachk.operators import BinaryOperator


def variable(name: str, reference: bool = False) -> Variable:
    return Variable(name, INT, VariableKind.FRAME if reference else VariableKind.GLOBAL, (0,), reference=reference)


a, b, c = (variable(name) for name in "abc")


def add(left: Expression, right: Expression) -> Binary:
    return Binary(BinaryOperator.ADD, left, right, INT)


def test_walk_goes_from_outside_in_and_left_to_right() -> None:
    inner = add(Reference(a), Reference(b))
    assert list(walk(add(inner, Constant(1)))) == [
        add(inner, Constant(1)),
        inner,
        Reference(a),
        Reference(b),
        Constant(1),
    ]


def test_a_conditional_place_has_two_roots() -> None:
    assert list(roots(Conditional(Reference(c), Reference(a), Reference(b), INT))) == [a, b]


def test_statement_expressions_and_results() -> None:
    first, second = Return(Constant(1)), Return(Constant(2))
    block = Block((Evaluate(Constant(0)), If(Reference(a), first, second)))
    assert list(statement_expressions(block)) == [Constant(0), Reference(a), Constant(1), Constant(2)]
    assert list(returned(block)) == [Constant(1), Constant(2)]


def test_writes_through_reference_parameters_are_found() -> None:
    target, untouched = variable("target", True), variable("untouched", True)
    increment = Block((Evaluate(Increment(Reference(target), 1, True, INT)), Return(Constant(0))))
    inner = Function("inner", (target, untouched), INT, increment)
    outer_parameter = variable("outer_parameter", True)
    call = Call(inner, (Reference(outer_parameter), Reference(c)), INT)
    outer = Function("outer", (outer_parameter,), INT, Block((Return(call),)))
    update = Assign(Reference(b), Call(outer, (Reference(a),), INT), INT)
    assert list(called_functions([update])) == [outer, inner]
    assert written_variables([update]) & {a, b, c} == {a, b}
