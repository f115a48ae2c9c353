"""The parts of the language that plain random networks do without: arrays, records, functions, and what can fail."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from random import Random

from tachk.base.operators import BinaryOperator
from tachk.model.builder import NetworkBuilder, Operand, Term, bound_variable, conditional, expression_of, quantifier
from tachk.model.expressions import (
    INT,
    Binary,
    Block,
    Call,
    Constant,
    Declare,
    Evaluate,
    Function,
    If,
    Iterate,
    QuantifierKind,
    Reference,
    Return,
    Statement,
    Variable,
    VariableKind,
    While,
)
from tachk.model.types import ArrayType, ClockType, IntType, RecordType, Type, VoidType

TOP = 2
"""All integers of random networks range over ``[0, TOP]``."""

_SMALL = IntType(0, TOP)
_CELLS = ArrayType(_SMALL, IntType(0, TOP))
_PAIR = RecordType("pair", (("first", _SMALL), ("rest", ArrayType(_SMALL, IntType(1, 2)))))
_FAILS = 0.3
"""The share of expressions that may fail in a network in which some may."""


@dataclass(slots=True)
class Language:
    """Draws expressions over a network's variables; all values lie in ``[0, TOP]`` unless something fails.

    Attributes:
        may_fail: expressions may leave a range or an array, divide by 0, shift too far, or set a clock below 0.
    """

    random: Random
    integers: Sequence[Term]
    clocks: Sequence[Term]
    may_fail: bool
    cells: Term
    pair: Term
    functions: list[Function] = field(default_factory=list)
    procedures: list[Function] = field(default_factory=list)

    # ---- values ---------------------------------------------------------------------------------------------------

    def value(self, depth: int = 2) -> Term:
        """An integer in ``[0, TOP]``; one that may fail is in it where it does not."""
        if self.may_fail and self.random.random() < _FAILS:
            return self._dangerous()
        kinds = ["plain", "cell", "field", "remainder", "choice", "smaller", "call", "call", "sum"]
        match self.random.choice(kinds) if depth > 0 else "plain":
            case "cell":
                return self.cells[self.value(depth - 1)]
            case "field":
                return self._field()
            case "remainder":
                return (self.value(depth - 1) + self.random.randint(1, 2)) % (TOP + 1)
            case "choice":
                return conditional(self.condition(depth - 1), self.value(depth - 1), self.value(depth - 1))
            case "smaller":
                return self.value(depth - 1) * self.value(depth - 1) // 2
            case "call" if self.functions:
                function = self.random.choice(self.functions)
                return _call(function, [self.value(depth - 1) for _ in function.parameters])
            case "sum":
                i = bound_variable("i", IntType(0, TOP))
                return quantifier(QuantifierKind.SUM, i, self.cells[i]) % (TOP + 1)
            case _:
                return self._plain()

    def _plain(self) -> Term:
        return self.random.choice(self.integers)

    def _field(self) -> Term:
        if self.random.random() < 0.5:
            return self.pair.field("first")
        return self.pair.field("rest")[self.random.randint(1, 2)]

    def _dangerous(self) -> Term:
        """Something that fails for some values of the variables, and else is in ``[0, TOP]``."""
        n, m = self._plain(), self._plain()
        return self.random.choice(
            [
                self.cells[n + 1],
                self.cells[n - 1],
                self.cells[n + m],
                self.pair.field("rest")[n],
                n // m,
                n % m,
                _with(BinaryOperator.SHIFT_LEFT, Term(Constant(1)), n - 1) % (TOP + 1),
            ]
        )

    def bound(self) -> Term:
        """An integer to compare clocks with, also below 0 or beyond TOP: its interval decides how far zones reach."""
        if self.random.random() < 0.5:
            return self.value()
        a, b = self.value(1), self.value(1)
        return self.random.choice(
            [
                a * b,
                a * 2 - b,
                (a - b) % 2 + 1,
                (a + 2) // (b + 1),
                _with(BinaryOperator.SHIFT_LEFT, a, b),
                _with(BinaryOperator.BIT_OR, a, b),
                _with(BinaryOperator.BIT_XOR, a, b) + a,
                _with(BinaryOperator.MAXIMUM, a, b) - _with(BinaryOperator.MINIMUM, a, b),
            ]
        )

    def condition(self, depth: int = 1) -> Term:
        """A condition on integers."""
        left, right = self.value(depth), self.random.randint(0, TOP)
        plain = self.random.choice([left == right, left != right, left < right + 1, left >= right])
        match self.random.choice(["plain", "plain", "and", "or", "imply", "not", "forall", "exists"]):
            case "and":
                return plain & self._simple()
            case "or":
                return self._simple() | plain
            case "imply":
                return self._simple().implies(plain)
            case "not":
                return ~plain
            case "forall" | "exists" as kind:
                i = bound_variable("i", IntType(0, TOP))
                which = QuantifierKind.FORALL if kind == "forall" else QuantifierKind.EXISTS
                return quantifier(which, i, self.cells[i] != right)
            case _:
                return plain

    def _simple(self) -> Term:
        return self._plain() == self.random.randint(0, TOP)

    def channel_index(self) -> Term:
        """The index of an array of two channels."""
        if self.may_fail and self.random.random() < _FAILS:
            return self._plain()
        return self.value(1) % 2

    # ---- updates --------------------------------------------------------------------------------------------------

    def update(self) -> Term:
        kinds = ["integer", "integer", "cell", "field", "record", "procedure", "clock", "one clock", "choice", "danger"]
        match self.random.choice(kinds):
            case "cell":
                return self.cells[self.value(1)].assign(self.value())
            case "field":
                return self._field().assign(self.value())
            case "record":
                return self.pair.assign(self.pair) if self.random.random() < 0.2 else self.cells.assign(self.cells)
            case "procedure" if self.procedures:
                function = self.random.choice(self.procedures)
                return _call(function, [self._plain() if p.reference else self.value(1) for p in function.parameters])
            case "clock":
                return self.random.choice(self.clocks).assign(self.value(1))
            case "one clock":
                left, right = self.random.choice(self.clocks), self.random.choice(self.clocks)
                return conditional(self.condition(), left.assign(0), right.assign(self.random.randint(0, 2)))
            case "choice":
                return conditional(
                    self.condition(), self._plain().assign(self.value(1)), self._plain().assign(self.value(1))
                )
            case "danger" if self.may_fail:
                n, m = self._plain(), self._plain()
                return self.random.choice(
                    [n.assign(n + 1), n.assign(n - m), self.random.choice(self.clocks).assign(n - 1), n.assign(n + m)]
                )
            case _:
                return self._plain().assign(self.value())

    # ---- functions ------------------------------------------------------------------------------------------------

    def add_functions(self) -> None:
        """Two functions that return a value, two that change variables; later ones may call earlier ones."""
        self.functions.append(self._search())
        self.functions.append(self.random.choice([self._count, self._either])())
        self.procedures.append(self._fill())
        self.procedures.append(self._step())

    def _search(self) -> Function:
        """The place of the first cell that has a value: a loop that is left early."""
        wanted, i = _frame("wanted"), _bound("i")
        found = If((self.cells[_term(i)] == _term(wanted)).expression, _return(_term(i)))
        return _function("search", [wanted], [Iterate(i, found), _return(self.value(1))], _SMALL)

    def _count(self) -> Function:
        """Counts up to a limit, or to where a condition holds."""
        limit, total = _frame("limit"), _frame("total")
        step = Evaluate(_term(total).assign(_term(total) + 1).expression)
        stop = If(((_term(total) == self.random.randint(1, TOP)) & self._simple()).expression, _return(_term(total)))
        loop = While((_term(total) < _term(limit)).expression, Block((stop, step)))
        return _function("count", [limit], [Declare(total), loop, _return(_term(total))], _SMALL)

    def _either(self) -> Function:
        left, right = _frame("left"), _frame("right")
        first = If((_term(left) > _term(right)).expression, _return(_term(left)))
        second = If(self.condition().expression, _return(_term(right)), _return(self.value(1)))
        return _function("either", [left, right], [first, second], _SMALL)

    def _fill(self) -> Function:
        """Writes cells up to a condition, backwards or forwards."""
        value, i = _frame("value"), _bound("i")
        stop = If((self.cells[_term(i)] == _term(value)).expression, Return())
        write = Evaluate(self.cells[TOP - _term(i)].assign(_term(value)).expression)
        return _function("fill", [value], [Iterate(i, Block((stop, write)))], VoidType())

    def _step(self) -> Function:
        """Changes a variable that is given by reference, and perhaps a clock."""
        target = _frame("target", reference=True)
        body: list[Statement] = [Evaluate(_term(target).assign((_term(target) + 1) % (TOP + 1)).expression)]
        if self.random.random() < 0.5:
            clock = self.random.choice(self.clocks)
            body.append(If(self.condition().expression, Evaluate(clock.assign(self.random.randint(0, 2)).expression)))
        return _function("step", [target], body, VoidType())


def random_language(
    random: Random, network: NetworkBuilder, integers: Sequence[Term], clocks: Sequence[Term], may_fail: bool
) -> Language:
    """Declares an array, a record and functions, and gives what can be said with them."""
    cells = network.declare("cells", _CELLS, [random.randint(0, TOP) for _ in range(TOP + 1)])
    pair = network.declare("pair", _PAIR, [random.randint(0, TOP) for _ in range(3)])
    language = Language(random, integers, clocks, may_fail, cells, pair)
    language.add_functions()
    return language


def random_copy(
    random: Random, clocks: Sequence[Term], condition: Callable[[], Term], offset: Callable[[], Term | int]
) -> Term:
    """An assignment or a call, with a condition and an offset now and then."""
    target, source = random.choice(clocks), random.choice(clocks)
    kind = random.random()
    if kind < 0.1:
        source = conditional(condition(), source, random.choice(clocks))
    elif kind < 0.2:
        target = conditional(condition(), target, random.choice(clocks))
    elif kind < 0.3:
        return _through_function(target, source, offset())
    return target.assign(source if random.random() < 0.4 else source + offset())


def _through_function(target: Term, source: Term, offset: Term | int) -> Term:
    """A call that sets one clock to another one, and that one to it."""
    parameters = tuple(Variable(name, ClockType(), VariableKind.FRAME, reference=True) for name in ("a", "b"))
    first, second = (Term(Reference(parameter)) for parameter in parameters)
    body = Block((Evaluate(first.assign(second + offset).expression), Evaluate(second.assign(first).expression)))
    function = Function("exchange", parameters, VoidType(), body)
    return Term(Call(function, (target.expression, expression_of(source)), VoidType()))


def _with(operator: BinaryOperator, left: Term, right: Term) -> Term:
    return Term(Binary(operator, left.expression, right.expression, INT))


def _call(function: Function, arguments: Sequence[Operand]) -> Term:
    return Term(Call(function, tuple(map(expression_of, arguments)), function.result))


def _frame(name: str, reference: bool = False) -> Variable:
    return Variable(name, _SMALL, VariableKind.FRAME, reference=reference)


def _bound(name: str) -> Variable:
    return Variable(name, IntType(0, TOP), VariableKind.BOUND)


def _term(variable: Variable) -> Term:
    return Term(Reference(variable))


def _return(value: Term) -> Return:
    return Return(value.expression)


def _function(name: str, parameters: Sequence[Variable], body: Sequence[Statement], result: Type) -> Function:
    return Function(name, tuple(parameters), result, Block(tuple(body)))
