"""Constant folding that keeps every run-time error.

An operation that would fail is left in place, so that it fails when the model runs, with the place in the text.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

from tachk.base.job import check_job
from tachk.base.operators import COMPARISONS, BinaryOperator, OperandError, UnaryOperator
from tachk.base.records import dataclass, field, replace
from tachk.model.connectives import negation
from tachk.model.expressions import (
    BOOL,
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
    VariableKind,
)
from tachk.model.network import Network
from tachk.model.remembered import MOST_RESULTS, by_network, by_part
from tachk.model.substitution import changed, with_parts
from tachk.model.traversal import process_expressions, walk, written_variables
from tachk.model.types import (
    ArrayType,
    BoolType,
    IntType,
    RecordType,
    ScalarType,
    Type,
    bounds,
    kinds_of_slots,
    slot_count,
)
from tachk.model.variable_layout import default_values


@dataclass(frozen=True, slots=True)
class Known:
    """The values known before the model runs.

    Attributes:
        values: the slots of variables that nothing writes.
        bound: the values of select, quantifier and iteration variables that are being expanded.
    """

    values: Mapping[Variable, tuple[int, ...]] = field(default_factory=dict)
    bound: Mapping[Variable, int] = field(default_factory=dict)

    def with_bound(self, variable: Variable, value: int) -> Known:
        return replace(self, bound={**self.bound, variable: value})


def known_values(network: Network, predicates: Sequence[Expression]) -> Known:
    """The integer variables of a network that neither it nor the predicates ever write."""
    constants, written = _constants(network), written_variables(predicates)
    if not written:
        return constants
    return Known({v: slots for v, slots in constants.values.items() if v not in written})


@by_network
def _constants(network: Network) -> Known:
    written = written_variables(network_expressions(network))
    return _shared(
        Known(
            {
                v: v.initial or default_values(v.type)
                for v in network.all_variables()
                if v not in written and all(map(is_integer, kinds_of_slots(v.type)))
            }
        )
    )


_recent: list[Known] = []


def _shared(known: Known) -> Known:
    """One object for what is known of several networks, by which the parts that they share are found faster."""
    if known not in _recent:
        _recent[:] = [*_recent[-MOST_RESULTS + 1 :], known]
    return _recent[_recent.index(known)]


def network_expressions(network: Network) -> Iterator[Expression]:
    """Every outermost expression of the processes, function bodies excluded, and what draws initial values."""
    for process in network.processes:
        yield from process_expressions(process)
    yield from drawn_values(network)


def drawn_values(network: Network) -> Iterator[Expression]:
    """The updates that draw initial values, in the order of the variables."""
    for variable in network.all_variables():
        if variable.drawn is not None:
            yield Assign(Reference(variable), variable.drawn, variable.type, span=variable.drawn.span)


def is_integer(type_: Type) -> bool:
    """True if the type is a single slot that holds a number."""
    return isinstance(type_, IntType | BoolType | ScalarType)


def apply_binary(operator: BinaryOperator, left: int, right: int) -> int | None:
    """The value of ``left operator right`` on numbers, None where that is a run-time error."""
    try:
        return operator.compute(left, right)
    except OperandError:
        return None


def negate(expression: Expression) -> Expression:
    """The logical negation, without double negations and with comparisons turned round."""
    match expression:
        case Constant(value):
            return Constant(int(value == 0), BOOL, expression.span)
        case Unary(UnaryOperator.NOT, operand):
            return operand
        case Binary(operator, left, right) if operator in COMPARISONS:
            return Binary(operator.negated, left, right, BOOL, expression.span)
    return negation(expression)


def truth(expression: Expression) -> Expression:
    """The expression as 0 or 1."""
    if isinstance(expression, Constant):
        return Constant(int(expression.value != 0), BOOL, expression.span)
    if isinstance(expression, LocationTest | Deadlock) or isinstance(expression.type, BoolType):
        return expression
    return Binary(BinaryOperator.NOT_EQUAL, expression, Constant(0), BOOL, expression.span)


def cannot_fail(expression: Expression) -> bool:
    """True if the expression has neither a run-time error nor an effect, whatever the state. Conservative."""
    for node in walk(expression):
        match node:
            case Constant() | LocationTest() | Deadlock() | Field() | Conditional() | Aggregate() | Comma():
                pass
            case Reference(variable):
                if variable.reference:
                    return False
            case Index(base, Constant(value)):
                if not isinstance(base.type, ArrayType) or not 0 <= value - base.type.low < base.type.size:
                    return False
            case Index(base, Reference(variable)) if _indexes(variable, base.type):
                pass
            case Unary():
                pass
            case Binary(operator) if operator.total:
                pass
            case Quantifier(QuantifierKind.FORALL | QuantifierKind.EXISTS):
                pass
            case _:
                return False
    return True


def _indexes(variable: Variable, array: Type) -> bool:
    """True if each value in the range of a variable, which is where its value always is, is an index of an array."""
    if not isinstance(variable.type, IntType | BoolType | ScalarType) or not isinstance(array, ArrayType):
        return False
    low, high = bounds(variable.type)
    return array.low <= low and high < array.low + array.size


def known_slot(place: Expression) -> tuple[Variable, int] | None:
    """The variable and slot a place denotes, if that does not depend on the state."""
    match place:
        case Reference(variable):
            return None if variable.reference else (variable, 0)
        case Field(base, name):
            inner = known_slot(base)
            if inner is None or not isinstance(base.type, RecordType):
                return None
            return inner[0], inner[1] + base.type.offset(name)
        case Index(base, Constant(value)):
            inner = known_slot(base)
            if inner is None or not isinstance(base.type, ArrayType) or not 0 <= value - base.type.low < base.type.size:
                return None
            return inner[0], inner[1] + (value - base.type.low) * slot_count(base.type.element)
        case _:
            pass
    return None


@by_part
def fold(expression: Expression, known: Known) -> Expression:
    """An equal expression in which everything that is known is a constant."""
    return _fold(expression, known)


@by_part
def fold_place(place: Expression, known: Known) -> Expression:
    """The same place, with its indices and conditions folded."""
    return _fold_place(place, known)


def _fold(expression: Expression, known: Known) -> Expression:
    check_job()
    match expression:
        case Constant():
            return expression
        case Reference() | Index() | Field():
            return _fold_read(_fold_place(expression, known), known)
        case Unary(operator, operand):
            inner = _fold(operand, known)
            if not isinstance(inner, Constant):
                return changed(expression, operand=inner)
            if operator is UnaryOperator.NOT:
                return negate(inner)
            return Constant(operator.compute(inner.value), expression.type, expression.span)
        case Binary():
            return _fold_binary(expression, known)
        case Conditional():
            return _fold_conditional(expression, _fold, known)
        case Quantifier(kind, _, body):
            inner = _fold(body, known)
            if isinstance(inner, Constant) and kind is not QuantifierKind.SUM:
                return truth(inner)
            return changed(expression, body=inner)
        case Assign(target, value):
            return changed(expression, target=_fold_place(target, known), value=_fold(value, known))
        case Increment(target):
            return changed(expression, target=_fold_place(target, known))
        case Call(function, arguments):
            pairs = zip(function.parameters, arguments, strict=True)
            return changed(
                expression,
                arguments=tuple(_fold_place(a, known) if p.reference else _fold(a, known) for p, a in pairs),
            )
        case _:
            return with_parts(expression, lambda part: _fold(part, known))


def _fold_place(place: Expression, known: Known) -> Expression:
    match place:
        case Index(base, index):
            return changed(place, base=_fold_place(base, known), index=_fold(index, known))
        case Field(base):
            return changed(place, base=_fold_place(base, known))
        case Conditional():
            return _fold_conditional(place, _fold_place, known)
        case Reference():
            return place
        case _:
            return _fold(place, known)


def _fold_conditional(
    expression: Conditional, side: Callable[[Expression, Known], Expression], known: Known
) -> Expression:
    test = _fold(expression.condition, known)
    if isinstance(test, Constant):
        return side(expression.then if test.value else expression.otherwise, known)
    then, otherwise = side(expression.then, known), side(expression.otherwise, known)
    return changed(expression, condition=test, then=then, otherwise=otherwise)


def _fold_read(place: Expression, known: Known) -> Expression:
    if not is_integer(place.type):
        return place
    if isinstance(place, Reference) and place.variable.kind is VariableKind.BOUND and place.variable in known.bound:
        return Constant(known.bound[place.variable], place.type, place.span)
    slot = known_slot(place)
    if slot is not None and slot[0] in known.values:
        return Constant(known.values[slot[0]][slot[1]], place.type, place.span)
    return place


def _fold_binary(expression: Binary, known: Known) -> Expression:
    operator = expression.operator
    left = _fold(expression.left, known)
    right = _fold(expression.right, known)
    if operator is BinaryOperator.IMPLY and isinstance(left, Constant):
        operator, left = BinaryOperator.OR, negate(left)
    if isinstance(left, Constant):
        if isinstance(right, Constant):
            value = apply_binary(operator, left.value, right.value)
            if value is not None:
                return Constant(value, expression.type, expression.span)
        if operator is BinaryOperator.AND:
            return truth(right) if left.value else Constant(0, BOOL, expression.span)
        if operator is BinaryOperator.OR:
            return Constant(1, BOOL, expression.span) if left.value else truth(right)
    elif isinstance(right, Constant):
        if operator in (BinaryOperator.AND, BinaryOperator.OR):
            neutral = (right.value != 0) == (operator is BinaryOperator.AND)
            if neutral:
                return truth(left)
            if cannot_fail(left):
                return Constant(int(operator is BinaryOperator.OR), BOOL, expression.span)
        if operator is BinaryOperator.IMPLY:
            if right.value == 0:
                return negate(left)
            if cannot_fail(left):
                return Constant(1, BOOL, expression.span)
    return changed(expression, operator=operator, left=left, right=right)
