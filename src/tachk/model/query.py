"""Questions about a network, with their names resolved."""

from __future__ import annotations

from enum import StrEnum
from typing import assert_never

from tachk.base.records import dataclass
from tachk.base.span import NOWHERE, Span
from tachk.base.words import QueryKind
from tachk.model.connectives import negation
from tachk.model.expressions import Expression, Variable
from tachk.model.network import Process


class Expectation(StrEnum):
    HOLDS = "holds"
    FAILS = "fails"


@dataclass(frozen=True, slots=True)
class JoinedChannel:
    """A channel by which two processes join that an observer hears: their edges note what happens.

    Attributes:
        channel: the channel, or the array of channels.
        element: the variable of the observer for the number of what has happened.
        numbers: the constant array of these numbers, by the place of a channel among those of its array; below 0: the
            observer does not hear it.
        updates: what happens at the end of the edges that receive, with that number; the last one is `forgets`.
    """

    channel: Variable
    element: Variable
    numbers: Variable
    updates: tuple[Expression, ...]

    @property
    def forgets(self) -> Expression:
        """The update that sets the number back."""
        return self.updates[-1]


@dataclass(frozen=True, slots=True)
class Observer:
    """An automaton beside a network that watches for violations of a temporal formula and hinders nothing.

    Attributes:
        process: to be added to the network behind all others.
        bad: the location that is reachable if and only if a finite run violates the formula.
        endings: the locations that a run without end violates the formula by never leaving.
        entries: where it gets into them.
        formula: the formula with its bounds as numbers, as text; empty for a scenario.
        triggers: for each implication that the formula demands always, its left side as text, and what must be true
            in some state so that the left side ever is.
        demanded: the conditions that must be true at all instants, each with its text.
        awaited: the conditions that must come and last, each with its text.
        sufficient: a condition on one state: where it is true in all states, the formula holds; None: none is known.
        joined: the channels by which two processes join that it hears.
    """

    process: Process
    bad: int
    formula: str
    endings: tuple[int, ...] = ()
    entries: tuple[int, ...] = ()
    triggers: tuple[tuple[str, Expression], ...] = ()
    demanded: tuple[tuple[str, Expression], ...] = ()
    awaited: tuple[tuple[str, Expression], ...] = ()
    sufficient: Expression | None = None
    joined: tuple[JoinedChannel, ...] = ()


@dataclass(frozen=True, slots=True)
class QueryDeadline:
    """The upper bound on a time, in time units; ``strict``: the time is less than the bound."""

    bound: int
    strict: bool = False


@dataclass(frozen=True, slots=True)
class Query:
    """A question about the runs of a network.

    Attributes:
        name: as given by a property line, else ``q1``, ``q2``, ... in order.
        kind: the operator.
        predicate: the state predicate; for LEADS_TO the left side, for SUPREMUM and the like the restriction or None.
        operands: LEADS_TO: the right side; SUPREMUM and the like: the expressions. Empty otherwise.
        text: the formula as the user wrote it.
        conditional: the expectation depends on constants, so that it is about other values of them, too.
        deadline: of EVENTUALLY and LEADS_TO: since the start, since the left side.
        observer: what has to be added to the network for this query alone; the predicate names its location.
        non_zeno: a run with infinitely many transitions counts only if time diverges in it.
        again: predicates without clocks; only runs count that meet each of them again and again, or end.
        ends: one that is true where such a run ends; None: it may end anywhere.
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
    deadline: QueryDeadline | None = None
    non_zeno: bool = False
    again: tuple[Expression, ...] = ()
    ends: Expression | None = None

    def __repr__(self) -> str:
        return f"<Query {self.name}: {self.text}>"

    @property
    def holds_when_reached(self) -> bool | None:
        """True if the query holds once one state satisfies `target`, False if it fails then; None if no single state
        decides it."""
        match self.kind:
            case QueryKind.POSSIBLY:
                return True
            case QueryKind.INVARIANTLY:
                return False
            case QueryKind.EVENTUALLY | QueryKind.POTENTIALLY_ALWAYS | QueryKind.LEADS_TO:
                return None
            case QueryKind.SUPREMUM | QueryKind.INFIMUM | QueryKind.BOUNDS:
                return None
            case never:
                assert_never(never)

    @property
    def target(self) -> Expression | None:
        """The states whose reachability decides the query; None exactly where `holds_when_reached` is None."""
        if self.holds_when_reached is None or self.predicate is None:
            return None
        if self.holds_when_reached:
            return self.predicate
        return negation(self.predicate)

    @property
    def avoided(self) -> Expression | None:
        """The condition that a run must avoid for ever to decide the query; None where no single run decides it."""
        match self.kind:
            case QueryKind.EVENTUALLY:
                return self.predicate
            case QueryKind.POTENTIALLY_ALWAYS:
                assert self.predicate is not None
                return negation(self.predicate)
            case QueryKind.LEADS_TO:
                return self.operands[0]
            case QueryKind.POSSIBLY | QueryKind.INVARIANTLY:
                return None
            case QueryKind.SUPREMUM | QueryKind.INFIMUM | QueryKind.BOUNDS:
                return None
            case never:
                assert_never(never)

    @property
    def begins(self) -> Expression | None:
        """The states in which such a run may begin to avoid it; None: the initial state."""
        return self.predicate if self.kind is QueryKind.LEADS_TO else None
