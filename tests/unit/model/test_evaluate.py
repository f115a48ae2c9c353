"""The reference evaluator: arithmetic of 32 bits, checks, places, functions."""

from __future__ import annotations

from fractions import Fraction

import pytest

from tachk.base.operators import BinaryOperator
from tachk.model import evaluate as ev
from tachk.model.expressions import (
    BOOL,
    INT,
    Aggregate,
    Assert,
    Assign,
    Binary,
    Block,
    Call,
    Conditional,
    Constant,
    Deadlock,
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
    Variable,
    VariableKind,
    While,
)
from tachk.model.fault import EvaluationFault, RuntimeErrorKind
from tachk.model.network import Network, Process
from tachk.model.types import ArrayType, ChannelType, ClockType, IntType, RecordType, VoidType
from tachk.model.variable_layout import variable_layout

SMALL = IntType(0, 5)
PAIR = RecordType("pair", (("a", INT), ("b", SMALL)))


def variable(name: str, type_: object, *initial: int, kind: VariableKind = VariableKind.GLOBAL) -> Variable:
    return Variable(name, type_, kind, initial)  # type: ignore[arg-type]


n = variable("n", INT, 7)
small = variable("small", SMALL, 2)
array = variable("array", ArrayType(SMALL, IntType(2, 4)), 1, 2, 3)
records = variable("records", ArrayType(PAIR, IntType(0, 1)), 1, 2, 3, 4)
clocks = variable("clocks", ArrayType(ClockType(), IntType(0, 1)), 0, 0)
channel = variable("channel", ChannelType())
positive = variable("positive", IntType(3, 9))
local_clock = variable("P.x", ClockType(), kind=VariableKind.LOCAL)
network = Network(
    (Process("P", "P", (), (), variables=(local_clock,)),),
    (n, small, array, records, clocks, channel, positive),
)


def environment(**more: object) -> ev.Environment:
    layout = variable_layout(network)
    return ev.Environment(layout, list(layout.initial), **more)  # type: ignore[arg-type]


def binary(left: int, operator: str, right: int) -> Binary:
    return Binary(BinaryOperator(operator), Constant(left), Constant(right), INT)


def fault(expression: Expression) -> RuntimeErrorKind:
    with pytest.raises(EvaluationFault) as caught:
        ev.evaluate_slots(expression, environment())
    return caught.value.kind


def test_layout_numbers_clocks_from_one_and_channels_from_zero_and_pins_them() -> None:
    layout = variable_layout(network)
    assert layout.names[-3:] == ("channel", "positive", "P.x")
    assert layout.initial == (7, 2, 1, 2, 3, 1, 2, 3, 4, 1, 2, 0, 3, 3)
    assert layout.first[local_clock] == 13
    assert layout.ranges[13] == (3, 3)
    assert layout.clock_slots == (9, 10, 13)
    assert layout.names[5:7] == ("records[0].a", "records[0].b")
    assert layout.names[2] == "array[2]"


@pytest.mark.parametrize(
    ("left", "operator", "right", "expected"),
    [
        (7, "/", 2, 3),
        (-7, "/", 2, -3),
        (7, "%", -2, 1),
        (-7, "%", 2, -1),
        (2, "**", 10, 1024),
        (-2, "**", 31, -(2**31)),
        (-1, "**", 1001, -1),
        (0, "**", 0, 1),
        (6, "&", 3, 2),
        (6, "|", 3, 7),
        (6, "^", 3, 5),
        (1, "<<", 30, 2**30),
        (-8, ">>", 1, -4),
        (3, "<?", 5, 3),
        (3, ">?", 5, 5),
        (3, "xor", 0, 1),
        (3, "xor", 5, 0),
        (5, "&&", 2, 1),
        (0, "imply", 0, 1),
        (5, "==", 1, 0),
        (2, "!=", 1, 1),
        (2**31 - 1, "+", 1, -(2**31)),
        (-(2**31), "-", 1, 2**31 - 1),
        (65536, "*", 65537, 65536),
        (-(2**31), "/", -1, -(2**31)),
        (3, "**", 40, 3**40 % 2**32),
        (-3, "**", 3, -27),
        (1, "<<", 31, -(2**31)),
    ],
)
def test_operators(left: int, operator: str, right: int, expected: int) -> None:
    assert ev.evaluate(binary(left, operator, right), environment()) == expected


