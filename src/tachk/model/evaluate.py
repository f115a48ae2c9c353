"""The reference evaluator: what expressions and statements mean, written to be obvious rather than fast.

Everything is evaluated left to right. In an assignment the place is computed first, for a compound assignment the old
value is read next, then the value is computed, then it is stored with a range check of the slot that is written.
A function parameter passed by value is checked like an assignment, a result against the declared result type.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from typing import assert_never

from tachk.base.job import check_job
from tachk.base.operators import COMPARISONS, BinaryOperator, OperandError, wrapped
from tachk.base.records import dataclass, field
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
from tachk.model.fault import EvaluationFault, RuntimeErrorKind
from tachk.model.floating import DOUBLE, FloatingOperation, halves, number_of
from tachk.model.types import (
    ArrayType,
    BoolType,
    ClockType,
    IntType,
    RecordType,
    ScalarType,
    Type,
    bounds,
    leaves,
    slot_count,
)
from tachk.model.variable_layout import VariableLayout, default_values, slot_bounds

STEP_LIMIT = 2**24
"""Expressions and statements evaluated in one piece of code before the fault LOOP."""

_STEPS_UNWATCHED = 256
"""So many of them pass between two looks at the time."""


@dataclass(slots=True)
class StoredSlots:
    """A piece of storage: values with their ranges."""

    values: list[int]
    ranges: Sequence[tuple[int, int]]


@dataclass(frozen=True, slots=True)
class Place:
    """A position in a piece of storage."""

    slots: StoredSlots
    offset: int

    def read(self, count: int = 1) -> tuple[int, ...]:
        return tuple(self.slots.values[self.offset : self.offset + count])

    def write(self, values: Sequence[int], span: Span) -> None:
        """Stores values; raises the fault RANGE, and then stores nothing, if one is outside its slot's range."""
        for value, (low, high) in zip(values, self.slots.ranges[self.offset : self.offset + len(values)], strict=True):
            if not low <= value <= high:
                raise EvaluationFault(RuntimeErrorKind.RANGE, span, f"{value} is not in [{low}, {high}]")
        self.slots.values[self.offset : self.offset + len(values)] = values


ClockChanges = dict[int, tuple[int, int]]
"""New values of clocks: the number of a clock (0: none) whose old value is taken, and an offset."""


def composed(first: ClockChanges, second: ClockChanges) -> ClockChanges:
    """The new values of clocks after two such assignments."""
    after = {}
    for clock, (source, more) in second.items():
        before, advance = first.get(source, (source, 0))
        # A summand may be unknown (`tachk.meaning.judge`).
        after[clock] = before, advance + more if advance else more
    return after


@dataclass(slots=True)
class Environment:
    """The environment in which an expression is evaluated.

    Attributes:
        layout: the numbering of slots.
        values: the content of every slot; updates change this list in place.
        locations: the current location of every process; needed by location tests only.
        clocks: the value of every clock, entry i for clock number i + 1; needed by clock comparisons only. Updates
            do not change it.
        resets: what updates assigned to clocks: clock number to new value, in terms of the values before all of them.
        deadlock: the answer to ``deadlock``; needed by that expression only.
        frame: the places of function parameters, local variables of functions and bound variables.
        steps: the number of steps of the current piece of code so far.
    """

    layout: VariableLayout
    values: list[int]
    locations: Sequence[int] = ()
    clocks: Sequence[Fraction] | None = None
    resets: ClockChanges = field(default_factory=dict)
    deadlock: Callable[[], bool] | None = None
    frame: dict[Variable, Place] = field(default_factory=dict)
    steps: int = 0
    _state: StoredSlots = field(init=False, repr=False)

    def __post_init__(self) -> None:
        self._state = StoredSlots(self.values, self.layout.ranges)

    def bind(self, variable: Variable, value: int) -> None:
        """Gives a select or quantifier variable its value."""
        assert isinstance(variable.type, IntType | BoolType | ScalarType)
        self.frame[variable] = Place(StoredSlots([value], (bounds(variable.type),)), 0)

    def read(self, variable: Variable) -> int:
        """The value of a variable of one slot; raises KeyError for one that is not in the environment."""
        in_frame = self.frame.get(variable)
        return self.values[self.layout.first[variable]] if in_frame is None else in_frame.read()[0]

    def place(self, variable: Variable) -> Place:
        """The place of a variable; raises KeyError for one that is not in the environment."""
        in_frame = self.frame.get(variable)
        return in_frame if in_frame is not None else Place(self._state, self.layout.first[variable])


