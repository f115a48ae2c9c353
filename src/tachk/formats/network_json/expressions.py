"""Expressions, statements and functions of a network as JSON, and back: one table of kinds for both directions.

Variables are referred to by number. The writer numbers them as they are declared, so equal networks have equal JSON.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from tachk.base.operators import BinaryOperator, UnaryOperator
from tachk.formats.network_json.types import Json, type_from_json, type_to_json
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
from tachk.model.floating import FloatingOperation
from tachk.model.floating_calls import OPERATION_FUNCTIONS


@dataclass(slots=True)
class ExpressionWriter:
    """Attributes:
    numbers: of the variables met so far.
    functions: those called so far, in order of their first call; ``bodies`` has their JSON.
    """

    lasting: frozenset[Variable] = frozenset()
    numbers: dict[Variable, int] = field(default_factory=dict)
    functions: dict[Function, int] = field(default_factory=dict)
    bodies: list[Json] = field(default_factory=list)

    def number(self, variable: Variable) -> int:
        return self.numbers.setdefault(variable, len(self.numbers))

    def variable(self, variable: Variable) -> Json:
        """The declaration of a variable."""
        value: Json = {
            "id": self.number(variable),
            "name": variable.name,
            "kind": variable.kind.value,
            "type": type_to_json(variable.type),
        }
        if variable.initial:
            value["initial"] = list(variable.initial)
        if variable.declared_meta and variable not in self.lasting:
            value["meta"] = True
        if variable.reference:
            value["reference"] = True
        if variable.priorities:
            value["priorities"] = list(variable.priorities)
        return value

    def function(self, function: Function) -> int:
        known = self.functions.get(function)
        if known is not None:
            return known
        number = len(self.functions)
        self.functions[function] = number
        self.bodies.append(None)
        self.bodies[number] = {
            "id": number,
            "name": function.name,
            "parameters": [self.variable(p) for p in function.parameters],
            "result": type_to_json(function.result),
            "body": self.statement(function.body),
        }
        if function.operation is not None:
            self.bodies[number]["operation"] = function.operation.name.lower()
        return number

    def optional(self, expression: Expression | None) -> Json:
        return None if expression is None else self.expression(expression)

    def expressions(self, expressions: Sequence[Expression]) -> list[Json]:
        return [self.expression(e) for e in expressions]

    def statements(self, statements: Sequence[Statement]) -> list[Json]:
        return [self.statement(s) for s in statements]

    def expression(self, expression: Expression) -> Json:
        kind = _EXPRESSION_OF[expression.kind if isinstance(expression, Quantifier) else type(expression)]
        value: dict[str, Json] = {"op": kind.name}
        for part in kind.parts:
            value[part.name] = part.codec.write(self, getattr(expression, part.attribute))
        value["type"] = type_to_json(expression.type)
        return value

    def statement(self, statement: Statement) -> Json:
        kind = _STATEMENT_OF[type(statement)]
        value: dict[str, Json] = {"do": kind.name, **dict.fromkeys(kind.names)}
        for part in kind.parts:
            value[part.name] = part.codec.write(self, getattr(statement, part.attribute))
        return value


@dataclass(slots=True)
class ExpressionReader:
    """Rebuilds expressions from JSON. Every method raises ValueError, KeyError or TypeError for other JSON.

    Attributes:
        variables: by number.
        functions: by number, made when they are first called.
        bodies: the JSON of the functions.
    """

    bodies: list[Json]
    variables: dict[int, Variable] = field(default_factory=dict)
    functions: dict[int, Function] = field(default_factory=dict)
    _open: set[int] = field(default_factory=set)

    def number(self, number: Json) -> Variable:
        return self.variables[number]

    def variable(self, value: Json) -> Variable:
        """Declares a variable."""
        made = Variable(
            value["name"],
            type_from_json(value["type"]),
            VariableKind(value["kind"]),
            tuple(value.get("initial", ())),
            value.get("meta", False),
            value.get("reference", False),
            tuple(value.get("priorities", ())),
        )
        if value["id"] in self.variables:
            raise ValueError(f"variable {value['id']} is declared twice")
        self.variables[value["id"]] = made
        return made

    def function(self, number: int) -> Function:
        if number in self.functions:
            return self.functions[number]
        if number in self._open:
            raise ValueError(f"function {number} calls itself")
        self._open.add(number)
        value = self.bodies[number]
        if "operation" in value:
            self.functions[number] = OPERATION_FUNCTIONS[FloatingOperation[value["operation"].upper()]]
            return self.functions[number]
        parameters = tuple(self.variable(p) for p in value["parameters"])
        body = self.statement(value["body"])
        if not isinstance(body, Block):
            raise ValueError(f"the body of function {number} is not a block")
        made = Function(value["name"], parameters, type_from_json(value["result"]), body)
        self.functions[number] = made
        return made

    def optional(self, value: Json) -> Expression | None:
        return None if value is None else self.expression(value)

    def expressions(self, values: Json) -> tuple[Expression, ...]:
        return tuple(self.expression(v) for v in values)

    def statements(self, values: Json) -> tuple[Statement, ...]:
        return tuple(self.statement(v) for v in values)

    def expression(self, value: Json) -> Expression:
        type_ = type_from_json(value["type"])
        kind = _EXPRESSIONS.get(value["op"])
        if kind is None:
            raise ValueError(f"{value['op']!r} is not a kind of expression")
        fields = dict(kind.fixed)
        for part in kind.parts:
            fields[part.attribute] = part.codec.read(self, value[part.name])
        if kind.made is not Reference:  # which has the type of its variable
            fields["type"] = type_
        made: Expression = kind.made(**fields)
        return made

    def statement(self, value: Json) -> Statement:
        kind = _STATEMENTS.get(value["do"])
        if kind is None:
            raise ValueError(f"{value['do']!r} is not a kind of statement")
        fields = {part.attribute: part.codec.read(self, value[part.name]) for part in kind.parts}
        made: Statement = kind.made(**fields)
        return made


class _FieldCodec(NamedTuple):
    """The functions that write and read the value of a field."""

    write: Callable[[ExpressionWriter, Any], Json]
    read: Callable[[ExpressionReader, Json], Any]

    def or_nothing(self) -> _FieldCodec:
        return _FieldCodec(
            lambda writer, value: None if value is None else self.write(writer, value),
            lambda reader, value: None if value is None else self.read(reader, value),
        )


class _NodeField(NamedTuple):
    """A field of a node, and its name in JSON."""

    name: str
    attribute: str
    codec: _FieldCodec


class _NodeForm(NamedTuple):
    """A kind of node.

    Attributes:
        name: in JSON.
        made: its class.
        parts: its fields, in the order in which variables and functions are numbered.
        names: of the fields, in the order of JSON.
        fixed: the fields that the name stands for.
    """

    name: str
    made: Callable[..., Any]
    parts: tuple[_NodeField, ...]
    names: tuple[str, ...]
    fixed: dict[str, Any]


_PLAIN = _FieldCodec(lambda writer, value: value, lambda reader, value: value)
_EXPRESSION = _FieldCodec(ExpressionWriter.expression, ExpressionReader.expression)
_OPTIONAL = _FieldCodec(ExpressionWriter.optional, ExpressionReader.optional)
_EXPRESSION_LIST = _FieldCodec(ExpressionWriter.expressions, ExpressionReader.expressions)
_STATEMENT = _FieldCodec(ExpressionWriter.statement, ExpressionReader.statement)
_STATEMENT_LIST = _FieldCodec(ExpressionWriter.statements, ExpressionReader.statements)
_DECLARATION = _FieldCodec(ExpressionWriter.variable, ExpressionReader.variable)
_NUMBER = _FieldCodec(ExpressionWriter.number, ExpressionReader.number)
_FUNCTION = _FieldCodec(ExpressionWriter.function, ExpressionReader.function)
_UNARY = _FieldCodec(lambda writer, operator: operator.value, lambda reader, value: UnaryOperator(value))
_BINARY = _FieldCodec(lambda writer, operator: operator.value, lambda reader, value: BinaryOperator(value))


def _kind(name: str, made: Callable[..., Any], /, **codecs: _FieldCodec | tuple[str, _FieldCodec]) -> _NodeForm:
    """Args:
    codecs: by the names of the fields in JSON; a pair where the attribute has another name.
    """
    parts = ((key, *(codec if type(codec) is tuple else (key, codec))) for key, codec in codecs.items())
    return _NodeForm(name, made, tuple(_NodeField(*part) for part in parts), tuple(codecs), {})


def _quantifier(kind: QuantifierKind) -> _NodeForm:
    row = _kind(kind.value, Quantifier, bound=("variable", _DECLARATION), body=_EXPRESSION)
    return row._replace(fixed={"kind": kind})


_EXPRESSIONS = {
    kind.name: kind
    for kind in (
        _kind("constant", Constant, value=_PLAIN),
        _kind("variable", Reference, variable=_NUMBER),
        _kind("index", Index, base=_EXPRESSION, index=_EXPRESSION),
        _kind("field", Field, base=_EXPRESSION, name=_PLAIN),
        _kind("aggregate", Aggregate, items=_EXPRESSION_LIST),
        _kind("unary", Unary, operator=_UNARY, operand=_EXPRESSION),
        _kind("binary", Binary, operator=_BINARY, left=_EXPRESSION, right=_EXPRESSION),
        _kind("conditional", Conditional, condition=_EXPRESSION, then=_EXPRESSION, otherwise=_EXPRESSION),
        *map(_quantifier, QuantifierKind),
        _kind("assign", Assign, target=_EXPRESSION, operator=_BINARY.or_nothing(), value=_EXPRESSION),
        _kind("increment", Increment, target=_EXPRESSION, delta=_PLAIN, prefix=_PLAIN),
        _kind("call", Call, function=_FUNCTION, arguments=_EXPRESSION_LIST),
        _kind("comma", Comma, items=_EXPRESSION_LIST),
        _kind("location", LocationTest, process=_PLAIN, location=_PLAIN),
        _kind("deadlock", Deadlock),
    )
}
_STATEMENTS = {
    kind.name: kind
    for kind in (
        _kind("evaluate", Evaluate, expression=_EXPRESSION),
        _kind("declare", Declare, initial=_OPTIONAL, variable=_DECLARATION)._replace(names=("variable", "initial")),
        _kind("block", Block, statements=_STATEMENT_LIST),
        _kind("if", If, condition=_EXPRESSION, then=_STATEMENT, otherwise=_STATEMENT.or_nothing()),
        _kind("while", While, condition=_EXPRESSION, body=_STATEMENT, test_first=_PLAIN),
        _kind("iterate", Iterate, variable=_DECLARATION, body=_STATEMENT),
        _kind("return", Return, value=_OPTIONAL),
        _kind("assert", Assert, condition=_EXPRESSION),
    )
}
_EXPRESSION_OF = {kind.fixed.get("kind", kind.made): kind for kind in _EXPRESSIONS.values()}
_STATEMENT_OF = {kind.made: kind for kind in _STATEMENTS.values()}
