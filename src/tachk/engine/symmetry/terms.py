"""Expressions as sequences of tokens, so that renaming is a map of tokens and equality is that of sequences.

While an expression is read, it is noted which of its numbers are of one type (`tachk.engine.symmetry.index_types`).
"""

from __future__ import annotations

from typing import NamedTuple, assert_never

from tachk.analysis.failures import can_fail
from tachk.analysis.fold import Known, fold, fold_place
from tachk.base.operators import COMPARISONS, BinaryOperator, OperandGroup, UnaryOperator
from tachk.base.records import dataclass, field
from tachk.engine.symmetry.index_types import ArrayTree, IndexTypes, Range, RecordTree, Tree
from tachk.model.expressions import (
    Aggregate,
    Assert,
    Assign,
    Binary,
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
    Variable,
    VariableKind,
    While,
)
from tachk.model.traversal import reads_clock, written_variables
from tachk.model.types import (
    ArrayType,
    BoolType,
    ClockType,
    IntType,
    RecordType,
    ScalarType,
    Type,
    bounds,
    leaves,
)
from tachk.model.variable_layout import default_value


class IndexValue(NamedTuple):
    """A constant, with its index type."""

    node: int
    value: int


class ProcessNumber(NamedTuple):
    """The number of a process, in the test of a location."""

    process: int


class Shift(NamedTuple):
    """A constant that is added to a number."""

    by: int


Token = Variable | IndexValue | ProcessNumber | Shift | str | tuple[object, ...]
"""The names that are renamed, and the rest."""

_ORDERED = frozenset(COMPARISONS) - {BinaryOperator.EQUAL, BinaryOperator.NOT_EQUAL}


