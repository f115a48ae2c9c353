"""The statements of functions."""

from __future__ import annotations

from tachk.base.records import dataclass
from tachk.syntax.ast.expressions import Expression, TypedefDeclaration, TypeExpression, VariableDeclaration
from tachk.syntax.ast.nodes import Identifier, Node


@dataclass(frozen=True, slots=True)
class BlockStatement(Node):
    declarations: tuple[VariableDeclaration | TypedefDeclaration, ...]
    statements: tuple[Statement, ...]


@dataclass(frozen=True, slots=True)
class ExpressionStatement(Node):
    expression: Expression


@dataclass(frozen=True, slots=True)
class EmptyStatement(Node):
    pass


@dataclass(frozen=True, slots=True)
class IfStatement(Node):
    condition: Expression
    then: Statement
    otherwise: Statement | None


@dataclass(frozen=True, slots=True)
class WhileStatement(Node):
    condition: Expression
    body: Statement


@dataclass(frozen=True, slots=True)
class DoStatement(Node):
    body: Statement
    condition: Expression


@dataclass(frozen=True, slots=True)
class ForStatement(Node):
    """``for (initial; condition; step)``; several expressions are separated by commas."""

    initial: tuple[Expression, ...]
    condition: tuple[Expression, ...]
    step: tuple[Expression, ...]
    body: Statement


@dataclass(frozen=True, slots=True)
class IterationStatement(Node):
    """``for (variable : type) body``."""

    variable: Identifier
    type: TypeExpression
    body: Statement


@dataclass(frozen=True, slots=True)
class ReturnStatement(Node):
    value: Expression | None


@dataclass(frozen=True, slots=True)
class AssertStatement(Node):
    condition: Expression


Statement = (
    BlockStatement
    | ExpressionStatement
    | EmptyStatement
    | IfStatement
    | WhileStatement
    | DoStatement
    | ForStatement
    | IterationStatement
    | ReturnStatement
    | AssertStatement
)
