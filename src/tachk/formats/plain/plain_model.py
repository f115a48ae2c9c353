"""A model in nothing but UPPAAL's language: what the exporters for UPPAAL write."""

from __future__ import annotations

from dataclasses import dataclass

from tachk.base.span import Span
from tachk.syntax import ast


@dataclass(frozen=True, slots=True)
class PlainRewriting:
    """One thing that was written differently.

    Attributes:
        kind: the construct: ``"import"``, ``"location blocks"``, ``"value passing"``, ``"signal"``, ``"property"``,
            ``"observer"``, ``"constant"``, ``"name"``, ``"time unit"``, ``"hide"``, ``"return"``, ``"text"``,
            ``"field"``, ``"UPPAAL 3.x"``.
        text: what became what, a sentence without a full stop.
    """

    kind: str
    span: Span
    text: str

    def __str__(self) -> str:
        return f"{self.span}: {self.kind}: {self.text}"


@dataclass(frozen=True, slots=True)
class PlainQuery:
    """Attributes:
    name: of the property; empty if it has none.
    comment: what is said about it: its title or its documentation.
    expectation: an outcome; of a document alone, without the values of constants, it may depend on them.
    conditional: what the model states, where that depends on constants.
    """

    name: str
    formula: ast.PropertyFormula
    comment: str = ""
    expectation: ast.Expected | None = None
    conditional: ast.ConditionalExpectation | None = None


@dataclass(frozen=True, slots=True)
class PlainModel:
    """Attributes:
    declarations: the global ones, in order.
    templates: all in the classic form.
    comments: those of the document itself.
    steps: how it came from the original.
    wrong: the texts of queries that no model can have, if it matters that they stay different.
    observed: there are observers in it, whose steps of their own leave no deadlock.
    """

    span: Span
    declarations: tuple[ast.Declaration, ...]
    templates: tuple[ast.Template, ...]
    instantiations: tuple[ast.Instantiation, ...]
    system: ast.SystemLine
    progress: tuple[ast.ProgressDeclaration, ...] = ()
    gantt: tuple[ast.GanttDeclaration, ...] = ()
    queries: tuple[PlainQuery, ...] = ()
    time_unit: str = ""
    comments: tuple[ast.Comment, ...] = ()
    steps: tuple[PlainRewriting, ...] = ()
    observed: bool = False
    wrong: tuple[str, ...] = ()

    def items(self) -> tuple[ast.Item, ...]:
        """Everything but the queries in the order in which UPPAAL reads it."""
        return (
            *self.declarations,
            *self.templates,
            *self.instantiations,
            self.system,
            *self.progress,
            *self.gantt,
        )
