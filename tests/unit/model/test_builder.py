"""What the builder makes of Python."""

from __future__ import annotations

import pytest

from tachk.base.words import Direction
from tachk.model.builder import NetworkBuilder, Term, bound_variable, conditional, quantifier
from tachk.model.evaluate import Environment, evaluate
from tachk.model.expressions import Binary, QuantifierKind, Reference, VariableKind
from tachk.model.types import ArrayType, ClockType, IntType, RecordType
from tachk.model.variable_layout import variable_layout


def value_of(network: NetworkBuilder, term: Term) -> int:
    layout = variable_layout(network.build())
    return evaluate(term.expression, Environment(layout, list(layout.initial)))


def test_operators_mean_what_the_language_means() -> None:
    network = NetworkBuilder()
    n = network.integer("n", -10, 10, initial=-7)
    flag = network.boolean("flag", True)
    for term, value in [
        (n + 3, -4),
        (3 + n, -4),
        (1 - n, 8),
        (2 * n, -14),
        (n // 2, -3),
        (n % 4, -3),
        (15 // n, -2),
        (15 % n, 1),
        (flag & (n < 0), 1),
        (~flag | (n == -7), 1),
        (flag.implies(n != -7), 0),
        (conditional(n > 0, 1, 2), 2),
    ]:
        assert value_of(network, term) == value


def test_arrays_records_and_quantifiers() -> None:
    network = NetworkBuilder()
    pair = RecordType("pair", (("a", IntType(0, 9)), ("b", IntType(0, 9))))
    table = network.declare("table", ArrayType(pair, IntType(0, 1)), [1, 2, 3, 4])
    i = bound_variable("i", IntType(0, 1))
    assert value_of(network, table[1].field("a")) == 3
    assert value_of(network, quantifier(QuantifierKind.SUM, i, table[i].field("b"))) == 6
    with pytest.raises(TypeError, match="indexed"):
        table[0][0]
    with pytest.raises(TypeError, match="fields"):
        table.field("a")


def test_a_difference_of_clocks_is_of_clock_type() -> None:
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    comparison = (x - y <= 3).expression
    assert isinstance(comparison, Binary)
    assert isinstance(comparison.left.type, ClockType)


def test_terms_cannot_be_used_as_python_truth_values() -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    with pytest.raises(TypeError, match="truth"):
        _ = x <= 3 and x >= 1


def test_processes_own_their_variables_and_count_in_order() -> None:
    network = NetworkBuilder()
    shared = network.channel("c", size=2, priority=3)
    first, second = network.process("P"), network.process("Q", priority=2)
    local = second.clock("x")
    a, b = second.location("A"), second.location("B")
    second.starts_in(b)
    first.location("Only")
    assert second.edge(b, a, guard=local >= 1, receive=shared[1]) == 0
    built = network.build()
    assert [p.name for p in built.processes] == ["P", "Q"]
    q = built.processes[1]
    assert (q.initial, q.priority, q.edges[0].source, q.edges[0].target) == (1, 2, 1, 0)
    assert q.edges[0].synchronisation is not None
    assert q.edges[0].synchronisation.direction is Direction.RECEIVE
    assert isinstance(local.expression, Reference)
    assert local.expression.variable.name == "Q.x"
    assert local.expression.variable.kind is VariableKind.LOCAL
    assert built.variables[0].priorities == (3, 3)


def test_an_edge_cannot_send_and_receive() -> None:
    network = NetworkBuilder()
    c = network.channel("c")
    process = network.process("P")
    a = process.location("A")
    with pytest.raises(ValueError, match="not both"):
        process.edge(a, a, send=c, receive=c)


@pytest.mark.parametrize(("low", "high"), [(-(2**31) - 1, 0), (0, 2**31), (1, 0)])
def test_a_range_fits_into_32_bits(low: int, high: int) -> None:
    with pytest.raises(ValueError, match="n is empty, or does not fit into 32 bits"):
        NetworkBuilder().integer("n", low, high)
