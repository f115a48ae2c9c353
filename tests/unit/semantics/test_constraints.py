"""The disjunctive normal form means the condition it comes from."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tachk.model.builder import NetworkBuilder, Term, bound_variable, conditional, quantifier
from tachk.model.cell_layout import cell_layout
from tachk.model.evaluate import Environment, holds
from tachk.model.expressions import BOOL, Binary, QuantifierKind
from tachk.model.fault import EvaluationFault
from tachk.model.types import IntType
from tachk.operators import BinaryOperator
from tachk.semantics import dbm
from tachk.semantics.constraints import FALSE, TRUE, disjunctive

NETWORK = NetworkBuilder()
X, Y = NETWORK.clock("x"), NETWORK.clock("y")
N = NETWORK.integer("n", 0, 3)
LAYOUT = cell_layout(NETWORK.build())
I = bound_variable("i", IntType(0, 2))

COMPARISONS = [
    lambda a, b: a < b,
    lambda a, b: a <= b,
    lambda a, b: a > b,
    lambda a, b: a >= b,
    lambda a, b: a == b,
    lambda a, b: a != b,
]
sides = st.one_of(st.integers(-1, 3), st.just(N), st.just(N + 1))
atoms = st.one_of(
    st.builds(
        lambda c, clock, side: c(clock, side), st.sampled_from(COMPARISONS), st.sampled_from([X, Y, X - Y]), sides
    ),
    st.builds(lambda c, clock, side: c(side, clock), st.sampled_from(COMPARISONS), st.sampled_from([X, Y]), st.just(N)),
    st.builds(lambda c: c(X, Y), st.sampled_from(COMPARISONS)),
    st.builds(lambda c, side: c(N, side), st.sampled_from(COMPARISONS), st.integers(0, 3)),
)


def same(left: Term, right: Term, operator: BinaryOperator) -> Term:
    return Term(Binary(operator, left.expression, right.expression, BOOL))


conditions = st.recursive(
    atoms,
    lambda inner: st.one_of(
        st.builds(lambda a, b: a & b, inner, inner),
        st.builds(lambda a, b: a | b, inner, inner),
        st.builds(lambda a, b: a.implies(b), inner, inner),
        st.builds(lambda a: ~a, inner),
        st.builds(conditional, inner, inner, inner),
        st.builds(
            same, inner, inner, st.sampled_from([BinaryOperator.XOR, BinaryOperator.EQUAL, BinaryOperator.NOT_EQUAL])
        ),
        st.builds(
            lambda kind, a: quantifier(kind, I, a & (I + 1 > X)),
            st.sampled_from([QuantifierKind.FORALL, QuantifierKind.EXISTS]),
            inner,
        ),
    ),
    max_leaves=5,
)
halves = st.integers(0, 8).map(lambda n: Fraction(n, 2))


@given(conditions, st.tuples(halves, halves), st.integers(0, 3))
def test_the_normal_form_holds_where_the_condition_holds(
    condition: Term, clocks: tuple[Fraction, Fraction], n: int
) -> None:
    values = [1, 2, n]
    expected = holds(condition.expression, Environment(LAYOUT, values, clocks=clocks))
    point = (Fraction(0), *clocks)
    for negated in (False, True):
        form = disjunctive(condition.expression, Environment(LAYOUT, values), negated)
        found = any(all(dbm.holds(c, point) for c in conjunction) for conjunction in form)
        assert found == (expected is not negated)


def test_what_the_left_side_decides_is_not_evaluated_on_the_right() -> None:
    faulty = 1 // N == X
    scratch = Environment(LAYOUT, [1, 2, 0])
    assert disjunctive(((N > 0) & faulty).expression, scratch) == FALSE
    assert disjunctive(((N == 0) | faulty).expression, scratch) == TRUE
    with pytest.raises(EvaluationFault):
        disjunctive(((N == 0) & faulty).expression, scratch)


def test_a_comparison_of_three_clocks_is_refused() -> None:
    network = NetworkBuilder()
    x, y, z = network.clock("x"), network.clock("y"), network.clock("z")
    layout = cell_layout(network.build())
    with pytest.raises(ValueError, match="two clocks"):
        disjunctive((x - y < z).expression, Environment(layout, [1, 2, 3]))
