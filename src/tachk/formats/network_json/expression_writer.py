"""Expressions, statements and functions of a network as JSON.

Variables are referred to by number. The writer numbers them as they are declared, so equal networks have equal JSON.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from tachk.formats.network_json.types import Json, type_to_json
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
    Reference,
    Return,
    Statement,
    Unary,
    Variable,
    While,
)


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

    def expression(self, expression: Expression) -> Json:
        parts = self._parts(expression)
        parts["type"] = type_to_json(expression.type)
        return parts

    def _parts(self, expression: Expression) -> dict[str, Json]:
        match expression:
            case Constant(value):
                return {"op": "constant", "value": value}
            case Reference(variable):
                return {"op": "variable", "variable": self.number(variable)}
            case Index(base, index):
                return {"op": "index", "base": self.expression(base), "index": self.expression(index)}
            case Field(base, name):
                return {"op": "field", "base": self.expression(base), "name": name}
            case Aggregate(items):
                return {"op": "aggregate", "items": self.expressions(items)}
            case Unary(operator, operand):
                return {"op": "unary", "operator": operator.value, "operand": self.expression(operand)}
            case Binary(operator, left, right):
                return {
                    "op": "binary",
                    "operator": operator.value,
                    "left": self.expression(left),
                    "right": self.expression(right),
                }
            case Conditional(condition, then, otherwise):
                return {
                    "op": "conditional",
                    "condition": self.expression(condition),
                    "then": self.expression(then),
                    "otherwise": self.expression(otherwise),
                }
            case Quantifier(kind, variable, body):
                bound = self.variable(variable)
                return {"op": kind.value, "bound": bound, "body": self.expression(body)}
            case Assign(target, value, _, combined):
                return {
                    "op": "assign",
                    "target": self.expression(target),
                    "operator": None if combined is None else combined.value,
                    "value": self.expression(value),
                }
            case Increment(target, delta, prefix):
                return {"op": "increment", "target": self.expression(target), "delta": delta, "prefix": prefix}
            case Call(function, arguments):
                return {
                    "op": "call",
                    "function": self.function(function),
                    "arguments": self.expressions(arguments),
                }
            case Comma(items):
                return {"op": "comma", "items": self.expressions(items)}
            case LocationTest(process, location):
                return {"op": "location", "process": process, "location": location}
            case Deadlock():
                return {"op": "deadlock"}

    def statement(self, statement: Statement) -> Json:
        match statement:
            case Evaluate(expression):
                return {"do": "evaluate", "expression": self.expression(expression)}
            case Declare(variable, initial):
                value = self.optional(initial)
                return {"do": "declare", "variable": self.variable(variable), "initial": value}
            case Block(statements):
                return {"do": "block", "statements": [self.statement(s) for s in statements]}
            case If(condition, then, otherwise):
                return {
                    "do": "if",
                    "condition": self.expression(condition),
                    "then": self.statement(then),
                    "otherwise": None if otherwise is None else self.statement(otherwise),
                }
            case While(condition, body, test_first):
                return {
                    "do": "while",
                    "condition": self.expression(condition),
                    "body": self.statement(body),
                    "test_first": test_first,
                }
            case Iterate(variable, body):
                return {"do": "iterate", "variable": self.variable(variable), "body": self.statement(body)}
            case Return(value):
                return {"do": "return", "value": self.optional(value)}
            case Assert(condition):
                return {"do": "assert", "condition": self.expression(condition)}
