"""Constants to which clocks are compared in a network: one number for each clock, found by interval arithmetic."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product

from tachk.base.operators import CONSTANT_HIGH, CONSTANT_LOW, BinaryOperator, UnaryOperator
from tachk.base.records import dataclass
from tachk.meaning.dbm import Constraint, bound_value, raw_bound
from tachk.model.clock_sums import clock_assignments, clock_sum
from tachk.model.expressions import Binary, Conditional, Constant, Expression, Field, Index, Reference, Unary, Variable
from tachk.model.network import Network
from tachk.model.traversal import process_expressions, roots, walk
from tachk.model.types import BoolType, ClockType, IntType, ScalarType, bounds, slot_count
from tachk.model.variable_layout import VariableLayout, variable_layout

Interval = tuple[int, int]
DIAGONAL_VALUES = 1000


@dataclass(frozen=True, slots=True)
class ClockConstants:
    """Attributes:
    maximum: for each clock (entry 0 is 0) no constant it is compared with, alone or in a difference, is larger in
        absolute value. Where it is compared in a difference, there is room for what both clocks may be set to.
    diagonals: the difference constraints between two real clocks, each for every value its bound can have.
    compared: the clocks that are compared at all.
    """

    maximum: tuple[int, ...]
    diagonals: tuple[Constraint, ...]
    compared: frozenset[int]


def clock_constants(network: Network, predicates: Sequence[Expression]) -> ClockConstants:
    """Collects the constants of all guards and invariants and of the predicates.

    Raises ValueError if the bound of a difference constraint has more than `DIAGONAL_VALUES` values, or copies make too
    many of them count.
    """
    layout = variable_layout(network)
    maximum = [0] * (len(layout.clock_slots) + 1)
    diagonals: set[Constraint] = set()
    compared: set[int] = set()
    for condition in [*_conditions(network), *predicates]:
        for comparison in _comparisons(condition):
            clocks = [*_clocks(comparison.left), *_clocks(comparison.right)]
            low, high = interval(comparison.right if not _clocks(comparison.right) else comparison.left)
            for clock in clocks:
                for number in _numbers(clock, layout):
                    maximum[number] = max(maximum[number], abs(low), abs(high))
                    compared.add(number)
            if len(clocks) == 2:
                diagonals.update(_differences(comparison, low, high, layout))
            elif len(clocks) > 2:
                raise ValueError(f"{comparison.span}: a comparison with more than two clocks")
    _copy_constants(clock_copies(network), maximum, diagonals, compared)
    values = _values(network, layout)
    for i, j, raw in diagonals:
        for number in (i, j):
            maximum[number] = max(maximum[number], abs(bound_value(raw)) + max(values[i], values[j]))
    return ClockConstants(tuple(maximum), tuple(sorted(diagonals)), frozenset(compared))


def _values(network: Network, layout: VariableLayout) -> list[int]:
    """The largest number that each clock may begin with or be set to; entry 0 is 0."""
    values = [0, *layout.starts]
    for assignment in clock_assignments(e for process in network.processes for e in process_expressions(process)):
        whole = clock_sum(assignment.value)
        if whole is not None and whole.offset is not None and whole.clock is None:
            high = interval(whole.offset)[1]
            for clock in _denoted(assignment.target, layout):
                values[clock] = max(values[clock], high)
    return values


def _denoted(place: Expression, layout: VariableLayout) -> frozenset[int]:
    """The clocks that a place may mean."""
    variables = tuple(roots(place))
    if any(variable not in layout.first for variable in variables):  # passed by reference
        return frozenset(range(1, len(layout.clock_slots) + 1))
    return frozenset(n for variable in variables for n in _numbers(Reference(variable), layout))


@dataclass(frozen=True, slots=True)
class Copies:
    """Some assignment may set one of the clocks to one of the sources and so much more."""

    clocks: frozenset[int]
    sources: frozenset[int]
    offsets: Interval


def clock_copies(network: Network) -> list[Copies]:
    """The assignments of clocks to clocks. Offsets are not negative: that is a run-time error."""
    layout = variable_layout(network)
    found = []
    for assignment in clock_assignments(e for process in network.processes for e in process_expressions(process)):
        whole = clock_sum(assignment.value)
        if whole is not None and whole.clock is not None:
            low, high = (0, 0) if whole.offset is None else interval(whole.offset)
            found.append(
                Copies(
                    _denoted(assignment.target, layout),
                    _denoted(whole.clock, layout),
                    (max(low, 0), max(high, 0)),
                )
            )
    return found


def _copy_constants(
    copies: Sequence[Copies], maximum: list[int], diagonals: set[Constraint], compared: set[int]
) -> None:
    """Hands the constants of a clock on to the clocks that it is set to. Raises ValueError if that never ends, which
    differences of clocks may cause."""
    changed = True
    while changed:
        before = sum(maximum), len(diagonals), len(compared)
        for copy in copies:
            largest = max((maximum[clock] for clock in copy.clocks), default=0)
            for source in copy.sources:
                maximum[source] = max(maximum[source], largest)
            if compared & copy.clocks:
                compared |= copy.sources
            for i, j, raw in list(diagonals):
                for source, offset in product(copy.sources, range(copy.offsets[0], copy.offsets[1] + 1)):
                    if i in copy.clocks and source != j:
                        diagonals.add((source, j, raw - 2 * offset))
                    if j in copy.clocks and source != i:
                        diagonals.add((i, source, raw + 2 * offset))
                    if len(diagonals) > DIAGONAL_VALUES:
                        raise ValueError("copies of clocks make too many differences of clocks count")
        for i, j, raw in diagonals:
            for clock in (i, j):
                maximum[clock] = max(maximum[clock], abs(bound_value(raw)))
        changed = before != (sum(maximum), len(diagonals), len(compared))


def _differences(comparison: Binary, low: int, high: int, layout: VariableLayout) -> Iterator[Constraint]:
    """A comparison of two clocks, as a constraint that splits the valuations the way the comparison does."""
    if high - low >= DIAGONAL_VALUES:
        raise ValueError(f"{comparison.span}: a difference of clocks is compared with too many values")
    left, right = _clocks(comparison.left), _clocks(comparison.right)
    first, second = left[0] if left else right[0], right[0] if len(left) == len(right) else (left or right)[1]
    for i, j, value in product(_numbers(first, layout), _numbers(second, layout), range(low, high + 1)):
        if i != j:
            for strict in (True, False):
                yield i, j, raw_bound(value, strict)


def interval(expression: Expression) -> Interval:
    """Bounds on the value of an integer expression; ``(0, 0)`` for one of clock type."""
    match expression:
        case Constant(value):
            return value, value
        case Unary(UnaryOperator.MINUS, operand):
            low, high = interval(operand)
            return -high, -low
        case Binary(BinaryOperator.ADD, left, right):
            (a, b), (c, d) = interval(left), interval(right)
            return a + c, b + d
        case Binary(BinaryOperator.SUBTRACT, left, right) if not isinstance(expression.type, ClockType):
            (a, b), (c, d) = interval(left), interval(right)
            return a - d, b - c
        case Binary(BinaryOperator.MULTIPLY, left, right):
            (a, b), (c, d) = interval(left), interval(right)
            products = (a * c, a * d, b * c, b * d)
            return min(products), max(products)
        case Binary(BinaryOperator.DIVIDE, left, _):
            largest = max(map(abs, interval(left)))
            return -largest, largest
        case Binary(BinaryOperator.MODULO, _, Constant(value)) if value != 0:
            return 1 - abs(value), abs(value) - 1
        case Binary(BinaryOperator.MINIMUM | BinaryOperator.MAXIMUM, left, right) | Conditional(_, left, right):
            (a, b), (c, d) = interval(left), interval(right)
            return min(a, c), max(b, d)
        case Binary(BinaryOperator.BIT_OR | BinaryOperator.BIT_XOR, left, right) if (
            interval(left)[0] >= 0 and interval(right)[0] >= 0
        ):
            return 0, 2 ** max(interval(left)[1], interval(right)[1]).bit_length() - 1
        case Binary(BinaryOperator.SHIFT_LEFT, left, right) if interval(left)[0] >= 0 and interval(right)[1] <= 8:
            return 0, interval(left)[1] << max(interval(right)[1], 0)
        case Binary():
            return (0, 0) if isinstance(expression.type, ClockType) else (CONSTANT_LOW, CONSTANT_HIGH)
        case _:
            return bounds(expression.type) if isinstance(expression.type, IntType | BoolType | ScalarType) else (0, 0)


def _conditions(network: Network) -> Iterator[Expression]:
    for process in network.processes:
        yield from (location.invariant for location in process.locations if location.invariant is not None)
        yield from (edge.guard for edge in process.edges if edge.guard is not None)


def _comparisons(condition: Expression) -> Iterator[Binary]:
    for expression in walk(condition):
        if isinstance(expression, Binary) and (_clocks(expression.left) or _clocks(expression.right)):
            yield expression


def _clocks(side: Expression) -> list[Expression]:
    if not isinstance(side.type, ClockType):
        return []
    return [side.left, side.right] if isinstance(side, Binary) else [side]


def _numbers(clock: Expression, layout: VariableLayout) -> Iterator[int]:
    """The clocks that an expression of clock type can denote: those of its variable."""
    variable = _variable(clock)
    first = layout.first[variable]
    slots = range(first, first + slot_count(variable.type))
    return (number for number, slot in enumerate(layout.clock_slots, start=1) if slot in slots)


def _variable(place: Expression) -> Variable:
    match place:
        case Reference(variable):
            return variable
        case Index(base) | Field(base):
            return _variable(base)
        case _:
            raise ValueError(f"{place.span}: this does not name a clock")
