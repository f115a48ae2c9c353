"""The disjunctive normal form means the condition it comes from."""

from __future__ import annotations

from fractions import Fraction
from functools import reduce
from itertools import product
from operator import and_, or_

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tachk.base.operators import BinaryOperator
from tachk.meaning import dbm
from tachk.meaning.comparisons import comparisons
from tachk.meaning.constraints import (
    FALSE,
    TRUE,
    Conjunction,
    certain,
    conjunction,
    disjunctive,
    satisfied,
    tidied,
)
from tachk.meaning.residual import residual
from tachk.model.builder import NetworkBuilder, Term, bound_variable, conditional, quantifier
from tachk.model.evaluate import Environment, holds
from tachk.model.expressions import BOOL, Binary, QuantifierKind
from tachk.model.fault import EvaluationFault
from tachk.model.types import IntType
from tachk.model.variable_layout import variable_layout

NETWORK = NetworkBuilder()
X, Y = NETWORK.clock("x"), NETWORK.clock("y")
N = NETWORK.integer("n", 0, 3)
LAYOUT = variable_layout(NETWORK.build())
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


@given(conditions, st.tuples(halves, halves), st.integers(0, 3))
def test_the_residual_holds_where_the_condition_holds(
    condition: Term, clocks: tuple[Fraction, Fraction], n: int
) -> None:
    left = residual(condition.expression, Environment(LAYOUT, [1, 2, n]))
    if left is not None:
        expected = holds(condition.expression, Environment(LAYOUT, [1, 2, n], clocks=clocks))
        assert left(clocks) is expected


def test_guards_and_invariants_as_models_write_them_have_residuals() -> None:
    written = [
        (X < N) & (Y - X >= 2),
        ~(N == X) | (X > Y),
        quantifier(QuantifierKind.FORALL, I, (N == I) | (X >= I)),
        (N > 0) & (X <= 2),
    ]
    for condition in written:
        assert residual(condition.expression, Environment(LAYOUT, [1, 2, 0])) is not None
    assert residual((1 // N == X).expression, Environment(LAYOUT, [1, 2, 0])) is None


def test_what_the_left_side_decides_is_not_evaluated_on_the_right() -> None:
    faulty = 1 // N == X
    scratch = Environment(LAYOUT, [1, 2, 0])
    assert disjunctive(((N > 0) & faulty).expression, scratch) == FALSE
    assert disjunctive(((N == 0) | faulty).expression, scratch) == TRUE
    with pytest.raises(EvaluationFault):
        disjunctive(((N == 0) & faulty).expression, scratch)


def test_a_comparison_of_three_clocks_is_rejected() -> None:
    network = NetworkBuilder()
    x, y, z = network.clock("x"), network.clock("y"), network.clock("z")
    layout = variable_layout(network.build())
    with pytest.raises(ValueError, match="two clocks"):
        disjunctive((x - y < z).expression, Environment(layout, [1, 2, 3]))


@given(conditions, st.integers(0, 3))
def test_the_truth_changes_only_with_that_of_a_comparison(condition: Term, n: int) -> None:
    values = [1, 2, n]
    found = sorted(comparisons(condition.expression, Environment(LAYOUT, values)))
    told: dict[tuple[bool, ...], bool] = {}
    for x, y in product([Fraction(n, 2) for n in range(9)], repeat=2):
        agreed = tuple(dbm.holds(constraint, (Fraction(0), x, y)) for constraint in found)
        truth = holds(condition.expression, Environment(LAYOUT, values, clocks=(x, y)))
        assert told.setdefault(agreed, truth) is truth


def test_comparisons_of_a_condition_are_found_without_its_normal_form() -> None:
    """That of the negation would have 2^60 parts."""
    parts = [(n % 4 == N) & (n < X) & (n > Y) for n in range(60)]
    condition = ~reduce(or_, parts)
    found = comparisons(condition.expression, Environment(LAYOUT, [1, 2, 3]))
    assert found == {c for n in range(3, 60, 4) for c in ((0, 1, 2 * -n), (2, 0, 2 * n))}


def test_what_is_true_without_clocks_is_no_longer_than_that() -> None:
    parts = [(N == 3) | (n != N) for n in range(60)]
    condition = reduce(and_, parts)
    assert certain(condition.expression, Environment(LAYOUT, [1, 2, 3])) == TRUE
    assert certain((~condition).expression, Environment(LAYOUT, [1, 2, 3])) == FALSE


bounds = st.tuples(st.integers(0, 2), st.integers(0, 2), st.integers(-6, 6)).filter(lambda bound: bound[0] != bound[1])
disjunctions = st.lists(st.lists(bounds, max_size=3).map(tuple), max_size=4)


@given(disjunctions, disjunctions)
def test_tidied_means_the_same(left: list[Conjunction], right: list[Conjunction]) -> None:
    whole = conjunction(left, right)
    fewer = tidied(whole)
    assert len(fewer) <= len(whole)
    for point in ((Fraction(a, 2), Fraction(b, 2)) for a in range(8) for b in range(8)):
        assert satisfied(fewer, point) == satisfied(whole, point)


def test_products_over_one_clock_stay_small() -> None:
    whole = TRUE
    for n in range(50):
        whole = tidied(conjunction(whole, [((1, 0, 2 * n),), ((0, 1, -400 + n),)]))
    assert len(whole) <= 51
