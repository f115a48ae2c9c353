"""Code that sets clocks."""

from __future__ import annotations

from typing import Protocol

from tachk.compiler.assembler import Assembler
from tachk.compiler.bytecode import Opcode
from tachk.compiler.refused_clocks import clock_comparison_unsupported
from tachk.model.clock_sums import clock_sum
from tachk.model.expressions import Assign, Expression


class Generator(Protocol):
    """What code is made with: `tachk.compiler.codegen.CodeGenerator`."""

    assembler: Assembler

    def value(self, expression: Expression) -> None: ...

    def address(self, expression: Expression) -> None: ...


def set_clock(generator: Generator, expression: Assign) -> None:
    """With the number of the clock on the stack: sets it. Raises UnsupportedError for what is no sum with one clock."""
    emit = generator.assembler.emit
    whole = clock_sum(expression.value)
    if whole is None:
        raise clock_comparison_unsupported(expression.value.span)
    if whole.clock is None:
        generator.value(expression.value)
        emit(Opcode.RESET, span=expression.span)
        return
    if whole.offset is not None:
        emit(Opcode.DUPLICATE)
    generator.address(whole.clock)
    emit(Opcode.LOAD_INDIRECT)
    emit(Opcode.COPY_CLOCK, span=expression.span)
    if whole.offset is not None:
        generator.value(whole.offset)
        emit(Opcode.ADVANCE_CLOCK, span=expression.span)
