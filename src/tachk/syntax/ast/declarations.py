"""Declarations, global or in a template."""

from __future__ import annotations

from tachk.base.records import dataclass
from tachk.syntax.ast.expressions import Expression, Parameter, TypedefDeclaration, TypeExpression, VariableDeclaration
from tachk.syntax.ast.nodes import Identifier, Node
from tachk.syntax.ast.statements import BlockStatement


@dataclass(frozen=True, slots=True)
class FunctionDeclaration(Node):
    result: TypeExpression
    name: Identifier
    parameters: tuple[Parameter, ...]
    body: BlockStatement


@dataclass(frozen=True, slots=True)
class ChannelPriorityDeclaration(Node):
    """``chan priority a, b[1] < default < c;`` groups in ascending order; ``default`` is a NameExpression."""

    groups: tuple[tuple[Expression, ...], ...]


@dataclass(frozen=True, slots=True)
class UpdateHook(Node):
    """``before_update { ... }`` or ``after_update { ... }``; parsed so that it can be refused by name."""

    kind: str
    updates: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class SignalDeclaration(Node):
    name: Identifier
    expression: Expression
    doc: str = ""


@dataclass(frozen=True, slots=True)
class ForeignImport(Node):
    """UPPAAL 5's ``import "library" { ... };`` parsed so that it can be refused by name."""

    library: str


@dataclass(frozen=True, slots=True)
class DynamicTemplate(Node):
    """``dynamic Template(int a);`` of statistical models; parsed so that it can be refused by name."""

    name: Identifier
    parameters: tuple[Parameter, ...]


Declaration = (
    VariableDeclaration
    | TypedefDeclaration
    | FunctionDeclaration
    | ChannelPriorityDeclaration
    | UpdateHook
    | SignalDeclaration
    | ForeignImport
    | DynamicTemplate
)
