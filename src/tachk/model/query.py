"""Questions about a network, with their names resolved."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from tachk.diagnostics.span import NOWHERE, Span
from tachk.model.expressions import Expression


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
class Query:
    """Attributes:
    name: as given by a property line, else ``q1``, ``q2``, ... in order.
    kind: the operator.
    predicate: the state predicate; for LEADS_TO the left side, for SUPREMUM and the like the restriction or None.
    operands: LEADS_TO: the right side; SUPREMUM and the like: the expressions. Empty otherwise.
    text: the formula as the user wrote it.
    """

    name: str
    kind: QueryKind
    predicate: Expression | None
    operands: tuple[Expression, ...] = ()
    text: str = ""
    title: str = ""
    expectation: Expectation | None = None
    span: Span = NOWHERE
