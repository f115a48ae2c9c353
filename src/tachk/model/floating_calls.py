"""Expressions of floating point numbers."""

from __future__ import annotations

from tachk.base.operators import BinaryOperator
from tachk.base.span import NOWHERE, Span
from tachk.model.expressions import (
    Aggregate,
    Block,
    Call,
    Constant,
    Expression,
    Function,
    Reference,
    Return,
    Variable,
    VariableKind,
)
from tachk.model.floating import DOUBLE, FloatingOperation, halves, number_of

_NAMES = {
    FloatingOperation.NEGATE: "-",
    FloatingOperation.ABSOLUTE: "fabs",
    FloatingOperation.SQUARE_ROOT: "sqrt",
    FloatingOperation.FLOOR: "floor",
    FloatingOperation.CEILING: "ceil",
    FloatingOperation.TRUNCATE: "trunc",
    FloatingOperation.ROUND: "round",
    FloatingOperation.FROM_INTEGER: "double",
    FloatingOperation.TO_INTEGER: "fint",
    FloatingOperation.EXPONENTIAL: "exp",
    FloatingOperation.LOGARITHM: "ln",
    FloatingOperation.DECIMAL_LOGARITHM: "log10",
    FloatingOperation.BINARY_LOGARITHM: "log2",
    FloatingOperation.SINE: "sin",
    FloatingOperation.COSINE: "cos",
    FloatingOperation.TANGENT: "tan",
    FloatingOperation.ARC_SINE: "asin",
    FloatingOperation.ARC_COSINE: "acos",
    FloatingOperation.ARC_TANGENT: "atan",
    FloatingOperation.ARC_TANGENT_2: "atan2",
    FloatingOperation.POWER: "pow",
    FloatingOperation.REMAINDER: "fmod",
    FloatingOperation.HYPOTENUSE: "hypot",
    FloatingOperation.RANDOM: "random",
    FloatingOperation.RANDOM_NORMAL: "random_normal",
    FloatingOperation.RANDOM_POISSON: "random_poisson",
    FloatingOperation.RANDOM_ARCSINE: "random_arcsine",
    FloatingOperation.RANDOM_GAMMA: "random_gamma",
    FloatingOperation.RANDOM_BETA: "random_beta",
    FloatingOperation.RANDOM_WEIBULL: "random_weibull",
    FloatingOperation.RANDOM_TRIANGULAR: "random_triangular",
}
NAMED_OPERATIONS = {
    "fmin": FloatingOperation.MINIMUM,
    "fmax": FloatingOperation.MAXIMUM,
    "log": FloatingOperation.DECIMAL_LOGARITHM,
    **{name: operation for operation, name in _NAMES.items() if name not in ("-", "double", "random_triangular")},
}
"""The operations that models call by name."""


def _function(operation: FloatingOperation) -> Function:
    parameters = tuple(
        Variable(name, type_, VariableKind.FRAME) for name, type_ in zip("ab", operation.parameters, strict=False)
    )
    name = _NAMES.get(operation) or BinaryOperator[operation.name].value
    return Function(name, parameters, operation.result, Block(()), operation=operation)


OPERATION_FUNCTIONS = {operation: _function(operation) for operation in FloatingOperation}


def _random_tri() -> Function:
    """UPPAAL's ``random_tri(from, mode, till)``."""
    ends = [Variable(name, DOUBLE, VariableKind.FRAME) for name in ("from", "mode", "till")]
    first, mode, last = map(Reference, ends)
    width = operated(FloatingOperation.SUBTRACT, (last, first))
    share = operated(FloatingOperation.DIVIDE, (operated(FloatingOperation.SUBTRACT, (mode, first)), width))
    drawn = operated(FloatingOperation.RANDOM_TRIANGULAR, (share,))
    value = operated(FloatingOperation.ADD, (first, operated(FloatingOperation.MULTIPLY, (width, drawn))))
    return Function("random_tri", tuple(ends), DOUBLE, Block((Return(value),)))


def operated(operation: FloatingOperation, arguments: tuple[Expression, ...], span: Span = NOWHERE) -> Expression:
    """An operation on expressions, a constant where they are; integers among floating point arguments are converted."""
    function = OPERATION_FUNCTIONS[operation]
    if operation is not FloatingOperation.FROM_INTEGER:
        arguments = tuple(map(as_double, arguments))
    numbers = [number for number in map(constant_number, arguments) if number is not None]
    result = operation.compute(numbers) if len(numbers) == len(arguments) else None
    if result is not None:
        is_double = operation.result == DOUBLE
        return floating_constant(result, span) if is_double else Constant(int(result), operation.result, span)
    return Call(function, arguments, function.result, span)


def as_double(value: Expression) -> Expression:
    """An integer or floating point expression as a floating point number."""
    if value.type == DOUBLE:
        return value
    if isinstance(value, Constant):
        return floating_constant(float(value.value), value.span)
    return operated(FloatingOperation.FROM_INTEGER, (value,), value.span)


def floating_constant(number: float, span: Span = NOWHERE) -> Expression:
    _, (_, half) = DOUBLE.fields
    return Aggregate(tuple(Constant(slot, half, span) for slot in halves(number)), DOUBLE, span)


def constant_number(expression: Expression) -> float | None:
    """The number that a floating point constant is; None for any other expression."""
    match expression:
        case Aggregate((Constant(high), Constant(low)), type_) if type_ == DOUBLE:
            return number_of((high, low))
        case _:
            return None


RANDOM_TRI = _random_tri()
