"""Queries and properties."""

from __future__ import annotations

from typing import TYPE_CHECKING

from tachk.base.records import dataclass
from tachk.base.words import QueryKind
from tachk.syntax.ast.expressions import Expression, NameExpression
from tachk.syntax.ast.nodes import Identifier, Node

if TYPE_CHECKING:
    from tachk.syntax.formula import Formula


@dataclass(frozen=True, slots=True)
class Deadline(Node):
    """``[<= bound]`` or, strict, ``[< bound]`` behind ``A<>`` and ``-->``."""

    bound: Expression
    strict: bool = False


@dataclass(frozen=True, slots=True)
class QueryFormula(Node):
    """A symbolic query.

    Attributes:
        predicate: the state predicate, the left side of ``-->``, or the restriction of ``sup`` and the like (or None).
        operands: the right side of ``-->``; the list of ``sup`` and the like.
        deadline: of ``A<>`` and ``-->``.
    """

    kind: QueryKind
    predicate: Expression | None
    operands: tuple[Expression, ...] = ()
    deadline: Deadline | None = None


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


@dataclass(frozen=True, slots=True)
class ScenarioTime(Node):
    """``5 ms``, or a constant; without a unit in units of the model, ``unit`` is empty then."""

    amount: int | NameExpression
    unit: str = ""


@dataclass(frozen=True, slots=True)
class ScenarioStep(Node):
    """``within 5 ms send[0] with number == 0;``, or ``nothing 5 ms;``.

    Attributes:
        channel: of the event, or an array of channels; None: nothing happens for `earliest`.
        earliest, latest: since the event before; None: no bound.
        condition: what must be true when it has happened; None: nothing.
    """

    channel: Expression | None
    earliest: ScenarioTime | None = None
    latest: ScenarioTime | None = None
    condition: Expression | None = None


@dataclass(frozen=True, slots=True)
class ObservesClause(Node):
    """``observes send, deliver;``: more channels that nothing happens on but the events of the scenario."""

    channels: tuple[Expression, ...]


@dataclass(frozen=True, slots=True)
class ScenarioFormula(Node):
    """``scenario NAME { ... }``: the question whether some run has these events, in this order."""

    clauses: tuple[ScenarioStep | ObservesClause, ...]


PropertyFormula = QueryFormula | UncheckedFormula | TemporalFormula | ScenarioFormula
"""The formula of a property or a query."""


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
"""The value of ``expect``: ``holds``, ``fails``, or which of them where."""


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
    """``hide A, B;``: templates or processes that printed runs leave out."""

    names: tuple[Identifier, ...]


@dataclass(frozen=True, slots=True)
class QueryEntry(Node):
    """One query of a .q file or of the command line, with the comment that describes it."""

    formula: PropertyFormula
    comment: str = ""
    expectation: Expected | None = None