@dataclass(slots=True)
class TermReader:
    """Reads the expressions of a network.

    Attributes:
        trees: the kinds of each variable met so far.
    """

    known: Known
    index_types: IndexTypes = field(default_factory=IndexTypes)
    trees: dict[Variable, Tree] = field(default_factory=dict)
    _functions: dict[Function, tuple[list[Token], Tree]] = field(default_factory=dict)
    _scope: dict[Variable, int] = field(default_factory=dict)

    def copy(self) -> TermReader:
        """A copy that may read on."""
        return TermReader(self.known, self.index_types.copy(), {**self.trees}, {**self._functions})

    def begin(self) -> None:
        """Begins a part with names of its own for bound variables."""
        self._scope = {}

    def tree_of(self, variable: Variable) -> Tree:
        tree = self.trees.get(variable)
        if tree is None:
            tree = self.trees[variable] = self.index_types.tree(variable.type, variable.span)
        return tree

    # ---- expressions ------------------------------------------------------------------------------------------------

    def whole(self, expression: Expression, tokens: list[Token]) -> Tree:
        """Appends the tokens of an outermost expression."""
        return self._read(fold_place(expression, self.known), tokens)

    def condition(self, expression: Expression, tokens: list[Token]) -> None:
        self._truth(fold(expression, self.known), tokens)

    def bind(self, variable: Variable, tokens: list[Token]) -> int:
        """A variable that goes through all values of its type."""
        low, high = bounds(variable.type) if isinstance(variable.type, IntType | BoolType | ScalarType) else (0, 0)
        self._scope[variable] = len(self._scope)
        tokens.append(("each", low, high))
        node = self.index_types.fresh()
        self.index_types.ranges.append(Range(node, low, high, variable.span))
        self.trees[variable] = node
        return node

    def _plain(self, expression: Expression, tokens: list[Token], reason: str) -> None:
        self.index_types.make_plain(self._read(expression, tokens), reason, expression.span)

    def _truth(self, expression: Expression, tokens: list[Token]) -> None:
        """An expression that counts as true if it is not 0."""
        tree = self._read(expression, tokens)
        if isinstance(tree, int) and isinstance(expression.type, IntType | BoolType | ScalarType):
            tokens.append(IndexValue(tree, 0))

    def _result(self) -> int:
        node = self.index_types.fresh()
        self.index_types.make_plain(node, "uses a truth value as a number")
        return node

    def _read(self, expression: Expression, tokens: list[Token]) -> Tree:
        match expression:
            case Constant(value):
                node = self.index_types.fresh()
                tokens.append(IndexValue(node, value))
                return node
            case Reference(variable):
                tree = self.tree_of(variable)
                if variable.kind in (VariableKind.BOUND, VariableKind.FRAME):
                    tokens.append(("bound", self._scope.setdefault(variable, len(self._scope))))
                else:
                    tokens.append(variable)
                return tree
            case Index(base, index):
                tokens.append("index")
                of_base = self._read(base, tokens)
                of_index = self._read(index, tokens)
                if not isinstance(of_base, ArrayTree) or not isinstance(of_index, int):
                    raise TypeError("an index of something that is not an array")
                self.index_types.unify(of_base.index, of_index, 0, expression.span)
                return of_base.element
            case Field(base, name):
                tokens.append(("field", name))
                of_base = self._read(base, tokens)
                if not isinstance(of_base, RecordTree):
                    raise TypeError("a field of something that is not a record")
                return dict(of_base.fields)[name]
            case Conditional(condition, then, otherwise):
                tokens.append("conditional")
                self._truth(condition, tokens)
                one = self._read(then, tokens)
                self.index_types.unify_trees(one, self._read(otherwise, tokens), expression.span)
                return one
            case Comma(items):
                tokens.append(("comma", len(items)))
                return [self._read(item, tokens) for item in items][-1]
            case Aggregate():
                return self._aggregate(expression, tokens)
            case Assign() | Increment():
                return self._write(expression, tokens)
            case Call():
                return self._call(expression, tokens)
            case Unary() | Binary() | Quantifier() | LocationTest() | Deadlock():
                return self._computed(expression, tokens)
            case _ as never:
                assert_never(never)

    def _computed(self, expression: Unary | Binary | Quantifier | LocationTest | Deadlock, tokens: list[Token]) -> Tree:
        match expression:
            case Unary(operator, operand):
                tokens.append(("unary", operator))
                if operator is UnaryOperator.NOT:
                    self._truth(operand, tokens)
                else:
                    self._plain(operand, tokens, f"`{operator.value}` computes with it")
                return self._result()
            case Binary():
                return self._binary(expression, tokens)
            case Quantifier():
                return self._quantifier(expression, tokens)
            case LocationTest(process, location):
                tokens += (ProcessNumber(process), ("at", location))
                return self._result()
            case Deadlock():
                tokens.append("deadlock")
                return self._result()
            case _ as never:
                assert_never(never)

    def _aggregate(self, expression: Aggregate, tokens: list[Token]) -> Tree:
        tokens.append(("aggregate", len(expression.items)))
        tree = self.index_types.tree(expression.type, expression.span, limited=False)
        parts = [self._read(item, tokens) for item in expression.items]
        if isinstance(tree, ArrayTree):
            self.index_types.make_plain(tree.index, "an array is written as a whole, place by place", expression.span)
            for part in parts:
                self.index_types.unify_trees(tree.element, part, expression.span)
        elif isinstance(tree, RecordTree):
            for (_, inner), part in zip(tree.fields, parts, strict=True):
                self.index_types.unify_trees(inner, part, expression.span)
        return tree

    def _binary(self, expression: Binary, tokens: list[Token]) -> Tree:
        operator, left, right = expression.operator, expression.left, expression.right
        index_types = self.index_types
        if operator.group is OperandGroup.CONNECTIVE:
            tokens.append(("binary", operator))
            self._truth(left, tokens)
            self._truth(right, tokens)
            return self._result()
        if operator.group is OperandGroup.COMPARISON:
            tokens.append(("binary", operator))
            one, other = self._read(left, tokens), self._read(right, tokens)
            if operator in _ORDERED or reads_clock(left) or reads_clock(right):
                word = f"`{operator.value}` compares it"
                index_types.make_plain(one, word, expression.span)
                index_types.make_plain(other, word, expression.span)
            else:
                index_types.unify_trees(one, other, expression.span)
            return self._result()
        if operator is BinaryOperator.ADD and isinstance(left, Constant):
            left, right = right, left
        if operator in (BinaryOperator.ADD, BinaryOperator.SUBTRACT) and isinstance(right, Constant):
            shift = right.value if operator is BinaryOperator.ADD else -right.value
            tokens.append(Shift(shift))
            inner = self._read(left, tokens)
            node = index_types.fresh()
            if isinstance(inner, int) and not reads_clock(left):
                index_types.unify(node, inner, shift, expression.span)
            else:
                index_types.make_plain(inner, f"`{operator.value}` computes with it", expression.span)
                index_types.make_plain(node, f"`{operator.value}` computes it", expression.span)
            return node
        if operator is BinaryOperator.MODULO and isinstance(right, Constant):
            round_ = _round(left, right.value)
            if round_ is not None:
                place, step = round_
                tokens.append(("round", step, right.value))
                tree = self._read(place, tokens)
                assert isinstance(tree, int)
                index_types.cycles.append(Range(tree, 0, right.value - 1, expression.span))
                return tree
        tokens.append(("binary", operator))
        word = f"`{operator.value}` computes with it"
        self._plain(left, tokens, word)
        self._plain(right, tokens, word)
        node = index_types.fresh()
        index_types.make_plain(node, f"`{operator.value}` computes it", expression.span)
        return node

    def _quantifier(self, expression: Quantifier, tokens: list[Token]) -> Tree:
        tokens.append(("quantifier", expression.kind))
        node = self.bind(expression.variable, tokens)
        body = expression.body
        if expression.kind is QuantifierKind.SUM:
            self._plain(body, tokens, "`sum` adds it")
        else:
            self._truth(body, tokens)
        if written_variables([body]):
            self.index_types.make_plain(node, "the body of a quantifier changes something", expression.span)
        if can_fail(body, self.known):
            self.index_types.make_plain(node, "the body of a quantifier may meet a run-time error", expression.span)
        return self._result()

    def _write(self, expression: Assign | Increment, tokens: list[Token]) -> Tree:
        if isinstance(expression, Increment):
            tokens.append(("increment", expression.delta, expression.prefix))
            tree = self._read(expression.target, tokens)
            self.index_types.make_plain(tree, "counts with it", expression.span)
            return tree
        tokens.append(("assign", expression.operator))
        tree = self._read(expression.target, tokens)
        value = self._read(expression.value, tokens)
        if expression.operator is not None or isinstance(expression.target.type, ClockType):
            self.index_types.make_plain(tree, "counts with it", expression.span)
            self.index_types.make_plain(value, "counts with it", expression.span)
        else:
            self.index_types.unify_trees(tree, value, expression.span)
        return tree

    # ---- functions --------------------------------------------------------------------------------------------------

    def _call(self, expression: Call, tokens: list[Token]) -> Tree:
        function = expression.function
        if function.operation is not None:
            tokens.append(("library", function.operation))
            for argument in expression.arguments:
                self._plain(argument, tokens, "a function of the library computes with it")
            tree = self.index_types.tree(function.result, limited=False)
            self.index_types.make_plain(tree, "a function of the library computes it", expression.span)
            return tree
        body, result = self._function(function)
        tokens.append(("call", len(expression.arguments)))
        for parameter, argument in zip(function.parameters, expression.arguments, strict=True):
            tokens.append(("argument", parameter.reference, parameter.type))
            self.index_types.unify_trees(self.tree_of(parameter), self._read(argument, tokens), argument.span)
        tokens += body
        return result

    def _function(self, function: Function) -> tuple[list[Token], Tree]:
        found = self._functions.get(function)
        if found is None:
            outside, self._scope = self._scope, {p: number for number, p in enumerate(function.parameters)}
            tokens: list[Token] = [("function", function.result)]
            result = self.index_types.tree(function.result, function.span)
            self._statement(function.body, result, tokens)
            self._scope = outside
            found = self._functions[function] = tokens, result
        return found

    def _statement(self, statement: Statement, result: Tree, tokens: list[Token]) -> None:
        def inside(*parts: Statement | None) -> None:
            for part in parts:
                if part is None:
                    tokens.append("nothing")
                else:
                    self._statement(part, result, tokens)

        match statement:
            case Evaluate(expression):
                tokens.append("evaluate")
                self.whole(expression, tokens)
            case Declare(variable, initial):
                self._declare(variable, initial, tokens)
            case Block(statements):
                tokens.append(("block", len(statements)))
                inside(*statements)
            case If(condition, then, otherwise):
                tokens.append("if")
                self.condition(condition, tokens)
                inside(then, otherwise)
            case While(condition, body, test_first):
                tokens.append(("while", test_first))
                self.condition(condition, tokens)
                inside(body)
            case Iterate(variable, body):
                tokens.append("iterate")
                node = self.bind(variable, tokens)
                if not _each_on_its_own(body, variable):
                    self.index_types.make_plain(node, "a loop goes through it in order", variable.span)
                inside(body)
            case Return(value):
                tokens.append(("return", value is None))
                if value is not None:
                    self.index_types.unify_trees(result, self.whole(value, tokens), value.span)
            case Assert(condition):
                tokens.append("assert")
                self.condition(condition, tokens)
            case _ as never:
                assert_never(never)

    def _declare(self, variable: Variable, initial: Expression | None, tokens: list[Token]) -> None:
        tree = self.tree_of(variable)
        number = self._scope.setdefault(variable, len(self._scope))
        tokens.append(("declare", number, variable.type, initial is None))
        if initial is not None:
            self.index_types.unify_trees(tree, self.whole(initial, tokens), variable.span)
            return
        for (_, leaf), node in zip(leaves(variable.type), slot_nodes(tree, variable.type), strict=True):
            value = default_value(leaf)
            self.index_types.defaults.append(Range(node, value, value, variable.span))


