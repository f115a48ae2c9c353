"""Run-time errors of a model."""

from __future__ import annotations

from enum import Enum, auto

from tachk.base.span import Span


class RuntimeErrorKind(Enum):
    """The core reports members of these names, with the code position where it happened."""

    RANGE = auto()
    """a value outside the declared range of a variable, parameter or result"""
    INDEX = auto()
    DIVISION = auto()
    NEGATIVE_CLOCK = auto()
    SHIFT = auto()
    NEGATIVE_EXPONENT = auto()
    ASSERT = auto()
    LOOP = auto()
    """more than 2**24 instructions in one piece of code"""
    NOT_FINITE = auto()
    """a floating point operation without a finite result, or too large for an integer"""
    BOUND = auto()
    """a clock is compared with a value beyond the constants the program was compiled for"""


class EvaluationFault(Exception):
    """Raised by the Python evaluator; ``span`` is the expression that failed, ``detail`` names the values involved."""

    def __init__(self, kind: RuntimeErrorKind, span: Span, detail: str = "") -> None:
        self.kind = kind
        self.span = span
        self.detail = detail
        super().__init__(f"{span}: {kind.name}" + (f": {detail}" if detail else ""))
