"""From parse trees to expressions, types, variables and parameters."""

from __future__ import annotations

from typing import Any, TypeVar

from tachk.base.operators import BinaryOperator, PrefixOperator
from tachk.base.span import Span
from tachk.syntax import ast
from tachk.syntax.chains import chain
from tachk.syntax.parsing.tokens import Token

Children = list[Any]
T = TypeVar("T")

_BINARY = {spelling: each for each in BinaryOperator for spelling in (each.value, each.word) if spelling is not None}
_PREFIX = {spelling: each for each in PrefixOperator for spelling in (each.value, each.word) if spelling is not None}
_ASSIGNED = {"=": None, ":=": None, **{f"{each}=": each for each in BinaryOperator}}
_TYPE_NAMES = ("double", "string")


def only(children: Children, kind: type[T]) -> tuple[T, ...]:
    return tuple(child for child in children if isinstance(child, kind))


def nodes(children: Children) -> tuple[Any, ...]:
    return tuple(child for child in children if isinstance(child, ast.Node))


def span_of(children: Children) -> Span:
    """From the first to the last thing a rule matched."""
    first = next(child for child in children if child is not None)
    last = next(child for child in reversed(children) if child is not None)
    start: Span = first.span
    return Span(start.source, start.start, last.span.end)


class ListOf(tuple[Any, ...]):
    """A non-empty list with the place it spans."""

    __slots__ = ()

    @property
    def span(self) -> Span:
        return span_of(list(self))