@pytest.mark.parametrize(
    ("expression", "kind"),
    [
        (binary(1, "/", 0), RuntimeErrorKind.DIVISION),
        (binary(1, "%", 0), RuntimeErrorKind.DIVISION),
        (binary(1, "<<", 32), RuntimeErrorKind.SHIFT),
        (binary(1, ">>", -1), RuntimeErrorKind.SHIFT),
        (binary(2, "**", -1), RuntimeErrorKind.NEGATIVE_EXPONENT),
        (Index(Reference(array), Constant(1), SMALL), RuntimeErrorKind.INDEX),
        (Index(Reference(array), Constant(5), SMALL), RuntimeErrorKind.INDEX),
        (Assign(Reference(small), Constant(6), SMALL), RuntimeErrorKind.RANGE),
        (Assign(Reference(local_clock), Constant(-1), ClockType()), RuntimeErrorKind.NEGATIVE_CLOCK),
        (Increment(Reference(positive), -1, True, SMALL), RuntimeErrorKind.RANGE),
    ],
)
def test_faults(expression: Expression, kind: RuntimeErrorKind) -> None:
    assert fault(expression) is kind


def test_short_circuit_hides_faults() -> None:
    bad = binary(1, "/", 0)
    for operator, left, expected in (
        (BinaryOperator.AND, 0, 0),
        (BinaryOperator.OR, 1, 1),
        (BinaryOperator.IMPLY, 0, 1),
    ):
        assert ev.evaluate(Binary(operator, Constant(left), bad, BOOL), environment()) == expected


def test_assignment_writes_the_list_and_has_the_new_value() -> None:
    env = environment()
    assert ev.evaluate(Assign(Reference(n), Constant(3), INT, BinaryOperator.ADD), env) == 10
    assert env.values[0] == 10


def test_postfix_increment_has_the_old_value() -> None:
    env = environment()
    assert ev.evaluate(Increment(Reference(n), 1, False, INT), env) == 7
    assert env.values[0] == 8


def test_conditional_is_a_place() -> None:
    env = environment()
    target = Conditional(Constant(0), Reference(n), Reference(small), SMALL)
    ev.execute([Assign(target, Constant(4), SMALL)], env)
    assert env.values[:2] == [7, 4]


def test_aggregates_are_copied_and_compared_slot_by_slot() -> None:
    env = environment()
    first, second = (Index(Reference(records), Constant(i), PAIR) for i in (0, 1))
    equal = Binary(BinaryOperator.EQUAL, first, second, BOOL)
    assert ev.evaluate(equal, env) == 0
    ev.execute([Assign(first, second, PAIR)], env)
    assert ev.evaluate(equal, env) == 1
    assert ev.evaluate(Field(first, "b", SMALL), env) == 4
    ev.execute([Assign(first, Aggregate((Constant(9), Constant(5)), PAIR), PAIR)], env)
    assert env.values[5:7] == [9, 5]


def test_failed_aggregate_assignment_stores_nothing() -> None:
    env = environment()
    with pytest.raises(EvaluationFault):
        ev.execute(
            [Assign(Index(Reference(records), Constant(0), PAIR), Aggregate((Constant(9), Constant(6)), PAIR), PAIR)],
            env,
        )
    assert env.values[5:7] == [1, 2]


def test_resets_are_recorded_with_the_clock_number() -> None:
    env = environment()
    ev.execute([Assign(Index(Reference(clocks), Constant(1), ClockType()), Constant(5), ClockType())], env)
    ev.execute([Assign(Reference(local_clock), Constant(0), ClockType())], env)
    assert env.resets == {2: (0, 5), 3: (0, 0)}


