"""Sound intervals of integer expressions: every value an evaluation without a run-time error can have lies inside.

Needed where the bound of a clock constraint depends on variables: the abstraction of zones must know how large it gets.
The domain does not follow what variables hold: one that is not known to be narrower has the values of its declared
range, whatever is written to it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import reduce
from itertools import product
from math import prod
from typing import NamedTuple, TypeVar

from tachk.analysis.fold import Known, apply_binary
from tachk.analysis.interpreter import Domain, Side, ValueOperations, number, place, run
from tachk.base.operators import CONSTANT_HIGH, CONSTANT_LOW, BinaryOperator
from tachk.base.records import dataclass, field
from tachk.base.span import Span
from tachk.model.expressions import Call, Constant, Expression, Function, Variable
from tachk.model.remembered import by_part
from tachk.model.traversal import statement_expressions, written_variables
from tachk.model.types import ArrayType, RecordType, ScalarLike, Type, VoidType, slot_count
from tachk.model.variable_layout import slot_range

Interval = tuple[int, int]
Slots = tuple[Interval, ...]

ANYTHING: Interval = (CONSTANT_LOW, CONSTANT_HIGH)
_UNKNOWN: Interval = (0, 1)
"""A condition that may be true or false."""
_TRUE: Interval = (1, 1)
_FALSE: Interval = (0, 0)
_MAXIMAL_SLOTS = 65536
_LONG = 2**14
"""Repetitions beyond which a loop might meet the limit on steps."""
_A = TypeVar("_A")


def interval(expression: Expression, known: Known) -> Interval:
    """The smallest and largest value the expression can have."""
    if isinstance(expression, Constant):
        return expression.value, expression.value
    return number(expression, IntervalDomain(known))


def possible_slots(expression: Expression, known: Known) -> tuple[tuple[Variable, int], ...] | None:
    """The slots (variable, number of the slot in it) a place may denote; None where that is not known."""
    slots: list[tuple[Variable, int]] = []
    for part in place(expression, IntervalDomain(known)):
        if part.variable is None or part.size + len(slots) > _MAXIMAL_SLOTS:
            return None
        slots += [(part.variable, slot) for slot in part.slots()]
    return tuple(slots)


class PossiblePart(NamedTuple):
    """A place at which a value may be: in a variable, or (None) at an unknown place.

    Attributes:
        first: the number of its first slot in the variable.
        steps: for each index around it the number of elements it may choose, and the number of slots of each.
        value: the contents of a place that nothing was written to since.
    """

    variable: Variable | None
    type: Type
    first: int = 0
    steps: tuple[tuple[int, int], ...] = ()
    value: Slots | None = None

    @property
    def size(self) -> int:
        return prod(count for count, _ in self.steps)

    def slots(self) -> Iterator[int]:
        for chosen in product(*(range(0, count * stride, stride) for count, stride in self.steps)):
            yield self.first + sum(chosen)


PossiblePlace = tuple[PossiblePart, ...]


def _compared(operator: BinaryOperator, left: Interval, right: Interval) -> Interval:
    if left[0] != left[1] or right[0] != right[1]:
        return _UNKNOWN
    return (int(operator.holds(left[0], right[0])),) * 2


_VALUES: ValueOperations[Interval, Interval] = ValueOperations(
    constant=lambda value: (value, value),
    truth_as_number=lambda truth: truth,
    number_as_truth=lambda number: _FALSE if number == _FALSE else _UNKNOWN if number[0] <= 0 <= number[1] else _TRUE,
    compare=_compared,
    choose=lambda test, then, otherwise: _hull(then, otherwise),
    negated=lambda truth: (1 - truth[1], 1 - truth[0]),
    same=lambda left, right: _compared(BinaryOperator.EQUAL, left, right),
    all_of=lambda truths: (min((low for low, _ in truths), default=1), min((high for _, high in truths), default=1)),
    any_of=lambda truths: (max((low for low, _ in truths), default=0), max((high for _, high in truths), default=0)),
)


@dataclass(slots=True)
class IntervalDomain(Domain[Interval, Interval, PossiblePlace]):
    """Attributes:
    narrow: the ranges of variables, where they are smaller than the declared ones and nothing was written to them.
    times: how often the loops around what is evaluated may repeat it.
    result: what the function has returned so far.
    """

    facts: Known
    narrow: dict[Variable, Interval] = field(default_factory=dict)
    times: int = 1
    result: Slots | None = None

    def can_fail(self, fails: bool = True) -> None:
        """Learns whether a run-time error is possible here, which leaves the values of the others as they are."""

    # ---- numbers and truth values ------------------------------------------------------------------------------------

    @property
    def values(self) -> ValueOperations[Interval, Interval]:
        return _VALUES

    def operation(self, operator: BinaryOperator, left: Interval, right: Interval, span: Span) -> Interval:
        self.can_fail(not operator.total and not operator.defined_for(*right))
        return arithmetic(operator, left, right)

    def compare_clocks(
        self, operator: BinaryOperator, left: Side[PossiblePlace, Interval], right: Side[PossiblePlace, Interval]
    ) -> Interval:
        return _UNKNOWN

    def is_at(self, process: int, location: int) -> Interval:
        return _UNKNOWN

    def deadlock(self, span: Span) -> Interval:
        return _UNKNOWN

    def each(self, variable: Variable) -> Iterator[None]:
        """All values at once, until nothing more is known that a repetition may change."""
        outer, (low, high) = self.times, slot_range(variable.type)
        self.times *= high - low + 1
        self.can_fail(self.times > _LONG)
        yield from self._repeated()
        self.times = outer

    def _repeated(self) -> Iterator[None]:
        while True:
            before = set(self.narrow)
            yield
            if self.narrow.keys() >= before:
                return

    def total(self, variable: Variable, summands: Sequence[Interval]) -> Interval:
        low, high = slot_range(variable.type)
        inner = reduce(_hull, summands)
        return _fit((high - low + 1) * inner[0], (high - low + 1) * inner[1])

    # ---- control -----------------------------------------------------------------------------------------------------

    def under(self, condition: Interval, action: Callable[[], _A], of: Expression | None = None) -> _A | None:
        return None if condition == _FALSE else action()

    def choose_place(self, test: Interval, then: PossiblePlace, otherwise: PossiblePlace) -> PossiblePlace:
        return then + otherwise

    # ---- places ------------------------------------------------------------------------------------------------------

    def place_of(self, variable: Variable) -> PossiblePlace:
        return (PossiblePart(None if variable.reference else variable, variable.type),)

    def element(self, base: PossiblePlace, array: ArrayType, index: Interval, span: Span) -> PossiblePlace:
        last = array.low + array.size - 1
        self.can_fail(not _within(index, (array.low, last)))
        first, stride = max(index[0], array.low), slot_count(array.element)
        count, offset = max(min(index[1], last) - first + 1, 0), (first - array.low) * stride
        step = () if count == 1 else ((count, stride),)
        return tuple(
            PossiblePart(part.variable, array.element, part.first + offset, part.steps + step) for part in base
        )

    def part(self, base: PossiblePlace, record: RecordType, name: str) -> PossiblePlace:
        type_, offset = dict(record.fields)[name], record.offset(name)
        return tuple(PossiblePart(part.variable, type_, part.first + offset, part.steps) for part in base)

    def new_place(self, type_: Type, slots: Slots | None, span: Span | None) -> PossiblePlace:
        value = slots if slots is None or span is None else self._stored(slots, type_)
        return (PossiblePart(None, type_, value=value),)

    def read(self, place: PossiblePlace, count: int) -> Slots:
        return reduce(_hulls, map(self._read, place))

    def _read(self, part: PossiblePart) -> Slots:
        variable = part.variable
        if part.value is not None:
            return part.value
        if not isinstance(part.type, ScalarLike):
            return _declared(part.type)
        if variable is not None and variable.type is part.type:
            if variable in self.narrow:
                return (self.narrow[variable],)
            if variable in self.facts.bound:
                return ((self.facts.bound[variable],) * 2,)
        if variable is not None and variable in self.facts.values and 0 < part.size <= _MAXIMAL_SLOTS:
            values = self.facts.values[variable]
            found = [values[slot] for slot in part.slots()]
            return ((min(found), max(found)),)
        return (slot_range(part.type),)

    def write(self, place: PossiblePlace, slots: Slots, span: Span) -> Slots:
        stored = [self._stored(slots, part.type) for part in place]
        self.forget([part.variable for part in place])
        return reduce(_hulls, stored)

    def _stored(self, slots: Slots, type_: Type) -> Slots:
        """The slots after being stored in a value of a type; a value out of range is a run-time error."""
        ranges = _declared(type_)
        if slots == ranges:
            return slots
        self.can_fail(not all(map(_within, slots, ranges)))
        return tuple(map(_common, slots, ranges))

    def forget(self, written: Iterable[Variable | None]) -> None:
        """Something was written to variables, or (None) to one that is not known."""
        for variable in written if self.narrow else ():
            if variable is None:
                self.narrow.clear()
            else:
                self.narrow.pop(variable, None)

    def set_clock(self, target: PossiblePlace, source: PossiblePlace | None, offset: Interval, span: Span) -> None:
        self.can_fail(offset[0] < 0)

    def refuse(self, what: str, span: Span) -> None:
        self.can_fail()

    # ---- functions and statements ------------------------------------------------------------------------------------

    def enter(self, variable: Variable, place: PossiblePlace) -> None:
        value = place[0].value
        self.narrow.pop(variable, None)
        if value is not None and isinstance(variable.type, ScalarLike):
            self.narrow[variable] = value[0]

    def operate(self, call: Call, arguments: Callable[[], Sequence[Slots]]) -> Slots:
        arguments()
        assert call.function.operation is not None
        self.can_fail(not call.function.operation.total)
        return _declared(call.function.result)

    def call(self, function: Function, places: Sequence[PossiblePlace]) -> Slots:
        result = _called(function, type(self), self.facts, tuple(each[0].value for each in places), self.times)
        if self.narrow:
            written = written_variables(statement_expressions(function.body))
            self.forget(written)
            for parameter, each in zip(function.parameters, places, strict=True):
                if parameter.reference and parameter in written:
                    self.forget(part.variable for part in each)
        return result

    def give_back(self, slots: Slots) -> None:
        self.result = slots if self.result is None else _hulls(self.result, slots)

    def sequence(self, parts: Iterable[Callable[[], Interval]]) -> Interval:
        for part in parts:
            part()
        return _UNKNOWN

    def branch(
        self, test: Interval, then: Callable[[], Interval], otherwise: Callable[[], Interval] | None
    ) -> Interval:
        self.under(test, then)
        if otherwise is not None:
            self.under(_VALUES.negated(test), otherwise)
        return _UNKNOWN

    def loop(
        self, condition: Callable[[], Interval], body: Callable[[], Interval], test_first: bool, span: Span
    ) -> Interval:
        self.can_fail()
        for _ in self._repeated():
            condition()
            body()
        return _UNKNOWN

    def check_assertion(self, truth: Interval, span: Span) -> None:
        self.can_fail()


@by_part
def _called(
    function: Function, kind: type[IntervalDomain], known: Known, given: tuple[Slots | None, ...], times: int
) -> Slots:
    """The result of a function for arguments in intervals."""
    domain = kind(known, times=times)
    for parameter, value in zip(function.parameters, given, strict=True):
        if not parameter.reference:
            domain.enter(parameter, (PossiblePart(None, parameter.type, value=value),))
    run(function.body, function.result, domain)
    return _declared(function.result) if domain.result is None else domain.result


def _declared(type_: Type) -> Slots:
    """The ranges of the slots of a type."""
    match type_:
        case ArrayType(element):
            return _declared(element) * type_.size
        case RecordType(_, fields):
            return tuple(slot for _, inner in fields for slot in _declared(inner))
        case VoidType():
            return ()
        case _:
            return (slot_range(type_),)


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
    """True if there is a value for some right side in an interval."""
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


def _hulls(one: Slots, other: Slots) -> Slots:
    return tuple(map(_hull, one, other))


def _within(inner: Interval, outer: Interval) -> bool:
    return outer[0] <= inner[0] and inner[1] <= outer[1]


def _common(inner: Interval, outer: Interval) -> Interval:
    """The intersection of two intervals; the outer one if it is empty."""
    low, high = max(inner[0], outer[0]), min(inner[1], outer[1])
    return (low, high) if low <= high else outer
