"""Building expressions with constants folded, and replacing variables in them.

Folding never hides a run-time error: an operation on constants that would fault stays as it is and faults when, and
only if, it is evaluated.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from tachk.base.operators import BinaryOperator, UnaryOperator
from tachk.base.records import replace
from tachk.base.span import Span
from tachk.model.evaluate import Environment, evaluate
from tachk.model.expressions import (
    BOOL,
    Assign,
    Binary,
    Conditional,
    Constant,
    Expression,
    Field,
    Increment,
    Index,
    Reference,
    Unary,
    Variable,
)
from tachk.model.fault import EvaluationFault
from tachk.model.substitution import with_parts
from tachk.model.types import ArrayType, BoolType, ClockType, IntType, RecordType, ScalarType, Type, slot_count
from tachk.model.variable_layout import VariableLayout

_EMPTY = Environment(VariableLayout({}, (), (), (), (), (), (), (), ()), [])


def _computed(expression: Expression, span: Span) -> Expression:
    """A constant in place of an expression whose operands are constants, unless it faults."""
    try:
        return Constant(evaluate(expression, _EMPTY), expression.type, span)
    except EvaluationFault:
        return expression


def unary(operator: UnaryOperator, operand: Expression, type_: Type, span: Span) -> Expression:
    result = Unary(operator, operand, type_, span)
    return _computed(result, span) if isinstance(operand, Constant) else result


def binary(operator: BinaryOperator, left: Expression, right: Expression, type_: Type, span: Span) -> Expression:
    result = Binary(operator, left, right, type_, span)
    if isinstance(left, Constant):
        if isinstance(right, Constant):
            return _computed(result, span)
        match operator, left.value != 0:
            case (BinaryOperator.AND, False) | (BinaryOperator.OR, True) | (BinaryOperator.IMPLY, False):
                return Constant(int(operator is not BinaryOperator.AND), BOOL, span)
            case (BinaryOperator.AND | BinaryOperator.IMPLY, True) | (BinaryOperator.OR, False) if _is_bool(right):
                return right
            case BinaryOperator.ADD, False:
                return right
            case _:
                pass
    return result


def joined(operator: BinaryOperator, parts: Sequence[Expression], type_: Type, span: Span) -> Expression:
    """One or more parts joined by an associative operator, as a balanced tree: there may be thousands."""
    if len(parts) == 1:
        return parts[0]
    middle = (len(parts) + 1) // 2
    first, second = joined(operator, parts[:middle], type_, span), joined(operator, parts[middle:], type_, span)
    return binary(operator, first, second, type_, span)


def _is_bool(expression: Expression) -> bool:
    return isinstance(expression.type, BoolType)


def negation(operand: Expression, span: Span) -> Expression:
    return unary(UnaryOperator.NOT, operand, BOOL, span)


def truth(value: Expression) -> Expression:
    """The boolean value of an integer expression."""
    if isinstance(value.type, BoolType):
        return value
    return binary(BinaryOperator.NOT_EQUAL, value, Constant(0, span=value.span), BOOL, value.span)


def conditional(condition: Expression, then: Expression, otherwise: Expression, type_: Type, span: Span) -> Expression:
    if isinstance(condition, Constant):
        return then if condition.value else otherwise
    return Conditional(condition, then, otherwise, type_, span)


def index(base: Expression, number: Expression, type_: Type, span: Span, constants: set[Variable]) -> Expression:
    return _constant_slot(Index(base, number, type_, span), constants)


def field(base: Expression, name: str, type_: Type, span: Span, constants: set[Variable]) -> Expression:
    return _constant_slot(Field(base, name, type_, span), constants)


def _constant_slot(place: Index | Field, constants: set[Variable]) -> Expression:
    if not isinstance(place.type, IntType | BoolType | ScalarType):
        return place
    offset = 0
    current: Expression = place
    while not isinstance(current, Reference):
        match current:
            case Index(base, Constant(value)) if isinstance(base.type, ArrayType):
                number = value - base.type.low
                if not 0 <= number < base.type.size:
                    return place
                offset += number * slot_count(base.type.element)
                current = base
            case Field(base, name) if isinstance(base.type, RecordType):
                offset += base.type.offset(name)
                current = base
            case _:
                return place
    if current.variable not in constants:
        return place
    return Constant(current.variable.initial[offset], place.type, place.span)


def substitute(expression: Expression, values: Mapping[Variable, Expression], constants: set[Variable]) -> Expression:
    """The expression with variables replaced, folded again. Only for expressions without assignments."""
    match expression:
        case Reference(variable):
            value = values.get(variable)
            return expression if value is None else replace(value, span=expression.span)
        case Assign() | Increment():
            raise TypeError("an expression with side effects cannot be instantiated")
        case _:
            return _folded(with_parts(expression, lambda part: substitute(part, values, constants)), constants)


def _folded(expression: Expression, constants: set[Variable]) -> Expression:
    match expression:
        case Index() | Field():
            return _constant_slot(expression, constants)
        case Unary(operator, operand, type_, span):
            return unary(operator, operand, type_, span)
        case Binary(operator, left, right, type_, span) if not isinstance(left.type, ClockType):
            return binary(operator, left, right, type_, span)
        case Conditional(condition, then, otherwise, type_, span):
            return conditional(condition, then, otherwise, type_, span)
        case _:
            return expression
