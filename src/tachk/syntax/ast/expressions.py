"""Expressions, types, and the declarations of names with a type: they are made of one another."""

from __future__ import annotations

from tachk.base.operators import BinaryOperator, PrefixOperator
from tachk.base.records import dataclass
from tachk.syntax.ast.nodes import Identifier, Node


@dataclass(frozen=True, slots=True)
class NameExpression(Node):
    name: str


@dataclass(frozen=True, slots=True)
class IntegerLiteral(Node):
    """Attributes:
    name: where a recording has a name for the number: that, as it stood in the formula; printed in its place.
    """

    value: int
    name: str = ""


@dataclass(frozen=True, slots=True)
class FloatLiteral(Node):
    text: str


@dataclass(frozen=True, slots=True)
class BooleanLiteral(Node):
    value: bool


@dataclass(frozen=True, slots=True)
class StringLiteral(Node):
    value: str


@dataclass(frozen=True, slots=True)
class UnaryExpression(Node):
    """``not`` is read as ``!``."""

    operator: PrefixOperator
    operand: Expression


@dataclass(frozen=True, slots=True)
class BinaryExpression(Node):
    """``and`` is read as ``&&``, ``or`` as ``||``."""

    operator: BinaryOperator
    left: Expression
    right: Expression


@dataclass(frozen=True, slots=True)
class AssignmentExpression(Node):
    """``target = value`` (``:=`` is read as ``=``); ``operator`` ADD means ``target += value`` and so on."""

    operator: BinaryOperator | None
    target: Expression
    value: Expression


@dataclass(frozen=True, slots=True)
class IncrementExpression(Node):
    """``operator`` is ``++`` or ``--``."""

    operator: str
    prefix: bool
    target: Expression


@dataclass(frozen=True, slots=True)
class ConditionalExpression(Node):
    condition: Expression
    then: Expression
    otherwise: Expression


@dataclass(frozen=True, slots=True)
class CallExpression(Node):
    """A call, or in queries a process of a template: ``Train(1)``."""

    function: Expression
    arguments: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class IndexExpression(Node):
    base: Expression
    index: Expression


@dataclass(frozen=True, slots=True)
class MemberExpression(Node):
    """``record.field`` or ``Process.name``."""

    base: Expression
    name: Identifier


@dataclass(frozen=True, slots=True)
class RateExpression(Node):
    """``x'``."""

    clock: Expression


@dataclass(frozen=True, slots=True)
class QuantifierExpression(Node):
    """``kind`` is ``forall``, ``exists``, ``sum`` or, over the processes of a dynamic template, ``foreach``."""

    kind: str
    variable: Identifier
    type: TypeExpression
    body: Expression


@dataclass(frozen=True, slots=True)
class DeadlockExpression(Node):
    pass


@dataclass(frozen=True, slots=True)
class SpawnExpression(Node):
    """``spawn Template(1)`` of statistical models; parsed so that it can be refused by name."""

    template: Identifier
    arguments: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class InitialiserList(Node):
    """``{1, x: 2}``: each item with its designator or None."""

    items: tuple[tuple[Identifier | None, Expression], ...]


Expression = (
    NameExpression
    | IntegerLiteral
    | FloatLiteral
    | BooleanLiteral
    | StringLiteral
    | UnaryExpression
    | BinaryExpression
    | AssignmentExpression
    | IncrementExpression
    | ConditionalExpression
    | CallExpression
    | IndexExpression
    | MemberExpression
    | RateExpression
    | QuantifierExpression
    | DeadlockExpression
    | SpawnExpression
    | InitialiserList
)


# ---- types and names with a type -----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class BuiltinType(Node):
    """``name`` is ``int``, ``bool``, ``clock``, ``chan``, ``void``, ``double`` or ``string``."""

    name: str


@dataclass(frozen=True, slots=True)
class RangeType(Node):
    """``int[low, high]``."""

    low: Expression
    high: Expression


@dataclass(frozen=True, slots=True)
class ScalarSetType(Node):
    """``scalar[size]``."""

    size: Expression


@dataclass(frozen=True, slots=True)
class StructType(Node):
    fields: tuple[VariableDeclaration, ...]


@dataclass(frozen=True, slots=True)
class NamedType(Node):
    name: str


@dataclass(frozen=True, slots=True)
class TypeExpression(Node):
    """A type with its prefixes: any of ``const``, ``meta``, ``urgent``, ``broadcast``, ``hybrid``."""

    prefixes: tuple[str, ...]
    base: BuiltinType | RangeType | ScalarSetType | StructType | NamedType


@dataclass(frozen=True, slots=True)
class Declarator(Node):
    """A declared name with its array dimensions, each a size or an index type, and its initialiser."""

    name: Identifier
    dimensions: tuple[Expression | TypeExpression, ...] = ()
    initialiser: Expression | None = None


@dataclass(frozen=True, slots=True)
class VariableDeclaration(Node):
    """``type a, b[2] = {0, 1};`` ``type`` is None for ``const N 5;`` of UPPAAL 3.x."""

    type: TypeExpression | None
    declarators: tuple[Declarator, ...]


@dataclass(frozen=True, slots=True)
class TypedefDeclaration(Node):
    type: TypeExpression
    declarators: tuple[Declarator, ...]


@dataclass(frozen=True, slots=True)
class Parameter(Node):
    """``const int[0,3] i``, ``chan &c``; dimensions as in a declarator."""

    type: TypeExpression
    reference: bool
    name: Identifier
    dimensions: tuple[Expression | TypeExpression, ...] = ()