class ExpressionBuilder:
    """The callbacks of the rules in the first half of expression.lark."""

    # ---- expressions ----

    def name(self, children: Children) -> ast.Identifier:
        token = children[0]
        return ast.Identifier(token.span, token.text)

    def name_expression(self, children: Children) -> ast.NameExpression:
        token = children[0]
        return ast.NameExpression(token.span, token.text)

    def integer(self, children: Children) -> ast.IntegerLiteral:
        return ast.IntegerLiteral(children[0].span, int(children[0].text))

    def float(self, children: Children) -> ast.FloatLiteral:
        return ast.FloatLiteral(children[0].span, children[0].text)

    def string(self, children: Children) -> ast.StringLiteral:
        return ast.StringLiteral(children[0].span, children[0].text[1:-1])

    def boolean(self, children: Children) -> ast.BooleanLiteral:
        return ast.BooleanLiteral(children[0].span, children[0].text == "true")

    def deadlock(self, children: Children) -> ast.DeadlockExpression:
        return ast.DeadlockExpression(children[0].span)

    def parenthesised(self, children: Children) -> Any:
        """The expression itself, its place widened by the parentheses."""
        inner = children[1]
        fields = [getattr(inner, name) for name in inner.__dataclass_fields__ if name != "span"]
        return type(inner)(span_of(children), *fields)

    def assignment(self, children: Children) -> ast.AssignmentExpression:
        target, operator, value = children
        return ast.AssignmentExpression(span_of(children), _ASSIGNED[operator.text], target, value)

    def conditional(self, children: Children) -> ast.ConditionalExpression:
        return ast.ConditionalExpression(span_of(children), children[0], children[2], children[4])

    def binary(self, children: Children) -> Any:
        """Operands with operators between them, which bind equally and to the left."""
        operands = [children[0]]
        joined = _BINARY[children[1].text]
        for operator, operand in zip(children[1::2], children[2::2], strict=True):
            symbol = _BINARY[operator.text]
            if symbol != joined:
                operands = [chain(joined, operands)]
                joined = symbol
            operands.append(operand)
        return chain(joined, operands)

    def unary(self, children: Children) -> ast.UnaryExpression:
        return ast.UnaryExpression(span_of(children), _PREFIX[children[0].text], children[1])

    def increment_before(self, children: Children) -> ast.IncrementExpression:
        return ast.IncrementExpression(span_of(children), children[0].text, True, children[1])

    def increment_after(self, children: Children) -> ast.IncrementExpression:
        return ast.IncrementExpression(span_of(children), children[1].text, False, children[0])

    def quantifier(self, children: Children) -> ast.QuantifierExpression:
        kind, _, variable, _, type_, _, body = children
        return ast.QuantifierExpression(span_of(children), kind.text, variable, type_, body)

    def spawn(self, children: Children) -> ast.SpawnExpression:
        return ast.SpawnExpression(span_of(children), children[1], tuple(children[3] or ()))

    def index(self, children: Children) -> ast.IndexExpression:
        return ast.IndexExpression(span_of(children), children[0], children[2])

    def call(self, children: Children) -> ast.CallExpression:
        return ast.CallExpression(span_of(children), children[0], tuple(children[2] or ()))

    def member(self, children: Children) -> ast.MemberExpression:
        return ast.MemberExpression(span_of(children), children[0], children[2])

    def rate(self, children: Children) -> ast.RateExpression:
        return ast.RateExpression(span_of(children), children[0])

    def arguments(self, children: Children) -> ListOf:
        return ListOf(nodes(children))

    # ---- types and variables ----

    def prefix(self, children: Children) -> Token:
        token: Token = children[0]
        return token

    def type(self, children: Children) -> ast.TypeExpression:
        *prefixes, base = children
        return ast.TypeExpression(span_of(children), tuple(prefix.text for prefix in prefixes), base)

    def builtin_type(self, children: Children) -> ast.BuiltinType:
        return ast.BuiltinType(children[0].span, children[0].text)

    def range_type(self, children: Children) -> ast.RangeType:
        return ast.RangeType(span_of(children), children[2], children[4])

    def scalar_type(self, children: Children) -> ast.ScalarSetType:
        return ast.ScalarSetType(span_of(children), children[2])

    def struct_type(self, children: Children) -> ast.StructType:
        return ast.StructType(span_of(children), only(children, ast.VariableDeclaration))

    def named_type(self, children: Children) -> ast.NamedType | ast.BuiltinType:
        token = children[0]
        if token.text in _TYPE_NAMES:
            return ast.BuiltinType(token.span, token.text)
        return ast.NamedType(token.span, token.text)

    def index_type(self, children: Children) -> ast.TypeExpression:
        base = self.range_type(children) if children[0].type == "INT" else self.scalar_type(children)
        return ast.TypeExpression(base.span, (), base)

    def dimension(self, children: Children) -> _Dimension:
        return _Dimension((children[1], children[2].span))

    def declarator(self, children: Children) -> ast.Declarator:
        name, *dimensions, _, initialiser = children
        return ast.Declarator(span_of(children), name, _sizes(dimensions), initialiser)

    def initialiser_list(self, children: Children) -> ast.InitialiserList:
        return ast.InitialiserList(span_of(children), tuple(only(children, _InitialiserItem)))

    def initialiser_item(self, children: Children) -> _InitialiserItem:
        return _InitialiserItem((children[0], children[2]))

    def variables(self, children: Children) -> ast.VariableDeclaration:
        return ast.VariableDeclaration(span_of(children), children[0], only(children, ast.Declarator))

    def typedef(self, children: Children) -> ast.TypedefDeclaration:
        return ast.TypedefDeclaration(span_of(children), children[1], only(children, ast.Declarator))

    def legacy_constants(self, children: Children) -> ast.VariableDeclaration:
        return ast.VariableDeclaration(span_of(children), None, only(children, ast.Declarator))

    def legacy_constant(self, children: Children) -> ast.Declarator:
        return self.declarator(children)

    def parameters(self, children: Children) -> ListOf:
        collected: list[ast.Parameter] = []
        for child in children:
            if isinstance(child, ast.Parameter):
                collected.append(child)
            elif isinstance(child, _ParameterContinued):
                type_ = collected[-1].type
                collected.append(ast.Parameter(child.name.span, type_, True, child.name, child.dimensions))
        return ListOf(collected)

    def parameter(self, children: Children) -> ast.Parameter:
        type_, ampersand, name, *dimensions = children
        return ast.Parameter(span_of(children), type_, ampersand is not None, name, _sizes(dimensions))

    def legacy_const_parameter(self, children: Children) -> ast.Parameter:
        const, name, *dimensions = children
        type_ = ast.TypeExpression(const.span, ("const",), ast.BuiltinType(const.span, "int"))
        return ast.Parameter(span_of(children), type_, False, name, _sizes(dimensions))

    def legacy_parameter(self, children: Children) -> _ParameterContinued:
        token, *dimensions = children
        return _ParameterContinued(ast.Identifier(token.span, token.text), _sizes(dimensions))


class _Dimension(tuple[Any, Any]):
    """The size or type of indices in brackets, and the place of the closing one."""

    __slots__ = ()

    @property
    def span(self) -> Span:
        span: Span = self[0].span.to(self[1])
        return span


def _sizes(dimensions: Children) -> tuple[Any, ...]:
    return tuple(dimension[0] for dimension in dimensions)


class _InitialiserItem(tuple[Any, Any]):
    """A designator or None, and the value."""

    __slots__ = ()

    @property
    def span(self) -> Span:
        return span_of(list(self))


class _ParameterContinued:
    """A further name after ``int a`` in a parameter list of UPPAAL 3.x."""

    __slots__ = ("dimensions", "name")

    def __init__(self, name: ast.Identifier, dimensions: tuple[Any, ...]) -> None:
        self.name = name
        self.dimensions = dimensions
