"""The test suite of a network: runs that the judge of runs has accepted, and what no run can cover."""

from __future__ import annotations

from contextlib import AbstractContextManager
from enum import StrEnum

from tachk.analysis.fold import known_values
from tachk.base.diagnostics.diagnostic import InternalError
from tachk.base.job import (
    StoppedError,
    current_job,
    is_interrupted,
    limited,
    remembering_interruption,
    under_way,
    unhurried,
)
from tachk.base.records import dataclass, replace
from tachk.base.words import QueryKind
from tachk.engine.compiler.features import check_supported
from tachk.engine.compiler.lower import lower
from tachk.engine.edge_paths import EdgePaths, Place
from tachk.engine.exact.concretise import concretise
from tachk.engine.options import Limits, Options
from tachk.engine.outcome import INTERRUPTED, TIME_LIMIT, Statistics
from tachk.meaning.discrete import PreparedNetwork, prepare
from tachk.meaning.initial_state import check_initial_state
from tachk.meaning.judge.replay import ReplayError, replay
from tachk.model.expressions import BOOL, Constant
from tachk.model.network import Network
from tachk.model.query import Query
from tachk.model.run import TimedTrace, Transition
from tachk.model.selections import check_selections
from tachk.transform.unfolded_edges import UnfoldedNetwork, unfolded_by_edges
from tachk.verify.covering.coverage import Coverage
from tachk.verify.covering.covering_paths import covering_paths
from tachk.verify.covering.single_search import search_for
from tachk.verify.semantic_lint.reached import switched_off
from tachk.verify.verdict import Answer

_SEARCH_SHARE, _CHOICE_SHARE = 0.5, 0.1
"""Of the time, for the search that looks for everything at once, and for the choice among what it finds."""


class Impossibility(StrEnum):
    """Why nothing covers a place, each proved."""

    FALSE_GUARD = "its guard is false with these constants"
    UNREACHED_SOURCE = "no run reaches the location that it leaves"
    NEVER_TAKEN = "no run takes it"
    NEVER_VISITED = "no run visits it"


@dataclass(frozen=True, slots=True)
class CoveringRun:
    """Attributes:
    covered: all that the run covers.
    new: of that, what no run before it covers.
    """

    run: TimedTrace
    covered: frozenset[Place]
    new: frozenset[Place]


@dataclass(frozen=True, slots=True)
class CoveringSuite:
    """Runs that together cover all that can be covered, but for what is unknown.

    Attributes:
        places: all that was to be covered.
        impossible: what no run covers, with the reason.
        unknown: what was neither covered nor proved impossible, with the reason: the limit that was hit.
        statistics: of the search that looked for everything at once.
    """

    coverage: Coverage
    places: frozenset[Place]
    runs: tuple[CoveringRun, ...]
    impossible: tuple[tuple[Place, Impossibility], ...]
    unknown: tuple[tuple[Place, str], ...]
    statistics: Statistics

    @property
    def covered(self) -> frozenset[Place]:
        missing = (place for place, _ in (*self.impossible, *self.unknown))
        return self.places - frozenset(missing)

    @property
    def steps(self) -> int:
        """The transitions of all runs."""
        return sum(len(each.run.path) for each in self.runs)


def covering_suite(
    network: Network, coverage: Coverage, options: Options = Options(), limits: Limits = Limits()
) -> CoveringSuite:
    """Looks for few runs that together cover all that can be covered.

    One search notes how each edge is taken first. If a limit stops it, what it has not met is searched for one by one
    in half of the time, each with the same share of what is left. Every run has been replayed by `tachk.meaning.judge`.

    Raises InputError where the initial state violates an invariant, UnsupportedError for a network that cannot be
    checked, and UsageError for pairs of edges where something depends on the location of a process.
    """
    if coverage is Coverage.PAIRS:
        unfolded = unfolded_by_edges(network)
        suite = _covering_suite(unfolded.network, coverage, options, limits)
        return replace(suite, runs=tuple(_lifted(unfolded, each) for each in suite.runs))
    return _covering_suite(network, coverage, options, limits)


def _lifted(unfolded: UnfoldedNetwork, covering: CoveringRun) -> CoveringRun:
    """Raises InternalError if the run is none of the network itself."""
    run = unfolded.lift(covering.run)
    if run is None:
        raise InternalError("a run found for pairs of edges is no run of the network")
    return replace(covering, run=run)


def _covering_suite(network: Network, coverage: Coverage, options: Options, limits: Limits) -> CoveringSuite:
    check_selections(network)
    check_supported(network, Query("", QueryKind.POSSIBLY, Constant(1, BOOL)))
    model = prepare(network)
    check_initial_state(model)
    try:
        with remembering_interruption(), limited(limits.seconds):
            return _CoveringSearch(model, coverage, options, limits).suite()
    except StoppedError as error:  # before anything was found
        start, places = coverage.at_start(network), coverage.all(network)
        unknown = tuple((place, error.reason) for place in sorted(places - start))
        return CoveringSuite(coverage, places, (), (), unknown, Statistics())


