"""Random expressions and updates in the whole language, each node with a place of its own in the text."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace

from hypothesis import strategies as st

from tachk.base.operators import BinaryOperator, OperandGroup, UnaryOperator
from tachk.base.span import Source, Span
from tachk.model.expressions import (
    BOOL,
    INT,
    Aggregate,
    Assert,
    Assign,
    Binary,
    Block,
    Call,
    Comma,
    Conditional,
    Constant,
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
    Variable,
    VariableKind,
    While,
)
from tachk.model.types import ArrayType, BoolType, ClockType, IntType, RecordType, Type

SMALL = IntType(-3, 6)
RECORD = RecordType("pair", (("p", SMALL), ("q", ArrayType(SMALL, IntType(1, 2)))))

COUNT = Variable("count", SMALL, VariableKind.GLOBAL, (1,))
WIDE = Variable("wide", IntType(-(2**31), 2**31 - 1), VariableKind.GLOBAL, (2**31 - 1,))
FLAG = Variable("flag", BoolType(), VariableKind.GLOBAL, (1,))
TABLE = Variable("table", ArrayType(SMALL, IntType(0, 3)), VariableKind.GLOBAL, (3, 0, -1, 2))
FIXED = Variable("fixed", ArrayType(IntType(), IntType(0, 2)), VariableKind.GLOBAL, (100, 200, 1))
ONE = Variable("one", RECORD, VariableKind.GLOBAL, (1, 2, 3))
MANY = Variable("many", ArrayType(RECORD, IntType(-1, 0)), VariableKind.GLOBAL, (0, 1, 2, 3, 4, 5))
CLOCKS = Variable("clocks", ArrayType(ClockType(), IntType(0, 2)), VariableKind.GLOBAL, (0, 0, 0))
VARIABLES = (COUNT, WIDE, FLAG, TABLE, FIXED, ONE, MANY, CLOCKS)

_SOURCE = Source("test", "x" * 10)
_numbers = itertools.count()


def span() -> Span:
    """A place of its own for every node, so that the place of an error can be compared."""
    number = next(_numbers)
    return Span(_SOURCE, number, number + 1)


ARITHMETIC = [each for each in BinaryOperator if each.group is OperandGroup.ARITHMETIC]
COMPARISONS = [each for each in BinaryOperator if each.group is OperandGroup.COMPARISON]
LOGIC = [each for each in BinaryOperator if each.group is OperandGroup.CONNECTIVE]


class Drawer:
    """Draws expressions over the variables above and those in scope."""

    def __init__(self, draw: st.DrawFn, effects: bool = True, functions: int = 2) -> None:
        self.draw = draw
        self.effects = effects
        self.scope: list[Variable] = []
        self.functions = functions

    def pick(self, choices: Sequence[str]) -> str:
        return self.draw(st.sampled_from(list(choices)))

    def integer(self, depth: int) -> Expression:
        kinds = ["constant", "place"]
        if depth > 0:
            kinds += ["arithmetic", "minus", "conditional", "sum", "boolean", "place"]
            if self.effects:
                kinds += ["assign", "increment", "comma"]
                if self.functions:
                    kinds += ["call"]
        match self.pick(kinds):
            case "constant":
                return Constant(self.draw(st.integers(-3, 5) | st.sampled_from([31, 32, 2**31 - 1, -(2**31)])), INT)
            case "place":
                return self.place(depth - 1)
            case "arithmetic":
                operator = self.draw(st.sampled_from(ARITHMETIC))
                return Binary(operator, self.integer(depth - 1), self.integer(depth - 1), INT, span())
            case "minus":
                return Unary(UnaryOperator.MINUS, self.integer(depth - 1), INT, span())
            case "conditional":
                return Conditional(
                    self.boolean(depth - 1), self.integer(depth - 1), self.integer(depth - 1), INT, span()
                )
            case "sum":
                return self.quantifier(QuantifierKind.SUM, depth)
            case "assign":
                return self.assign(depth)
            case "increment":
                prefix = self.draw(st.booleans())
                return Increment(self.place(depth - 1), self.draw(st.sampled_from([1, -1])), prefix, INT, span())
            case "comma":
                return Comma((self.effect(depth - 1), self.integer(depth - 1)), INT, span())
            case "call":
                return self.call(depth)
            case _:
                return self.boolean(depth - 1)

    def boolean(self, depth: int) -> Expression:
        kinds = ["flag", "location", "comparison"]
        if depth > 0:
            kinds += ["logic", "logic", "not", "forall", "exists", "aggregates", "integer"]
        match self.pick(kinds):
            case "flag":
                return Reference(FLAG, span())
            case "location":
                return LocationTest(0, self.draw(st.integers(0, 1)))
            case "logic":
                operator = self.draw(st.sampled_from(LOGIC))
                return Binary(operator, self.boolean(depth - 1), self.boolean(depth - 1), BOOL, span())
            case "not":
                return Unary(UnaryOperator.NOT, self.boolean(depth - 1), BOOL, span())
            case "forall":
                return self.quantifier(QuantifierKind.FORALL, depth)
            case "exists":
                return self.quantifier(QuantifierKind.EXISTS, depth)
            case "aggregates":
                operator = self.draw(st.sampled_from(COMPARISONS[:2]))
                return Binary(operator, self.record(depth - 1), self.record(depth - 1), BOOL, span())
            case "integer":
                return self.integer(depth - 1)
            case _:
                operator = self.draw(st.sampled_from(COMPARISONS))
                return Binary(operator, self.integer(depth - 1), self.integer(depth - 1), BOOL, span())

    def quantifier(self, kind: QuantifierKind, depth: int) -> Expression:
        low = self.draw(st.integers(-1, 2))
        variable = Variable("q", IntType(low, low + self.draw(st.integers(0, 3))), VariableKind.BOUND)
        self.scope.append(variable)
        body = self.integer(depth - 1) if kind is QuantifierKind.SUM else self.boolean(depth - 1)
        self.scope.pop()
        return Quantifier(kind, variable, body, INT if kind is QuantifierKind.SUM else BOOL, span())

    def read_only(self, depth: int) -> Expression:
        choices: list[Expression] = [Constant(self.draw(st.integers(-1, 3)))]
        choices += [Reference(v) for v in self.scope if not isinstance(v.type, ArrayType | RecordType)]
        return self.draw(st.sampled_from(choices)) if depth <= 0 else self.integer(depth - 1)

    def place(self, depth: int) -> Expression:
        """An assignable place that holds an integer."""
        arrays = [v for v in self.scope if isinstance(v.type, ArrayType) and v.kind is VariableKind.FRAME]
        scalars = [v for v in self.scope if v.type == SMALL and v.kind is VariableKind.FRAME]
        records = [v for v in self.scope if isinstance(v.type, RecordType)]
        match self.pick(["count", "table", "one", "many", "wide", "conditional", "frame", "fixed"]):
            case "wide":
                return Reference(WIDE)
            case "table":
                return Index(Reference(TABLE), self.read_only(depth), SMALL, span())
            case "fixed" if not self.effects:
                return Index(Reference(FIXED), self.read_only(depth), INT, span())
            case "one":
                return Field(Reference(self.draw(st.sampled_from([ONE, *records]))), "p", SMALL, span())
            case "many":
                inner = Index(Reference(MANY), self.read_only(depth), RECORD, span())
                fields = Field(inner, "q", ArrayType(SMALL, IntType(1, 2)), span())
                return Index(fields, self.read_only(depth), SMALL, span())
            case "conditional" if depth > 0:
                return Conditional(self.boolean(0), self.place(depth - 1), self.place(depth - 1), SMALL, span())
            case "frame" if arrays:
                return Index(Reference(self.draw(st.sampled_from(arrays))), self.read_only(depth), SMALL, span())
            case "frame" if scalars:
                return Reference(self.draw(st.sampled_from(scalars)))
            case _:
                return Reference(COUNT)

    def record_place(self, depth: int) -> Expression:
        records = [v for v in self.scope if isinstance(v.type, RecordType)]
        match self.pick(["one", "many", "conditional"]):
            case "many":
                return Index(Reference(MANY), self.read_only(depth), RECORD, span())
            case "conditional" if depth > 0:
                return Conditional(
                    self.boolean(0), self.record_place(depth - 1), self.record_place(depth - 1), RECORD, span()
                )
            case _:
                return Reference(self.draw(st.sampled_from([ONE, *records])))

    def record(self, depth: int) -> Expression:
        kinds = ["place"]
        if depth > 0:
            kinds += ["literal"]
            if self.effects:
                kinds += ["assign", "comma"]
                if self.functions:
                    kinds += ["call"]
        match self.pick(kinds):
            case "literal":
                pair = Aggregate((self.integer(depth - 1), self.integer(depth - 1)), ArrayType(SMALL, IntType(1, 2)))
                return Aggregate((self.integer(depth - 1), pair), RECORD, span())
            case "assign":
                return Assign(self.record_place(depth - 1), self.record(depth - 1), RECORD, span=span())
            case "comma":
                return Comma((self.effect(depth - 1), self.record(depth - 1)), RECORD, span())
            case "call":
                return self.call(depth, RECORD)
            case _:
                return self.record_place(depth)

    def assign(self, depth: int) -> Expression:
        operator = self.draw(st.none() | st.sampled_from(ARITHMETIC))
        return Assign(self.place(depth - 1), self.integer(depth - 1), SMALL, operator, span())

    def effect(self, depth: int) -> Expression:
        match self.pick(["assign", "record", "clock", "increment", "integer"]):
            case "record":
                return Assign(self.record_place(depth - 1), self.record(depth - 1), RECORD, span=span())
            case "clock":
                clock = Index(Reference(CLOCKS), self.read_only(depth - 1), ClockType(), span())
                value: Expression = Binary(BinaryOperator.MINIMUM, self.integer(depth - 1), Constant(1000), INT, span())
                source = Index(Reference(CLOCKS), self.read_only(depth - 1), ClockType(), span())
                match self.pick(["number", "clock", "sum"]):
                    case "clock":
                        value = source
                    case "sum":
                        value = Binary(BinaryOperator.ADD, source, value, ClockType(), span())
                return Assign(clock, value, ClockType(), span=span())
            case "increment":
                return Increment(self.place(depth - 1), 1, self.draw(st.booleans()), INT, span())
            case "integer":
                return self.integer(depth)
            case _:
                return self.assign(depth)

    def call(self, depth: int, result: Type = SMALL) -> Expression:
        self.functions -= 1
        outer, self.scope = self.scope, []
        array = ArrayType(SMALL, IntType(0, 3))
        parameters = (
            Variable("n", SMALL, VariableKind.FRAME),
            Variable("a", array, VariableKind.FRAME, reference=True),
            Variable("b", array, VariableKind.FRAME),
            Variable("r", RECORD, VariableKind.FRAME, reference=self.draw(st.booleans())),
            Variable("s", SMALL, VariableKind.FRAME, reference=True),
        )
        self.scope = list(parameters)
        value = self.record(depth - 1) if result == RECORD else self.integer(depth - 1)
        body = Block((*self.statements(depth - 1, result), Return(value)))
        function = Function("f", parameters, result, body, span())
        self.scope = outer
        # Folding may replace a conditional by its branch; the sum keeps the place of the argument.
        first = Binary(BinaryOperator.ADD, self.integer(depth - 1), Constant(0), INT, span())
        arguments = (
            first,
            Reference(TABLE),
            Reference(TABLE),
            self.record_place(depth - 1),
            self.place(depth - 1),
        )
        call = Call(function, arguments, result, span())
        if result == SMALL and self.draw(st.booleans()):
            nested = (call, *arguments[1:])
            return Call(function, nested, result, span())
        return call

    def statements(self, depth: int, result: Type) -> tuple[Statement, ...]:
        return tuple(self.statement(depth, result) for _ in range(self.draw(st.integers(0, 2))))

    def statement(self, depth: int, result: Type) -> Statement:
        kinds = ["effect", "declare"] + (["if", "while", "iterate", "return", "assert"] if depth > 0 else [])
        match self.pick(kinds):
            case "declare":
                type_ = self.draw(st.sampled_from([SMALL, RECORD]))
                local = Variable("local", type_, VariableKind.FRAME)
                initial: Expression | None = None
                if self.draw(st.booleans()):
                    initial = self.record(depth - 1) if type_ == RECORD else self.integer(depth - 1)
                self.scope.append(local)
                return Declare(local, initial if initial is None else replace(initial, span=span()))
            case "if":
                return If(self.boolean(depth - 1), self.block(depth - 1, result), self.block(depth - 1, result))
            case "while":
                step = Evaluate(Increment(Reference(COUNT), 1, True, INT, span()))
                test = Binary(BinaryOperator.LESS, Reference(COUNT), self.read_only(0), BOOL, span())
                return While(test, Block((step, self.block(depth - 1, result))), self.draw(st.booleans()))
            case "iterate":
                variable = Variable("i", IntType(0, self.draw(st.integers(0, 3))), VariableKind.BOUND)
                self.scope.append(variable)
                body = self.block(depth - 1, result)
                self.scope.remove(variable)
                return Iterate(variable, body)
            case "return":
                value = self.record(depth - 1) if result == RECORD else self.integer(depth - 1)
                return If(self.boolean(depth - 1), Return(replace(value, span=span())))
            case "assert":
                return Assert(replace(self.boolean(depth - 1), span=span()))
            case _:
                return Evaluate(self.effect(depth))

    def block(self, depth: int, result: Type) -> Block:
        outer = list(self.scope)
        statements = self.statements(depth, result)
        self.scope = outer
        return Block(statements)


@st.composite
def values(draw: st.DrawFn, effects: bool) -> Expression:
    return Drawer(draw, effects).integer(4)


@st.composite
def update_lists(draw: st.DrawFn) -> list[Expression]:
    drawer = Drawer(draw)
    return [drawer.effect(3) for _ in range(draw(st.integers(1, 3)))]
