"""Long chains of an operator: shallow trees that print as they were written."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tachk.base.operators import BinaryOperator
from tachk.base.span import NOWHERE, Source
from tachk.syntax import ast
from tachk.syntax.chains import LONGEST_FROM_LEFT, chain, operands_of
from tachk.syntax.parsing.parser import parse_expression
from tachk.syntax.printing.expression_printer import print_expression

pytestmark = pytest.mark.drawn


def parse(text: str) -> ast.Expression:
    expression, diagnostics = parse_expression(Source("t.ta", text))
    assert not diagnostics
    assert expression is not None
    return expression


def depth(expression: ast.Expression) -> int:
    if not isinstance(expression, ast.BinaryExpression):
        return 0
    return 1 + max(depth(expression.left), depth(expression.right))


def leaves(expression: ast.Expression) -> list[str]:
    if not isinstance(expression, ast.BinaryExpression):
        return [print_expression(expression)]
    return leaves(expression.left) + leaves(expression.right)


@pytest.mark.parametrize("operator", [each for each in BinaryOperator if each.associative])
def test_a_long_chain_is_shallow_in_order_and_prints_as_written(operator: str) -> None:
    names = [f"a{number}" for number in range(5000)]
    text = f" {operator} ".join(names)
    tree = parse(text)
    assert depth(tree) < 60
    assert leaves(tree) == names
    assert print_expression(tree) == text


def test_a_short_chain_is_built_from_the_left() -> None:
    tree = parse("+".join("abcd"))
    assert isinstance(tree, ast.BinaryExpression)
    assert print_expression(tree.left) == "a + b + c"


def test_operators_of_one_level_are_applied_from_the_left() -> None:
    many = " + ".join("a" * (LONGEST_FROM_LEFT + 5))
    tree = parse(f"{many} - b + c")
    assert isinstance(tree, ast.BinaryExpression) and tree.operator == "+"
    assert isinstance(tree.left, ast.BinaryExpression) and tree.left.operator == "-"
    assert print_expression(tree.left.left) == many


@pytest.mark.parametrize(
    "text",
    [
        "({0}) + ({0})",
        "({0}) + b",
        "b + ({0}) + c",
        "({0} + b) + ({0}) + {0}",
        "{0} - {0} + ({0})",
        "({0}) * b + ({0})",
    ],
)
@pytest.mark.parametrize("count", [2, LONGEST_FROM_LEFT, LONGEST_FROM_LEFT + 1, 3 * LONGEST_FROM_LEFT])
def test_parentheses_around_chains_survive_printing(text: str, count: int) -> None:
    tree = parse(text.format(" + ".join("a" * count)))
    assert parse(print_expression(tree)) == tree


def name(text: str) -> ast.Expression:
    return ast.NameExpression(NOWHERE, text)


@st.composite
def joined(draw: st.DrawFn) -> ast.Expression:
    """Chains of chains, so long that some are balanced."""
    operator = draw(st.sampled_from([BinaryOperator.ADD, BinaryOperator.AND]))
    inner = st.one_of(
        st.just(name("a")),
        st.integers(2, 50).map(lambda count: chain(operator, [name("b")] * count)),
        st.integers(2, 50).map(lambda count: chain(BinaryOperator.SUBTRACT, [name("c")] * count)),
    )
    return chain(operator, draw(st.lists(inner, min_size=2, max_size=60)))


@given(joined())
@settings(max_examples=60, deadline=None)
def test_any_tree_of_chains_is_read_again_as_it_was(tree: ast.Expression) -> None:
    assert parse(print_expression(tree)) == tree
    assert isinstance(tree, ast.BinaryExpression)
    assert chain(tree.operator, operands_of(tree)) == tree
