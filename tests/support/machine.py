"""An interpreter of program code, written for clarity: the oracle for the core's virtual machine."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from tachk.base.diagnostics.diagnostic import InternalError
from tachk.base.operators import CONNECTIVES, BinaryOperator, OperandError, UnaryOperator
from tachk.base.span import NOWHERE, Span
from tachk.engine.compiler.bytecode import Opcode
from tachk.engine.compiler.program import Program
from tachk.model.fault import EvaluationFault, RuntimeErrorKind
from tachk.model.floating import DOUBLE, FloatingOperation, halves, number_of

INSTRUCTION_LIMIT = 2**24

_OPERANDS = {
    Opcode.CONST: 1,
    Opcode.LOAD: 1,
    Opcode.STORE: 1,
    Opcode.INDEX: 3,
    Opcode.COPY: 1,
    Opcode.EQUAL_SLOTS: 1,
    Opcode.JUMP: 1,
    Opcode.JUMP_IF_ZERO: 1,
    Opcode.JUMP_IF_NONZERO: 1,
    Opcode.CALL: 1,
    Opcode.CHECK_RANGE: 2,
    Opcode.FLOATING: 2,
}
_MEMORY = frozenset(
    {Opcode.LOAD, Opcode.LOAD_INDIRECT, Opcode.STORE, Opcode.STORE_INDIRECT}
    | {Opcode.COPY, Opcode.EQUAL_SLOTS, Opcode.RESET, Opcode.COPY_CLOCK, Opcode.ADVANCE_CLOCK, Opcode.FLOATING}
)
_BINARY = {Opcode[operator.name]: operator for operator in BinaryOperator if operator not in CONNECTIVES}


@dataclass(slots=True)
class Machine:
    """Attributes:
    slots: the content of every slot, frame slots included; code changes it in place.
    resets: the clocks that code has set so far: clock number to the clock whose value before the code it has (0 for
        none), and how much more.
    """

    program: Program
    slots: list[int]
    resets: dict[int, tuple[int, int]] = field(default_factory=dict)

    def run(self, position: int) -> int | None:
        """Runs a piece of code; its value, if it leaves one. Raises EvaluationFault."""
        code = self.program.code
        stack: list[int] = []
        returns: list[int] = []
        for _ in range(INSTRUCTION_LIMIT):
            opcode = Opcode(code[position])
            count = _OPERANDS.get(opcode, 0)
            operands = code[position + 1 : position + 1 + count]
            after = position + 1 + count
            match opcode:
                case Opcode.END:
                    if returns or len(stack) > 1:
                        raise InternalError(f"code ends with {len(stack)} values on the stack")
                    return stack[0] if stack else None
                case Opcode.JUMP:
                    after = operands[0]
                case Opcode.JUMP_IF_ZERO:
                    after = operands[0] if stack.pop() == 0 else after
                case Opcode.JUMP_IF_NONZERO:
                    after = operands[0] if stack.pop() != 0 else after
                case Opcode.CALL:
                    returns.append(after)
                    after = operands[0]
                case Opcode.RETURN:
                    after = returns.pop()
                case _ if opcode in _MEMORY:
                    self._access(opcode, operands, stack, position)
                case _:
                    self._compute(opcode, operands, stack, position)
            position = after
        raise self._fault(RuntimeErrorKind.LOOP, position)

    def _access(self, opcode: Opcode, operands: Sequence[int], stack: list[int], position: int) -> None:
        """Executes what reads or writes slots and clocks."""
        slots = self.slots
        match opcode:
            case Opcode.LOAD:
                stack.append(slots[operands[0]])
            case Opcode.LOAD_INDIRECT:
                stack.append(slots[stack.pop()])
            case Opcode.STORE:
                self._store(operands[0], stack.pop(), position)
            case Opcode.STORE_INDIRECT:
                value = stack.pop()
                self._store(stack.pop(), value, position)
            case Opcode.COPY:
                source = stack.pop()
                target = stack.pop()
                values = slots[source : source + operands[0]]
                for i, value in enumerate(values):
                    self._store(target + i, value, position)
            case Opcode.EQUAL_SLOTS:
                right = stack.pop()
                left = stack.pop()
                stack.append(int(slots[left : left + operands[0]] == slots[right : right + operands[0]]))
            case Opcode.RESET:
                value = stack.pop()
                clock = stack.pop()
                if value < 0:
                    raise self._fault(RuntimeErrorKind.NEGATIVE_CLOCK, position)
                self.resets[clock] = 0, value
            case Opcode.COPY_CLOCK:
                source = stack.pop()
                self.resets[stack.pop()] = self.resets.get(source, (source, 0))
            case Opcode.ADVANCE_CLOCK:
                value = stack.pop()
                clock = stack.pop()
                if value < 0:
                    raise self._fault(RuntimeErrorKind.NEGATIVE_CLOCK, position)
                source, before = self.resets.get(clock, (clock, 0))
                self.resets[clock] = source, before + value
            case Opcode.FLOATING:
                operation = FloatingOperation(operands[0])
                given = [stack.pop(), stack.pop()][::-1][: len(operation.parameters)]
                whole = operation is FloatingOperation.FROM_INTEGER
                result = operation.compute([n if whole else number_of(slots[n : n + 2]) for n in given])
                if result is None:
                    raise self._fault(RuntimeErrorKind.NOT_FINITE, position)
                if operation.result == DOUBLE:
                    slots[operands[1] : operands[1] + 2] = halves(result)
                    result = operands[1]
                stack.append(int(result))
            case _:
                raise InternalError(f"{opcode.name} does not access memory")

    def _compute(self, opcode: Opcode, operands: Sequence[int], stack: list[int], position: int) -> None:
        """Executes what looks at the stack only."""
        match opcode:
            case Opcode.CONST:
                stack.append(operands[0])
            case Opcode.INDEX:
                low, size, stride = operands
                index = stack.pop() - low
                if not 0 <= index < size:
                    raise self._fault(RuntimeErrorKind.INDEX, position)
                stack.append(stack.pop() + index * stride)
            case Opcode.DUPLICATE:
                stack.append(stack[-1])
            case Opcode.POP:
                stack.pop()
            case Opcode.SWAP:
                stack[-1], stack[-2] = stack[-2], stack[-1]
            case Opcode.OVER:
                stack.append(stack[-2])
            case Opcode.NEGATE:
                stack[-1] = UnaryOperator.MINUS.compute(stack[-1])
            case Opcode.NOT:
                stack[-1] = UnaryOperator.NOT.compute(stack[-1])
            case Opcode.BOOLEAN:
                stack[-1] = int(stack[-1] != 0)
            case Opcode.ASSERT:
                if stack.pop() == 0:
                    raise self._fault(RuntimeErrorKind.ASSERT, position)
            case Opcode.CHECK_RANGE:
                if not operands[0] <= stack[-1] <= operands[1]:
                    raise self._fault(RuntimeErrorKind.RANGE, position)
            case _:
                right = stack.pop()
                left = stack.pop()
                stack.append(self._binary(opcode, left, right, position))

    def _binary(self, opcode: Opcode, left: int, right: int, position: int) -> int:
        try:
            return _BINARY[opcode].compute(left, right)
        except OperandError as error:
            raise self._fault(RuntimeErrorKind[error.failure.name], position) from None

    def _store(self, slot: int, value: int, position: int) -> None:
        if not self.program.slots[slot].low <= value <= self.program.slots[slot].high:
            raise self._fault(RuntimeErrorKind.RANGE, position)
        self.slots[slot] = value

    def _fault(self, kind: RuntimeErrorKind, position: int) -> EvaluationFault:
        return EvaluationFault(kind, site(self.program, position))


def initial_slots(program: Program) -> list[int]:
    """The content of the slots in the initial state."""
    return [slot.initial for slot in program.slots]


def site(program: Program, position: int) -> Span:
    """The place in the text an instruction comes from."""
    sites: Sequence[tuple[int, Span]] = program.sites
    low, high = 0, len(sites)
    while low < high:
        middle = (low + high) // 2
        if sites[middle][0] <= position:
            low = middle + 1
        else:
            high = middle
    return sites[low - 1][1] if low else NOWHERE