def evaluate(expression: Expression, environment: Environment) -> int:
    """The value of an expression of integer, boolean or scalar type, with its side effects. Raises EvaluationFault."""
    environment.steps = 0
    return _scalar(expression, environment)


def evaluate_slots(expression: Expression, environment: Environment) -> tuple[int, ...]:
    """The slots of the value of an expression of any type. Raises EvaluationFault."""
    environment.steps = 0
    return _slots(expression, environment)


def holds(condition: Expression | None, environment: Environment) -> bool:
    """True if a condition is true; None is. Raises EvaluationFault."""
    return condition is None or evaluate(condition, environment) != 0


def execute(updates: Iterable[Expression], environment: Environment) -> None:
    """Executes the updates of one edge, left to right, on the environment. Raises EvaluationFault."""
    environment.steps = 0
    for update in updates:
        _slots(update, environment)


def clock_number(expression: Expression, environment: Environment) -> int:
    """The number of the clock that an expression of clock type denotes. Raises EvaluationFault."""
    environment.steps = 0
    return _place(expression, environment).read()[0]


def channel_number(expression: Expression, environment: Environment) -> int:
    """The number of the channel that an expression of channel type denotes. Raises EvaluationFault."""
    environment.steps = 0
    return _place(expression, environment).read()[0]


# ---- expressions ------------------------------------------------------------------------------------------------


def _count_step(span: Span, environment: Environment) -> None:
    environment.steps += 1
    if not environment.steps % _STEPS_UNWATCHED:
        check_job()
    if environment.steps > STEP_LIMIT:
        raise EvaluationFault(RuntimeErrorKind.LOOP, span)


def _slots(expression: Expression, environment: Environment) -> tuple[int, ...]:
    if isinstance(expression.type, IntType | BoolType | ScalarType):
        return (_scalar(expression, environment),)
    match expression:
        case Aggregate(items):
            return tuple(slot for item in items for slot in _slots(item, environment))
        case Assign():
            return _assign(expression, environment)
        case Call():
            return _call(expression, environment)
        case Comma(items):
            for item in items[:-1]:
                _slots(item, environment)
            return _slots(items[-1], environment)
        case Conditional(condition, then, otherwise):
            return _slots(then if _scalar(condition, environment) else otherwise, environment)
        case Reference() | Index() | Field():
            return _place(expression, environment).read(slot_count(expression.type))
        case _:
            raise TypeError(f"{type(expression).__name__} has no aggregate value")


def _scalar(expression: Expression, environment: Environment) -> int:
    _count_step(expression.span, environment)
    match expression:
        case Constant(value):
            return value
        case Binary():
            return _binary(expression, environment)
        case Reference() | Index() | Field():
            return _read(expression, environment)
        case Unary(operator, operand):
            return operator.compute(_scalar(operand, environment))
        case Conditional(condition, then, otherwise):
            return _scalar(then if _scalar(condition, environment) else otherwise, environment)
        case Quantifier():
            return _quantifier(expression, environment)
        case Assign():
            return _assign(expression, environment)[0]
        case Increment(target, delta, prefix, _, span):
            place = _place(target, environment)
            old = place.read()[0]
            new = wrapped(old + delta)
            place.write((new,), span)
            return new if prefix else old
        case Call():
            return _call(expression, environment)[0]
        case Comma(items):
            for item in items[:-1]:
                _slots(item, environment)
            return _scalar(items[-1], environment)
        case LocationTest(process, location):
            return int(environment.locations[process] == location)
        case Deadlock():
            if environment.deadlock is None:
                raise ValueError("this environment cannot answer 'deadlock'")
            return int(environment.deadlock())
        case Aggregate():
            raise TypeError("an aggregate is not a scalar value")
        case _ as never:
            assert_never(never)


