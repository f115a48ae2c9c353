"""The syntax tree: what the text says, nothing resolved, every node with its place.

The tree is the common ground of the text parser, the UPPAAL XML reader, the formatter and elaboration. Comments are
kept beside it (`Document.comments`) and put back by the formatter.
"""

from __future__ import annotations

from dataclasses import field
from typing import TYPE_CHECKING

from tachk.diagnostics.span import Span
from tachk.operators import BinaryOperator, PrefixOperator
from tachk.records import dataclass

if TYPE_CHECKING:
    from tachk.syntax.formula import Formula


@dataclass(frozen=True, slots=True)
class Node:
    """Every node has a place; equality ignores it, so trees of differently laid out texts compare equal."""

    span: Span = field(compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Identifier(Node):
    name: str


# ---- expressions ------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class NameExpression(Node):
    name: str


@dataclass(frozen=True, slots=True)
class IntegerLiteral(Node):
    value: int


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


# ---- types and declarations ---------------------------------------------------------------------------------------


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
class TimeUnitDeclaration(Node):
    """``time_unit = 1 ms;``"""

    amount: int
    unit: str


@dataclass(frozen=True, slots=True)
class ImportDeclaration(Node):
    """``import "file.ta";``"""

    path: str


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


# ---- statements ---------------------------------------------------------------------------------------------------


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


# ---- templates ----------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class SelectBinding(Node):
    """``i : int[0,3]``."""

    name: Identifier
    type: TypeExpression


@dataclass(frozen=True, slots=True)
class SynchronisationLabel(Node):
    """``c!``, ``c[i]?``, or with a value ``c!e`` / ``c?x``; ``direction`` is ``!``, ``?`` or ``""`` (CSP style)."""

    channel: Expression
    direction: str
    value: Expression | None = None


@dataclass(frozen=True, slots=True)
class EdgeDeclaration(Node):
    """``source`` and ``target`` name locations or branchpoints. A conjunction written with commas (UPPAAL 3.x) is read
    as ``&&``. ``source`` is None inside a location block, where the location is the source."""

    source: Identifier | None
    target: Identifier
    selects: tuple[SelectBinding, ...] = ()
    guard: Expression | None = None
    synchronisation: SynchronisationLabel | None = None
    updates: tuple[Expression, ...] = ()
    probability: Expression | None = None
    controllable: bool = True
    doc: str = ""


@dataclass(frozen=True, slots=True)
class LocationDeclaration(Node):
    """``edges`` is empty in the classic form. ``initial``, ``urgent`` and ``committed`` are merged from the ``init``,
    ``urgent`` and ``commit`` lines of the classic form. The rate of the exponential distribution, which only
    statistical checking looks at, is ``exponential_rate`` divided by ``rate_divisor``, written ``rate : divisor``."""

    name: Identifier
    invariant: Expression | None = None
    exponential_rate: Expression | None = None
    initial: bool = False
    urgent: bool = False
    committed: bool = False
    edges: tuple[EdgeDeclaration, ...] = ()
    doc: str = ""
    rate_divisor: Expression | None = None


@dataclass(frozen=True, slots=True)
class Branchpoint(Node):
    """A choice; in the location-centric form it owns its outgoing edges."""

    name: Identifier
    edges: tuple[EdgeDeclaration, ...] = ()


@dataclass(frozen=True, slots=True)
class Template(Node):
    """Attributes:
    classic: written with ``state ... trans ...``; then ``edges`` holds all edges with their sources. Otherwise the
        locations hold them.
    """

    name: Identifier
    parameters: tuple[Parameter, ...]
    declarations: tuple[Declaration, ...]
    locations: tuple[LocationDeclaration, ...]
    branchpoints: tuple[Branchpoint, ...] = ()
    edges: tuple[EdgeDeclaration, ...] = ()
    classic: bool = True
    doc: str = ""


# ---- the system section -------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Instantiation(Node):
    """``P = T(1, x);`` or the partial ``P(const int[0,3] i) = T(i, 5);``"""

    name: Identifier
    parameters: tuple[Parameter, ...]
    template: Identifier
    arguments: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class SystemLine(Node):
    """``system A, B < C;``: groups in ascending process priority; one group where ``<`` does not occur."""

    groups: tuple[tuple[Identifier, ...], ...]


@dataclass(frozen=True, slots=True)
class ProgressMeasure(Node):
    """``e;`` or ``guard : e;``."""

    guard: Expression | None
    expression: Expression


@dataclass(frozen=True, slots=True)
class ProgressDeclaration(Node):
    """``progress { e; guard : e; }``; a hint to other tools, without meaning for the behaviour."""

    measures: tuple[ProgressMeasure, ...]


@dataclass(frozen=True, slots=True)
class GanttDeclaration(Node):
    """``gantt { ... }``: kept as text, drawing only."""

    text: str


# ---- queries and properties ---------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class QueryFormula(Node):
    """A symbolic query.

    Attributes:
        kind: ``E<>``, ``A[]``, ``A<>``, ``E[]``, ``-->``, ``sup``, ``inf`` or ``bounds``.
        predicate: the state predicate, the left side of ``-->``, or the restriction of ``sup`` and the like (or None).
        operands: the right side of ``-->``; the list of ``sup`` and the like.
    """

    kind: str
    predicate: Expression | None
    operands: tuple[Expression, ...] = ()


@dataclass(frozen=True, slots=True)
class UncheckedFormula(Node):
    """A statistical, game, learning or scenario query: kept as text and listed as not checked."""

    text: str
    family: str


@dataclass(frozen=True, slots=True)
class TemporalFormula(Node):
    """A property of runs, written as a formula or as a sentence.

    Attributes:
        formula: None for a sentence, whose meaning `tachk.logic.sentences` knows.
        sentence: the text of a sentence up to its full stop, blanks settled; empty for a formula.
    """

    formula: Formula | None
    sentence: str = ""


PropertyFormula = QueryFormula | UncheckedFormula | TemporalFormula
"""What a property or a query asks."""


@dataclass(frozen=True, slots=True)
class ConditionalExpectation(Node):
    """``fails if N > 2 else holds``: ``outcome`` where a condition on constants is true.

    Attributes:
        outcome: ``holds`` or ``fails``.
    """

    outcome: str
    condition: Expression
    otherwise: str | ConditionalExpectation


Expected = str | ConditionalExpectation
"""What ``expect`` says: ``holds``, ``fails``, or which of them where."""


@dataclass(frozen=True, slots=True)
class PropertyDeclaration(Node):
    """``property NAME "title" : formula expect holds;``."""

    name: Identifier
    title: str
    formula: PropertyFormula
    expectation: Expected | None = None
    doc: str = ""


@dataclass(frozen=True, slots=True)
class ExpectationDeclaration(Node):
    """``expect A, B fails;``: what a system expects of properties that an imported file states."""

    names: tuple[Identifier, ...]
    expectation: Expected


@dataclass(frozen=True, slots=True)
class HideDeclaration(Node):
    """``hide A, B;``: templates or processes that told runs leave out."""

    names: tuple[Identifier, ...]


@dataclass(frozen=True, slots=True)
class QueryEntry(Node):
    """One query of a .q file or of the command line, with the comment that describes it."""

    formula: PropertyFormula
    comment: str = ""
    expectation: Expected | None = None


Item = (
    Declaration
    | ImportDeclaration
    | TimeUnitDeclaration
    | Template
    | Instantiation
    | SystemLine
    | ProgressDeclaration
    | GanttDeclaration
    | PropertyDeclaration
    | ExpectationDeclaration
    | HideDeclaration
)


@dataclass(frozen=True, slots=True)
class Comment(Node):
    """``text`` with its delimiters; ``own_line`` if nothing but blanks stands before it on its line."""

    text: str
    own_line: bool


@dataclass(frozen=True, slots=True)
class Document(Node):
    """A whole text: its items in order and its comments.

    Attributes:
        legacy: the text could only be read as UPPAAL 3.x.
    """

    items: tuple[Item, ...]
    comments: tuple[Comment, ...] = field(default=(), compare=False)
    legacy: bool = field(default=False, compare=False)