def _round(expression: Expression, size: int) -> tuple[Expression, int] | None:
    """The place of a variable that lies in [0, size - 1], and the positive step that is added to it."""
    step = 0
    while isinstance(expression, Binary) and expression.operator in (BinaryOperator.ADD, BinaryOperator.SUBTRACT):
        left, right = expression.left, expression.right
        if expression.operator is BinaryOperator.ADD and isinstance(left, Constant):
            left, right = right, left
        if not isinstance(right, Constant):
            return None
        step += right.value if expression.operator is BinaryOperator.ADD else -right.value
        expression = left
    if not isinstance(expression, Reference | Index | Field) or not isinstance(expression.type, IntType):
        return None
    return (expression, step) if bounds(expression.type) == (0, size - 1) and step > 0 else None


def _each_on_its_own(body: Statement, variable: Variable) -> bool:
    """True if a loop only sets the element of arrays that its variable names to constants."""
    match body:
        case Block(statements):
            return all(_each_on_its_own(statement, variable) for statement in statements)
        case Evaluate(Assign(Index(Reference(array), Reference(index)), Constant(), _, None)):
            return index is variable and array.kind is not VariableKind.FRAME
        case _:
            return False


def slot_nodes(tree: Tree, type_: Type) -> list[int]:
    """The index type of each slot of a value, in the order of `tachk.model.types.leaves`."""
    match tree, type_:
        case int(), _:
            return [tree]
        case ArrayTree(_, element), ArrayType(of_element):
            return slot_nodes(element, of_element) * type_.size
        case RecordTree(fields), RecordType(_, of_fields):
            return [
                n for (_, part), (_, of_part) in zip(fields, of_fields, strict=True) for n in slot_nodes(part, of_part)
            ]
        case _:
            raise TypeError("a tree that does not fit its type")
