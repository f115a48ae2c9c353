"""Symbolic evaluation of expressions: their meaning in `tachk.model.evaluate`, for all states at once.

What can go wrong is collected with the condition under which it does; what comes behind it then means nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TypeVar, assert_never

from tachk.base.diagnostics.diagnostic import Diagnostic, UnsupportedError
from tachk.base.operators import COMPARISONS, CONNECTIVES, CONSTANT_HIGH, BinaryOperator, UnaryOperator
from tachk.base.span import Span
from tachk.base.time_limit import check_time
from tachk.engine.smt.storage import CLOCK_SOURCE, CLOCK_VALUE, STATE, Storage, SymbolicPlace, either, place_at
from tachk.engine.smt.terms import (
    Formula,
    SymbolicNumber,
    all_of,
    any_of,
    choose,
    compare,
    compute,
    conj,
    constant,
    disj,
    minus,
    narrowed,
    neg,
    of_formula,
    same,
    truth_of,
    undefined,
)
from tachk.meaning.constraints import compares_clocks
from tachk.model.cell_layout import CellLayout, cell_bounds
from tachk.model.clock_sums import clock_sum
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
from tachk.model.fault import RuntimeErrorKind
from tachk.model.types import (
    ArrayType,
    BoolType,
    ClockType,
    IntType,
    RecordType,
    ScalarType,
    Type,
    bounds,
    cell_count,
    leaves,
)

_WRONG = {
    BinaryOperator.POWER: RuntimeErrorKind.NEGATIVE_EXPONENT,
    BinaryOperator.SHIFT_LEFT: RuntimeErrorKind.SHIFT,
    BinaryOperator.SHIFT_RIGHT: RuntimeErrorKind.SHIFT,
}
"""What happens where an operator has no value; with the others it is division by zero."""


@dataclass(frozen=True, slots=True)
class PossibleFault:
    """Something that goes wrong where ``condition`` holds."""

    condition: Formula
    kind: RuntimeErrorKind
    span: Span


Clocks = tuple[int, ...]
CompareClocks = Callable[[BinaryOperator, Clocks, Clocks, SymbolicNumber], Formula]
"""Whether the sum of some clocks minus that of others compares in some way with a number."""

_T = TypeVar("_T")


@dataclass(slots=True)
class Evaluator:
    """Attributes:
    locations: that of every process.
    path: under which condition what is being executed is executed at all.
    faults: what may go wrong, in order.
    doomed: something goes wrong on every way from here.
    deadlock: whether the state is a deadlock.
    """

    layout: CellLayout
    locations: Sequence[SymbolicNumber]
    storage: Storage
    compare_clocks: CompareClocks
    deadlock: Callable[[], Formula] | None = None
    path: Formula = True
    faults: list[PossibleFault] = field(default_factory=list)
    doomed: bool = False
    frame: dict[Variable, SymbolicPlace] = field(default_factory=dict)

    def bind(self, variable: Variable, value: int) -> None:
        """Gives a select or quantifier variable its value."""
        segment = self.storage.new_segment((constant(value),), ((value, value),))
        self.frame[variable] = place_at(segment)

    def under(self, condition: Formula, action: Callable[[], _T]) -> _T | None:
        """Does something where a condition holds; what it writes is written there alone. None where it never does."""
        condition_now = conj(self.path, condition)
        if condition is False or condition_now is False:
            return None
        outer, self.path = self.path, condition_now
        if condition is True:
            result = action()
        else:
            doomed = self.doomed
            result, changes = self.storage.apart(action)
            self.storage.apply(changes, condition)
            self.doomed = doomed
        self.path = outer
        return result

    def goes_wrong(self, condition: Formula, kind: RuntimeErrorKind, span: Span) -> None:
        whole = conj(self.path, condition)
        self.doomed = self.doomed or condition is True
        if whole is not False:
            self.faults.append(PossibleFault(whole, kind, span))

    # ---- conditions --------------------------------------------------------------------------------------------------

    def truth(self, expression: Expression) -> Formula:
        """Whether a condition is true."""
        match expression:
            case Unary(UnaryOperator.NOT, operand):
                return neg(self.truth(operand))
            case Binary(operator, left, right) if operator in CONNECTIVES:
                return self._connected(operator, left, right)
            case Binary(operator, left, right) if operator in COMPARISONS:
                return self._compared(operator, left, right)
            case Conditional(condition, then, otherwise) if isinstance(expression.type, BoolType):
                test = self.truth(condition)
                # Where the test looks at clocks both sides are evaluated, whatever the clocks are.
                blind = compares_clocks(condition)
                first = self.under(True if blind else test, lambda: self.truth(then))
                second = self.under(True if blind else neg(test), lambda: self.truth(otherwise))
                return disj(conj(test, bool_of(first)), conj(neg(test), bool_of(second)))
            case Quantifier(kind, variable, body) if kind is not QuantifierKind.SUM:
                return self._quantified(kind, variable, body)
            case Comma(items) if isinstance(expression.type, BoolType):
                for item in items[:-1]:
                    self.cells(item)
                return self.truth(items[-1])
            case LocationTest(process, location):
                return self.locations[process].is_value(location)
            case Deadlock():
                if self.deadlock is None:
                    raise refused("deadlock", expression.span)
                return self.deadlock()
            case _:
                return truth_of(self.number(expression))

    def _connected(self, operator: BinaryOperator, left: Expression, right: Expression) -> Formula:
        first = self.truth(left)
        if operator is BinaryOperator.XOR:
            return neg(same(first, self.truth(right)))
        needed = neg(first) if operator is BinaryOperator.OR else first
        if not isinstance(first, bool) and compares_clocks(left):
            needed = True
        second = bool_of(self.under(needed, lambda: self.truth(right)))
        if operator is BinaryOperator.AND:
            return conj(first, second)
        return disj(first if operator is BinaryOperator.OR else neg(first), second)

    def _compared(self, operator: BinaryOperator, left: Expression, right: Expression) -> Formula:
        if isinstance(left.type, ArrayType | RecordType):
            equal = [
                compare(BinaryOperator.EQUAL, a, b) for a, b in zip(self.cells(left), self.cells(right), strict=True)
            ]
            return all_of(equal) if operator is BinaryOperator.EQUAL else neg(all_of(equal))
        if isinstance(left.type, ClockType) or isinstance(right.type, ClockType):
            return self._compared_clocks(operator, left, right)
        if isinstance(left.type, BoolType) and isinstance(right.type, BoolType):
            if operator in (BinaryOperator.EQUAL, BinaryOperator.NOT_EQUAL):
                equal_truth = same(self.truth(left), self.truth(right))
                return equal_truth if operator is BinaryOperator.EQUAL else neg(equal_truth)
        first = self.number(left)
        return compare(operator, first, self.number(right))

    def _compared_clocks(self, operator: BinaryOperator, left: Expression, right: Expression) -> Formula:
        plus_left, minus_left, constant_left = self._linear(left)
        plus_right, minus_right, constant_right = self._linear(right)
        bound = compute(BinaryOperator.SUBTRACT, constant_right, constant_left)
        options: list[tuple[Formula, list[int], list[int]]] = [(True, [], [])]
        for adds, clocks in ((True, plus_left), (True, minus_right), (False, minus_left), (False, plus_right)):
            if clocks is not None:
                options = [
                    (conj(condition, also), [*plus, clock] if adds else plus, less if adds else [*less, clock])
                    for condition, plus, less in options
                    for also, clock in clocks
                ]
        return any_of(
            conj(condition, self.compare_clocks(operator, tuple(plus), tuple(less), bound))
            for condition, plus, less in options
            if condition is not False
        )

    def _linear(
        self, side: Expression
    ) -> tuple[list[tuple[Formula, int]] | None, list[tuple[Formula, int]] | None, SymbolicNumber]:
        """One side of a comparison: a clock added, one subtracted, or a number."""
        if not isinstance(side.type, ClockType):
            return None, None, self.number(side)
        if isinstance(side, Binary):
            first = self.clocks_named(side.left)
            return first, self.clocks_named(side.right), constant(0)
        return self.clocks_named(side), None, constant(0)

    def clocks_named(self, expression: Expression) -> list[tuple[Formula, int]]:
        """The clocks, or the channels, that an expression may denote, each with its condition."""
        return self._of_place(self.place(expression))

    def _of_place(self, place: SymbolicPlace) -> list[tuple[Formula, int]]:
        found: list[tuple[Formula, int]] = []
        for condition, segment, position in place.alternatives:
            number = self.storage.cells[segment, position]
            found += [(conj(condition, number.is_value(value)), value) for value in number.values]
        return [(condition, number) for condition, number in found if condition is not False]

    def _quantified(self, kind: QuantifierKind, variable: Variable, body: Expression) -> Formula:
        assert isinstance(variable.type, IntType | BoolType | ScalarType)
        low, high = bounds(variable.type)
        every = kind is QuantifierKind.FORALL
        blind = compares_clocks(body)
        open_still: Formula = True
        results: list[Formula] = []
        for value in range(low, high + 1):
            check_time()
            self.bind(variable, value)
            one = bool_of(self.under(open_still, lambda: self.truth(body)))
            results.append(one if every else neg(one))
            if not blind:
                open_still = conj(open_still, results[-1])
        return all_of(results) if every else neg(all_of(results))

    # ---- values ------------------------------------------------------------------------------------------------------

    def number(self, expression: Expression) -> SymbolicNumber:
        """The value of an expression of integer, boolean or scalar type."""
        match expression:
            case Constant(value):
                return constant(value)
            case Reference() | Index() | Field():
                return self._read(self.place(expression))[0]
            case Unary(UnaryOperator.MINUS, operand):
                return minus(self.number(operand))
            case Binary(operator, left, right) if operator not in CONNECTIVES and operator not in COMPARISONS:
                first = self.number(left)
                return self._computed(operator, first, self.number(right), expression.span)
            case Conditional(condition, then, otherwise):
                test = self.truth(condition)
                first_side = self.under(test, lambda: self.number(then))
                second_side = self.under(neg(test), lambda: self.number(otherwise))
                if first_side is None or second_side is None:
                    return first_side or second_side or constant(0)
                return choose(test, first_side, second_side)
            case Quantifier(QuantifierKind.SUM, variable, body):
                return self._summed(variable, body)
            case Assign() | Call():
                return self.cells(expression)[0]
            case Increment(target, delta, prefix, _, span):
                place = self.place(target)
                old = self._read(place)[0]
                new = compute(BinaryOperator.ADD, old, constant(delta))
                self._write(place, (new,), span)
                return new if prefix else old
            case Comma(items):
                for item in items[:-1]:
                    self.cells(item)
                return self.number(items[-1])
            case Unary() | Binary() | Quantifier() | LocationTest() | Deadlock():
                return of_formula(self.truth(expression))
            case Aggregate():
                raise TypeError("an aggregate is not a scalar value")
            case _ as never:
                assert_never(never)

    def cells(self, expression: Expression) -> tuple[SymbolicNumber, ...]:
        """The cells of the value of an expression of any type."""
        match expression:
            case Assign():
                return self._assign(expression)
            case Call():
                return self.call(expression)
            case Aggregate(items):
                return tuple(cell for item in items for cell in self.cells(item))
            case Comma(items):
                for item in items[:-1]:
                    self.cells(item)
                return self.cells(items[-1])
            case _ if isinstance(expression.type, IntType | BoolType | ScalarType):
                return (self.number(expression),)
            case Conditional(condition, then, otherwise):
                test = self.truth(condition)
                first = self.under(test, lambda: self.cells(then))
                second = self.under(neg(test), lambda: self.cells(otherwise))
                if first is None or second is None:
                    return first or second or ()
                return tuple(choose(test, a, b) for a, b in zip(first, second, strict=True))
            case _:
                return self._read(self.place(expression), cell_count(expression.type))

    def _computed(
        self, operator: BinaryOperator, left: SymbolicNumber, right: SymbolicNumber, span: Span
    ) -> SymbolicNumber:
        wrong = undefined(operator, right)
        if wrong is not False:
            kind = _WRONG.get(operator, RuntimeErrorKind.DIVISION)
            self.goes_wrong(wrong, kind, span)
        try:
            return compute(operator, left, right)
        except ValueError as error:
            raise refused(f"this expression: {error}", span) from None

    def _summed(self, variable: Variable, body: Expression) -> SymbolicNumber:
        assert isinstance(variable.type, IntType | BoolType | ScalarType)
        low, high = bounds(variable.type)
        total = constant(0)
        for value in range(low, high + 1):
            self.bind(variable, value)
            total = compute(BinaryOperator.ADD, total, self.number(body))
        return total

    # ---- places ------------------------------------------------------------------------------------------------------

    def place(self, expression: Expression) -> SymbolicPlace:
        match expression:
            case Reference(variable):
                in_frame = self.frame.get(variable)
                return in_frame if in_frame is not None else place_at(STATE, self.layout.first[variable])
            case Index(base, index, _, span):
                assert isinstance(base.type, ArrayType)
                return self._indexed(self.place(base), base.type, self.number(index), span)
            case Field(base, name):
                assert isinstance(base.type, RecordType)
                return self.place(base).moved(base.type.offset(name))
            case Conditional(condition, then, otherwise):
                test = self.truth(condition)
                first = self.under(test, lambda: self.place(then))
                second = self.under(neg(test), lambda: self.place(otherwise))
                if first is None or second is None:
                    return first or second or SymbolicPlace(())
                return either(test, first, second)
            case _:
                values = self.cells(expression)
                return place_at(self.storage.new_segment(values, ranges_of(expression.type)))

    def _indexed(self, start: SymbolicPlace, array: ArrayType, index: SymbolicNumber, span: Span) -> SymbolicPlace:
        size, count = array.size, cell_count(array.element)
        first, last = array.low, array.low + size - 1
        outside = disj(
            compare(BinaryOperator.LESS, index, constant(first)), compare(BinaryOperator.GREATER, index, constant(last))
        )
        self.goes_wrong(outside, RuntimeErrorKind.INDEX, span)
        found = []
        for number in range(max(index.low, first), min(index.high, last) + 1):
            here = index.is_value(number)
            for condition, segment, position in start.alternatives:
                both = conj(condition, here)
                if both is not False:
                    found.append((both, segment, position + (number - first) * count))
        return SymbolicPlace(tuple(found) or ((True, *start.alternatives[0][1:]),))

    def _read(self, place: SymbolicPlace, count: int = 1) -> tuple[SymbolicNumber, ...]:
        values: list[SymbolicNumber] = []
        for offset in range(count):
            value: SymbolicNumber | None = None
            for condition, segment, position in reversed(place.alternatives):
                cell = self.storage.cells[segment, position + offset]
                value = cell if value is None else choose(condition, cell, value)
            assert value is not None
            values.append(value)
        return tuple(values)

    def _write(self, place: SymbolicPlace, values: Sequence[SymbolicNumber], span: Span) -> None:
        for offset, value in enumerate(values):
            for condition, segment, position in place.alternatives:
                low, high = self.storage.ranges[segment][position + offset]
                if value.low < low or value.high > high:
                    inside = conj(
                        compare(BinaryOperator.GREATER_EQUAL, value, constant(low)),
                        compare(BinaryOperator.LESS_EQUAL, value, constant(high)),
                    )
                    self.goes_wrong(conj(condition, neg(inside)), RuntimeErrorKind.RANGE, span)
                cell = segment, position + offset
                stored = narrowed(value, low, high)
                self.storage.write(cell, choose(condition, stored, self.storage.cells.get(cell, stored)))

    def _assign(self, expression: Assign) -> tuple[SymbolicNumber, ...]:
        target, value, span = expression.target, expression.value, expression.span
        place = self.place(target)
        if isinstance(target.type, ClockType):
            return (self._set_clock(place, value, span),)
        if expression.operator is None:
            cells = self.cells(value)
        else:
            old = self._read(place)[0]
            cells = (self._computed(expression.operator, old, self.number(value), span),)
        self._write(place, cells, span)
        return cells

    def _set_clock(self, target: SymbolicPlace, value: Expression, span: Span) -> SymbolicNumber:
        whole = clock_sum(value)
        if whole is None:
            raise refused("a clock that is set to something else than a number, a clock, or a sum of both", span)
        from_place = None if whole.clock is None else self.place(whole.clock)
        offset = constant(0) if whole.offset is None else self.number(whole.offset)
        self.goes_wrong(compare(BinaryOperator.LESS, offset, constant(0)), RuntimeErrorKind.NEGATIVE_CLOCK, span)
        source, more = constant(0), offset
        if from_place is not None:
            cells = self.storage.cells
            for condition, clock in self._of_place(from_place):
                advanced = cells[CLOCK_VALUE, clock]
                if advanced.high + offset.high > CONSTANT_HIGH:
                    raise refused("a clock that may be advanced so far in one step", span)
                source = choose(condition, cells[CLOCK_SOURCE, clock], source)
                more = choose(condition, compute(BinaryOperator.ADD, advanced, offset), more)
        for condition, clock in self._of_place(target):
            for cell, number in (((CLOCK_SOURCE, clock), source), ((CLOCK_VALUE, clock), more)):
                self.storage.write(cell, choose(condition, number, self.storage.cells[cell]))
        return offset

    def call(self, expression: Call) -> tuple[SymbolicNumber, ...]:
        """Executes a function; the cells of its result."""
        raise NotImplementedError


def bool_of(found: Formula | None) -> Formula:
    """What was evaluated; False where it never is."""
    return False if found is None else found


def ranges_of(type_: Type) -> tuple[tuple[int, int], ...]:
    return tuple(cell_bounds(leaf) for _, leaf in leaves(type_))


def refused(what: str, span: Span) -> UnsupportedError:
    return UnsupportedError(
        Diagnostic("E0745", f"the engine smt does not encode {what}", span, "ask the zone engine: --engine zone")
    )
