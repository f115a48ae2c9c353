"""Expressions and statements as code for the core's stack machine.

The order of evaluation is that of `tachk.model.evaluate`, which is the oracle for this module.

Aggregates never lie on the stack: their value is the number of the first slot of a block that holds it, either the
variable itself or a temporary. Function parameters, local variables and results have fixed frame slots, since functions
are not recursive.
"""

from __future__ import annotations

from tachk.diagnostics.diagnostic import Diagnostic, UnsupportedError
from tachk.diagnostics.span import Span
from tachk.model.expressions import (
    Aggregate,
    Assert,
    Assign,
    Binary,
    BinaryOperator,
    Block,
    Call,
    Comma,
    Conditional,
    Constant,
    Deadlock,
    Declare,
    Evaluate,
    Expression,
    Field,
    Function,
    If,
    Increment,
    Index,
    Iterate,
    LocationTest,
    Quantifier,
    QuantifierKind,
    Reference,
    Return,
    Statement,
    Unary,
    UnaryOperator,
    Variable,
    While,
)
from tachk.model.layout import default_value
from tachk.model.traversal import walk
from tachk.model.types import (
    ArrayType,
    BoolType,
    ChannelType,
    ClockType,
    IntType,
    RecordType,
    ScalarType,
    Type,
    VoidType,
    bounds,
    cell_count,
    leaves,
)
from tachk.semantics.assembler import Assembler, Label
from tachk.semantics.bytecode import Opcode
from tachk.semantics.fold import CONNECTIVES, Known, fold, fold_place, is_aggregate, is_integer
from tachk.semantics.layout import Layout, cell_range

_ARITHMETIC = {
    BinaryOperator.ADD: Opcode.ADD,
    BinaryOperator.SUBTRACT: Opcode.SUBTRACT,
    BinaryOperator.MULTIPLY: Opcode.MULTIPLY,
    BinaryOperator.DIVIDE: Opcode.DIVIDE,
    BinaryOperator.MODULO: Opcode.MODULO,
    BinaryOperator.POWER: Opcode.POWER,
    BinaryOperator.BIT_AND: Opcode.BIT_AND,
    BinaryOperator.BIT_OR: Opcode.BIT_OR,
    BinaryOperator.BIT_XOR: Opcode.BIT_XOR,
    BinaryOperator.SHIFT_LEFT: Opcode.SHIFT_LEFT,
    BinaryOperator.SHIFT_RIGHT: Opcode.SHIFT_RIGHT,
    BinaryOperator.MINIMUM: Opcode.MINIMUM,
    BinaryOperator.MAXIMUM: Opcode.MAXIMUM,
    BinaryOperator.EQUAL: Opcode.EQUAL,
    BinaryOperator.NOT_EQUAL: Opcode.NOT_EQUAL,
    BinaryOperator.LESS: Opcode.LESS,
    BinaryOperator.LESS_EQUAL: Opcode.LESS_EQUAL,
    BinaryOperator.GREATER: Opcode.GREATER,
    BinaryOperator.GREATER_EQUAL: Opcode.GREATER_EQUAL,
}