def test_copies_of_clocks_are_recorded_in_terms_of_the_values_before() -> None:
    env = environment()
    x, y = Index(Reference(clocks), Constant(0), ClockType()), Index(Reference(clocks), Constant(1), ClockType())
    local = Reference(local_clock)
    updates = [(local, x), (x, y), (y, Binary(BinaryOperator.ADD, local, Constant(2), ClockType())), (local, y)]
    ev.execute([Assign(target, value, ClockType()) for target, value in updates], env)
    assert env.resets == {1: (2, 0), 2: (1, 2), 3: (1, 2)}


def test_clock_differences_are_exact() -> None:
    env = environment(clocks=(Fraction(1, 2), Fraction(1, 6), Fraction(1, 3)))
    difference = Binary(
        BinaryOperator.SUBTRACT,
        Index(Reference(clocks), Constant(0), ClockType()),
        Reference(local_clock),
        ClockType(),
    )
    sixth = Index(Reference(clocks), Constant(1), ClockType())
    assert ev.holds(Binary(BinaryOperator.EQUAL, difference, sixth, BOOL), env)
    assert ev.holds(Binary(BinaryOperator.LESS, difference, Constant(1), BOOL), env)


def test_location_tests_and_deadlock_ask_the_environment() -> None:
    env = environment(locations=(4,), deadlock=lambda: True)
    assert ev.evaluate(LocationTest(0, 4), env) == 1
    assert ev.evaluate(LocationTest(0, 3), env) == 0
    assert ev.evaluate(Deadlock(), env) == 1


def test_quantifiers() -> None:
    i = variable("i", IntType(2, 4), kind=VariableKind.BOUND)
    element = Index(Reference(array), Reference(i), SMALL)
    positive_element = Binary(BinaryOperator.GREATER, element, Constant(1), BOOL)
    assert ev.evaluate(Quantifier(QuantifierKind.SUM, i, element, INT), environment()) == 6
    assert ev.evaluate(Quantifier(QuantifierKind.FORALL, i, positive_element, BOOL), environment()) == 0
    assert ev.evaluate(Quantifier(QuantifierKind.EXISTS, i, positive_element, BOOL), environment()) == 1


def test_function_with_loop_local_and_reference_parameter() -> None:
    target = Variable("target", INT, VariableKind.FRAME, reference=True)
    limit = Variable("limit", SMALL, VariableKind.FRAME)
    i = variable("i", IntType(1, 9), kind=VariableKind.BOUND)
    total = Variable("total", INT, VariableKind.FRAME)
    add = Assign(Reference(total), Reference(i), INT, BinaryOperator.ADD)
    body = Block(
        (
            Declare(total),
            Iterate(
                i,
                If(
                    Binary(BinaryOperator.LESS_EQUAL, Reference(i), Reference(limit), BOOL),
                    Evaluate(add),
                ),
            ),
            Evaluate(Assign(Reference(target), Reference(total), INT)),
            Return(Reference(total)),
        )
    )
    function = Function("f", (target, limit), IntType(0, 10), body)
    env = environment()
    assert ev.evaluate(Call(function, (Reference(n), Constant(4)), INT), env) == 10
    assert env.values[0] == 10
    for argument in (6, 5):  # an argument outside the parameter's range, a result outside the function's
        assert fault(Call(function, (Reference(n), Constant(argument)), INT)) is RuntimeErrorKind.RANGE


def test_do_loop_runs_once_and_assert_faults() -> None:
    body = Block(
        (
            While(Constant(0), Evaluate(Increment(Reference(n), 1, True, INT)), test_first=False),
            While(Constant(0), Evaluate(Increment(Reference(n), 1, True, INT))),
            Assert(Binary(BinaryOperator.EQUAL, Reference(n), Constant(9), BOOL)),
        )
    )
    call = Call(Function("f", (), VoidType(), body), (), VoidType())
    assert fault(call) is RuntimeErrorKind.ASSERT


def test_endless_loop_is_a_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ev, "STEP_LIMIT", 1000)
    endless = Block((While(Constant(1), Block(())),))
    assert fault(Call(Function("f", (), VoidType(), endless), (), VoidType())) is RuntimeErrorKind.LOOP
