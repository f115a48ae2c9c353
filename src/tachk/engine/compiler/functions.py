"""Functions and their statements as code.

The frame slots of a function are fixed, since functions are not recursive. Arguments go into the parameters' slots, a
scalar result stays on the stack, an aggregate result goes into slots of its own.
"""

from __future__ import annotations

from typing import Protocol

from tachk.analysis.fold import Known, fold, is_integer
from tachk.base.span import Span
from tachk.engine.compiler.assembler import Assembler, JumpLabel
from tachk.engine.compiler.bytecode import Opcode
from tachk.engine.compiler.slot_layout import SlotLayout
from tachk.model.expressions import (
    Assert,
    Block,
    Call,
    Declare,
    Evaluate,
    Expression,
    Function,
    If,
    Iterate,
    Return,
    Statement,
    Variable,
    While,
)
from tachk.model.traversal import walk
from tachk.model.types import VoidType, is_aggregate, leaves, slot_count
from tachk.model.variable_layout import default_value, slot_range


class ExpressionGenerator(Protocol):
    """The interface of the generator of expressions that functions need."""

    layout: SlotLayout
    known: Known
    assembler: Assembler

    def value(self, expression: Expression) -> None: ...

    def jump(self, expression: Expression, when: bool, label: JumpLabel) -> None: ...

    def effect(self, expression: Expression) -> None: ...

    def address(self, expression: Expression) -> None: ...

    def copy_into(self, slot: int, value: Expression, span: Span) -> None: ...

    def loop_start(self, variable: Variable) -> JumpLabel: ...

    def loop_next(self, variable: Variable, again: JumpLabel) -> None: ...


class FunctionGenerator:
    """Appends calls, and at the end the bodies of the functions that were called, to the code of a program."""

    def __init__(self, code: ExpressionGenerator) -> None:
        self._code = code
        self._functions: dict[Function, JumpLabel] = {}
        self._pending: list[Function] = []
        self._results: dict[Function, int] = {}
        self._current: Function | None = None

    def finish(self) -> None:
        """Appends the functions that were called."""
        while self._pending:
            self._body(self._pending.pop())

    def _body(self, function: Function) -> None:
        self._code.assembler.place(self._functions[function])
        self._current = function
        self._statement(function.body)
        if is_integer(function.result):
            self._code.assembler.emit(Opcode.CONST, 0)
            self._code.assembler.emit(Opcode.ASSERT, span=function.span)
        self._code.assembler.emit(Opcode.RETURN)
        self._current = None

    def call(self, call: Call) -> None:
        """Runs a function. A scalar result is on the stack, an aggregate in the function's result slots."""
        function = call.function
        pairs = list(zip(function.parameters, call.arguments, strict=True))
        delayed: list[Variable] = []
        for i, (parameter, argument) in enumerate(pairs):
            calls_follow = any(isinstance(node, Call) for _, later in pairs[i + 1 :] for node in walk(later))
            self._argument(parameter, argument, delay=calls_follow)
            if calls_follow:
                delayed.append(parameter)
        for parameter in reversed(delayed):
            self._store_delayed(parameter, call.span)
        if function not in self._functions:
            self._functions[function] = JumpLabel()
            self._pending.append(function)
        self._code.assembler.emit_to(Opcode.CALL, self._functions[function])

    def _argument(self, parameter: Variable, argument: Expression, delay: bool) -> None:
        """Evaluates an argument into its parameter, or, where a later argument might run the same function, keeps it on
        the stack until `_store_delayed`."""
        slot = self._code.layout.first_slot(parameter)
        if parameter.reference:
            self._code.address(argument)
            if not delay:
                self._code.assembler.emit(Opcode.STORE, slot)
        elif is_aggregate(parameter.type):
            if delay:
                temporary = self._code.layout.block(parameter.name, parameter.type)
                self._code.copy_into(temporary, argument, argument.span)
                self._code.assembler.emit(Opcode.CONST, temporary)
            else:
                self._code.copy_into(slot, argument, argument.span)
        else:
            self._code.value(argument)
            if delay:
                self._code.assembler.emit(Opcode.CHECK_RANGE, *slot_range(parameter.type), span=argument.span)
            else:
                self._code.assembler.emit(Opcode.STORE, slot, span=argument.span)

    def _store_delayed(self, parameter: Variable, span: Span) -> None:
        slot = self._code.layout.first_slot(parameter)
        if is_aggregate(parameter.type) and not parameter.reference:
            self._code.assembler.emit(Opcode.CONST, slot)
            self._code.assembler.emit(Opcode.SWAP)
            self._code.assembler.emit(Opcode.COPY, slot_count(parameter.type), span=span)
        else:
            self._code.assembler.emit(Opcode.STORE, slot, span=span)

    def result_slot(self, function: Function) -> int:
        if function not in self._results:
            self._results[function] = self._code.layout.block(f"{function.name}()", function.result)
        return self._results[function]

    # ---- statements -----------------------------------------------------------------------------------------------

    def _statement(self, statement: Statement) -> None:
        emit = self._code.assembler.emit
        match statement:
            case Evaluate(expression):
                self._code.effect(fold(expression, self._code.known))
            case Declare(variable, initial):
                self._declare(variable, initial)
            case Block(statements):
                for inner in statements:
                    self._statement(inner)
            case If(condition, then, otherwise):
                other, end = JumpLabel(), JumpLabel()
                self._code.jump(fold(condition, self._code.known), False, other)
                self._statement(then)
                if otherwise is not None:
                    self._code.assembler.emit_to(Opcode.JUMP, end)
                self._code.assembler.place(other)
                if otherwise is not None:
                    self._statement(otherwise)
                self._code.assembler.place(end)
            case While(condition, body, test_first):
                again, end = JumpLabel(), JumpLabel()
                test = fold(condition, self._code.known)
                if test_first:
                    self._code.jump(test, False, end)
                self._code.assembler.place(again)
                self._statement(body)
                self._code.jump(test, True, again)
                self._code.assembler.place(end)
            case Iterate(variable, body):
                again = self._code.loop_start(variable)
                self._statement(body)
                self._code.loop_next(variable, again)
            case Return(value):
                self._return(value)
                emit(Opcode.RETURN)
            case Assert(condition):
                self._code.value(fold(condition, self._code.known))
                emit(Opcode.ASSERT, span=condition.span)

    def _declare(self, variable: Variable, initial: Expression | None) -> None:
        slot = self._code.layout.first_slot(variable)
        if initial is None:
            for i, (_, type_) in enumerate(leaves(variable.type)):
                self._code.assembler.emit(Opcode.CONST, default_value(type_))
                self._code.assembler.emit(Opcode.STORE, slot + i)
        elif is_aggregate(variable.type):
            self._code.copy_into(slot, fold(initial, self._code.known), initial.span)
        else:
            self._code.value(fold(initial, self._code.known))
            self._code.assembler.emit(Opcode.STORE, slot, span=initial.span)

    def _return(self, value: Expression | None) -> None:
        assert self._current is not None
        if value is None:
            return
        result = self._current.result
        folded = fold(value, self._code.known)
        if is_aggregate(result):
            self._code.copy_into(self.result_slot(self._current), folded, value.span)
        elif isinstance(result, VoidType):
            self._code.effect(folded)
        else:
            self._code.value(folded)
            self._code.assembler.emit(Opcode.CHECK_RANGE, *slot_range(result), span=value.span)
