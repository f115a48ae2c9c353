"""Names that UPPAAL 5 declares; a model may declare them itself."""

from __future__ import annotations

from tachk.frontend.expressions.typing import WIDE
from tachk.model.expressions import (
    BOOL,
    INT,
    Binary,
    Block,
    Conditional,
    Constant,
    Function,
    Reference,
    Return,
    Unary,
    Variable,
    VariableKind,
)
from tachk.model.types import IntType, Type
from tachk.operators import BinaryOperator, UnaryOperator

BUILTIN_TYPES: dict[str, Type] = {
    "int8_t": IntType(-(2**7), 2**7 - 1),
    "uint8_t": IntType(0, 2**8 - 1),
    "int16_t": IntType(-(2**15), 2**15 - 1),
    "uint16_t": IntType(0, 2**16 - 1),
    "int32_t": IntType(-(2**31), 2**31 - 1),
}

BUILTIN_CONSTANTS = {
    "INT8_MIN": -(2**7),
    "INT8_MAX": 2**7 - 1,
    "UINT8_MAX": 2**8 - 1,
    "INT16_MIN": -(2**15),
    "INT16_MAX": 2**15 - 1,
    "UINT16_MAX": 2**16 - 1,
    "INT32_MIN": -(2**31),
    "INT32_MAX": 2**31 - 1,
}


def _absolute_value() -> Function:
    number = Variable("number", WIDE, VariableKind.FRAME)
    value = Reference(number)
    negative = Binary(BinaryOperator.LESS, value, Constant(0, INT), BOOL)
    result = Conditional(negative, Unary(UnaryOperator.MINUS, value, WIDE), value, WIDE)
    return Function("abs", (number,), WIDE, Block((Return(result),)))


BUILTIN_FUNCTIONS = {"abs": _absolute_value()}

# fmt: off
FLOATING_FUNCTIONS = frozenset(
    {
        "random", "random_normal", "random_poisson", "random_arcsine", "random_beta", "random_gamma", "random_tri",
        "random_weibull", "fabs", "fmod", "remainder", "fma", "fmax", "fmin", "fdim", "exp", "exp2", "expm1", "ln",
        "log", "log10", "log2", "log1p", "pow", "sqrt", "cbrt", "hypot", "sin", "cos", "tan", "asin", "acos", "atan",
        "atan2", "sinh", "cosh", "tanh", "asinh", "acosh", "atanh", "erf", "erfc", "tgamma", "lgamma", "ceil",
        "floor", "trunc", "round", "fint", "ldexp", "ilogb", "logb", "nextafter", "copysign", "signbit", "isfinite",
        "isinf", "isnan", "isnormal", "isunordered",
    }
)
# fmt: on
"""Functions on floating point numbers, which only statistical checking can evaluate."""

DYNAMIC_FUNCTIONS = frozenset({"exit", "numOf"})
"""Functions about processes that appear and vanish while the system runs, which only statistical checking knows."""

DYNAMIC_HELP = "processes cannot appear or vanish while the system runs; name all of them in the system line"
