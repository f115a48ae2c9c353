"""Walking over expressions: order, functions, what is written."""

from __future__ import annotations

import pytest

from tachk.base.operators import BinaryOperator
from tachk.model import traversal
from tachk.model.expressions import (
    BOOL,
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
    Index,
    Reference,
    Return,
    Statement,
    Variable,
    VariableKind,
)
from tachk.model.traversal import (
    ClockDependence,
    called_functions,
    children,
    clock_in,
    compares_clocks,
    depends_on_clocks,
    reads_clock,
    roots,
    statement_expressions,
    walk,
    written_variables,
)
from tachk.model.types import ArrayType, ClockType, VoidType


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


def test_statement_expressions() -> None:
    first, second = Return(Constant(1)), Return(Constant(2))
    block = Block((Evaluate(Constant(0)), If(Reference(a), first, second)))
    assert list(statement_expressions(block)) == [Constant(0), Reference(a), Constant(1), Constant(2)]
    chain: Statement = second
    for _ in range(5000):  # more than the interpreter recurses
        chain = If(Reference(a), first, chain)
    assert list(statement_expressions(chain)) == [*[Reference(a), Constant(1)] * 5000, Constant(2)]


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


X = Variable("x", ClockType(), VariableKind.GLOBAL)
BY_REFERENCE = Variable("y", ClockType(), VariableKind.FRAME, reference=True)
CLOCK = Reference(X)
EARLY = Binary(BinaryOperator.LESS, CLOCK, Constant(3), BOOL)
TABLE = Reference(Variable("table", ArrayType(INT, BOOL), VariableKind.GLOBAL, (0, 0)))
SETS_CLOCK = Function("restart", (), VoidType(), Block((Evaluate(Assign(CLOCK, Constant(0), ClockType())),)))
TAKES_CLOCK = Function("seven", (BY_REFERENCE,), INT, Return(Constant(7)))


@pytest.mark.parametrize(
    ("expression", "reads", "compares", "named"),
    [
        (Reference(a), False, False, None),
        (EARLY, True, True, CLOCK),
        (Conditional(EARLY, Reference(a), Constant(0), INT), True, True, CLOCK),
        (CLOCK, True, False, CLOCK),
        (Assign(CLOCK, Constant(0), ClockType()), False, False, Assign(CLOCK, Constant(0), ClockType())),
        (Assign(Index(TABLE, EARLY, INT), Constant(1), INT), False, True, CLOCK),
        (Assign(Reference(a), EARLY, INT), True, True, CLOCK),
        (Call(SETS_CLOCK, (), VoidType()), False, False, Assign(CLOCK, Constant(0), ClockType())),
        (Call(TAKES_CLOCK, (CLOCK,), INT), False, False, CLOCK),
    ],
)
def test_what_an_expression_has_to_do_with_clocks(
    expression: Expression, reads: bool, compares: bool, named: Expression | None
) -> None:
    assert (reads_clock(expression), compares_clocks(expression)) == (reads, compares)
    assert clock_in(expression) == named


def test_what_depends_on_clocks_is_found_once_for_each_part(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = Variable("x", ClockType(), VariableKind.GLOBAL)
    early = Binary(BinaryOperator.LESS, Reference(clock, ClockType()), Constant(1), BOOL)
    for timed in (True, False):
        chain: Expression = early if timed else Constant(1, BOOL)
        links = []
        for _ in range(200):
            chain = Binary(BinaryOperator.IMPLY, chain, Constant(1, BOOL), BOOL)
            links.append(chain)
        looked: list[Expression] = []

        def children_of(part: Expression, looked: list[Expression] = looked) -> tuple[Expression, ...]:
            looked.append(part)
            return children(part)

        monkeypatch.setattr(traversal, "children", children_of)
        depends = ClockDependence()
        answers = [depends(link) for link in (*links, *reversed(links))]
        assert len(looked) <= 3 * len(links)
        monkeypatch.undo()
        assert answers == [timed] * (2 * len(links)) == [depends_on_clocks(link) for link in links] * 2
