"""What can go wrong while a model runs."""

from __future__ import annotations

from enum import IntEnum

from tachk.diagnostics.span import Span


class RuntimeErrorKind(IntEnum):
    """The number is what the C++ core reports, with the code position where it happened."""

    NONE = 0
    RANGE = 1
    """a value outside the declared range of a variable, parameter or result"""
    INDEX = 2
    DIVISION = 3
    NEGATIVE_CLOCK = 4
    SHIFT = 6
    NEGATIVE_EXPONENT = 7
    ASSERT = 8
    LOOP = 9
    """more than 2**24 instructions in one piece of code"""
    BOUND = 10
    """a clock is compared with a value beyond the constants the program was compiled for"""


class EvaluationFault(Exception):
    """Raised by the Python evaluator; ``span`` is the expression that failed, ``detail`` names the values involved."""

    def __init__(self, kind: RuntimeErrorKind, span: Span, detail: str = "") -> None:
        self.kind = kind
        self.span = span
        self.detail = detail
        super().__init__(f"{span}: {kind.name}" + (f": {detail}" if detail else ""))
