"""Symbolic execution: the meaning of expressions and statements in `tachk.model.evaluate`, for all states at once.

A domain of `tachk.analysis.interpreter` with terms of z3. What can go wrong is collected with the condition under which
it does; what comes behind it then means nothing. Branches are executed apart and joined, so that a loop over numbers
that are known is unrolled and ends.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial, reduce
from typing import TypeVar

from tachk.analysis.interpreter import Domain, Side, ValueOperations, number, place, run, slots, truth
from tachk.base.diagnostics.diagnostic import Diagnostic, UnsupportedError
from tachk.base.job import check_job
from tachk.base.operators import CONSTANT_HIGH, BinaryOperator
from tachk.base.span import Span
from tachk.engine.smt.storage import CLOCK_SOURCE, CLOCK_VALUE, STATE, Slot, Storage, SymbolicPlace, either, place_at
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
    narrowed,
    neg,
    of_formula,
    same,
    truth_of,
    undefined,
)
from tachk.model.expressions import Call, Expression, Function, Variable
from tachk.model.fault import RuntimeErrorKind
from tachk.model.traversal import ClockDependence
from tachk.model.types import ArrayType, RecordType, Type, VoidType, leaves, slot_count
from tachk.model.variable_layout import VariableLayout, default_values, slot_bounds, slot_range

ROUNDS = 512
"""A loop that may take more than these rounds is refused."""

_WRONG = {
    BinaryOperator.POWER: RuntimeErrorKind.NEGATIVE_EXPONENT,
    BinaryOperator.SHIFT_LEFT: RuntimeErrorKind.SHIFT,
    BinaryOperator.SHIFT_RIGHT: RuntimeErrorKind.SHIFT,
}
"""The faults of operators without a value; with the others it is division by zero."""


@dataclass(frozen=True, slots=True)
class PossibleFault:
    """Something that goes wrong where ``condition`` holds."""

    condition: Formula
    kind: RuntimeErrorKind
    span: Span


Clocks = tuple[int, ...]
CompareClocks = Callable[[BinaryOperator, Clocks, Clocks, SymbolicNumber], Formula]
"""The formula that compares the sum of some clocks minus that of others with a number."""

SymbolicSlots = tuple[SymbolicNumber, ...]
_Exit = tuple[Formula, dict[Slot, SymbolicNumber]]
"""The end of one of several paths: its condition, and the values of slots then."""
_T = TypeVar("_T")


_VALUES = ValueOperations(constant, of_formula, truth_of, compare, choose, neg, same, all_of, any_of)


@dataclass(slots=True)
class Machine(Domain[SymbolicNumber, Formula, SymbolicPlace]):
    """Attributes:
    locations: that of every process.
    path: under which condition what is being executed is executed at all.
    faults: what may go wrong, in order.
    doomed: something goes wrong on every way from here.
    is_deadlock: whether the state is a deadlock.
    returned: where the current function has returned, with what, and what slots held then.
    depends_on_clocks: whether the truth of a condition does.
    """

    layout: VariableLayout
    locations: Sequence[SymbolicNumber]
    storage: Storage
    clocks_compare: CompareClocks
    is_deadlock: Callable[[], Formula] | None = None
    path: Formula = True
    faults: list[PossibleFault] = field(default_factory=list)
    doomed: bool = False
    frame: dict[Variable, SymbolicPlace] = field(default_factory=dict)
    returned: list[tuple[Formula, SymbolicSlots, dict[Slot, SymbolicNumber]]] = field(default_factory=list)
    depends_on_clocks: ClockDependence = field(default_factory=ClockDependence)

    # ---- the interface -----------------------------------------------------------------------------------------------

    def truth(self, condition: Expression) -> Formula:
        return truth(condition, self)

    def number(self, expression: Expression) -> SymbolicNumber:
        return number(expression, self)

    def clocks_named(self, expression: Expression) -> list[tuple[Formula, int]]:
        """The clocks, or the channels, that an expression may denote, each with its condition."""
        return self._clocks_at(place(expression, self))

    def execute(self, updates: Iterable[Expression]) -> None:
        for update in updates:
            slots(update, self)

    def bind(self, variable: Variable, value: int) -> None:
        """Gives a select or quantifier variable its value."""
        self.frame[variable] = place_at(self.storage.new_segment((constant(value),), ((value, value),)))

    def goes_wrong(self, condition: Formula, kind: RuntimeErrorKind, span: Span) -> None:
        whole = conj(self.path, condition)
        self.doomed = self.doomed or condition is True
        if whole is not False:
            self.faults.append(PossibleFault(whole, kind, span))

    # ---- numbers and truth values ------------------------------------------------------------------------------------

    @property
    def values(self) -> ValueOperations[SymbolicNumber, Formula]:
        return _VALUES

    def operation(
        self, operator: BinaryOperator, left: SymbolicNumber, right: SymbolicNumber, span: Span
    ) -> SymbolicNumber:
        wrong = undefined(operator, right)
        if wrong is not False:
            self.goes_wrong(wrong, _WRONG.get(operator, RuntimeErrorKind.DIVISION), span)
        try:
            return compute(operator, left, right)
        except ValueError as error:
            raise unsupported(f"this expression: {error}", span) from None

    def compare_clocks(
        self,
        operator: BinaryOperator,
        left: Side[SymbolicPlace, SymbolicNumber],
        right: Side[SymbolicPlace, SymbolicNumber],
    ) -> Formula:
        zero = constant(0)
        bound = compute(BinaryOperator.SUBTRACT, right[2] or zero, left[2] or zero)
        options: list[tuple[Formula, list[int], list[int]]] = [(True, [], [])]
        for adds, clock_place in ((True, left[0]), (True, right[1]), (False, left[1]), (False, right[0])):
            if clock_place is not None:
                options = [
                    (conj(condition, also), [*plus, clock] if adds else plus, less if adds else [*less, clock])
                    for condition, plus, less in options
                    for also, clock in self._clocks_at(clock_place)
                ]
        return any_of(
            conj(condition, self.clocks_compare(operator, tuple(plus), tuple(less), bound))
            for condition, plus, less in options
            if condition is not False
        )

    def is_at(self, process: int, location: int) -> Formula:
        return self.locations[process].is_value(location)

    def deadlock(self, span: Span) -> Formula:
        if self.is_deadlock is None:
            raise unsupported("deadlock", span)
        return self.is_deadlock()

    def each(self, variable: Variable) -> Iterator[None]:
        low, high = slot_range(variable.type)
        for value in range(low, high + 1):
            check_job()
            self.bind(variable, value)
            yield

    def total(self, variable: Variable, summands: Sequence[SymbolicNumber]) -> SymbolicNumber:
        return reduce(partial(compute, BinaryOperator.ADD), summands, constant(0))

    # ---- control -----------------------------------------------------------------------------------------------------

    def under(self, condition: Formula, action: Callable[[], _T], of: Expression | None = None) -> _T | None:
        """Does something where a condition holds; what it writes is written there alone. None where it never does."""
        if of is not None and not isinstance(condition, bool) and self.depends_on_clocks(of):
            condition = True
        condition_now = conj(self.path, condition)
        if condition is False or condition_now is False:
            return None
        outer, self.path = self.path, condition_now
        if condition is True:
            result = action()
        else:
            doomed = self.doomed
            result, changes = self.storage.undone(action)
            self.storage.apply(changes, condition)
            self.doomed = doomed
        self.path = outer
        return result

    def choose_place(self, test: Formula, then: SymbolicPlace, otherwise: SymbolicPlace) -> SymbolicPlace:
        return either(test, then, otherwise)

    # ---- places ------------------------------------------------------------------------------------------------------

    def place_of(self, variable: Variable) -> SymbolicPlace:
        in_frame = self.frame.get(variable)
        return in_frame if in_frame is not None else place_at(STATE, self.layout.first[variable])

    def element(self, base: SymbolicPlace, array: ArrayType, index: SymbolicNumber, span: Span) -> SymbolicPlace:
        first, last, count = array.low, array.low + array.size - 1, slot_count(array.element)
        outside = disj(
            compare(BinaryOperator.LESS, index, constant(first)), compare(BinaryOperator.GREATER, index, constant(last))
        )
        self.goes_wrong(outside, RuntimeErrorKind.INDEX, span)
        found = []
        for number_ in range(max(index.low, first), min(index.high, last) + 1):
            here = index.is_value(number_)
            for condition, segment, position in base.alternatives:
                both = conj(condition, here)
                if both is not False:
                    found.append((both, segment, position + (number_ - first) * count))
        return SymbolicPlace(tuple(found) or ((True, *base.alternatives[0][1:]),))

    def part(self, base: SymbolicPlace, record: RecordType, name: str) -> SymbolicPlace:
        return base.moved(record.offset(name))

    def new_place(self, type_: Type, slots: SymbolicSlots | None, span: Span | None) -> SymbolicPlace:
        ranges = tuple(slot_bounds(leaf) for _, leaf in leaves(type_))
        if slots is not None and span is None:
            return place_at(self.storage.new_segment(slots, ranges))
        new = place_at(self.storage.new_segment(_defaults(type_), ranges))
        if slots is not None and span is not None:
            self.write(new, slots, span)
        return new

    def read(self, place: SymbolicPlace, count: int) -> SymbolicSlots:
        values: list[SymbolicNumber] = []
        for offset in range(count):
            value: SymbolicNumber | None = None
            for condition, segment, position in reversed(place.alternatives):
                slot = self.storage.slots[segment, position + offset]
                value = slot if value is None else choose(condition, slot, value)
            assert value is not None
            values.append(value)
        return tuple(values)

    def write(self, place: SymbolicPlace, slots: SymbolicSlots, span: Span) -> SymbolicSlots:
        for offset, value in enumerate(slots):
            for condition, segment, position in place.alternatives:
                low, high = self.storage.ranges[segment][position + offset]
                if value.low < low or value.high > high:
                    inside = conj(
                        compare(BinaryOperator.GREATER_EQUAL, value, constant(low)),
                        compare(BinaryOperator.LESS_EQUAL, value, constant(high)),
                    )
                    self.goes_wrong(conj(condition, neg(inside)), RuntimeErrorKind.RANGE, span)
                slot = segment, position + offset
                stored = narrowed(value, low, high)
                self.storage.write(slot, choose(condition, stored, self.storage.slots.get(slot, stored)))
        return slots

    def set_clock(
        self, target: SymbolicPlace, source: SymbolicPlace | None, offset: SymbolicNumber, span: Span
    ) -> None:
        self.goes_wrong(compare(BinaryOperator.LESS, offset, constant(0)), RuntimeErrorKind.NEGATIVE_CLOCK, span)
        from_clock, more = constant(0), offset
        stored = self.storage.slots
        for condition, clock in [] if source is None else self._clocks_at(source):
            advanced = stored[CLOCK_VALUE, clock]
            if advanced.high + offset.high > CONSTANT_HIGH:
                raise unsupported("a clock that may be advanced so far in one step", span)
            from_clock = choose(condition, stored[CLOCK_SOURCE, clock], from_clock)
            more = choose(condition, compute(BinaryOperator.ADD, advanced, offset), more)
        for condition, clock in self._clocks_at(target):
            for slot, value in (((CLOCK_SOURCE, clock), from_clock), ((CLOCK_VALUE, clock), more)):
                self.storage.write(slot, choose(condition, value, stored[slot]))

    def refuse(self, what: str, span: Span) -> None:
        raise unsupported(what, span)

    def _clocks_at(self, place: SymbolicPlace) -> list[tuple[Formula, int]]:
        found: list[tuple[Formula, int]] = []
        for condition, segment, position in place.alternatives:
            number_ = self.storage.slots[segment, position]
            found += [(conj(condition, number_.is_value(value)), value) for value in number_.values]
        return [(condition, clock) for condition, clock in found if condition is not False]

    # ---- functions and statements ------------------------------------------------------------------------------------

    def enter(self, variable: Variable, place: SymbolicPlace) -> None:
        self.frame[variable] = place

    def operate(self, call: Call, arguments: Callable[[], Sequence[SymbolicSlots]]) -> SymbolicSlots:
        raise unsupported("floating point arithmetic", call.span)

    def call(self, function: Function, places: Sequence[SymbolicPlace]) -> SymbolicSlots:
        self.frame.update(zip(function.parameters, places, strict=True))
        outer_returned, self.returned = self.returned, []
        path, segments = self.path, self.storage.segments
        goes_on = self._unless_doomed(partial(run, function.body, function.result, self))
        self.doomed = not self.returned and goes_on is False
        exits: list[_Exit] = [(condition, snapshot) for condition, _, snapshot in self.returned]
        if goes_on is not False:
            exits.append((conj(path, goes_on), self.storage.snapshot()))
        self.storage.continue_from(exits, segments)
        result: SymbolicSlots = ()
        for condition, values, _ in reversed(self.returned):
            result = tuple(choose(condition, a, b) for a, b in zip(values, result, strict=True)) if result else values
        self.returned, self.path = outer_returned, path
        return result or (() if isinstance(function.result, VoidType) else _defaults(function.result))

    def give_back(self, slots: SymbolicSlots) -> None:
        self.returned.append((self.path, slots, self.storage.snapshot()))

    def sequence(self, parts: Iterable[Callable[[], Formula]]) -> Formula:
        outer = self.path
        alive: Formula = True
        for part in parts:
            check_job()
            self.path = conj(outer, alive)
            if self.path is False:
                break
            alive = conj(alive, self._unless_doomed(part))
        self.path = outer
        return alive

    def branch(self, test: Formula, then: Callable[[], Formula], otherwise: Callable[[], Formula] | None) -> Formula:
        def side(condition: Formula, body: Callable[[], Formula] | None) -> Formula:
            if body is None:
                return True
            outer, self.path = self.path, conj(self.path, condition)
            goes_on = self._unless_doomed(body)
            self.path = outer
            return goes_on

        if isinstance(test, bool):
            return side(True, then if test else otherwise)
        first, then_changes = self.storage.undone(lambda: side(test, then))
        second, other_changes = self.storage.undone(lambda: side(neg(test), otherwise))
        if first is False:
            self.storage.apply(other_changes)
        elif second is False:
            self.storage.apply(then_changes)
        else:
            self.storage.join(test, then_changes, other_changes)
        return disj(conj(test, first), conj(neg(test), second))

    def loop(
        self, condition: Callable[[], Formula], body: Callable[[], Formula], test_first: bool, span: Span
    ) -> Formula:
        outer, segments = self.path, self.storage.segments
        exits: list[_Exit] = []
        alive: Formula = True
        for number_ in range(ROUNDS + 1):
            check_job()
            if test_first or number_ > 0:
                self.path = conj(outer, alive)
                again = condition()
                if again is not True:
                    exits.append((conj(alive, neg(again)), self.storage.snapshot()))
                alive = conj(alive, again)
            self.path = conj(outer, alive)
            if alive is False or self.path is False:
                break
            alive = conj(alive, self._unless_doomed(body))
        else:
            raise unsupported(f"a loop that may take more than {ROUNDS} rounds", span)
        self.path = outer
        if exits:
            self.storage.continue_from(exits, segments)
        return any_of(condition for condition, _ in exits)

    def check_assertion(self, truth: Formula, span: Span) -> None:
        self.goes_wrong(neg(truth), RuntimeErrorKind.ASSERT, span)

    def _unless_doomed(self, body: Callable[[], Formula]) -> Formula:
        """The condition that control goes on after a statement; False if something in it always goes wrong."""
        outer, self.doomed = self.doomed, False
        goes_on = body()
        doomed, self.doomed = self.doomed, outer
        return False if doomed else goes_on


def or_false(found: Formula | None) -> Formula:
    """The evaluated condition; False where it never is."""
    return False if found is None else found


def unsupported(what: str, span: Span) -> UnsupportedError:
    return UnsupportedError(
        Diagnostic("E0745", f"the engine smt does not encode {what}", span, "ask the zone engine: --engine zone")
    )


def _defaults(type_: Type) -> SymbolicSlots:
    return tuple(map(constant, default_values(type_)))
