"""Questions about a network, with their names resolved."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from tachk.diagnostics.span import NOWHERE, Span
from tachk.model.expressions import Expression
from tachk.model.network import Process


class QueryKind(StrEnum):
    POSSIBLY = "E<>"
    INVARIANTLY = "A[]"
    EVENTUALLY = "A<>"
    POTENTIALLY_ALWAYS = "E[]"
    LEADS_TO = "-->"
    SUPREMUM = "sup"
    INFIMUM = "inf"
    BOUNDS = "bounds"


class Expectation(StrEnum):
    HOLDS = "holds"
    FAILS = "fails"


@dataclass(frozen=True, slots=True)
class Observer:
    """An automaton beside a network that watches for violations of a temporal formula and hinders nothing.

    Attributes:
        process: to be added to the network behind all others.
        bad: the location that is reachable if and only if the formula can be violated.
        formula: the formula with its bounds as numbers, as text.
    """

    process: Process
    bad: int
    formula: str


@dataclass(frozen=True, slots=True)
class Query:
    """Attributes:
    name: as given by a property line, else ``q1``, ``q2``, ... in order.
    kind: the operator.
    predicate: the state predicate; for LEADS_TO the left side, for SUPREMUM and the like the restriction or None.
    operands: LEADS_TO: the right side; SUPREMUM and the like: the expressions. Empty otherwise.
    text: the formula as the user wrote it.
    conditional: the expectation depends on constants, so that it speaks of other values of them, too.
    observer: what has to be added to the network for this query alone; the predicate names its location.
    """

    name: str
    kind: QueryKind
    predicate: Expression | None
    operands: tuple[Expression, ...] = ()
    text: str = ""
    title: str = ""
    expectation: Expectation | None = None
    span: Span = NOWHERE
    observer: Observer | None = None
    conditional: bool = False