class _CoveringSearch:
    """The runs found so far, and what they cover."""

    def __init__(self, model: PreparedNetwork, coverage: Coverage, options: Options, limits: Limits) -> None:
        self.model, self.network, self.coverage = model, model.network, coverage
        self.options, self.limits = options, limits
        self.runs: list[CoveringRun] = []
        self.covered = set(coverage.at_start(self.network))
        self.impossible: dict[Place, Impossibility] = {}
        self.unknown: dict[Place, str] = {}

    def suite(self) -> CoveringSuite:
        places = self.coverage.all(self.network)
        reason, doubtful, statistics = self._at_once()
        self._note_false_guards()
        visited = self._visited()
        left = sorted(places - self.covered - self.impossible.keys())
        for number, place in enumerate(left):
            if place in self.covered:
                continue
            if reason or place in doubtful:
                self._alone(place, len(left) - number)
            else:
                self.impossible[place] = self._why_never(place, visited)
        return CoveringSuite(
            self.coverage,
            places,
            self._needed(),
            tuple(sorted(self.impossible.items())),
            tuple(sorted((place, why) for place, why in self.unknown.items() if place not in self.covered)),
            statistics,
        )

    def _at_once(self) -> tuple[str, frozenset[Place], Statistics]:
        """The search for everything: why it ended before it was through, and the places to which a path has no run."""
        program, _ = lower(self.network)
        exact = not program.has_stopwatches
        edges = EdgePaths(program, self.options, self.limits)
        with _share(_SEARCH_SHARE):
            reason = edges.run()
        with _share(_CHOICE_SHARE):
            paths = covering_paths(self.network, self.coverage, edges, exact)
        with unhurried():
            for path in paths:
                self._add(edges.transitions(path), exact)
            found = frozenset(self.coverage.by_edge(self.network, edge) for edge in edges.paths())
        return reason, found - self.covered, edges.statistics

    def _add(self, path: tuple[Transition, ...], exact: bool) -> None:
        """Judges the run of a path. Raises InternalError if there is none although each path should have one."""
        covered = self.coverage.by_path(self.network, path)
        if covered <= self.covered:
            return
        run = concretise(self.model, path)
        if run is None:
            if exact:
                raise InternalError("a path found for coverage has no timed run")
            return
        try:
            replay(self.model, run)
        except ReplayError as error:
            raise InternalError(f"a run found for coverage does not replay: {error}") from error
        self.runs.append(CoveringRun(run, covered, covered - self.covered))
        self.covered |= covered

    def _note_false_guards(self) -> None:
        if self.coverage is not Coverage.LOCATIONS:
            off = switched_off(self.network, known_values(self.network, []))
            self.impossible |= dict.fromkeys(off - self.covered, Impossibility.FALSE_GUARD)

    def _visited(self) -> frozenset[Place]:
        """The locations that the runs visit."""
        return Coverage.LOCATIONS.at_start(self.network).union(
            *(Coverage.LOCATIONS.by_path(self.network, each.run.path) for each in self.runs)
        )

    def _why_never(self, place: Place, visited: frozenset[Place]) -> Impossibility:
        """Of a place that nothing covers, as a search through all states has shown."""
        if self.coverage is Coverage.LOCATIONS:
            return Impossibility.NEVER_VISITED
        number, edge = place
        source = self.network.processes[number].edges[edge].source
        return Impossibility.NEVER_TAKEN if (number, source) in visited else Impossibility.UNREACHED_SOURCE

    def _alone(self, place: Place, shares: int) -> None:
        """Searches for one place, in its share of the time that is left."""
        seconds = current_job().seconds_left
        if is_interrupted() or (seconds is not None and seconds <= 0):
            self.unknown[place] = INTERRUPTED if is_interrupted() else TIME_LIMIT
            return
        limits = replace(self.limits, seconds=None if seconds is None else seconds / shares)
        verdict = search_for(self.network, self.coverage, place, self.options, limits)
        if verdict.answer is Answer.HOLDS and verdict.trace is not None:
            with unhurried():
                self._add(verdict.trace.path, exact=True)
        elif verdict.answer is Answer.FAILS:
            edges = self.coverage is not Coverage.LOCATIONS
            self.impossible[place] = Impossibility.NEVER_TAKEN if edges else Impossibility.NEVER_VISITED
        else:
            self.unknown[place] = verdict.reason or (verdict.unsupported.message if verdict.unsupported else "")

    def _needed(self) -> tuple[CoveringRun, ...]:
        """The runs without those that cover nothing alone: runs that were found later may cover it all."""
        start = self.coverage.at_start(self.network)
        runs = list(self.runs)
        for each in sorted(self.runs, key=lambda one: len(one.run.path)):
            others = frozenset().union(*(other.covered for other in runs if other is not each))
            if each.covered - start <= others:
                runs.remove(each)
        needed = []
        for each in runs:
            needed.append(replace(each, new=each.covered - start))
            start |= each.covered
        return tuple(needed)


def _share(part: float) -> AbstractContextManager[None]:
    """A job with a part of the time that is left, even if that is none: what was found before is not lost."""
    job = current_job()
    return under_way(job if job.seconds_left is None else job.narrowed(part * job.seconds_left))
