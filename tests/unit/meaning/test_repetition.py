"""Which clocks have to return to their values for a loop to be repeatable."""

from __future__ import annotations

from fractions import Fraction

from tachk.meaning.discrete import initial_discrete, prepare
from tachk.meaning.repetition import observable_clocks
from tachk.model.builder import NetworkBuilder


def test_a_clock_beyond_all_it_is_compared_with_need_not_return() -> None:
    network = NetworkBuilder()
    x, _ = network.clock("x"), network.clock("unread")
    process = network.process("P")
    a = process.location("A")
    process.edge(a, a, guard=x >= 3)
    model = prepare(network.build())
    seen = observable_clocks(model, [initial_discrete(model)], [])
    three, four = Fraction(3), Fraction(4)
    assert seen.same(1, three, three)
    assert not seen.same(1, three, four)
    assert seen.same(1, Fraction(7, 2), four)
    assert seen.same(2, Fraction(0), four)


def test_what_the_predicate_compares_counts() -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    network.process("P").location("A")
    model = prepare(network.build())
    start = [initial_discrete(model)]
    assert observable_clocks(model, start, []).same(1, Fraction(1), Fraction(9))
    assert not observable_clocks(model, start, [(x >= 5).expression]).same(1, Fraction(1), Fraction(9))


def test_clocks_that_are_compared_with_each_other_must_return() -> None:
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    process = network.process("P")
    a = process.location("A")
    process.edge(a, a, guard=x - y <= 2)
    model = prepare(network.build())
    seen = observable_clocks(model, [initial_discrete(model)], [])
    assert not seen.same(1, Fraction(8), Fraction(9))
