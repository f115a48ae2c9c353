"""Names that UPPAAL 5 declares; a model may declare them itself."""

from __future__ import annotations

import math
import sys

from tachk.base.operators import BinaryOperator, UnaryOperator
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

BUILTIN_TYPES: dict[str, Type] = {
    "int8_t": IntType(-(2**7), 2**7 - 1),
    "uint8_t": IntType(0, 2**8 - 1),
    "int16_t": IntType(-(2**15), 2**15 - 1),
    "uint16_t": IntType(0, 2**16 - 1),
    "int32_t": IntType(-(2**31), 2**31 - 1),
}

FOREIGN_TYPES = {
    **dict.fromkeys(("float", "real", "number", "Double"), "double"),
    **dict.fromkeys(("boolean", "Boolean", "Bool"), "bool"),
    **dict.fromkeys(("integer", "Integer", "long", "short", "unsigned", "char", "byte"), "int"),
    **dict.fromkeys(("channel", "event"), "chan"),
    **dict.fromkeys(("timer", "Clock"), "clock"),
}
"""Types of other languages, and those of the same meaning here."""

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


BUILTIN_DOUBLES = {
    "FLT_MIN": 2.0**-126,
    "FLT_MAX": (2 - 2.0**-23) * 2.0**127,
    "DBL_MIN": sys.float_info.min,
    "DBL_MAX": sys.float_info.max,
    "M_PI": math.pi,
    "M_PI_2": math.pi / 2,
    "M_PI_4": math.pi / 4,
    "M_E": math.e,
    "M_LOG2E": 1.442695040888963387004650940070860087871551513671875,
    "M_LOG10E": 0.43429448190325181666793241674895398318767547607421875,
    "M_LN2": 0.69314718055994528622676398299518041312694549560546875,
    "M_LN10": 2.30258509299404590109361379290930926799774169921875,
    "M_1_PI": 0.31830988618379069121644192420751567810773849487304688,
    "M_2_PI": 0.63661977236758138243288840385503135621547698974609375,
    "M_2_SQRTPI": 1.1283791670955125585606992899556644260883331298828125,
    "M_SQRT2": 1.4142135623730951454746218587388284504413604736328125,
    "M_SQRT1_2": 0.70710678118654757273736092931936942522068023681640625,
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
