"""A whole text: what stands in it beside templates, declarations and properties."""

from __future__ import annotations

from tachk.base.records import dataclass, field
from tachk.base.words import Direction
from tachk.syntax.ast.declarations import Declaration
from tachk.syntax.ast.expressions import Expression, Parameter
from tachk.syntax.ast.nodes import Identifier, Node
from tachk.syntax.ast.properties import ExpectationDeclaration, HideDeclaration, PropertyDeclaration
from tachk.syntax.ast.templates import Template


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


@dataclass(frozen=True, slots=True)
class ReplacesClause(Node):
    """``replaces P, Q;``: the processes whose place a recording takes."""

    names: tuple[Identifier, ...]


@dataclass(frozen=True, slots=True)
class RecordedColumn(Node):
    """``number`` or ``number = e``: a column of a recorded event and what it says; without ``e`` what has its name."""

    name: Identifier
    expression: Expression | None


@dataclass(frozen=True, slots=True)
class VisibleClause(Node):
    """``visible send[l][k] as sent(link = l, kind = k, number) per l;``

    Attributes:
        channel: its indices are constants, or names for what the recording says.
        direction: whether the model sends (``send[l]!``) or receives; None: as the channels show.
        per: the indices that events of one stream have in common.
    """

    channel: Expression
    direction: Direction | None
    event: Identifier
    columns: tuple[RecordedColumn, ...]
    per: tuple[Identifier, ...]


@dataclass(frozen=True, slots=True)
class HiddenClause(Node):
    """``hidden write, call;``: channels on which what is replaced may do what it likes."""

    channels: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class AllowanceClause(Node):
    """``tolerance 5 ms;``, ``late 20 ms;`` or ``late input 1 ms;``; without a unit in units of the model, ``unit`` is
    empty then.

    Attributes:
        side: ``input`` or ``output``, whose lateness it is; empty where none is named.
    """

    word: str
    side: str
    amount: int
    unit: str


@dataclass(frozen=True, slots=True)
class RecordedModelClause(Node):
    """``import "recorded.ta" (GUARDED, WAIT = 2 * PACE);``: recordings are held against that model.

    Attributes:
        constants: constants of that model, with what they are here.
    """

    path: str
    constants: tuple[RecordedColumn, ...]


RecordingClause = ReplacesClause | VisibleClause | HiddenClause | AllowanceClause | RecordedModelClause


@dataclass(frozen=True, slots=True)
class RecordingDeclaration(Node):
    """``recording { ... }``: how recordings of the real system are held against the model."""

    clauses: tuple[RecordingClause, ...]


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
    | RecordingDeclaration
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
