"""Expressions and statements as code for the core's stack machine.

The order of evaluation is that of `tachk.model.evaluate`, which is the oracle for this module.

Aggregates never lie on the stack: their value is the number of the first slot of a block that holds it, either the
variable itself or a temporary. Function parameters, local variables and results have fixed frame slots, since functions
are not recursive.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from tachk.analysis.fold import Known, fold, fold_place, is_integer
from tachk.base.operators import CONNECTIVES, BinaryOperator, UnaryOperator
from tachk.base.span import Span
from tachk.engine.compiler.assembler import Assembler, JumpLabel
from tachk.engine.compiler.bytecode import Opcode
from tachk.engine.compiler.clock_code import clock_comparison_unsupported, refuse_clock_slots, set_clock
from tachk.engine.compiler.functions import FunctionGenerator
from tachk.engine.compiler.slot_layout import SlotLayout
from tachk.model.expressions import (
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
)
from tachk.model.floating import FloatingOperation
from tachk.model.traversal import may_change, walk
from tachk.model.types import (
    ArrayType,
    BoolType,
    ClockType,
    IntType,
    RecordType,
    ScalarType,
    bounds,
    is_aggregate,
    slot_count,
)

_UNARY = {UnaryOperator.NOT: Opcode.NOT, UnaryOperator.MINUS: Opcode.NEGATE}


class CodeGenerator:
    """Appends pieces of code to one program.

    The entry points fold what they are given with their `Known` and return the position of the piece.
    """

    def __init__(self, layout: SlotLayout, known: Known, tables: Collection[Variable] = ()) -> None:
        """The variables in ``tables`` are arrays of integers that are only read, by index: they lie in the code."""
        self.layout = layout
        self.known = known
        self.assembler = Assembler()
        self._tables = {variable: self.assembler.data(variable.initial) for variable in tables}
        self._functions = FunctionGenerator(self)

    # ---- pieces of code ------------------------------------------------------------------------------------------

    def value_code(self, expression: Expression, known: Known | None = None) -> int:
        """Code for a number: a bound, a condition (0 is false)."""
        start = len(self.assembler.code)
        self.value(fold(expression, known or self.known))
        self.assembler.emit(Opcode.END)
        return start

    def slots_code(self, expression: Expression, known: Known | None = None) -> int:
        """Code for the slot in which the value of an array or record begins, such as a floating point number."""
        start = len(self.assembler.code)
        self.address(fold(expression, known or self.known))
        self.assembler.emit(Opcode.END)
        return start

    def conjunction_code(self, parts: Sequence[Expression], known: Known | None = None) -> int:
        """Code for the truth of a conjunction, evaluated from left to right."""
        start = len(self.assembler.code)
        false = JumpLabel()
        for part in parts:
            self.jump(fold(part, known or self.known), False, false)
        self.assembler.emit(Opcode.CONST, 1)
        self.assembler.emit(Opcode.END)
        self.assembler.place(false)
        self.assembler.emit(Opcode.CONST, 0)
        self.assembler.emit(Opcode.END)
        return start

    def number_code(self, place: Expression, known: Known | None = None) -> int:
        """Code for the number of the clock or channel that a place denotes."""
        start = len(self.assembler.code)
        self.address(fold_place(place, known or self.known))
        self.assembler.emit(Opcode.LOAD_INDIRECT)
        self.assembler.emit(Opcode.END)
        return start

    def update_code(self, updates: tuple[Expression, ...], known: Known | None = None) -> int:
        """Code for a sequence of updates; leaves nothing on the stack."""
        start = len(self.assembler.code)
        for update in updates:
            self.effect(fold(update, known or self.known))
        self.assembler.emit(Opcode.END)
        return start

    def finish(self) -> None:
        """Appends the functions that were called; nothing may be added afterwards."""
        self._functions.finish()

    # ---- loops -------------------------------------------------------------------------------------------------------

    def loop_start(self, variable: Variable) -> JumpLabel:
        low, _ = _value_range(variable)
        self.assembler.emit(Opcode.CONST, low)
        self.assembler.emit(Opcode.STORE, self.layout.first_slot(variable))
        again = JumpLabel()
        self.assembler.place(again)
        return again

    def loop_next(self, variable: Variable, again: JumpLabel) -> None:
        """Goes on with the next value; falls through behind the last one."""
        emit, slot = self.assembler.emit, self.layout.first_slot(variable)
        _, high = _value_range(variable)
        end = JumpLabel()
        emit(Opcode.LOAD, slot)
        emit(Opcode.CONST, high)
        emit(Opcode.GREATER_EQUAL)
        self.assembler.emit_to(Opcode.JUMP_IF_NONZERO, end)
        emit(Opcode.LOAD, slot)
        emit(Opcode.CONST, 1)
        emit(Opcode.ADD)
        emit(Opcode.STORE, slot)
        self.assembler.emit_to(Opcode.JUMP, again)
        self.assembler.place(end)

    # ---- scalar values ----------------------------------------------------------------------------------------------

    def value(self, expression: Expression) -> None:
        """Pushes a number. The expression is folded already."""
        emit = self.assembler.emit
        match expression:
            case Constant(value):
                emit(Opcode.CONST, value)
            case Reference() | Index() | Field():
                self._read(expression)
            case Unary(operator, operand, _, span):
                self.value(operand)
                emit(_UNARY[operator], span=span)
            case Binary():
                self._binary(expression)
            case Conditional(condition, then, otherwise):
                other, end = JumpLabel(), JumpLabel()
                self.jump(condition, False, other)
                self.value(then)
                self.assembler.emit_to(Opcode.JUMP, end)
                self.assembler.place(other)
                self.value(otherwise)
                self.assembler.place(end)
            case Quantifier():
                self._quantifier(expression)
            case Assign(target):
                slot = self.layout.known_slot(target)
                if slot is not None:
                    self.effect(expression)
                    emit(Opcode.LOAD, slot)
                else:
                    self.address(target)
                    emit(Opcode.DUPLICATE)
                    self._store_through(expression)
                    emit(Opcode.LOAD_INDIRECT)
            case Increment():
                self._increment(expression)
            case Call(function):
                if function.operation is not None:
                    self._operate(expression, function.operation)
                else:
                    self._functions.call(expression)
            case Comma(items):
                for item in items[:-1]:
                    self.effect(item)
                self.value(items[-1])
            case LocationTest(process, location):
                emit(Opcode.LOAD, process)
                emit(Opcode.CONST, location)
                emit(Opcode.EQUAL)
            case Deadlock() | Aggregate():
                raise TypeError(f"{type(expression).__name__} has no integer value")

    def _read(self, place: Reference | Index | Field) -> None:
        emit = self.assembler.emit
        match place:
            case Index(Reference(variable), index, _, span) if variable in self._tables:
                assert isinstance(variable.type, ArrayType)
                self.value(index)
                emit(Opcode.TABLE, self._tables[variable], variable.type.low, variable.type.size, span=span)
                return
            case _:
                pass
        if isinstance(place.type, ClockType):
            raise clock_comparison_unsupported(place.span)
        slot = self.layout.known_slot(place)
        if slot is not None:
            emit(Opcode.LOAD, slot)
        else:
            self.address(place)
            emit(Opcode.LOAD_INDIRECT)

    def _binary(self, expression: Binary) -> None:
        emit = self.assembler.emit
        operator, left, right, span = expression.operator, expression.left, expression.right, expression.span
        if operator is BinaryOperator.XOR:
            self.value(left)
            emit(Opcode.BOOLEAN)
            self.value(right)
            emit(Opcode.BOOLEAN)
            emit(Opcode.NOT_EQUAL)
        elif operator in CONNECTIVES:
            false, end = JumpLabel(), JumpLabel()
            self.jump(expression, False, false)
            emit(Opcode.CONST, 1)
            self.assembler.emit_to(Opcode.JUMP, end)
            self.assembler.place(false)
            emit(Opcode.CONST, 0)
            self.assembler.place(end)
        elif is_aggregate(left.type):
            self._stable_address(left, right)
            self.address(right)
            emit(Opcode.EQUAL_SLOTS, slot_count(left.type))
            match operator:
                case BinaryOperator.EQUAL:
                    pass
                case BinaryOperator.NOT_EQUAL:
                    emit(Opcode.NOT)
                case _:
                    raise ValueError(f"{operator} does not compare arrays or records")
        else:
            self.value(left)
            self.value(right)
            emit(Opcode[operator.name], span=span)

    def jump(self, expression: Expression, when: bool, label: JumpLabel) -> None:
        """Goes to the label if the truth of the expression is ``when``, else falls through."""
        match expression:
            case Constant(value):
                if (value != 0) == when:
                    self.assembler.emit_to(Opcode.JUMP, label)
            case Unary(UnaryOperator.NOT, operand):
                self.jump(operand, not when, label)
            case Binary(BinaryOperator.AND | BinaryOperator.OR | BinaryOperator.IMPLY as operator, left, right):
                left_decides = operator is BinaryOperator.OR  # the left truth that makes the right side superfluous
                if (operator is not BinaryOperator.AND) == when:
                    self.jump(left, left_decides, label)
                    self.jump(right, when, label)
                else:
                    end = JumpLabel()
                    self.jump(left, left_decides, end)
                    self.jump(right, when, label)
                    self.assembler.place(end)
            case _:
                self.value(expression)
                self.assembler.emit_to(Opcode.JUMP_IF_NONZERO if when else Opcode.JUMP_IF_ZERO, label)

    def _quantifier(self, expression: Quantifier) -> None:
        emit = self.assembler.emit
        if expression.kind is QuantifierKind.SUM:
            emit(Opcode.CONST, 0)
            again = self.loop_start(expression.variable)
            self.value(expression.body)
            emit(Opcode.ADD, span=expression.span)
            self.loop_next(expression.variable, again)
            return
        exists = expression.kind is QuantifierKind.EXISTS
        decided, end = JumpLabel(), JumpLabel()
        again = self.loop_start(expression.variable)
        self.jump(expression.body, exists, decided)
        self.loop_next(expression.variable, again)
        emit(Opcode.CONST, int(not exists))
        self.assembler.emit_to(Opcode.JUMP, end)
        self.assembler.place(decided)
        emit(Opcode.CONST, int(exists))
        self.assembler.place(end)

    def _increment(self, expression: Increment) -> None:
        emit = self.assembler.emit
        span = expression.span
        slot = self.layout.known_slot(expression.target)
        if slot is not None:
            emit(Opcode.LOAD, slot)
            if not expression.prefix:
                emit(Opcode.DUPLICATE)
            emit(Opcode.CONST, expression.delta)
            emit(Opcode.ADD, span=span)
            emit(Opcode.STORE, slot, span=span)
            if expression.prefix:
                emit(Opcode.LOAD, slot)
            return
        self.address(expression.target)
        emit(Opcode.DUPLICATE)
        if expression.prefix:
            emit(Opcode.DUPLICATE)
            emit(Opcode.LOAD_INDIRECT)
        else:
            emit(Opcode.LOAD_INDIRECT)
            emit(Opcode.SWAP)
            emit(Opcode.OVER)
        emit(Opcode.CONST, expression.delta)
        emit(Opcode.ADD, span=span)
        emit(Opcode.STORE_INDIRECT, span=span)
        if expression.prefix:
            emit(Opcode.LOAD_INDIRECT)

    # ---- effects ----------------------------------------------------------------------------------------------------

    def effect(self, expression: Expression) -> None:
        """Evaluates an expression without keeping its value."""
        emit = self.assembler.emit
        match expression:
            case Assign(target):
                if is_aggregate(target.type):
                    self._assign_aggregate(expression)
                    return
                slot = self.layout.known_slot(target)
                if slot is None or isinstance(target.type, ClockType):
                    self.address(target)
                    self._store_through(expression)
                    return
                if expression.operator is not None:
                    emit(Opcode.LOAD, slot)
                self.value(expression.value)
                if expression.operator is not None:
                    emit(Opcode[expression.operator.name], span=expression.span)
                emit(Opcode.STORE, slot, span=expression.span)
            case Comma(items):
                for item in items:
                    self.effect(item)
            case Call(function) if function.operation is None:
                self._functions.call(expression)
                if is_integer(function.result):
                    emit(Opcode.POP)
            case Conditional(condition, then, otherwise) if not is_integer(expression.type):
                other, end = JumpLabel(), JumpLabel()
                self.jump(condition, False, other)
                self.effect(then)
                self.assembler.emit_to(Opcode.JUMP, end)
                self.assembler.place(other)
                self.effect(otherwise)
                self.assembler.place(end)
            case Constant():
                return
            case _ if is_integer(expression.type):
                self.value(expression)
                emit(Opcode.POP)
            case _:
                self.address(expression)
                emit(Opcode.POP)

    def _store_through(self, expression: Assign) -> None:
        """With the target's address on the stack: computes the value and stores it."""
        emit = self.assembler.emit
        if isinstance(expression.target.type, ClockType):
            emit(Opcode.LOAD_INDIRECT)
            set_clock(self, expression)
            return
        if expression.operator is not None:
            emit(Opcode.DUPLICATE)
            emit(Opcode.LOAD_INDIRECT)
        self.value(expression.value)
        if expression.operator is not None:
            emit(Opcode[expression.operator.name], span=expression.span)
        emit(Opcode.STORE_INDIRECT, span=expression.span)

    # ---- places and aggregates --------------------------------------------------------------------------------------

    def address(self, expression: Expression) -> None:
        """Pushes the first slot of a place, or of a block that holds the value of an aggregate."""
        emit = self.assembler.emit
        slot = self.layout.known_slot(expression)
        if slot is not None:
            emit(Opcode.CONST, slot)
            return
        match expression:
            case Reference(variable):
                emit(Opcode.LOAD, self.layout.first_slot(variable))
            case Index(base, index, _, span):
                assert isinstance(base.type, ArrayType)
                self.address(base)
                self.value(index)
                stride = slot_count(base.type.element)
                emit(Opcode.INDEX, base.type.low, base.type.size, stride, span=span)
            case Field(base, name):
                assert isinstance(base.type, RecordType)
                self.address(base)
                offset = base.type.offset(name)
                if offset:
                    emit(Opcode.CONST, offset)
                    emit(Opcode.ADD)
            case Conditional(condition, then, otherwise):
                other, end = JumpLabel(), JumpLabel()
                self.jump(condition, False, other)
                self.address(then)
                self.assembler.emit_to(Opcode.JUMP, end)
                self.assembler.place(other)
                self.address(otherwise)
                self.assembler.place(end)
            case Comma(items):
                for item in items[:-1]:
                    self.effect(item)
                self.address(items[-1])
            case Assign(target) if is_aggregate(target.type):
                self.address(target)
                emit(Opcode.DUPLICATE)
                self._aggregate_value(expression.value)
                emit(Opcode.COPY, slot_count(target.type), span=expression.span)
            case Call(function) if function.operation is not None:
                self._operate(expression, function.operation)
            case Call(function) if is_aggregate(function.result):
                self._functions.call(expression)
                temporary = self.layout.temporary(slot_count(function.result))
                emit(Opcode.CONST, temporary)
                emit(Opcode.CONST, self._functions.result_slot(function))
                emit(Opcode.COPY, slot_count(function.result))
                emit(Opcode.CONST, temporary)
            case Aggregate(items):
                temporary = self.layout.temporary(slot_count(expression.type))
                self._fill(temporary, items)
                emit(Opcode.CONST, temporary)
            case _:
                temporary = self.layout.temporary(1)
                self.value(expression)
                emit(Opcode.STORE, temporary)
                emit(Opcode.CONST, temporary)

    def _operate(self, call: Call, operation: FloatingOperation) -> None:
        """Pushes the result of an operation; of a floating point result, the slot in which it begins."""
        emit = self.assembler.emit
        first = call.arguments[0]
        if operation is FloatingOperation.FROM_INTEGER:
            self.value(first)
        else:
            self._stable_address(first, *call.arguments[1:])
        if len(call.arguments) > 1:
            self.address(call.arguments[1])
        else:
            emit(Opcode.CONST, 0)
        slot = self.layout.temporary(slot_count(operation.result))
        emit(Opcode.FLOATING, operation, slot, span=call.span)

    def _fill(self, slot: int, items: tuple[Expression, ...]) -> None:
        for item in items:
            size = slot_count(item.type)
            if is_aggregate(item.type):
                self.assembler.emit(Opcode.CONST, slot)
                self.address(item)
                self.assembler.emit(Opcode.COPY, size)
            else:
                self.value(item)
                self.assembler.emit(Opcode.STORE, slot)
            slot += size

    def _stable_address(self, expression: Expression, *later: Expression) -> None:
        """Like `_address`, but what is evaluated later cannot change the slots any more."""
        if any(may_change(node) for each in later for node in walk(each)):
            temporary = self.layout.temporary(slot_count(expression.type))
            self.copy_into(temporary, expression, expression.span)
            self.assembler.emit(Opcode.CONST, temporary)
        else:
            self.address(expression)

    def _aggregate_value(self, expression: Expression) -> None:
        refuse_clock_slots(expression)
        self.address(expression)

    def _assign_aggregate(self, expression: Assign) -> None:
        self.address(expression.target)
        self._aggregate_value(expression.value)
        self.assembler.emit(Opcode.COPY, slot_count(expression.target.type), span=expression.span)

    def copy_into(self, slot: int, value: Expression, span: Span) -> None:
        self.assembler.emit(Opcode.CONST, slot)
        self._aggregate_value(value)
        self.assembler.emit(Opcode.COPY, slot_count(value.type), span=span)


def _value_range(variable: Variable) -> tuple[int, int]:
    assert isinstance(variable.type, IntType | BoolType | ScalarType)
    return bounds(variable.type)
