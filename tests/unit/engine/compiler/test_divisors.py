"""What every value of an expression is a multiple of."""

from __future__ import annotations

from tachk.analysis.divisors import divisor
from tachk.analysis.fold import Known
from tachk.base.operators import BinaryOperator
from tachk.model.builder import NetworkBuilder, Term, conditional
from tachk.model.expressions import INT, Binary, Constant
from tachk.model.types import ArrayType, IntType

NETWORK = NetworkBuilder()
INDEX = NETWORK.integer("index", 0, 3)
TABLE = NETWORK.declare("table", ArrayType(IntType(), IntType(0, 3)), (10, -40, 30, 20))
NETWORK.process("P").location("only")
KNOWN = Known({NETWORK.build().variables[1]: (10, -40, 30, 20)})


def of(operator: BinaryOperator, number: int) -> int:
    return divisor(Binary(operator, Term(Constant(number)).expression, TABLE[INDEX].expression, INT), KNOWN)


def test_products_multiply_and_sums_share_divisors() -> None:
    assert divisor(TABLE[INDEX].expression, KNOWN) == 10
    assert of(BinaryOperator.MULTIPLY, 15) == 150
    assert of(BinaryOperator.MULTIPLY, 4) == 40
    assert of(BinaryOperator.ADD, 15) == 5
    assert of(BinaryOperator.SUBTRACT, 4) == 2


def test_a_choice_has_what_both_sides_share() -> None:
    assert divisor(conditional(INDEX == 0, TABLE[INDEX], 15).expression, KNOWN) == 5