def _number(expression: Expression, environment: Environment) -> int | Fraction:
    if isinstance(expression.type, ClockType):
        if isinstance(expression, Binary):
            assert expression.operator is BinaryOperator.SUBTRACT
            return _number(expression.left, environment) - _number(expression.right, environment)
        if environment.clocks is None:
            raise ValueError("this environment has no clock values")
        return environment.clocks[_read(expression, environment) - 1]
    return _scalar(expression, environment)


def _read(place: Expression, environment: Environment) -> int:
    """The value of a place of one slot."""
    if isinstance(place, Reference):
        return environment.read(place.variable)
    return _place(place, environment).read()[0]


def _place(expression: Expression, environment: Environment) -> Place:
    match expression:
        case Reference(variable):
            return environment.place(variable)
        case Index(base, index, _, span):
            assert isinstance(base.type, ArrayType)
            start = _place(base, environment)
            number = _scalar(index, environment) - base.type.low
            if not 0 <= number < base.type.size:
                low, high = base.type.low, base.type.low + base.type.size - 1
                raise EvaluationFault(RuntimeErrorKind.INDEX, span, f"{number + low} is not in [{low}, {high}]")
            return Place(start.slots, start.offset + number * slot_count(base.type.element))
        case Field(base, name):
            assert isinstance(base.type, RecordType)
            start = _place(base, environment)
            return Place(start.slots, start.offset + base.type.offset(name))
        case Conditional(condition, then, otherwise):
            return _place(then if _scalar(condition, environment) else otherwise, environment)
        case _:
            values = _slots(expression, environment)
            return Place(StoredSlots(list(values), _ranges(expression.type)), 0)


def _ranges(type_: Type) -> tuple[tuple[int, int], ...]:
    return tuple(slot_bounds(leaf) for _, leaf in leaves(type_))


def _assign(expression: Assign, environment: Environment) -> tuple[int, ...]:
    target, value, span = expression.target, expression.value, expression.span
    place = _place(target, environment)
    if isinstance(target.type, ClockType):
        whole = clock_sum(value)
        if whole is None:
            raise ValueError(f"{span}: a clock is set to what is not a sum with one clock")
        source = 0 if whole.clock is None else _place(whole.clock, environment).read()[0]
        number = 0 if whole.offset is None else _scalar(whole.offset, environment)
        if number < 0:
            raise EvaluationFault(RuntimeErrorKind.NEGATIVE_CLOCK, span, f"{number} is negative")
        environment.resets.update(composed(environment.resets, {place.read()[0]: (source, number)}))
        return (number,)
    if expression.operator is None:
        slots = _slots(value, environment)
    else:
        old = place.read()[0]
        slots = (_computed(expression.operator, old, _scalar(value, environment), span),)
    place.write(slots, span)
    return slots


def _call(expression: Call, environment: Environment) -> tuple[int, ...]:
    function: Function = expression.function
    if function.operation is not None:
        return _operate(function.operation, expression, environment)
    places = []
    for parameter, argument in zip(function.parameters, expression.arguments, strict=True):
        if parameter.reference:
            places.append(_place(argument, environment))
        else:
            place = Place(StoredSlots(list(default_values(parameter.type)), _ranges(parameter.type)), 0)
            place.write(_slots(argument, environment), argument.span)
            places.append(place)
    environment.frame.update(zip(function.parameters, places, strict=True))
    return _run(function.body, function.result, environment) or ()


