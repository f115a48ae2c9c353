"""Expressions, statements and functions of a network from the JSON that `expression_writer` writes."""

from __future__ import annotations

from dataclasses import dataclass, field

from tachk.base.operators import BinaryOperator, UnaryOperator
from tachk.formats.network_json.types import Json, type_from_json
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
class ExpressionReader:
    """Rebuilds what the writer took apart. Every method raises ValueError, KeyError or TypeError for other JSON.

    Attributes:
        variables: by number.
        functions: by number, made when they are first called.
        bodies: the JSON of the functions.
    """

    bodies: list[Json]
    variables: dict[int, Variable] = field(default_factory=dict)
    functions: dict[int, Function] = field(default_factory=dict)
    _open: set[int] = field(default_factory=set)

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

    def expression(self, value: Json) -> Expression:
        type_ = type_from_json(value["type"])
        match value["op"]:
            case "constant":
                return Constant(value["value"], type_)
            case "variable":
                return Reference(self.variables[value["variable"]])
            case "index":
                return Index(self.expression(value["base"]), self.expression(value["index"]), type_)
            case "field":
                return Field(self.expression(value["base"]), value["name"], type_)
            case "aggregate":
                return Aggregate(self.expressions(value["items"]), type_)
            case "unary":
                return Unary(UnaryOperator(value["operator"]), self.expression(value["operand"]), type_)
            case "binary":
                left, right = self.expression(value["left"]), self.expression(value["right"])
                return Binary(BinaryOperator(value["operator"]), left, right, type_)
            case "conditional":
                first, then = self.expression(value["condition"]), self.expression(value["then"])
                return Conditional(first, then, self.expression(value["otherwise"]), type_)
            case "forall" | "exists" | "sum" as kind:
                bound = self.variable(value["bound"])
                return Quantifier(QuantifierKind(kind), bound, self.expression(value["body"]), type_)
            case "assign":
                combined = None if value["operator"] is None else BinaryOperator(value["operator"])
                target = self.expression(value["target"])
                return Assign(target, self.expression(value["value"]), type_, combined)
            case "increment":
                return Increment(self.expression(value["target"]), value["delta"], value["prefix"], type_)
            case "call":
                return Call(self.function(value["function"]), self.expressions(value["arguments"]), type_)
            case "comma":
                return Comma(self.expressions(value["items"]), type_)
            case "location":
                return LocationTest(value["process"], value["location"])
            case "deadlock":
                return Deadlock()
            case other:
                raise ValueError(f"{other!r} is not a kind of expression")

    def statement(self, value: Json) -> Statement:
        match value["do"]:
            case "evaluate":
                return Evaluate(self.expression(value["expression"]))
            case "declare":
                initial = self.optional(value["initial"])
                return Declare(self.variable(value["variable"]), initial)
            case "block":
                return Block(tuple(self.statement(s) for s in value["statements"]))
            case "if":
                condition, then = self.expression(value["condition"]), self.statement(value["then"])
                otherwise = None if value["otherwise"] is None else self.statement(value["otherwise"])
                return If(condition, then, otherwise)
            case "while":
                return While(self.expression(value["condition"]), self.statement(value["body"]), value["test_first"])
            case "iterate":
                return Iterate(self.variable(value["variable"]), self.statement(value["body"]))
            case "return":
                return Return(self.optional(value["value"]))
            case "assert":
                return Assert(self.expression(value["condition"]))
            case other:
                raise ValueError(f"{other!r} is not a kind of statement")
