"""Typed expressions as text, in the notation of the language: for drawings and messages."""

from __future__ import annotations

from tachk.base.operators import BinaryOperator, PrefixOperator
from tachk.base.span import NOWHERE
from tachk.model.expressions import (
    Aggregate,
    Assign,
    Binary,
    Call,
    Comma,
    Conditional,
    Constant,
    Deadlock,
    Expression,
    Field,
    Function,
    Increment,
    Index,
    LocationTest,
    Quantifier,
    Reference,
    Unary,
)
from tachk.model.floating import FloatingOperation
from tachk.model.floating_calls import constant_number
from tachk.model.network import Network
from tachk.model.types import BoolType, IntType, ScalarType, Type
from tachk.syntax import ast
from tachk.syntax.printing.expression_printer import print_expression, print_type


def expression_text(expression: Expression, network: Network, owner: str = "") -> str:
    """The text of an expression.

    Args:
        owner: the name of a process; its variables are written without it.
    """
    return print_expression(expression_node(expression, network, owner))


def expression_node(expression: Expression, network: Network, owner: str = "") -> ast.Expression:
    """The syntax tree of an expression; arguments as for `expression_text`."""
    return _node(expression, network, f"{owner}." if owner else "")


def type_text(type_: Type) -> str:
    """The text of the type of a bound variable."""
    return print_type(type_node(type_))


def type_node(type_: Type) -> ast.TypeExpression:
    """The syntax tree of the type of a bound variable."""
    base: ast.BuiltinType | ast.RangeType | ast.ScalarSetType | ast.NamedType
    match type_:
        case IntType(low, high):
            base = ast.RangeType(NOWHERE, _number(low), _number(high))
        case BoolType():
            base = ast.BuiltinType(NOWHERE, "bool")
        case ScalarType(name):
            base = ast.NamedType(NOWHERE, name)
        case _:
            raise TypeError(f"{type_} does not bind a variable")
    return ast.TypeExpression(NOWHERE, (), base)


def _number(value: int) -> ast.Expression:
    return ast.IntegerLiteral(NOWHERE, value)


def _node(expression: Expression, network: Network, prefix: str) -> ast.Expression:
    def inner(part: Expression) -> ast.Expression:
        return _node(part, network, prefix)

    at = NOWHERE
    number = constant_number(expression)
    if number is not None:
        return ast.FloatLiteral(at, repr(number))
    match expression:
        case Constant(value, BoolType()):
            return ast.BooleanLiteral(at, bool(value))
        case Constant(value):
            return _number(value)
        case Reference(variable):
            return ast.NameExpression(at, variable.name.removeprefix(prefix) if prefix else variable.name)
        case Index(base, index):
            return ast.IndexExpression(at, inner(base), inner(index))
        case Field(base, name):
            return ast.MemberExpression(at, inner(base), ast.Identifier(at, name))
        case Aggregate(items):
            return ast.InitialiserList(at, tuple((None, inner(item)) for item in items))
        case Unary(operator, operand):
            return ast.UnaryExpression(at, PrefixOperator(operator), inner(operand))
        case Binary(operator, left, right):
            return ast.BinaryExpression(at, operator, inner(left), inner(right))
        case Conditional(condition, then, otherwise):
            return ast.ConditionalExpression(at, inner(condition), inner(then), inner(otherwise))
        case Quantifier(kind, variable, body):
            bound = ast.Identifier(at, variable.name)
            return ast.QuantifierExpression(at, kind.value, bound, type_node(variable.type), inner(body))
        case Assign(target, value, _, operator):
            return ast.AssignmentExpression(at, operator, inner(target), inner(value))
        case Increment(target, delta, before):
            return ast.IncrementExpression(at, "++" if delta > 0 else "--", before, inner(target))
        case Call(Function(operation=FloatingOperation.FROM_INTEGER), (value,)):
            return inner(value)
        case Call(Function(operation=FloatingOperation.NEGATE), (value,)):
            return ast.UnaryExpression(at, PrefixOperator.MINUS, inner(value))
        case Call(Function(operation=FloatingOperation() as operation), (left, right)) if not operation.only_simulated:
            return ast.BinaryExpression(at, BinaryOperator[operation.name], inner(left), inner(right))
        case Call(function, arguments):
            called = ast.NameExpression(at, function.name)
            return ast.CallExpression(at, called, tuple(inner(argument) for argument in arguments))
        case Comma(items):
            return ast.CallExpression(at, ast.NameExpression(at, ""), tuple(inner(item) for item in items))
        case LocationTest(process, location):
            owner = network.processes[process]
            whole = ast.NameExpression(at, owner.name)
            return ast.MemberExpression(at, whole, ast.Identifier(at, owner.locations[location].name))
        case Deadlock():
            return ast.DeadlockExpression(at)
