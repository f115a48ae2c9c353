"""Sound intervals of integer expressions: every value an evaluation without a run-time error can have lies inside.

Needed where the bound of a clock constraint depends on variables: the abstraction of zones must know how large it gets.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from tachk.analysis.fold import Known, apply_binary, is_integer
from tachk.base.operators import COMPARISONS, CONNECTIVES, CONSTANT_HIGH, CONSTANT_LOW, BinaryOperator, UnaryOperator
from tachk.model.cell_layout import cell_range
from tachk.model.expressions import (
    Aggregate,
    Assign,
    Binary,
    Call,
    Comma,
    Conditional,
    Constant,
    Deadlock,
    Expression,
    Field,
    Increment,
    Index,
    LocationTest,
    Quantifier,
    QuantifierKind,
    Reference,
    Unary,
    Variable,
)
from tachk.model.traversal import returned, statement_expressions, written_variables
from tachk.model.types import ArrayType, RecordType, Type, cell_count, leaves

Interval = tuple[int, int]

ANYTHING: Interval = (CONSTANT_LOW, CONSTANT_HIGH)
_MAXIMAL_CELLS = 65536


def interval(expression: Expression, known: Known, arguments: Mapping[Variable, Interval] | None = None) -> Interval:
    """The smallest and largest value the expression can have; ``arguments`` are intervals of function parameters."""
    given = arguments or {}
    match expression:
        case Constant(value):
            return value, value
        case Reference(variable) if variable in given:
            return given[variable]
        case Reference() | Index() | Field():
            return _read(expression, known, given)
        case Unary(UnaryOperator.MINUS, operand):
            low, high = interval(operand, known, given)
            return _fit(-high, -low)
        case Unary() | LocationTest() | Deadlock():
            return 0, 1
        case Binary(operator, left, right):
            if operator in COMPARISONS or operator in CONNECTIVES:
                return 0, 1
            return arithmetic(operator, interval(left, known, given), interval(right, known, given))
        case Conditional(_, then, otherwise):
            return _hull(interval(then, known, given), interval(otherwise, known, given))
        case Quantifier(kind, variable, body):
            if kind is not QuantifierKind.SUM:
                return 0, 1
            low, high = cell_range(variable.type)
            inner = interval(body, known, given)
            return _fit((high - low + 1) * inner[0], (high - low + 1) * inner[1])
        case Assign(target) | Increment(target):
            low, high = cell_range(target.type)
            return (low - 1, high + 1) if isinstance(expression, Increment) else (low, high)
        case Call():
            return _call(expression, known, given)
        case Comma(items):
            return interval(items[-1], known, given)
        case Aggregate():
            raise TypeError("an aggregate has no interval")


def possible_cells(place: Expression, known: Known) -> tuple[tuple[Variable, int], ...] | None:
    """The cells (variable, number of the cell in it) a place may denote; None where that is not known."""
    match place:
        case Reference(variable):
            return None if variable.reference else ((variable, 0),)
        case Field(base, name):
            assert isinstance(base.type, RecordType)
            inside = possible_cells(base, known)
            return None if inside is None else tuple((v, c + base.type.offset(name)) for v, c in inside)
        case Index(base, index):
            assert isinstance(base.type, ArrayType)
            inside = possible_cells(base, known)
            low, high = interval(index, known)
            first = max(low - base.type.low, 0)
            last = min(high - base.type.low, base.type.size - 1)
            if inside is None or len(inside) * max(last - first + 1, 0) > _MAXIMAL_CELLS:
                return None
            stride = cell_count(base.type.element)
            return tuple((v, c + i * stride) for v, c in inside for i in range(first, last + 1))
        case Conditional(_, then, otherwise):
            one, other = possible_cells(then, known), possible_cells(otherwise, known)
            return None if one is None or other is None else one + other
        case _:
            pass
    return None


def _read(place: Expression, known: Known, given: Mapping[Variable, Interval]) -> Interval:
    bounds_by_type = cell_range(place.type) if is_integer(place.type) else ANYTHING
    cells = None if given else possible_cells(place, known)
    if not cells:
        return bounds_by_type
    types: dict[Variable, tuple[tuple[str, Type], ...]] = {}
    for variable in {variable for variable, _ in cells}:
        if variable not in known.values:
            types[variable] = tuple(leaves(variable.type))
    values = [known.values[variable][cell] for variable, cell in cells if variable not in types]
    ranges = [cell_range(types[variable][cell][1]) for variable, cell in cells if variable in types]
    lows, highs = (values + [each[side] for each in ranges] for side in (0, 1))
    return min(lows), max(highs)


def _call(call: Call, known: Known, given: Mapping[Variable, Interval]) -> Interval:
    declared = cell_range(call.function.result)
    if call.function.operation is not None:
        return declared
    written = written_variables(list(statement_expressions(call.function.body)))
    arguments = {
        parameter: interval(argument, known, given)
        for parameter, argument in zip(call.function.parameters, call.arguments, strict=True)
        if is_integer(parameter.type) and not parameter.reference and parameter not in written
    }
    result: Interval | None = None
    for value in returned(call.function.body):
        one = interval(value, known, arguments)
        result = one if result is None else _hull(result, one)
    if result is None:
        return declared
    low, high = max(result[0], declared[0]), min(result[1], declared[1])
    return (low, high) if low <= high else declared


def arithmetic(operator: BinaryOperator, left: Interval, right: Interval) -> Interval:
    """The values of ``left operator right`` where there is one; 0 where there is none, for that is not evaluated to a
    value but to a run-time error."""
    if not _ever_defined(operator, right):
        return 0, 0
    match operator:
        case BinaryOperator.ADD:
            return _fit(left[0] + right[0], left[1] + right[1])
        case BinaryOperator.SUBTRACT:
            return _fit(left[0] - right[1], left[1] - right[0])
        case BinaryOperator.MULTIPLY:
            products = [a * b for a in left for b in right]
            return _fit(min(products), max(products))
        case BinaryOperator.DIVIDE:
            if left[0] == CONSTANT_LOW and right[0] <= -1 <= right[1]:
                return ANYTHING
            return _extremes(operator, left, tuple(_divisors(right)))
        case BinaryOperator.MODULO:
            remainder = max(abs(right[0]), abs(right[1]), 1) - 1
            return max(min(left[0], 0), -remainder), min(max(left[1], 0), remainder)
        case BinaryOperator.MINIMUM:
            return min(left[0], right[0]), min(left[1], right[1])
        case BinaryOperator.MAXIMUM:
            return max(left[0], right[0]), max(left[1], right[1])
        case BinaryOperator.BIT_AND if left[0] >= 0 or right[0] >= 0:
            return 0, min(i[1] for i in (left, right) if i[0] >= 0)
        case BinaryOperator.BIT_OR | BinaryOperator.BIT_XOR if left[0] >= 0 and right[0] >= 0:
            return 0, (1 << max(left[1], right[1]).bit_length()) - 1
        case BinaryOperator.SHIFT_LEFT | BinaryOperator.SHIFT_RIGHT:
            distances = max(right[0], 0), min(right[1], 31)
            shifted = [a << d if operator is BinaryOperator.SHIFT_LEFT else a >> d for a in left for d in distances]
            return _fit(min(shifted), max(shifted))
        case BinaryOperator.POWER if left[0] >= 0 and right[0] >= 0:
            if left[1] > 1 and right[1] > 31:
                return ANYTHING
            return _fit(0, max(left[1] ** min(right[1], 31), 1))
        case _:
            return ANYTHING


def _ever_defined(operator: BinaryOperator, right: Interval) -> bool:
    """Whether there is a value for some right side in an interval."""
    return operator.total or any(first <= right[1] and right[0] <= last for first, last in operator.rights)


def _divisors(interval_: Interval) -> Iterator[int]:
    """The divisors at which a quotient takes its extreme values."""
    for candidate in (interval_[0], interval_[1], -1, 1):
        if candidate != 0 and interval_[0] <= candidate <= interval_[1]:
            yield candidate


def _extremes(operator: BinaryOperator, left: Interval, right: tuple[int, ...]) -> Interval:
    values = [apply_binary(operator, a, b) for a in left for b in right]
    known = [v for v in values if v is not None]
    return (min(known), max(known)) if len(known) == len(values) else ANYTHING


def _hull(one: Interval, other: Interval) -> Interval:
    return min(one[0], other[0]), max(one[1], other[1])


def _fit(low: int, high: int) -> Interval:
    """Anything, if a result may leave the 32 bits: then it wraps around."""
    return (low, high) if low >= CONSTANT_LOW and high <= CONSTANT_HIGH else ANYTHING
