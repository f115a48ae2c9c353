"""Paths to edges: one search that notes how each edge is taken first, and searches that go on where a path ends."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping, Sequence, Set

from tachk import _core
from tachk.base.diagnostics.diagnostic import InternalError
from tachk.base.records import replace
from tachk.engine.compiler.program import Goal, Program
from tachk.engine.core_search import core_limits, core_options, run_in_slices, statistics_of, transitions_of
from tachk.engine.options import Limits, Options, SearchOrder
from tachk.engine.outcome import Statistics
from tachk.engine.program_image import encode
from tachk.model.run import Transition

Place = tuple[int, int]
"""A process and one of its edges, or of its locations, by their numbers."""

Actions = Sequence[Sequence[int]]
"""The edges of the program that are taken together, for each action of a path."""

_STATES_ONWARD = 20_000
"""A search that goes on stops after so many states: the path that begins anew is known."""
_AT_ONCE = 32
"""So many states are explored before it looks again at what has been taken."""


class EdgePaths:
    """Shortest paths to the edges of a program, as far as a search breadth first finds them: it may drop a state for a
    larger one that is further away.

    Every path has a run, unless clocks stop. No process may be interchangeable with another one.
    """

    def __init__(self, program: Program, options: Options = Options(), limits: Limits = Limits()) -> None:
        if program.interchangeable:
            raise InternalError("paths to edges are looked for where processes keep their places")
        self._program = program
        order = SearchOrder.BFS if options.order is SearchOrder.AUTO else options.order
        self._options = _whole(options, order)
        self._image = encode(program, [Goal(())])
        self._limits = limits
        self._explorer = self._search(limits)
        self.statistics = Statistics()

    def run(self) -> str:
        """Explores everything; why the search ended before, empty if it did not: then no other edge can be taken."""
        begun = time.perf_counter()
        status, reason = run_in_slices(self._explorer, begun)
        self.statistics = statistics_of(self._explorer, begun)
        return reason if reason or status is _core.Status.FINISHED else status.name

    def paths(self) -> Mapping[Place, Actions]:
        """For each edge that was taken, by process and number, a path whose last action takes it."""
        found: dict[Place, Actions] = {}
        for edge in self._explorer.taken():
            path = self._explorer.path_to_edge(edge)
            place = self._place(edge)
            if place not in found or len(path) < len(found[place]):
                found[place] = path
        return found

    def onward(self, before: Actions, wanted: Set[Place]) -> Actions | None:
        """The way on from the end of a path to where an edge is taken that is wanted; None if none was found."""
        states = min(_STATES_ONWARD, self._limits.states or _STATES_ONWARD)
        explorer = self._search(Limits(states=states, memory_bytes=self._limits.memory_bytes))
        if not explorer.begin_after(before):
            return None
        search = _UntilTaken(explorer, lambda taken: [edge for edge in taken if self._place(edge) in wanted])
        run_in_slices(search, time.perf_counter())
        return min(map(explorer.path_to_edge, search.found), key=len, default=None)

    def taken_by(self, actions: Actions) -> frozenset[Place]:
        """The edges that a path takes."""
        return frozenset(self._place(edge) for action in actions for edge in action)

    def transitions(self, actions: Actions) -> tuple[Transition, ...]:
        return transitions_of(self._program, actions)

    def _place(self, edge: int) -> Place:
        return self._program.edges[edge].process, self._program.edges[edge].edge

    def _search(self, limits: Limits) -> _core.Explorer:
        return _core.Explorer(self._image, core_options(self._options), core_limits(limits))


def _whole(options: Options, order: SearchOrder) -> Options:
    """The options with which all states are explored, in this order."""
    return replace(options.off("attempts"), order=order, partial_order=False)


class _UntilTaken:
    """A search that is over when an edge has been taken that is wanted."""

    def __init__(self, explorer: _core.Explorer, wanted: Callable[[Iterable[int]], list[int]]) -> None:
        self._explorer, self._wanted = explorer, wanted
        self.found: list[int] = []

    def run(
        self, expansions: int, seconds: float | None = None, poll: Callable[[], None] | None = None
    ) -> _core.Status:
        status = self._explorer.run(min(expansions, _AT_ONCE), seconds, poll)
        self.found = self._wanted(self._explorer.taken())
        return _core.Status.FINISHED if self.found else status

    def statistics(self) -> tuple[int, int, int, int]:
        return self._explorer.statistics()
