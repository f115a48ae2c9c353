"""Expressions and statements in the words of TChecker.

TChecker has conjunctions, arithmetic and ``(if c then a else b)``, so conditions on integers become nested ``if``
terms. What it has no words for is refused by name.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import chain

from tachk.analysis.conditions import ClockAtom
from tachk.analysis.fold import Known, cannot_fail, fold, fold_place, known_slot, negate
from tachk.base.diagnostics.diagnostic import Diagnostic, UnsupportedError
from tachk.base.operators import COMPARISONS, CONNECTIVES, BinaryOperator, UnaryOperator
from tachk.base.span import Span
from tachk.model.clock_sums import clock_sum
from tachk.model.expressions import (
    BOOL,
    INT,
    Aggregate,
    Assign,
    Binary,
    Call,
    Comma,
    Conditional,
    Constant,
    Expression,
    Field,
    Increment,
    Index,
    Quantifier,
    QuantifierKind,
    Reference,
    Unary,
    Variable,
)
from tachk.model.traversal import walk, written_variables
from tachk.model.types import ArrayType, BoolType, ClockType, RecordType, Type
from tachk.model.variable_layout import default_values, slot_range

_ARITHMETIC = {
    BinaryOperator.ADD,
    BinaryOperator.SUBTRACT,
    BinaryOperator.MULTIPLY,
    BinaryOperator.DIVIDE,
    BinaryOperator.MODULO,
}


def unsupported(what: str, span: Span, help_: str | None = None) -> UnsupportedError:
    return UnsupportedError(Diagnostic("E0802", f"TChecker has no {what}", span, help_))


def written_out(expression: Expression, known: Known) -> Expression:
    """The expression folded, with every quantifier replaced by its instances."""
    match expression:
        case Quantifier(kind, variable, body):
            low, high = slot_range(variable.type)
            parts = [written_out(body, known.with_bound(variable, value)) for value in range(low, high + 1)]
            result = parts[0]
            for part in parts[1:]:
                result = Binary(kind.joins, result, part, INT if kind is QuantifierKind.SUM else BOOL, expression.span)
            return fold(result, known)
        case Binary(_, left, right):
            return fold(replace(expression, left=written_out(left, known), right=written_out(right, known)), known)
        case Unary(_, operand):
            return fold(replace(expression, operand=written_out(operand, known)), known)
        case Conditional(condition, then, otherwise):
            parts = [written_out(part, known) for part in (condition, then, otherwise)]
            return fold(replace(expression, condition=parts[0], then=parts[1], otherwise=parts[2]), known)
        case Assign(target, value):
            return replace(expression, target=fold_place(target, known), value=written_out(value, known))
        case Comma(items) | Aggregate(items):
            return replace(expression, items=tuple(written_out(item, known) for item in items))
        case Index(_, index) if any(isinstance(node, Quantifier) for node in walk(index)):
            return fold(replace(expression, index=written_out(index, known)), known)
        case _:
            return fold(expression, known)


@dataclass(slots=True)
class TermPrinter:
    """Attributes:
    names: of the leaves of variables: by variable and field path, without the indices.
    arrays: the variables that some index depends on the state; the slots of all others have names of their own.
    constants: the initial slots of the variables that nothing writes.
    """

    names: Mapping[tuple[Variable, tuple[str, ...]], str]
    arrays: Collection[Variable]
    constants: Mapping[Variable, tuple[int, ...]] = field(default_factory=dict)

    # ---- places -----------------------------------------------------------------------------------------------------

    def place(self, place: Expression) -> str:
        """A clock or an integer variable, or an element of an array."""
        variable, fields, indices = self._path(place)
        name = self.names[variable, fields]
        if not indices:
            return name
        if variable not in self.arrays:
            return slot_name(name, [self._constant(index) for index, _ in indices])
        return f"{name}[{self.term(flat_index(indices))}]"

    def _path(self, place: Expression) -> tuple[Variable, tuple[str, ...], list[tuple[Expression, ArrayType]]]:
        """The variable, the names of the fields and the indices that lead to a place."""
        fields: list[str] = []
        indices: list[tuple[Expression, ArrayType]] = []
        node = place
        while True:
            match node:
                case Reference(variable):
                    return variable, tuple(reversed(fields)), list(reversed(indices))
                case Field(base, name):
                    fields.append(name)
                    node = base
                case Index(base, index) if isinstance(base.type, ArrayType):
                    indices.append((index, base.type))
                    node = base
                case Conditional():
                    raise unsupported("choice between variables", place.span, "use two edges")
                case _:
                    raise unsupported("such access to a variable", place.span)

    def _constant(self, index: Expression) -> int:
        assert isinstance(index, Constant), "an index that is computed makes its variable an array"
        return index.value

    # ---- numbers ----------------------------------------------------------------------------------------------------

    def term(self, expression: Expression) -> str:
        """An integer expression."""
        match expression:
            case Constant(value):
                return str(value)
            case Reference() | Index() | Field():
                return self._read(expression)
            case Unary(UnaryOperator.MINUS, operand):
                return f"-({self.term(operand)})"
            case Binary(operator, left, right) if operator in _ARITHMETIC:
                return f"({self.term(left)} {operator.value} {self.term(right)})"
            case Binary(BinaryOperator.MINIMUM | BinaryOperator.MAXIMUM as operator, left, right):
                one, other = self.term(left), self.term(right)
                comparison = "<" if operator is BinaryOperator.MINIMUM else ">"
                return f"(if {one} {comparison} {other} then {one} else {other})"
            case Conditional(condition, then, otherwise):
                return f"(if {self.condition(condition)} then {self.term(then)} else {self.term(otherwise)})"
            case Call(function):
                raise unsupported(f"functions: `{function.name}` is called", expression.span, "write out what it does")
            case Assign() | Increment() | Comma():
                raise unsupported("assignment inside an expression", expression.span, "make it an update of its own")
            case Binary(operator) if operator not in COMPARISONS and operator not in CONNECTIVES:
                raise unsupported(f"operator `{operator.value}`", expression.span)
            case _:
                return f"(if {self.condition(expression)} then 1 else 0)"

    def _read(self, place: Expression) -> str:
        variable, _, indices = self._path(place)
        if variable in self.constants and indices:
            return self._table(place, variable, [])
        return self.place(place)

    def _table(self, place: Expression, variable: Variable, chosen: list[int]) -> str:
        """The value of a constant array at an index that the state decides: a chain of comparisons."""
        computed = next((n for n in walk(place) if isinstance(n, Index) and not isinstance(n.index, Constant)), None)
        if computed is None:
            slot = known_slot(place)
            return "0" if slot is None else str(self.constants[variable][slot[1]])
        assert isinstance(computed.base.type, ArrayType)
        low, size = computed.base.type.low, computed.base.type.size
        index = self.term(computed.index)
        result = ""
        for value in range(low + size - 1, low - 1, -1):
            fixed = replace(computed, index=Constant(value, computed.index.type))
            inner = self._table(_replaced(place, computed, fixed), variable, [*chosen, value])
            result = f"(if {index} == {value} then {inner} else {result})" if result else inner
        return result

    # ---- conditions -------------------------------------------------------------------------------------------------

    def condition(self, expression: Expression) -> str:
        """A condition without clocks, as a conjunction."""
        match expression:
            case Constant(value):
                return "1 == 1" if value else "0 == 1"
            case Unary(UnaryOperator.NOT, operand):
                return self._negated(operand)
            case Binary(BinaryOperator.AND, left, right):
                return f"{self.condition(left)} && {self.condition(right)}"
            case Binary(BinaryOperator.OR, left, right):
                return f"{self._either(left, right)} != 0"
            case Binary(BinaryOperator.IMPLY, left, right):
                return f"{self._either(negate(left), right)} != 0"
            case Binary(BinaryOperator.XOR, left, right):
                return f"(if {self.condition(left)} then 1 else 0) != (if {self.condition(right)} then 1 else 0)"
            case Binary(operator, left, right) if operator in COMPARISONS:
                if isinstance(left.type, ArrayType | RecordType):
                    return self._equal(expression, left, right)
                return f"{self.term(left)} {operator.value} {self.term(right)}"
            case _:
                return f"{self.term(expression)} != 0"

    def _either(self, left: Expression, right: Expression) -> str:
        return f"(if {self.condition(left)} then 1 else (if {self.condition(right)} then 1 else 0))"

    def _negated(self, operand: Expression) -> str:
        turned = negate(operand)
        if not isinstance(turned, Unary):
            return self.condition(turned)
        if isinstance(operand, Reference | Index | Field):
            return f"{self.term(operand)} == 0"
        return f"(if {self.condition(operand)} then 0 else 1) != 0"

    def _equal(self, node: Binary, left: Expression, right: Expression) -> str:
        pairs = list(zip(slots(left), slots(right), strict=True))
        equal = " && ".join(f"{self.term(one)} == {self.term(other)}" for one, other in pairs)
        if node.operator is BinaryOperator.EQUAL:
            return equal
        return f"(if {equal} then 0 else 1) != 0"

    def atom(self, atom: ClockAtom) -> str:
        """A comparison of a clock."""
        sign = "<" if atom.strict else "<="
        if atom.left is not None and atom.right is not None:
            raise unsupported("comparison of two clocks", atom.span, "measure the difference with a clock of its own")
        if atom.left is not None:
            return f"{self.place(atom.left)} {sign} {self.term(atom.bound)}"
        assert atom.right is not None, "an atom names a clock"
        bound = atom.bound
        opposite = bound.operand if isinstance(bound, Unary) else Unary(UnaryOperator.MINUS, bound, INT, atom.span)
        if isinstance(bound, Constant):
            opposite = Constant(-bound.value)
        return f"{self.place(atom.right)} {sign.replace('<', '>')} {self.term(opposite)}"

    # ---- updates ----------------------------------------------------------------------------------------------------

    def statements(self, update: Expression) -> Iterator[str]:
        """An update as statements."""
        match update:
            case Comma(items):
                yield from chain.from_iterable(self.statements(item) for item in items)
            case Conditional(condition, then, otherwise) if written_variables([then, otherwise]):
                first = "; ".join(self.statements(then)) or "nop"
                second = "; ".join(self.statements(otherwise)) or "nop"
                yield f"if {self.condition(condition)} then {first} else {second} end"
            case Assign(target, value, _, None) if isinstance(target.type, ArrayType | RecordType):
                places = list(slots(target))
                if isinstance(value, Aggregate) and set(_variables(value)) & set(_variables(target)):
                    raise unsupported("simultaneous assignment", update.span)
                yield from (self._assignment(place, item) for place, item in zip(places, slots(value), strict=True))
            case Assign(target, value, _, operator):
                if operator is not None:
                    value = Binary(operator, target, value, INT, update.span)
                yield self._assignment(target, value)
            case Increment(target, delta):
                yield f"{self.place(target)} = {self.place(target)} {'+' if delta > 0 else '-'} {abs(delta)}"
            case _ if cannot_fail(update):
                return
            case _:
                self.term(update)  # refuses calls
                raise unsupported("update without an effect", update.span, "leave it out")

    def _assignment(self, target: Expression, value: Expression) -> str:
        if isinstance(target.type, BoolType) and not isinstance(value.type, BoolType):
            value = Binary(BinaryOperator.NOT_EQUAL, value, Constant(0), BOOL, value.span)
            value = fold(value, Known())
        if isinstance(target.type, ClockType):
            return f"{self.place(target)} = {self._clock_value(value)}"
        return f"{self.place(target)} = {self.term(value)}"

    def _clock_value(self, value: Expression) -> str:
        whole = clock_sum(value)
        if whole is None:
            raise unsupported("such value of a clock", value.span)
        if whole.clock is None:
            return self.term(value) if isinstance(value, Constant) else f"0 + {self.term(value)}"
        clock = self.place(whole.clock)
        return clock if whole.offset is None else f"{self.term(whole.offset)} + {clock}"


def slot_name(name: str, indices: list[int]) -> str:
    """The name of an element that has a variable of its own."""
    return "_".join([name, *(str(i) if i >= 0 else f"m{-i}" for i in indices)])


def flat_index(indices: list[tuple[Expression, ArrayType]]) -> Expression:
    """The number of an element among all elements of an array of arrays, row by row, from 0."""
    result: Expression = Constant(0)
    for index, type_ in indices:
        step = Binary(BinaryOperator.MULTIPLY, result, Constant(type_.size), INT, index.span)
        own = Binary(BinaryOperator.SUBTRACT, index, Constant(type_.low), INT, index.span) if type_.low else index
        result = fold(step, Known())
        result = (
            own
            if isinstance(result, Constant) and not result.value
            else Binary(BinaryOperator.ADD, result, own, INT, index.span)
        )
    return fold(result, Known())


def slots(value: Expression) -> Iterator[Expression]:
    """The numbers that make up an array or a struct."""
    type_: Type = value.type
    match value:
        case Aggregate(items):
            yield from chain.from_iterable(slots(item) for item in items)
        case _ if isinstance(type_, ArrayType):
            for i in range(type_.low, type_.low + type_.size):
                yield from slots(Index(value, Constant(i), type_.element, value.span))
        case _ if isinstance(type_, RecordType):
            for name, inner in type_.fields:
                yield from slots(Field(value, name, inner, value.span))
        case _:
            yield value


def initial_slots(variable: Variable) -> tuple[int, ...]:
    return variable.initial or default_values(variable.type)


def _variables(expression: Expression) -> Iterator[Variable]:
    return (node.variable for node in walk(expression) if isinstance(node, Reference))


def _replaced(place: Expression, old: Expression, new: Expression) -> Expression:
    if place is old:
        return new
    match place:
        case Index(base) | Field(base):
            return replace(place, base=_replaced(base, old, new))
        case _:
            return place
