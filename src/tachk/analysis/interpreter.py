"""One interpreter of expressions and statements over a domain, which says what numbers, truth values and places are.

Here alone stands what is evaluated, in which order, and what short-circuiting leaves out: as in `tachk.model.evaluate`,
which judges it and shares nothing with it. A domain says what the operations do and what can go wrong in them
(P. Cousot, R. Cousot, Abstract interpretation, POPL 1977).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from typing import Generic, Protocol, TypeVar, assert_never

from tachk.base.operators import COMPARISONS, CONNECTIVES, BinaryOperator, UnaryOperator
from tachk.base.records import dataclass
from tachk.base.span import Span
from tachk.model.clock_sums import clock_sum
from tachk.model.expressions import (
    Aggregate,
    Assert,
    Assign,
    Binary,
    Block,
    Call,
    Comma,
    Conditional,
    Constant,
    Deadlock,
    Declare,
    Evaluate,
    Expression,
    Field,
    Function,
    If,
    Increment,
    Index,
    Iterate,
    LocationTest,
    Quantifier,
    QuantifierKind,
    Reference,
    Return,
    Statement,
    Unary,
    Variable,
    While,
)
from tachk.model.traversal import depends_on_clocks
from tachk.model.types import ArrayType, BoolType, ClockType, RecordType, ScalarLike, Type, is_aggregate, slot_count

N = TypeVar("N")
"""A number."""
T = TypeVar("T")
"""A truth value."""
P = TypeVar("P")
"""A place: where the slots of a value are."""
_A = TypeVar("_A")
_EQUALITIES = BinaryOperator.EQUAL, BinaryOperator.NOT_EQUAL

Side = tuple[P | None, P | None, N | None]
"""One side of a comparison of clocks: a clock that is added, one that is subtracted, or a number."""


@dataclass(frozen=True, slots=True)
class ValueOperations(Generic[N, T]):
    """The operations on numbers and truth values that cannot fail."""

    constant: Callable[[int], N]
    truth_as_number: Callable[[T], N]
    number_as_truth: Callable[[N], T]
    compare: Callable[[BinaryOperator, N, N], T]
    choose: Callable[[T, N, N], N]
    negated: Callable[[T], T]
    same: Callable[[T, T], T]
    all_of: Callable[[Sequence[T]], T]
    any_of: Callable[[Sequence[T]], T]


class Domain(Protocol[N, T, P]):
    """The operations with which the interpreter computes. Those that can meet a run-time error note it."""

    @property
    def values(self) -> ValueOperations[N, T]: ...

    def operation(self, operator: BinaryOperator, left: N, right: N, span: Span) -> N:
        """An arithmetic operation. Division by 0 and the like are run-time errors."""

    def compare_clocks(self, operator: BinaryOperator, left: Side[P, N], right: Side[P, N]) -> T: ...

    def is_at(self, process: int, location: int) -> T: ...

    def deadlock(self, span: Span) -> T: ...

    def under(self, condition: T, action: Callable[[], _A], of: Expression | None = None) -> _A | None:
        """Does an action where a condition holds, and gives its result; None where the condition never holds.

        If ``of``, of which the condition is the truth, depends on clocks, the action is done everywhere, unless the
        truth is known.
        """

    def each(self, variable: Variable) -> Iterator[None]:
        """Gives a variable all its values, one by one or several at once."""

    def total(self, variable: Variable, summands: Sequence[N]) -> N:
        """The sum over all values of a variable of what each of them, or several at once, have given."""

    # ---- places ------------------------------------------------------------------------------------------------------

    def place_of(self, variable: Variable) -> P: ...

    def element(self, base: P, array: ArrayType, index: N, span: Span) -> P:
        """An element of an array. An index out of range is a run-time error."""

    def part(self, base: P, record: RecordType, name: str) -> P: ...

    def choose_place(self, test: T, then: P, otherwise: P) -> P: ...

    def new_place(self, type_: Type, slots: tuple[N, ...] | None, span: Span | None) -> P:
        """A new place that holds slots, checked as `write` does if there is a span, or the default of its type."""

    def read(self, place: P, count: int) -> tuple[N, ...]: ...

    def write(self, place: P, slots: tuple[N, ...], span: Span) -> tuple[N, ...]:
        """Stores slots, and gives what is stored. A value out of the range of its slot is a run-time error."""

    def set_clock(self, target: P, source: P | None, offset: N, span: Span) -> None:
        """Sets a clock to the value of another, or to 0, and so much more. Less than 0 is a run-time error."""

    def refuse(self, what: str, span: Span) -> None:
        """Meets an expression that has no meaning."""

    # ---- functions and statements ------------------------------------------------------------------------------------

    def enter(self, variable: Variable, place: P) -> None:
        """Gives a parameter or a local variable its place."""

    def operate(self, call: Call, arguments: Callable[[], Sequence[tuple[N, ...]]]) -> tuple[N, ...]:
        """Calls a function without statements."""

    def call(self, function: Function, places: Sequence[P]) -> tuple[N, ...]:
        """Executes the body of a function, by `run`, with places for its parameters; the slots of its result."""

    def give_back(self, slots: tuple[N, ...]) -> None:
        """Ends the function with a result."""

    def sequence(self, parts: Iterable[Callable[[], T]]) -> T:
        """Executes parts one after the other as long as control goes on; whether it does behind the last."""

    def branch(self, test: T, then: Callable[[], T], otherwise: Callable[[], T] | None) -> T: ...

    def loop(self, condition: Callable[[], T], body: Callable[[], T], test_first: bool, span: Span) -> T: ...

    def check_assertion(self, truth: T, span: Span) -> None:
        """Checks an assertion: a run-time error where it is not true."""


# ---- expressions -----------------------------------------------------------------------------------------------------


def number(expression: Expression, domain: Domain[N, T, P]) -> N:
    """The value of an expression of integer, boolean or scalar type."""
    match expression:
        case Constant(value):
            return domain.values.constant(value)
        case Reference() | Index() | Field():
            return domain.read(place(expression, domain), 1)[0]
        case Unary(UnaryOperator.MINUS, operand, _, span):
            subtracted = number(operand, domain)
            return domain.operation(BinaryOperator.SUBTRACT, domain.values.constant(0), subtracted, span)
        case Binary(operator, left, right) if operator not in CONNECTIVES and operator not in COMPARISONS:
            first = number(left, domain)
            return domain.operation(operator, first, number(right, domain), expression.span)
        case Conditional():
            return _chosen(expression, lambda side: number(side, domain), domain.values.choose, domain)
        case Quantifier(QuantifierKind.SUM, variable, body):
            return domain.total(variable, [number(body, domain) for _ in domain.each(variable)])
        case Assign() | Call() | Comma():
            return slots(expression, domain)[0]
        case Increment(target, delta, prefix, _, span):
            where = place(target, domain)
            old = domain.read(where, 1)[0]
            new = domain.operation(BinaryOperator.ADD, old, domain.values.constant(delta), span)
            stored = domain.write(where, (new,), span)[0]
            return stored if prefix else old
        case Unary() | Binary() | Quantifier() | LocationTest() | Deadlock():
            return domain.values.truth_as_number(truth(expression, domain))
        case Aggregate():
            raise TypeError("an aggregate is not a scalar value")
        case _ as never:
            assert_never(never)


def truth(expression: Expression, domain: Domain[N, T, P]) -> T:
    """The truth of a condition in a domain."""
    match expression:
        case Unary(UnaryOperator.NOT, operand):
            return domain.values.negated(truth(operand, domain))
        case Binary(operator) if operator in CONNECTIVES:
            return _connected(expression, domain)
        case Binary(operator) if operator in COMPARISONS:
            return _compared(expression, domain)
        case Conditional(condition, then, otherwise) if isinstance(expression.type, BoolType):
            test = truth(condition, domain)
            ways = (test, then), (domain.values.negated(test), otherwise)
            return domain.values.any_of([_both(first, condition, second, domain) for first, second in ways])
        case Quantifier(kind) if kind is not QuantifierKind.SUM:
            return _quantified(expression, domain)
        case Comma(items) if isinstance(expression.type, BoolType):
            for item in items[:-1]:
                slots(item, domain)
            return truth(items[-1], domain)
        case LocationTest(process, location):
            return domain.is_at(process, location)
        case Deadlock():
            return domain.deadlock(expression.span)
        case _:
            return domain.values.number_as_truth(number(expression, domain))


def _both(first: T, of: Expression, second: Expression, domain: Domain[N, T, P]) -> T:
    """A conjunction, whose right side is evaluated where the left one is true, or everywhere if that depends on
    clocks."""
    found = domain.under(first, partial(truth, second, domain), of)
    return domain.values.any_of([]) if found is None else domain.values.all_of([first, found])


def _connected(expression: Binary, domain: Domain[N, T, P]) -> T:
    operator, left, right = expression.operator, expression.left, expression.right
    first, values = truth(left, domain), domain.values
    if operator.decided_by is None:
        return values.negated(values.same(first, truth(right, domain)))
    if operator is BinaryOperator.AND:
        return _both(first, left, right, domain)
    not_first = values.negated(first)
    undecided, decided = (not_first, first) if operator is BinaryOperator.OR else (first, not_first)
    second = domain.under(undecided, partial(truth, right, domain), left)
    return decided if second is None else values.any_of([decided, second])


def _quantified(expression: Quantifier, domain: Domain[N, T, P]) -> T:
    values, every = domain.values, expression.kind is QuantifierKind.FORALL
    always = depends_on_clocks(expression.body)
    open_still = values.all_of([])
    results: list[T] = []
    for _ in domain.each(expression.variable):
        one = domain.under(open_still, partial(truth, expression.body, domain))
        if one is None:
            one = values.any_of([])
        results.append(one if every else values.negated(one))
        if not always:
            open_still = values.all_of([open_still, results[-1]])
    return values.all_of(results) if every else values.negated(values.all_of(results))


def _compared(expression: Binary, domain: Domain[N, T, P]) -> T:
    operator, left, right, values = expression.operator, expression.left, expression.right, domain.values
    if isinstance(left.type, ClockType) or isinstance(right.type, ClockType):
        one = _side(left, domain)
        other = _side(right, domain)
        return domain.compare_clocks(operator, one, other)
    if is_aggregate(left.type):
        pairs = zip(slots(left, domain), slots(right, domain), strict=True)
        equal = values.all_of([values.compare(BinaryOperator.EQUAL, a, b) for a, b in pairs])
    elif isinstance(left.type, BoolType) and isinstance(right.type, BoolType) and operator in _EQUALITIES:
        is_left = truth(left, domain)
        equal = values.same(is_left, truth(right, domain))
    else:
        first = number(left, domain)
        return values.compare(operator, first, number(right, domain))
    return equal if operator is BinaryOperator.EQUAL else values.negated(equal)


def _side(side: Expression, domain: Domain[N, T, P]) -> Side[P, N]:
    if not isinstance(side.type, ClockType):
        return None, None, number(side, domain)
    if isinstance(side, Binary):
        added = place(side.left, domain)
        return added, place(side.right, domain), None
    return place(side, domain), None, None


def slots(expression: Expression, domain: Domain[N, T, P]) -> tuple[N, ...]:
    """The slots of the value of an expression of any type."""
    match expression:
        case Assign():
            return _assigned(expression, domain)
        case Call():
            return _called(expression, domain)
        case Aggregate(items):
            return tuple(slot for item in items for slot in slots(item, domain))
        case Comma(items):
            return [slots(item, domain) for item in items][-1]
        case _ if isinstance(expression.type, ScalarLike):
            return (number(expression, domain),)
        case Conditional():
            return _chosen(expression, lambda side: slots(side, domain), partial(_choose_slots, domain), domain)
        case Reference() | Index() | Field():
            return domain.read(place(expression, domain), slot_count(expression.type))
        case _:
            raise TypeError(f"{type(expression).__name__} has no aggregate value")


def _choose_slots(domain: Domain[N, T, P], test: T, then: tuple[N, ...], otherwise: tuple[N, ...]) -> tuple[N, ...]:
    return tuple(domain.values.choose(test, one, other) for one, other in zip(then, otherwise, strict=True))


def _chosen(
    expression: Conditional,
    value: Callable[[Expression], _A],
    join: Callable[[T, _A, _A], _A],
    domain: Domain[N, T, P],
) -> _A:
    test = truth(expression.condition, domain)
    one = domain.under(test, lambda: value(expression.then))
    other = domain.under(domain.values.negated(test), lambda: value(expression.otherwise))
    if one is not None and other is not None:
        return join(test, one, other)
    found = other if one is None else one
    return value(expression.then) if found is None else found  # nothing is executed where both are None


def place(expression: Expression, domain: Domain[N, T, P]) -> P:
    """The place that an expression denotes; a temporary one if it is not a place."""
    match expression:
        case Reference(variable):
            return domain.place_of(variable)
        case Index(base, index):
            assert isinstance(base.type, ArrayType)
            whole = place(base, domain)
            return domain.element(whole, base.type, number(index, domain), expression.span)
        case Field(base, name):
            assert isinstance(base.type, RecordType)
            return domain.part(place(base, domain), base.type, name)
        case Conditional():
            return _chosen(expression, lambda side: place(side, domain), domain.choose_place, domain)
        case _:
            return domain.new_place(expression.type, slots(expression, domain), None)


def _assigned(expression: Assign, domain: Domain[N, T, P]) -> tuple[N, ...]:
    target, value, operator, span = expression.target, expression.value, expression.operator, expression.span
    where = place(target, domain)
    if isinstance(target.type, ClockType):
        whole = clock_sum(value)
        if whole is None:
            domain.refuse("a clock that is set to something else than a number, a clock, or a sum of both", span)
            return (domain.values.constant(0),)
        source = None if whole.clock is None else place(whole.clock, domain)
        offset = domain.values.constant(0) if whole.offset is None else number(whole.offset, domain)
        domain.set_clock(where, source, offset, span)
        return (offset,)
    if operator is None:
        return domain.write(where, slots(value, domain), span)
    old = domain.read(where, 1)[0]
    return domain.write(where, (domain.operation(operator, old, number(value, domain), span),), span)


def _called(expression: Call, domain: Domain[N, T, P]) -> tuple[N, ...]:
    function, arguments = expression.function, expression.arguments
    if function.operation is not None:
        return domain.operate(expression, lambda: [slots(argument, domain) for argument in arguments])
    places = [
        place(argument, domain)
        if parameter.reference
        else domain.new_place(parameter.type, slots(argument, domain), argument.span)
        for parameter, argument in zip(function.parameters, arguments, strict=True)
    ]
    return domain.call(function, places)


# ---- statements ------------------------------------------------------------------------------------------------------


def run(statement: Statement, result: Type, domain: Domain[N, T, P]) -> T:
    """Executes a statement of a function with this type of result; whether control goes on behind it."""
    match statement:
        case Evaluate(expression):
            slots(expression, domain)
        case Declare(variable, initial):
            given = None if initial is None else slots(initial, domain)
            domain.enter(variable, domain.new_place(variable.type, given, (initial or variable).span))
        case Block(statements):
            return domain.sequence([partial(run, each, result, domain) for each in statements])
        case If(condition, then, otherwise):
            other = None if otherwise is None else partial(run, otherwise, result, domain)
            return domain.branch(truth(condition, domain), partial(run, then, result, domain), other)
        case While(condition, body, test_first):
            turn = partial(truth, condition, domain), partial(run, body, result, domain)
            return domain.loop(*turn, test_first, condition.span)
        case Iterate(variable, body):
            return domain.sequence(partial(run, body, result, domain) for _ in domain.each(variable))
        case Return(value):
            given = () if value is None else slots(value, domain)
            if value is not None:
                given = domain.read(domain.new_place(result, given, value.span), len(given))
            domain.give_back(given)
            return domain.values.any_of([])
        case Assert(condition):
            domain.check_assertion(truth(condition, domain), condition.span)
        case _ as never:
            assert_never(never)
    return domain.values.all_of([])