class CodeGenerator:
    """Appends pieces of code to one program.

    The entry points fold what they are given with their `Known` and return the position of the piece.
    """

    def __init__(self, layout: Layout, known: Known) -> None:
        self.layout = layout
        self.known = known
        self.assembler = Assembler()
        self._functions: dict[Function, Label] = {}
        self._pending: list[Function] = []
        self._results: dict[Function, int] = {}
        self._current: Function | None = None

    # ---- pieces of code ------------------------------------------------------------------------------------------

    def value_code(self, expression: Expression, known: Known | None = None) -> int:
        """Code for a number: a bound, a condition (0 is false)."""
        start = len(self.assembler.code)
        self._value(fold(expression, known or self.known))
        self.assembler.emit(Opcode.END)
        return start

    def number_code(self, place: Expression, known: Known | None = None) -> int:
        """Code for the number of the clock or channel that a place denotes."""
        start = len(self.assembler.code)
        self._address(fold_place(place, known or self.known))
        self.assembler.emit(Opcode.LOAD_INDIRECT)
        self.assembler.emit(Opcode.END)
        return start

    def update_code(self, updates: tuple[Expression, ...], known: Known | None = None) -> int:
        """Code for a sequence of updates; leaves nothing on the stack."""
        start = len(self.assembler.code)
        for update in updates:
            self._effect(fold(update, known or self.known))
        self.assembler.emit(Opcode.END)
        return start

    def finish(self) -> None:
        """Appends the functions that were called; nothing may be added afterwards."""
        while self._pending:
            self._function(self._pending.pop())

    # ---- functions ------------------------------------------------------------------------------------------------

    def _function(self, function: Function) -> None:
        self.assembler.place(self._functions[function])
        self._current = function
        self._statement(function.body)
        if is_integer(function.result):
            self.assembler.emit(Opcode.CONST, 0)
            self.assembler.emit(Opcode.ASSERT, span=function.span)
        self.assembler.emit(Opcode.RETURN)
        self._current = None

    def _call(self, call: Call) -> None:
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
            self._functions[function] = Label()
            self._pending.append(function)
        self.assembler.emit_to(Opcode.CALL, self._functions[function])

    def _argument(self, parameter: Variable, argument: Expression, delay: bool) -> None:
        """Evaluates an argument into its parameter, or, where a later argument might run the same function, keeps it on
        the stack until `_store_delayed`."""
        slot = self.layout.first_slot(parameter)
        if parameter.reference:
            self._address(argument)
            if not delay:
                self.assembler.emit(Opcode.STORE, slot)
        elif is_aggregate(parameter.type):
            if delay:
                temporary = self.layout.block(parameter.name, parameter.type)
                self._copy_into(temporary, argument, argument.span)
                self.assembler.emit(Opcode.CONST, temporary)
            else:
                self._copy_into(slot, argument, argument.span)
        else:
            self._value(argument)
            if delay:
                self.assembler.emit(Opcode.CHECK_RANGE, *cell_range(parameter.type), span=argument.span)
            else:
                self.assembler.emit(Opcode.STORE, slot, span=argument.span)

    def _store_delayed(self, parameter: Variable, span: Span) -> None:
        slot = self.layout.first_slot(parameter)
        if is_aggregate(parameter.type) and not parameter.reference:
            self.assembler.emit(Opcode.CONST, slot)
            self.assembler.emit(Opcode.SWAP)
            self.assembler.emit(Opcode.COPY, cell_count(parameter.type), span=span)
        else:
            self.assembler.emit(Opcode.STORE, slot, span=span)

    def _result_slot(self, function: Function) -> int:
        if function not in self._results:
            self._results[function] = self.layout.block(f"{function.name}()", function.result)
        return self._results[function]

    # ---- statements -----------------------------------------------------------------------------------------------

    def _statement(self, statement: Statement) -> None:
        emit = self.assembler.emit
        match statement:
            case Evaluate(expression):
                self._effect(fold(expression, self.known))
            case Declare(variable, initial):
                self._declare(variable, initial)
            case Block(statements):
                for inner in statements:
                    self._statement(inner)
            case If(condition, then, otherwise):
                other, end = Label(), Label()
                self._jump(fold(condition, self.known), False, other)
                self._statement(then)
                if otherwise is not None:
                    self.assembler.emit_to(Opcode.JUMP, end)
                self.assembler.place(other)
                if otherwise is not None:
                    self._statement(otherwise)
                self.assembler.place(end)
            case While(condition, body, test_first):
                again, end = Label(), Label()
                test = fold(condition, self.known)
                if test_first:
                    self._jump(test, False, end)
                self.assembler.place(again)
                self._statement(body)
                self._jump(test, True, again)
                self.assembler.place(end)
            case Iterate(variable, body):
                again = self._loop_start(variable)
                self._statement(body)
                self._loop_next(variable, again)
            case Return(value):
                self._return(value)
                emit(Opcode.RETURN)
            case Assert(condition):
                self._value(fold(condition, self.known))
                emit(Opcode.ASSERT, span=condition.span)

    def _declare(self, variable: Variable, initial: Expression | None) -> None:
        slot = self.layout.first_slot(variable)
        if initial is None:
            for i, (_, type_) in enumerate(leaves(variable.type)):
                self.assembler.emit(Opcode.CONST, default_value(type_))
                self.assembler.emit(Opcode.STORE, slot + i)
        elif is_aggregate(variable.type):
            self._copy_into(slot, fold(initial, self.known), initial.span)
        else:
            self._value(fold(initial, self.known))
            self.assembler.emit(Opcode.STORE, slot, span=initial.span)

    def _return(self, value: Expression | None) -> None:
        assert self._current is not None
        if value is None:
            return
        result = self._current.result
        folded = fold(value, self.known)
        if is_aggregate(result):
            self._copy_into(self._result_slot(self._current), folded, value.span)
        elif isinstance(result, VoidType):
            self._effect(folded)
        else:
            self._value(folded)
            self.assembler.emit(Opcode.CHECK_RANGE, *cell_range(result), span=value.span)

    def _loop_start(self, variable: Variable) -> Label:
        low, _ = _value_range(variable)
        self.assembler.emit(Opcode.CONST, low)
        self.assembler.emit(Opcode.STORE, self.layout.first_slot(variable))
        again = Label()
        self.assembler.place(again)
        return again

    def _loop_next(self, variable: Variable, again: Label) -> None:
        """Goes on with the next value; falls through behind the last one."""
        emit, slot = self.assembler.emit, self.layout.first_slot(variable)
        _, high = _value_range(variable)
        end = Label()
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

    def _value(self, expression: Expression) -> None:
        """Pushes a number. The expression is folded already."""
        emit = self.assembler.emit
        match expression:
            case Constant(value):
                emit(Opcode.CONST, value)
            case Reference() | Index() | Field():
                if isinstance(expression.type, ClockType):
                    raise clock_comparison_unsupported(expression.span)
                slot = self.layout.known_slot(expression)
                if slot is not None:
                    emit(Opcode.LOAD, slot)
                else:
                    self._address(expression)
                    emit(Opcode.LOAD_INDIRECT)
            case Unary(operator, operand, _, span):
                self._value(operand)
                emit(Opcode.NOT if operator is UnaryOperator.NOT else Opcode.NEGATE, span=span)
            case Binary():
                self._binary(expression)
            case Conditional(condition, then, otherwise):
                other, end = Label(), Label()
                self._jump(condition, False, other)
                self._value(then)
                self.assembler.emit_to(Opcode.JUMP, end)
                self.assembler.place(other)
                self._value(otherwise)
                self.assembler.place(end)
            case Quantifier():
                self._quantifier(expression)
            case Assign(target):
                slot = self.layout.known_slot(target)
                if slot is not None:
                    self._effect(expression)
                    emit(Opcode.LOAD, slot)
                else:
                    self._address(target)
                    emit(Opcode.DUPLICATE)
                    self._store_through(expression)
                    emit(Opcode.LOAD_INDIRECT)
            case Increment():
                self._increment(expression)
            case Call():
                self._call(expression)
            case Comma(items):
                for item in items[:-1]:
                    self._effect(item)
                self._value(items[-1])
            case LocationTest(process, location):
                emit(Opcode.LOAD, process)
                emit(Opcode.CONST, location)
                emit(Opcode.EQUAL)
            case Deadlock() | Aggregate():
                raise TypeError(f"{type(expression).__name__} has no integer value")

    def _binary(self, expression: Binary) -> None:
        emit = self.assembler.emit
        operator, left, right, span = expression.operator, expression.left, expression.right, expression.span
        if operator is BinaryOperator.XOR:
            self._value(left)
            emit(Opcode.BOOLEAN)
            self._value(right)
            emit(Opcode.BOOLEAN)
            emit(Opcode.NOT_EQUAL)
        elif operator in CONNECTIVES:
            false, end = Label(), Label()
            self._jump(expression, False, false)
            emit(Opcode.CONST, 1)
            self.assembler.emit_to(Opcode.JUMP, end)
            self.assembler.place(false)
            emit(Opcode.CONST, 0)
            self.assembler.place(end)
        elif is_aggregate(left.type):
            self._stable_address(left, right)
            self._address(right)
            emit(Opcode.EQUAL_CELLS, cell_count(left.type))
            if operator is BinaryOperator.NOT_EQUAL:
                emit(Opcode.NOT)
        else:
            self._value(left)
            self._value(right)
            emit(_ARITHMETIC[operator], span=span)

    def _jump(self, expression: Expression, when: bool, label: Label) -> None:
        """Goes to the label if the truth of the expression is ``when``, else falls through."""
        match expression:
            case Constant(value):
                if (value != 0) == when:
                    self.assembler.emit_to(Opcode.JUMP, label)
            case Unary(UnaryOperator.NOT, operand):
                self._jump(operand, not when, label)
            case Binary(BinaryOperator.AND | BinaryOperator.OR | BinaryOperator.IMPLY as operator, left, right):
                left_decides = operator is BinaryOperator.OR  # the left truth that makes the right side superfluous
                if (operator is not BinaryOperator.AND) == when:
                    self._jump(left, left_decides, label)
                    self._jump(right, when, label)
                else:
                    end = Label()
                    self._jump(left, left_decides, end)
                    self._jump(right, when, label)
                    self.assembler.place(end)
            case _:
                self._value(expression)
                self.assembler.emit_to(Opcode.JUMP_IF_NONZERO if when else Opcode.JUMP_IF_ZERO, label)

    def _quantifier(self, expression: Quantifier) -> None:
        emit = self.assembler.emit
        if expression.kind is QuantifierKind.SUM:
            emit(Opcode.CONST, 0)
            again = self._loop_start(expression.variable)
            self._value(expression.body)
            emit(Opcode.ADD, span=expression.span)
            self._loop_next(expression.variable, again)
            return
        exists = expression.kind is QuantifierKind.EXISTS
        decided, end = Label(), Label()
        again = self._loop_start(expression.variable)
        self._jump(expression.body, exists, decided)
        self._loop_next(expression.variable, again)
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
        self._address(expression.target)
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

    def _effect(self, expression: Expression) -> None:
        """Evaluates an expression without keeping its value."""
        emit = self.assembler.emit
        match expression:
            case Assign(target):
                if is_aggregate(target.type):
                    self._assign_aggregate(expression)
                    return
                slot = self.layout.known_slot(target)
                if slot is None or isinstance(target.type, ClockType):
                    self._address(target)
                    self._store_through(expression)
                    return
                if expression.operator is not None:
                    emit(Opcode.LOAD, slot)
                self._value(expression.value)
                if expression.operator is not None:
                    emit(_ARITHMETIC[expression.operator], span=expression.span)
                emit(Opcode.STORE, slot, span=expression.span)
            case Comma(items):
                for item in items:
                    self._effect(item)
            case Call(function):
                self._call(expression)
                if is_integer(function.result):
                    emit(Opcode.POP)
            case Conditional(condition, then, otherwise) if not is_integer(expression.type):
                other, end = Label(), Label()
                self._jump(condition, False, other)
                self._effect(then)
                self.assembler.emit_to(Opcode.JUMP, end)
                self.assembler.place(other)
                self._effect(otherwise)
                self.assembler.place(end)
            case Constant():
                return
            case _ if is_integer(expression.type):
                self._value(expression)
                emit(Opcode.POP)
            case _:
                self._address(expression)
                emit(Opcode.POP)

    def _store_through(self, expression: Assign) -> None:
        """With the target's address on the stack: computes the value and stores it."""
        emit = self.assembler.emit
        if isinstance(expression.target.type, ClockType):
            emit(Opcode.LOAD_INDIRECT)
            self._value(expression.value)
            emit(Opcode.RESET, span=expression.span)
            return
        if expression.operator is not None:
            emit(Opcode.DUPLICATE)
            emit(Opcode.LOAD_INDIRECT)
        self._value(expression.value)
        if expression.operator is not None:
            emit(_ARITHMETIC[expression.operator], span=expression.span)
        emit(Opcode.STORE_INDIRECT, span=expression.span)

    # ---- places and aggregates --------------------------------------------------------------------------------------

    def _address(self, expression: Expression) -> None:
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
                self._address(base)
                self._value(index)
                stride = cell_count(base.type.element)
                emit(Opcode.INDEX, base.type.low, base.type.size, stride, span=span)
            case Field(base, name):
                assert isinstance(base.type, RecordType)
                self._address(base)
                offset = base.type.offset(name)
                if offset:
                    emit(Opcode.CONST, offset)
                    emit(Opcode.ADD)
            case Conditional(condition, then, otherwise):
                other, end = Label(), Label()
                self._jump(condition, False, other)
                self._address(then)
                self.assembler.emit_to(Opcode.JUMP, end)
                self.assembler.place(other)
                self._address(otherwise)
                self.assembler.place(end)
            case Comma(items):
                for item in items[:-1]:
                    self._effect(item)
                self._address(items[-1])
            case Assign(target) if is_aggregate(target.type):
                self._address(target)
                emit(Opcode.DUPLICATE)
                self._aggregate_value(expression.value)
                emit(Opcode.COPY, cell_count(target.type), span=expression.span)
            case Call(function) if is_aggregate(function.result):
                self._call(expression)
                temporary = self.layout.temporary(cell_count(function.result))
                emit(Opcode.CONST, temporary)
                emit(Opcode.CONST, self._result_slot(function))
                emit(Opcode.COPY, cell_count(function.result))
                emit(Opcode.CONST, temporary)
            case Aggregate(items):
                temporary = self.layout.temporary(cell_count(expression.type))
                self._fill(temporary, items)
                emit(Opcode.CONST, temporary)
            case _:
                temporary = self.layout.temporary(1)
                self._value(expression)
                emit(Opcode.STORE, temporary)
                emit(Opcode.CONST, temporary)

    def _fill(self, slot: int, items: tuple[Expression, ...]) -> None:
        for item in items:
            cells = cell_count(item.type)
            if is_aggregate(item.type):
                self.assembler.emit(Opcode.CONST, slot)
                self._address(item)
                self.assembler.emit(Opcode.COPY, cells)
            else:
                self._value(item)
                self.assembler.emit(Opcode.STORE, slot)
            slot += cells

    def _stable_address(self, expression: Expression, later: Expression) -> None:
        """Like `_address`, but what is evaluated later cannot change the cells any more."""
        if any(isinstance(node, Assign | Increment | Call) for node in walk(later)):
            temporary = self.layout.temporary(cell_count(expression.type))
            self._copy_into(temporary, expression, expression.span)
            self.assembler.emit(Opcode.CONST, temporary)
        else:
            self._address(expression)

    def _aggregate_value(self, expression: Expression) -> None:
        _refuse_clock_cells(expression)
        self._address(expression)

    def _assign_aggregate(self, expression: Assign) -> None:
        self._address(expression.target)
        self._aggregate_value(expression.value)
        self.assembler.emit(Opcode.COPY, cell_count(expression.target.type), span=expression.span)

    def _copy_into(self, slot: int, value: Expression, span: Span) -> None:
        self.assembler.emit(Opcode.CONST, slot)
        self._aggregate_value(value)
        self.assembler.emit(Opcode.COPY, cell_count(value.type), span=span)


def _value_range(variable: Variable) -> tuple[int, int]:
    assert isinstance(variable.type, IntType | BoolType | ScalarType)
    return bounds(variable.type)


def _contains_clocks(type_: Type) -> bool:
    return any(isinstance(leaf, ClockType | ChannelType) for _, leaf in leaves(type_))


def _refuse_clock_cells(expression: Expression) -> None:
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
