"""From queries to explorations: what has to be reached, and which questions can share one search."""

from __future__ import annotations

from collections.abc import Iterable

from tachk.model.expressions import Deadlock, Expression, Reference, Variable
from tachk.model.query import Observer, Query
from tachk.model.traversal import walk
from tachk.model.types import ClockType, leaves
from tachk.records import dataclass
from tachk.reduction.spectators import speaks_of_nothing


@dataclass(frozen=True, slots=True)
class Task:
    """A query, its number among those that were asked, and the states whose reachability decides it."""

    number: int
    query: Query
    target: Expression

    @classmethod
    def of(cls, number: int, query: Query) -> Task:
        """Raises ValueError for a query that reachability does not decide."""
        if query.target is None:
            raise ValueError(f"the query {query.name} with {query.kind.value} is not decided by reachability")
        return cls(number, query, query.target)


@dataclass(frozen=True, slots=True)
class Search:
    """Tasks that are decided by one exploration, of the network with the observer if there is one."""

    tasks: tuple[Task, ...]
    observer: Observer | None = None


def plan(tasks: Iterable[Task]) -> tuple[Search, ...]:
    """One search for each set of tasks whose queries look at the same clocks, and agree in asking for deadlock or not
    and in speaking of anything at all.

    A clock in a predicate stays alive everywhere, ``deadlock`` needs a finer abstraction, and where a query speaks of
    nothing (``E<> false``) nothing may be left out, so sharing a search with such a query would make the others pay for
    it. So would an observer: a query that has one is searched alone.
    """
    searches: dict[tuple[bool, frozenset[Variable], bool, int | None], list[Task]] = {}
    for task in tasks:
        alone = None if task.query.observer is None else task.number
        searches.setdefault((*_demands(task.target), alone), []).append(task)
    return tuple(Search(tuple(shared), shared[0].query.observer) for shared in searches.values())


def _demands(target: Expression) -> tuple[bool, frozenset[Variable], bool]:
    parts = list(walk(target))
    variables = {part.variable for part in parts if isinstance(part, Reference)}
    clocks = frozenset(filter(_has_clock, variables))
    return any(isinstance(part, Deadlock) for part in parts), clocks, speaks_of_nothing(target)


def _has_clock(variable: Variable) -> bool:
    return any(isinstance(leaf, ClockType) for _, leaf in leaves(variable.type))
