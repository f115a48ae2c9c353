"""The clauses of an edge in the one order in which every format writes them."""

from __future__ import annotations

from enum import StrEnum
from typing import Any

from tachk.base.records import dataclass
from tachk.syntax import ast


class ClauseKind(StrEnum):
    """The values are the words of the language."""

    SELECT = "select"
    GUARD = "guard"
    SYNCHRONISATION = "sync"
    UPDATES = "assign"
    PROBABILITY = "probability"

    @property
    def label(self) -> str:
        """The kind of the label in UPPAAL's XML and in pictures."""
        return _LABELS.get(self, self.value)


_LABELS = {ClauseKind.SYNCHRONISATION: "synchronisation", ClauseKind.UPDATES: "assignment"}


@dataclass(frozen=True, slots=True)
class Clause:
    """Attributes:
    value: a tuple of bindings or of updates; an expression for a guard or a probability; a synchronisation.
    """

    kind: ClauseKind
    value: Any

    @property
    def first(self) -> Any:
        """The first node of the clause."""
        return self.value[0] if isinstance(self.value, tuple) else self.value


def edge_clauses(edge: ast.EdgeDeclaration) -> tuple[Clause, ...]:
    """The clauses that an edge has, in order."""
    every = (
        Clause(ClauseKind.SELECT, edge.selects),
        Clause(ClauseKind.GUARD, edge.guard),
        Clause(ClauseKind.SYNCHRONISATION, edge.synchronisation),
        Clause(ClauseKind.UPDATES, edge.updates),
        Clause(ClauseKind.PROBABILITY, edge.probability),
    )
    return tuple(clause for clause in every if clause.value is not None and clause.value != ())
