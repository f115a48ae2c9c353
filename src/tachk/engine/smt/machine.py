"""Symbolic execution of statements and functions.

Branches are executed apart and joined, so that a loop over numbers that are known is unrolled and ends.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import assert_never

from tachk.base.time_limit import check_time
from tachk.engine.smt.evaluator import Evaluator, ranges_of, refused
from tachk.engine.smt.storage import Cell, place_at
from tachk.engine.smt.terms import Formula, SymbolicNumber, any_of, choose, conj, constant, disj, neg
from tachk.model.cell_layout import default_cells
from tachk.model.expressions import (
    Assert,
    Block,
    Call,
    Declare,
    Evaluate,
    Expression,
    If,
    Iterate,
    Return,
    Statement,
    While,
)
from tachk.model.fault import RuntimeErrorKind
from tachk.model.types import BoolType, IntType, ScalarType, Type, VoidType, bounds

ROUNDS = 512
"""A loop that may take more than these rounds is refused."""


@dataclass(slots=True)
class Machine(Evaluator):
    """Attributes:
    returned: where the current function has returned, with what, and what cells held then.
    """

    returned: list[tuple[Formula, tuple[SymbolicNumber, ...], dict[Cell, SymbolicNumber]]] = field(default_factory=list)

    def execute(self, updates: Iterable[Expression]) -> None:
        for update in updates:
            self.cells(update)

    def call(self, expression: Call) -> tuple[SymbolicNumber, ...]:
        function = expression.function
        if function.operation is not None:
            raise refused("floating point arithmetic", expression.span)
        places = []
        for parameter, argument in zip(function.parameters, expression.arguments, strict=True):
            if parameter.reference:
                places.append(self.place(argument))
            else:
                values = self.cells(argument)
                defaults = [constant(v) for v in default_cells(parameter.type)]
                place = place_at(self.storage.new_segment(defaults, ranges_of(parameter.type)))
                self._write(place, values, argument.span)
                places.append(place)
        self.frame.update(zip(function.parameters, places, strict=True))
        outer_returned, self.returned = self.returned, []
        path, segments = self.path, self.storage.segments
        goes_on = self._run(function.body, function.result)
        self.doomed = not self.returned and goes_on is False
        exits = [(condition, snapshot) for condition, _, snapshot in self.returned]
        if goes_on is not False:
            exits.append((conj(path, goes_on), self.storage.snapshot()))
        self.storage.continue_from(exits, segments)
        result: tuple[SymbolicNumber, ...] = ()
        for condition, values, _ in reversed(self.returned):
            result = tuple(choose(condition, a, b) for a, b in zip(values, result, strict=True)) if result else values
        self.returned, self.path = outer_returned, path
        if not result and not isinstance(function.result, VoidType):
            return tuple(constant(v) for v in default_cells(function.result))
        return result

    def _run(self, statement: Statement, result: Type) -> Formula:
        """Executes a statement; whether control goes on behind it."""
        doomed, self.doomed = self.doomed, False
        goes_on = self._control_of(statement, result)
        if self.doomed:
            goes_on = False
        self.doomed = doomed
        return goes_on

    def _control_of(self, statement: Statement, result: Type) -> Formula:
        match statement:
            case Evaluate(expression):
                self.cells(expression)
            case Declare(variable, initial):
                defaults = [constant(v) for v in default_cells(variable.type)]
                place = place_at(self.storage.new_segment(defaults, ranges_of(variable.type)))
                if initial is not None:
                    self._write(place, self.cells(initial), initial.span)
                self.frame[variable] = place
            case Block(statements):
                return self._sequence(len(statements), lambda number: self._run(statements[number], result))
            case If(condition, then, otherwise):
                return self._branch(self.truth(condition), then, otherwise, result)
            case While(condition, body, test_first):
                return self._loop(condition, body, test_first, result)
            case Iterate(variable, body):
                assert isinstance(variable.type, IntType | BoolType | ScalarType)
                low, high = bounds(variable.type)

                def turn(number: int) -> Formula:
                    self.bind(variable, low + number)
                    return self._run(body, result)

                return self._sequence(high - low + 1, turn)
            case Return(value):
                values = () if value is None else self.cells(value)
                if value is not None:
                    place = place_at(self.storage.new_segment(values, ranges_of(result)))
                    self._write(place, values, value.span)
                    values = self._read(place, len(values))
                self.returned.append((self.path, values, self.storage.snapshot()))
                return False
            case Assert(condition):
                self.goes_wrong(neg(self.truth(condition)), RuntimeErrorKind.ASSERT, condition.span)
            case _ as never:
                assert_never(never)
        return True

    def _sequence(self, count: int, run: Callable[[int], Formula]) -> Formula:
        """Executes one thing after another as long as control goes on."""
        outer, goes_on = self.path, True
        alive: Formula = goes_on
        for number in range(count):
            check_time()
            self.path = conj(outer, alive)
            if self.path is False:
                break
            alive = conj(alive, run(number))
        self.path = outer
        return alive

    def _branch(self, test: Formula, then: Statement, otherwise: Statement | None, result: Type) -> Formula:
        def side(condition: Formula, statement: Statement | None) -> Formula:
            if statement is None:
                return True
            outer, self.path = self.path, conj(self.path, condition)
            goes_on = self._run(statement, result)
            self.path = outer
            return goes_on

        if isinstance(test, bool):
            return side(True, then if test else otherwise)
        first, then_changes = self.storage.apart(lambda: side(test, then))
        second, other_changes = self.storage.apart(lambda: side(neg(test), otherwise))
        if first is False:
            self.storage.apply(other_changes)
        elif second is False:
            self.storage.apply(then_changes)
        else:
            self.storage.join(test, then_changes, other_changes)
        return disj(conj(test, first), conj(neg(test), second))

    def _loop(self, condition: Expression, body: Statement, test_first: bool, result: Type) -> Formula:
        outer, segments = self.path, self.storage.segments
        exits: list[tuple[Formula, dict[Cell, SymbolicNumber]]] = []
        alive: Formula = True
        for number in range(ROUNDS + 1):
            check_time()
            if test_first or number > 0:
                self.path = conj(outer, alive)
                again = self.truth(condition)
                if again is not True:
                    exits.append((conj(alive, neg(again)), self.storage.snapshot()))
                alive = conj(alive, again)
            self.path = conj(outer, alive)
            if alive is False or self.path is False:
                break
            alive = conj(alive, self._run(body, result))
        else:
            raise refused(f"a loop that may take more than {ROUNDS} rounds", condition.span)
        self.path = outer
        if exits:
            self.storage.continue_from(exits, segments)
        return any_of(condition for condition, _ in exits)
