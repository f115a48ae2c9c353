"""From queries to explorations: what has to be found out, and which questions can share one search."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from enum import StrEnum
from typing import assert_never

from tachk.base.records import dataclass, replace
from tachk.base.words import QueryKind
from tachk.model.connectives import negation
from tachk.model.expressions import Deadlock, Expression, Reference, Variable
from tachk.model.query import Observer, Query
from tachk.model.traversal import walk
from tachk.model.types import ClockType, leaves
from tachk.transform.cone_of_influence import speaks_of_nothing


class Analysis(StrEnum):
    """A task: the question that decides a query."""

    REACHABILITY = "reachability"
    """Is some state of a set reached?"""
    LIVENESS = "liveness"
    """Is there a run that never reaches a state of a set?"""
    EXTREMES = "extremes"
    """The largest and least values of expressions."""


def analysis_of(query: Query) -> Analysis:
    match query.kind:
        case QueryKind.POSSIBLY | QueryKind.INVARIANTLY:
            return Analysis.REACHABILITY
        case QueryKind.EVENTUALLY | QueryKind.POTENTIALLY_ALWAYS | QueryKind.LEADS_TO:
            return Analysis.LIVENESS
        case QueryKind.SUPREMUM | QueryKind.INFIMUM | QueryKind.BOUNDS:
            return Analysis.EXTREMES
        case never:
            assert_never(never)


@dataclass(frozen=True, slots=True)
class Task:
    """A query, and its number among all queries of the user.

    Attributes:
        condition: in its place: where it is true in all states, the query holds, and otherwise nothing is known.
    """

    number: int
    query: Query
    condition: Expression | None = None

    def __hash__(self) -> int:
        return self.number  # no other task has it, and a query is long

    @property
    def target(self) -> Expression:
        """The states whose reachability decides the query. Raises ValueError where reachability does not."""
        if self.condition is not None:
            return negation(self.condition)
        if self.query.target is None:
            raise ValueError(f"the query {self.query.name} with {self.query.kind.value} is not decided by reachability")
        return self.query.target


@dataclass(frozen=True, slots=True)
class Search:
    """Tasks that are decided by one exploration, of the network with the observer if there is one."""

    analysis: Analysis
    tasks: tuple[Task, ...]
    observer: Observer | None = None

    @property
    def explores_everything(self) -> bool:
        """True if nothing of the network may be left out, because it asks for deadlock."""
        return self.analysis is Analysis.REACHABILITY and any(_asks_deadlock(task.target) for task in self.tasks)

    @property
    def names(self) -> tuple[str, ...]:
        """The names of its queries."""
        return tuple(task.query.name for task in self.tasks)

    @property
    def targets(self) -> list[Expression]:
        return [task.target for task in self.tasks]

    def without(self, numbers: Collection[int]) -> Search:
        """The search for the tasks with other numbers."""
        return replace(self, tasks=tuple(task for task in self.tasks if task.number not in numbers))


def plan(tasks: Iterable[Task]) -> tuple[Search, ...]:
    """One search for each set of tasks whose queries look at the same clocks, and agree in asking for deadlock or not
    and in speaking of anything at all.

    A clock in a predicate stays alive everywhere, ``deadlock`` needs a finer abstraction, and where a query is about
    nothing (``E<> false``) nothing may be left out, so sharing a search with such a query would make the others pay for
    it. So would an observer: a query that has one is searched alone, as is every query of another analysis.
    """
    searches: dict[tuple[Analysis, frozenset[Variable], bool, bool, int | None], list[Task]] = {}
    for task in tasks:
        searches.setdefault(_demands(task), []).append(task)
    return tuple(Search(key[0], tuple(shared), shared[0].query.observer) for key, shared in searches.items())


def _demands(task: Task) -> tuple[Analysis, frozenset[Variable], bool, bool, int | None]:
    """The key of tasks that share a search; the number of the task where it shares with none."""
    analysis = analysis_of(task.query)
    if analysis is not Analysis.REACHABILITY:
        return analysis, frozenset(), False, False, task.number
    target = task.target
    parts = list(walk(target))
    variables = {part.variable for part in parts if isinstance(part, Reference)}
    asks_deadlock = _asks_deadlock(target)
    alone = None if task.query.observer is None else task.number
    return analysis, frozenset(filter(_has_clock, variables)), asks_deadlock, speaks_of_nothing(target), alone


def _asks_deadlock(target: Expression) -> bool:
    return any(isinstance(part, Deadlock) for part in walk(target))


def _has_clock(variable: Variable) -> bool:
    return any(isinstance(leaf, ClockType) for _, leaf in leaves(variable.type))
