"""The table of operators, each row against a second definition of what it should say."""

from __future__ import annotations

import ctypes
import itertools
import math
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import pytest

from tachk.base import operators
from tachk.base.operators import (
    _ROWS,
    COMPARISONS,
    CONNECTIVES,
    CONSTANT_HIGH,
    CONSTANT_LOW,
    BinaryOperator,
    Failure,
    OperandError,
    OperandGroup,
    UnaryOperator,
    wrapped,
)
from tachk.base.span import Source
from tachk.model.fault import RuntimeErrorKind
from tachk.syntax import ast
from tachk.syntax.parsing.parser import parse_expression

SAMPLES = [CONSTANT_LOW, CONSTANT_LOW + 1, -40, -33, -8, -3, -1, 0, 1, 2, 3, 7, 31, 32, 40, 65537, CONSTANT_HIGH]
PAIRS = list(itertools.product(SAMPLES, SAMPLES))


def _power(left: int, right: int) -> int | None:
    result = 1
    for bit in f"{right:b}" if right >= 0 else "":
        result = result * result * (left if bit == "1" else 1) % 2**32
    return result if right >= 0 else None


MEANINGS: dict[str, Callable[[int, int], int | bool | None]] = {
    "+": lambda a, b: a - -b,
    "-": lambda a, b: a + -b,
    "*": lambda a, b: int(Fraction(a) * b),
    "/": lambda a, b: math.trunc(Fraction(a, b)) if b else None,
    "%": lambda a, b: int(math.copysign(abs(a) % abs(b), a)) if b else None,
    "**": _power,
    "&": lambda a, b: ~(~a | ~b),
    "|": lambda a, b: ~(~a & ~b),
    "^": lambda a, b: (a | b) - (a & b),
    "<<": lambda a, b: a * 2**b if b in range(32) else None,
    ">>": lambda a, b: math.floor(Fraction(a, 2**b)) if b in range(32) else None,
    "&&": lambda a, b: bool(a) and bool(b),
    "||": lambda a, b: bool(a) or bool(b),
    "imply": lambda a, b: bool(a) <= bool(b),
    "xor": lambda a, b: bool(a) is not bool(b),
    "==": lambda a, b: a - b == 0,
    "!=": lambda a, b: a - b != 0,
    "<": lambda a, b: a - b < 0,
    "<=": lambda a, b: a - b <= 0,
    ">": lambda a, b: a - b > 0,
    ">=": lambda a, b: a - b >= 0,
    "<?": lambda a, b: sorted((a, b))[0],
    ">?": lambda a, b: sorted((a, b))[1],
}


def test_every_operator_has_a_row_and_a_meaning_to_compare_with() -> None:
    assert set(_ROWS) == set(BinaryOperator) == set(MEANINGS)


def test_an_operator_without_a_row_stops_the_import() -> None:
    source = Path(operators.__file__).read_text()
    extended = source.replace('    MAXIMUM = ">?"\n', '    MAXIMUM = ">?"\n    OTHER = "<>"\n')
    assert extended != source
    with pytest.raises(KeyError, match="<>"):
        exec(extended, {"__name__": "operators_with_one_more"})


@pytest.mark.parametrize("operator", BinaryOperator)
def test_values(operator: BinaryOperator) -> None:
    for left, right in PAIRS:
        expected = MEANINGS[operator](left, right)
        assert operator.defined_for(right, right) is (expected is not None), (left, right)
        if expected is None:
            with pytest.raises(OperandError):
                operator.compute(left, right)
        else:
            assert operator.compute(left, right) == ctypes.c_int32(int(expected)).value, (left, right)


@pytest.mark.parametrize("operator", BinaryOperator)
def test_right_sides_with_a_value(operator: BinaryOperator) -> None:
    assert operator.total is operator.defined_for(CONSTANT_LOW, CONSTANT_HIGH)
    for low, high in PAIRS:
        if low <= high < low + 100:
            every = all(MEANINGS[operator](5, right) is not None for right in range(low, high + 1))
            assert operator.defined_for(low, high) is every, (low, high)


@pytest.mark.parametrize("operator", sorted(COMPARISONS))
def test_comparisons_negated_and_mirrored(operator: BinaryOperator) -> None:
    for left, right in itertools.product([*SAMPLES, Fraction(1, 3), Fraction(-5, 2)], repeat=2):
        assert operator.holds(left, right) is MEANINGS[operator](left, right)  # type: ignore[arg-type]
        assert operator.negated.holds(left, right) is not operator.holds(left, right)
        assert operator.mirrored.holds(right, left) is operator.holds(left, right)


@pytest.mark.parametrize("operator", sorted(set(BinaryOperator) - COMPARISONS))
def test_only_comparisons_compare(operator: BinaryOperator) -> None:
    for ask in (lambda: operator.negated, lambda: operator.mirrored, lambda: operator.holds(1, 2)):
        with pytest.raises(ValueError, match="is not a comparison"):
            ask()


def test_connectives() -> None:
    assert {"&&", "||", "imply", "xor"} == CONNECTIVES
    for operator in CONNECTIVES:
        decided = operator.decided_by
        for right in (0, 1, 5):
            if decided is not None:
                assert operator.compute(int(decided), right) == operator.compute(int(decided), 0)
    assert {operator for operator in BinaryOperator if operator.decided_by is not None} == {"&&", "||", "imply"}


@pytest.mark.parametrize("operator", BinaryOperator)
def test_associative_operators_may_be_grouped_anyhow(operator: BinaryOperator) -> None:
    if operator in COMPARISONS or not operator.total:
        assert not operator.associative
        return
    triples = itertools.product(SAMPLES, repeat=3)
    same = all(
        operator.compute(operator.compute(a, b), c) == operator.compute(a, operator.compute(b, c))
        for a, b, c in triples
    )
    assert operator.associative is same


@pytest.mark.parametrize("first", BinaryOperator)
def test_levels_are_those_of_the_grammar(first: BinaryOperator) -> None:
    for second in BinaryOperator:
        tree, _ = parse_expression(Source("", f"a {first} b {second} c"))
        assert isinstance(tree, ast.BinaryExpression)
        assert tree.operator == (second if first.level >= second.level else first), (first, second)


def test_words() -> None:
    for operator in BinaryOperator:
        if operator.word is not None:
            tree, _ = parse_expression(Source("", f"a {operator.word} b"))
            assert isinstance(tree, ast.BinaryExpression)
            assert tree.operator == operator


def test_versions_of_uppaal() -> None:
    assert {operator for operator in BinaryOperator if operator.since != (4, 0)} == {"xor", "**"}
    assert BinaryOperator.XOR.since == BinaryOperator.POWER.since == (5, 0)


def test_failures_are_run_time_errors() -> None:
    assert {failure.name for failure in Failure} <= {kind.name for kind in RuntimeErrorKind}
    with pytest.raises(OperandError, match="7 divided by 0") as caught:
        BinaryOperator.MODULO.compute(7, 0)
    assert caught.value.failure is Failure.DIVISION


def test_unary() -> None:
    for value in SAMPLES:
        assert UnaryOperator.MINUS.compute(value) == wrapped(-value) == ctypes.c_int32(-value).value
        assert UnaryOperator.NOT.compute(value) == (value == 0)


def test_groups() -> None:
    assert {"==", "!=", "<", "<=", ">", ">="} == COMPARISONS
    assert {o for o in BinaryOperator if o.group is OperandGroup.ARITHMETIC} == set(
        BinaryOperator
    ) - COMPARISONS - CONNECTIVES
