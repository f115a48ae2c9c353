"""Options and limits of the engines. Imports nothing heavy: options of commands are made of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from enum import StrEnum

from tachk.base.arguments import check_argument
from tachk.base.diagnostics.diagnostic import UsageError
from tachk.base.records import dataclass, replace
from tachk.base.seeds import DEFAULT_SEED


class Engine(StrEnum):
    """The engines that decide queries."""

    ZONE = "zone"
    SMT = "smt"
    """z3, by bounded model checking and induction; see `tachk.engine.smt`."""
    BOTH = "both"
    """One after the other; a contradiction between them is an internal error."""


class Pace(StrEnum):
    """The run to a state that is shown."""

    EARLY = "early"
    """One along the path that was found, early."""
    FASTEST = "fastest"
    """A run that takes the least time of all runs."""
    SLOWEST = "slowest"
    """The one along the path that was found whose last transition is latest."""


class SearchOrder(StrEnum):
    """The order in which states are explored; without a limit it changes no verdict."""

    AUTO = "auto"
    """Breadth first; by progress from the moment on when most states that were explored turn out to be covered by
    later ones."""
    BFS = "bfs"
    DFS = "dfs"
    RANDOM_DFS = "rdfs"
    PROGRESS = "progress"
    """The states first that have come least far, counted in rounds and layers of the locations of each process."""
    BEST_FIRST = "best-first"
    """The states first that are nearest to the goal, by the edges that each process still has to take and the variables
    that have other values (greedy best-first search)."""

    @property
    def finds_shortest(self) -> bool:
        """True if the path that is found first can be a shortest one."""
        return self in (SearchOrder.AUTO, SearchOrder.BFS)


class Extrapolation(StrEnum):
    """How zones are made larger, so that there are finitely many; none of the ways changes a verdict."""

    LU = "lu"
    """Extra+LU of Behrmann, Bouyer, Larsen, Pelánek 2006 (LU+). A deadlock found
    with it is tried exactly, and MAX searches again where it proves not to be one."""
    MAX = "max"
    """The same operator with L = U = the larger of both: preserves enabledness (deadlock, priorities)."""
    NONE = "none"

    @property
    def keeps_deadlocks(self) -> bool:
        """True if a widened valuation is in a deadlock only if one from which it comes is."""
        return self in (Extrapolation.MAX, Extrapolation.NONE)


class BoundScope(StrEnum):
    LOCAL = "local"
    """Clock bounds for each location."""
    GLOBAL = "global"
    """One bound for each clock in the whole model."""


class LocalTimes(StrEnum):
    """Searches in which each process has a time of its own, where that is sound: `tachk.engine.local_times`."""

    AUTO = "auto"
    """If the first states show that it saves many."""
    ALWAYS = "always"


LARGEST_SEED = 2**32 - 1
NEVER = 2**32 - 1
"""`Options.proof_after` for no proof at all."""
MOST_PROCESSES = 256


REDUCTIONS = {
    "alu": "drop a state also if a stored zone simulates its zone: the exact test for the abstraction aLU (Herbreteau, "
    "Srivathsan, Walukiewicz 2012), tried now and then and kept where it often says yes. Not where a query is about "
    "`deadlock` or of largest and smallest values, nor for runs that go on for ever.",
    "merging": "make one state of states that wait to be explored and differ in their zones only, where these together "
    "are a zone, as long as that often is so. Breadth first; not with `shortest`, `partial_order`, a limit "
    "on depth, nor for largest and smallest values or runs that go on for ever.",
    "pruning": "for `E<>` and `A[]`: drop a state from which one process, or one variable, that the goal names can no "
    "longer come to what the goal asks, whatever everybody else does: a backward search over the locations of one "
    "process and the intervals of one of its clocks, or over the values of one variable. Not where a run-time error "
    "may lie ahead, clocks stop, or the goal contains `deadlock`, nor for largest and smallest values.",
    "attempts": "for `A<>`, `E[]` and `-->`: on the way to all states, explore up to one state for every eight depth "
    "first, so that a run is found early. For `E<>` and `A[]` with the order `AUTO`: once 20,000 states are stored, "
    "explore up to 5,000 as with `partial_order`, if that is of use in a quarter of the first 256, and then 1,500 "
    "depth first with processes that keep their places, each in a search of its own; not with `shortest`.",
    "cone": "freeze processes that cannot influence the answer (cone of influence).",
    "symmetry": "search one state for all that differ by an exchange of interchangeable processes.",
    "local-times": "let each process have a time of its own in a search, where that is sound and seems to save states.",
}
"""Reductions of the states of all searches. Each is on unless `Options.without` names it."""


@dataclass(frozen=True, slots=True)
class Options:
    """Options of a search. None of them changes a verdict.

    Attributes:
        engine: the engine that decides; all other options are of the zone engine.
        order: the order in which states are explored; BFS gives short paths, and so does AUTO where it stays with it.
        seed: for RANDOM_DFS, from 0 to 2**32 - 1.
        extrapolation: the zone abstraction.
        bounds: where the clock bounds of the abstraction come from.
        subsumption: drop a state whose zone lies inside a stored zone, not only equal ones.
        width: the least number of bits of a clock bound in a zone: 16, 32 or 64; constants that do not fit need more.
        scale: count time in the largest unit of which every time in the model is a multiple.
        vector: use the widest vector instructions of this machine; off: portable code.
        reclaim: use the memory of zones again that no uncovered state has.
        pack_clocks: zones of more clocks than this are stored without those that do not matter where the processes are.
        partial_order: where time cannot pass, because of an urgent or committed location or an invariant, one order of
            independent actions is explored, not each of them; off: only in an attempt (see there). Not with `shortest`,
            a limit on depth, priorities, clocks that stop, interchangeable processes, or where the query contains
            `deadlock` or is about extreme values.
        chunk_words: large discrete states are held in parts of so many 64-bit words, each part once; 0: in one.
        rows_after: from how many different zones on their rows are held once each, if that takes less memory; 0:
            always.
        reduced_after: the same of zones in reduced form, the constraints from which the others follow, where a zone
            has 8 to 63 clocks and bounds of 16 or 32 bits, if that takes far less memory.
        local_times: search over local times, which saves the orders in which independent transitions happen. Only where
            that is sound, and not with `shortest` or a limit on depth.
        proof_after: for `A<>` and `E[]`: how many states are explored depth first before a search breadth first looks
            for a short proof that there is no run; for `-->` it does so at once. 2**32 - 1: never.
        processes: how many searches for different queries run at the same time, each in a process of its own, once a
            second has passed; 0: as many as the machine has cores, up to eight. On Windows one. Where there are more
            than searches, `attempts` run beside each in a thread of its own.
        without: what is switched off, by name: strategies (`tachk.verify.strategies`), and the `REDUCTIONS`.
        shortest: find paths of as few transitions as possible; with BFS only, which AUTO then is. It may take more
            states: a state is dropped for a larger one only if that is not further from the initial state.
        pace: which run to a state that was found is shown; FASTEST takes further searches.

    Where an enumeration is expected, the value of a member will do: ``Options(engine="smt")``.

    Raises UsageError for a number out of its range, for a text that is no member, and for `shortest` with another order
    than BFS.
    """

    order: SearchOrder = SearchOrder.AUTO
    seed: int = DEFAULT_SEED
    extrapolation: Extrapolation = Extrapolation.LU
    bounds: BoundScope = BoundScope.LOCAL
    subsumption: bool = True
    width: int = 16
    scale: bool = True
    vector: bool = True
    reclaim: bool = True
    pack_clocks: int = 16
    local_times: LocalTimes = LocalTimes.AUTO
    partial_order: bool = False
    chunk_words: int = 8
    rows_after: int = 1024
    reduced_after: int = 1024
    proof_after: int = 2000
    processes: int = 1
    without: frozenset[str] = frozenset()
    shortest: bool = False
    engine: Engine = Engine.ZONE
    pace: Pace = Pace.EARLY

    @property
    def cone(self) -> bool:
        """Whether processes that cannot influence an answer are frozen."""
        return "cone" not in self.without

    @property
    def symmetry(self) -> bool:
        """Whether one state is explored for all that differ only in which interchangeable process is which."""
        return "symmetry" not in self.without

    def off(self, *names: str) -> Options:
        """These options with the reductions of these names switched off."""
        return replace(self, without=self.without | set(names))

    def on(self, *names: str) -> Options:
        """These options with the reductions of these names switched on."""
        return replace(self, without=self.without - set(names))

    def __post_init__(self) -> None:
        for name, kind in _KINDS.items():
            object.__setattr__(self, name, _member(name, kind, getattr(self, name)))
        names: Iterable[str] = self.without
        object.__setattr__(self, "without", frozenset([names] if isinstance(names, str) else names))
        _check_range("seed", self.seed, 0, LARGEST_SEED)
        _check_range("chunk_words", self.chunk_words, 0, 2**16)
        _check_range("rows_after", self.rows_after, 0, 2**32 - 1)
        _check_range("reduced_after", self.reduced_after, 0, 2**32 - 1)
        _check_range("proof_after", self.proof_after, 0, NEVER)
        _check_range("pack_clocks", self.pack_clocks, 0, 2**32 - 1)
        _check_range("processes", self.processes, 0, MOST_PROCESSES)
        if self.width not in (16, 32, 64):
            raise UsageError(f"`width` is 16, 32 or 64, not {self.width}")
        if self.shortest and not self.order.finds_shortest:
            raise UsageError(
                f"a shortest path needs the search order bfs, not {self.order.value}",
                "breadth-first search is what makes the first path that is found a shortest one",
            )


_KINDS: Mapping[str, type[StrEnum]] = {
    "order": SearchOrder,
    "extrapolation": Extrapolation,
    "bounds": BoundScope,
    "local_times": LocalTimes,
    "engine": Engine,
    "pace": Pace,
}


def _member(name: str, kind: type[StrEnum], value: object) -> StrEnum:
    """The member that a value is or names. Raises UsageError."""
    for member in kind:
        if value == member:
            return member
    raise UsageError(f"`{name}` is {value!r}, but it must be one of {', '.join(kind)}")


@dataclass(frozen=True, slots=True)
class Limits:
    """The limits of a search; None means no limit.

    Attributes:
        states: stored states.
        seconds: wall-clock seconds for everything together.
        seconds_each: wall-clock seconds for each search; queries that look at the same clocks share one.
        memory_bytes: the limit on the bytes that a search stores; and, with a tenth more, on the growth of the process
            meanwhile, if the system reports it.
        depth: transitions from the initial state.

    Raises UsageError for a negative limit.
    """

    states: int | None = None
    seconds: float | None = None
    memory_bytes: int | None = None
    depth: int | None = None
    seconds_each: float | None = None

    def of_states(self, states: int) -> Limits:
        """These limits, and that no more than so many states are stored."""
        return replace(self, states=states if self.states is None else min(states, self.states))

    def __post_init__(self) -> None:
        for name in ("states", "seconds", "memory_bytes", "depth", "seconds_each"):
            value = getattr(self, name)
            check_argument(name, value, "float | None" if name.startswith("seconds") else "int | None")
            if value is not None and not value >= 0:  # nan included
                raise UsageError(f"the limit `{name}` is {value}, but it must be at least 0")


def _check_range(name: str, value: int, low: int, high: int) -> None:
    check_argument(name, value, "int")
    if not low <= value <= high:
        raise UsageError(f"`{name}` is {value}, but it must lie in [{low}, {high}]")
