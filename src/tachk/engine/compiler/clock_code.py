"""Code that sets clocks, and the facts about them that code cannot express, as their values lie in zones."""

from __future__ import annotations

from typing import Protocol

from tachk.base.diagnostics.diagnostic import Diagnostic, UnsupportedError
from tachk.base.span import Span
from tachk.engine.compiler.assembler import Assembler
from tachk.engine.compiler.bytecode import Opcode
from tachk.engine.compiler.slot_layout import SlotLayout
from tachk.model.clock_sums import clock_assignments, clock_sum
from tachk.model.expressions import Assign, Expression
from tachk.model.types import ChannelType, ClockType, Type, leaves


class Generator(Protocol):
    """The maker of code: `tachk.engine.compiler.codegen.CodeGenerator`."""

    assembler: Assembler
    layout: SlotLayout

    def value(self, expression: Expression) -> None: ...

    def address(self, expression: Expression) -> None: ...


def set_clock(generator: Generator, expression: Assign) -> None:
    """Sets the clock whose number is on the stack. Raises UnsupportedError for what is not a sum with one clock."""
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
    if whole.offset is None:
        emit(Opcode.COPY_CLOCK, span=expression.span)
    elif any(clock_assignments([whole.offset])):
        # The assignments of the offset come before the copy.
        offset = generator.layout.temporary(1)
        generator.value(whole.offset)
        emit(Opcode.STORE, offset)
        emit(Opcode.COPY_CLOCK, span=expression.span)
        emit(Opcode.LOAD, offset)
        emit(Opcode.ADVANCE_CLOCK, span=expression.span)
    else:
        emit(Opcode.COPY_CLOCK, span=expression.span)
        generator.value(whole.offset)
        emit(Opcode.ADVANCE_CLOCK, span=expression.span)


def _contains_clocks(type_: Type) -> bool:
    return any(isinstance(leaf, ClockType | ChannelType) for _, leaf in leaves(type_))


def refuse_clock_slots(expression: Expression) -> None:
    """Raises UnsupportedError for a copy of a value that contains clocks."""
    if _contains_clocks(expression.type):
        raise UnsupportedError(
            Diagnostic(
                "E0702",
                "an array or record that contains clocks cannot be copied",
                expression.span,
                "assign its integer cells one by one, or pass it by reference",
            )
        )


def clock_comparison_unsupported(span: Span) -> UnsupportedError:
    """A clock is compared where only integers can be evaluated."""
    return UnsupportedError(
        Diagnostic(
            "E0703",
            "a clock is compared inside an expression that must be a number",
            span,
            "compare clocks only in guards, invariants and queries, joined by &&, ||, imply, not or forall",
        )
    )