def _operate(operation: FloatingOperation, expression: Call, environment: Environment) -> tuple[int, ...]:
    slots = [_slots(argument, environment) for argument in expression.arguments]
    arguments = [number_of(c) if len(c) > 1 else c[0] for c in slots]
    result = operation.compute(arguments)
    if result is None:
        given = " and ".join(map(str, arguments))
        raise EvaluationFault(RuntimeErrorKind.NOT_FINITE, expression.span, f"`{expression.function.name}` of {given}")
    return halves(result) if operation.result == DOUBLE else (int(result),)


def _quantifier(expression: Quantifier, environment: Environment) -> int:
    assert isinstance(expression.variable.type, IntType | BoolType | ScalarType)
    low, high = bounds(expression.variable.type)
    total = 0
    for value in range(low, high + 1):
        environment.bind(expression.variable, value)
        result = _scalar(expression.body, environment)
        match expression.kind:
            case QuantifierKind.FORALL:
                if not result:
                    return 0
            case QuantifierKind.EXISTS:
                if result:
                    return 1
            case QuantifierKind.SUM:
                total = wrapped(total + result)
    return {QuantifierKind.FORALL: 1, QuantifierKind.EXISTS: 0, QuantifierKind.SUM: total}[expression.kind]


def _binary(expression: Binary, environment: Environment) -> int:
    operator, left, right = expression.operator, expression.left, expression.right
    if operator in COMPARISONS:
        if isinstance(left.type, ArrayType | RecordType):
            return _compare_slots(operator, _slots(left, environment), _slots(right, environment))
        return int(operator.holds(_number(left, environment), _number(right, environment)))
    first = _scalar(left, environment)
    if operator.decided_by == (first != 0):
        return operator.compute(first, 0)
    return _computed(operator, first, _scalar(right, environment), expression.span)


def _compare_slots(comparison: BinaryOperator, left: tuple[int, ...], right: tuple[int, ...]) -> int:
    match comparison:
        case BinaryOperator.EQUAL:
            return int(left == right)
        case BinaryOperator.NOT_EQUAL:
            return int(left != right)
        case _:
            raise ValueError(f"{comparison} does not compare arrays or records")


def _computed(operator: BinaryOperator, left: int, right: int, span: Span) -> int:
    try:
        return operator.compute(left, right)
    except OperandError as error:
        raise EvaluationFault(RuntimeErrorKind[error.failure.name], span, str(error)) from None


# ---- statements ---------------------------------------------------------------------------------------------------


def _run(statement: Statement, result: Type, environment: Environment) -> tuple[int, ...] | None:
    """Executes a statement; the slots of the result if it returned, else None."""
    match statement:
        case Evaluate(expression):
            _slots(expression, environment)
        case Declare(variable, initial):
            slots = default_values(variable.type)
            place = Place(StoredSlots(list(slots), _ranges(variable.type)), 0)
            if initial is not None:
                place.write(_slots(initial, environment), initial.span)
            environment.frame[variable] = place
        case Block(statements):
            for inner in statements:
                returned = _run(inner, result, environment)
                if returned is not None:
                    return returned
        case If(condition, then, otherwise):
            chosen = then if _scalar(condition, environment) else otherwise
            return None if chosen is None else _run(chosen, result, environment)
        case While(condition, body, test_first):
            if test_first and not _scalar(condition, environment):
                return None
            while True:
                _count_step(condition.span, environment)
                returned = _run(body, result, environment)
                if returned is not None:
                    return returned
                if not _scalar(condition, environment):
                    return None
        case Iterate(variable, body):
            assert isinstance(variable.type, IntType | BoolType | ScalarType)
            low, high = bounds(variable.type)
            for value in range(low, high + 1):
                _count_step(variable.span, environment)
                environment.bind(variable, value)
                returned = _run(body, result, environment)
                if returned is not None:
                    return returned
        case Return(value):
            if value is None:
                return ()
            slots = _slots(value, environment)
            Place(StoredSlots(list(slots), _ranges(result)), 0).write(slots, value.span)
            return slots
        case Assert(condition):
            if not _scalar(condition, environment):
                raise EvaluationFault(RuntimeErrorKind.ASSERT, condition.span)
        case _ as never:
            assert_never(never)
    return None
