"""Test suites of random networks against walks through regions, and against the smallest suites."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from contextlib import suppress
from itertools import combinations
from random import Random

import pytest

from tachk.base.diagnostics.diagnostic import InputError, UsageError
from tachk.engine.edge_paths import Place
from tachk.engine.options import Limits, Options
from tachk.engine.zone_graph import ZoneGraph, zone_graph
from tachk.meaning.discrete import prepare
from tachk.meaning.judge.replay import replay
from tachk.meaning.step import StepError, initial_state, successors
from tachk.model.builder import NetworkBuilder
from tachk.model.fault import EvaluationFault
from tachk.model.network import Network
from tachk.model.run import TimedState
from tachk.transform.unfolded_edges import unfolded_by_edges
from tachk.verify.covering.coverage import Coverage
from tachk.verify.covering.single_search import search_for
from tachk.verify.covering.suite import CoveringSuite, Impossibility, covering_suite
from tachk.verify.verdict import Answer
from tests.support import Shape, random_case
from tests.support.oracles.digitised import delayed, region_steps
from tests.support.seeds import enough, seeds

SHAPES = {
    "small": Shape(processes=2, locations=3, clocks=2, constant=3),
    "one clock": Shape(processes=3, locations=3, clocks=1, constant=2, priorities=True),
    "language": Shape(processes=2, locations=3, clocks=1, constant=2, language=True, faults=0.2),
}
_MOST = 400


def edges_in_regions(network: Network) -> set[Place] | None:
    """The edges that are taken from some region, of which one point each is visited; None if there are too many."""
    model = prepare(network)
    normalised, next_delay = region_steps(network, [])
    taken: set[Place] = set()
    passed: set[object] = set()
    waiting: deque[TimedState] = deque()

    def add(state: TimedState | None) -> None:
        while state is not None and len(passed) <= _MOST:
            clocks = normalised(state.clocks)
            if (state.discrete, clocks) in passed:
                return
            passed.add((state.discrete, clocks))
            state = TimedState(state.discrete, clocks, state.time)
            waiting.append(state)
            state = delayed(model, state, next_delay(clocks))

    add(initial_state(model))
    while waiting:
        state = waiting.popleft()
        for transition, after in successors(model, state):
            taken.update((each.process, each.edge) for each in transition.participants)
            add(after)
    return taken if len(passed) <= _MOST else None


def pairs_in_regions(network: Network) -> set[tuple[int, int | None, int]] | None:
    """Each process with each edge that it takes, and the one that it took before, by the same visits."""
    model = prepare(network)
    normalised, next_delay = region_steps(network, [])
    taken: set[tuple[int, int | None, int]] = set()
    passed: set[object] = set()
    start: tuple[int | None, ...] = (None,) * len(network.processes)
    waiting: deque[tuple[TimedState | None, tuple[int | None, ...]]] = deque([(initial_state(model), start)])
    while waiting and len(passed) <= 4 * _MOST:
        state, last = waiting.popleft()
        if state is None or (key := (state.discrete, normalised(state.clocks), last)) in passed:
            continue
        passed.add(key)
        clocks = normalised(state.clocks)
        state = TimedState(state.discrete, clocks, state.time)
        for transition, after in successors(model, state):
            own = {each.process: each.edge for each in transition.participants}
            taken.update((process, last[process], edge) for process, edge in own.items())
            waiting.append((after, tuple(own.get(process, before) for process, before in enumerate(last))))
        waiting.append((delayed(model, state, next_delay(clocks)), last))
    return taken if len(passed) <= 4 * _MOST else None


def check_suite(network: Network, suite: CoveringSuite) -> None:
    """What must be so of every suite: its runs are runs, and each place is covered, impossible or unknown."""
    model = prepare(network)
    covered = set(suite.coverage.at_start(network))
    for each in suite.runs:
        replay(model, each.run)
        assert each.covered == suite.coverage.by_path(network, each.run.path)
        assert each.new == each.covered - covered
        assert each.new
        covered |= each.covered
    parts = [covered, {place for place, _ in suite.impossible}, {place for place, _ in suite.unknown}]
    assert suite.covered == covered
    assert sum(map(len, parts)) == len(suite.places) == len(set().union(*parts))
    assert all(reason for _, reason in (*suite.impossible, *suite.unknown))


@pytest.mark.parametrize("shape", SHAPES)
def test_all_edges_that_can_be_taken_are_taken(shape: str) -> None:
    compared = untaken = 0
    for seed in seeds(range(30)):
        network = random_case(Random(seed), SHAPES[shape]).network
        with suppress(InputError, StepError, EvaluationFault):
            expected = edges_in_regions(network)
            if expected is None:
                continue
            edges = covering_suite(network, Coverage.EDGES)
            check_suite(network, edges)
            assert (edges.covered, edges.unknown) == (expected, ()), f"seed {seed}"
            locations = covering_suite(network, Coverage.LOCATIONS)
            check_suite(network, locations)
            visited = {(number, network.processes[number].edges[edge].target) for number, edge in expected}
            start = Coverage.LOCATIONS.at_start(network)
            assert (locations.covered, locations.unknown) == (visited | start, ()), f"seed {seed}"
            compared += 1
            untaken += len(edges.impossible)
    assert enough(compared > 8)
    assert enough(untaken > 3)


def test_all_pairs_of_edges_that_can_be_taken_are_taken() -> None:
    compared = untaken = 0
    for seed in seeds(range(20)):
        network = random_case(Random(seed), SHAPES["small"]).network
        with suppress(InputError, StepError, EvaluationFault, UsageError):
            expected = pairs_in_regions(network)
            if expected is None:
                continue
            suite, unfolded = covering_suite(network, Coverage.PAIRS), unfolded_by_edges(network)
            found = set()
            for each in suite.runs:
                replay(prepare(network), each.run)
                last: dict[int, int] = {}
                own = set()
                for transition in each.run.path:
                    for part in transition.participants:
                        own.add((part.process, last.get(part.process), part.edge))
                        last[part.process] = part.edge
                pairs = ((process, unfolded.pairs[process][number]) for process, number in each.covered)
                assert own == {(process, pair.before, pair.edge) for process, pair in pairs}
                found |= own
            assert (found, suite.unknown) == (expected, ()), f"seed {seed}"
            compared += 1
            untaken += len(suite.impossible)
    assert enough(compared > 3)
    assert enough(untaken > 3)


def test_a_search_for_one_place_agrees() -> None:
    answers = {Answer.HOLDS: True, Answer.FAILS: False}
    for seed in seeds(range(8)):
        network = random_case(Random(seed), SHAPES["small"]).network
        with suppress(InputError):
            for coverage in (Coverage.EDGES, Coverage.LOCATIONS):
                suite = covering_suite(network, coverage)
                for place in suite.places:
                    verdict = search_for(network, coverage, place, Options(), Limits())
                    assert answers[verdict.answer] == (place in suite.covered), f"seed {seed}, {coverage}, {place}"


@pytest.mark.parametrize("states", [1, 3, 10, 40])
def test_a_limit_makes_nothing_impossible(states: int) -> None:
    unknown = 0
    for seed in seeds(range(20)):
        network = random_case(Random(seed), Shape(clocks=2)).network
        with suppress(InputError):
            graph = zone_graph(network, 150)
            if graph.reason:
                continue
            expected = {(p.process, p.edge) for _, move, _ in graph.edges for p in move.participants}
            suite = covering_suite(network, Coverage.EDGES, limits=Limits(states=states))
            check_suite(network, suite)
            assert suite.covered <= expected, f"seed {seed}"
            assert not expected & {place for place, _ in suite.impossible}, f"seed {seed}"
            unknown += len(suite.unknown)
    assert enough(unknown > 0 or states > 3)


def test_paths_that_go_on_have_runs_where_clocks_stop() -> None:
    for seed in seeds(range(20)):
        network = random_case(Random(seed), Shape(processes=2, locations=3, clocks=2, stopwatches=True)).network
        with suppress(InputError):
            check_suite(network, covering_suite(network, Coverage.EDGES, limits=Limits(states=500)))


def test_no_time_leaves_all_unknown() -> None:
    network = branching().build()
    suite = covering_suite(network, Coverage.EDGES, limits=Limits(seconds=1e-9))
    assert (suite.runs, suite.impossible, suite.covered) == ((), (), frozenset())
    assert dict(suite.unknown) == dict.fromkeys(suite.places, "time limit")


def branching() -> NetworkBuilder:
    """A choice between two ways that end, with what no run takes."""
    builder = NetworkBuilder()
    process = builder.process("P")
    x = process.clock("x")
    start, left, right, never = (process.location(name) for name in ("start", "left", "right", "never"))
    process.edge(start, left)
    process.edge(start, right)
    process.edge(left, left, guard=x >= 2)
    process.edge(right, never, guard=(x < 1) & (x > 1))
    process.edge(never, start)
    process.edge(start, start, guard=x >= 3, updates=[x.assign(0)])
    return builder


def test_ends_of_runs_and_reasons() -> None:
    network = branching().build()
    suite = covering_suite(network, Coverage.EDGES)
    check_suite(network, suite)
    assert len(suite.runs) == 2
    assert suite.steps == 4
    reasons = {place: reason for (_, place), reason in suite.impossible}
    assert reasons == {3: Impossibility.NEVER_TAKEN, 4: Impossibility.UNREACHED_SOURCE}
    locations = covering_suite(network, Coverage.LOCATIONS)
    assert (len(locations.runs), locations.steps) == (2, 2)
    assert locations.impossible == (((0, 3), Impossibility.NEVER_VISITED),)


def fewest_runs(graph: ZoneGraph, wanted: frozenset[Place]) -> int:
    """The least number of runs that take all these edges together, by all sets of edges that one run can take."""
    onward: dict[int, list[tuple[frozenset[Place], int]]] = {}
    for source, move, target in graph.edges:
        taken = frozenset((each.process, each.edge) for each in move.participants)
        onward.setdefault(source, []).append((taken & wanted, target))
    first = (0, frozenset[Place]())
    passed, waiting = {first}, [first]
    while waiting:
        node, covered = waiting.pop()
        for taken, target in onward.get(node, []):
            after = target, covered | taken
            if after not in passed:
                passed.add(after)
                waiting.append(after)
    sets = {covered for _, covered in passed}
    largest = [one for one in sets if not any(one < other for other in sets)]
    return next(n for n in range(len(wanted) + 1) if any(wanted <= _union(some) for some in combinations(largest, n)))


def _union(some: Iterable[frozenset[Place]]) -> frozenset[Place]:
    return frozenset().union(*some)


def test_distance_from_the_fewest_runs() -> None:
    """The greedy choice takes few runs more than a smallest suite; that one may need many more steps."""
    chosen = smallest = 0
    for seed in seeds(range(60)):
        network = random_case(Random(seed), SHAPES["small"]).network
        with suppress(InputError):
            suite = covering_suite(network, Coverage.EDGES)
            graph = zone_graph(network, 60)
            if graph.reason or not 0 < len(suite.covered) <= 9:
                continue
            fewest = fewest_runs(graph, suite.covered)
            assert len(suite.runs) >= fewest, f"seed {seed}"
            chosen, smallest = chosen + len(suite.runs), smallest + fewest
    assert enough(0 < smallest <= chosen <= 1.2 * smallest)
