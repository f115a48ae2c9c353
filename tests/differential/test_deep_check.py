"""What `tachk check --deep` says that no run does, against the zone graph that is made in Python."""

from __future__ import annotations

from collections import Counter
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from random import Random

import networkx as nx
import pytest

from tachk.analysis.edge_steps import steps_of
from tachk.analysis.fold import known_values
from tachk.analysis.recurrent_edges import lasting_edges, suspicious
from tachk.base.diagnostics.diagnostic import InputError
from tachk.base.operators import BinaryOperator
from tachk.engine.compiler.lower import lower
from tachk.engine.options import Extrapolation, Limits, Options, SearchOrder
from tachk.engine.zone import explore_everything
from tachk.engine.zone_graph import zone_graph
from tachk.meaning.discrete import prepare
from tachk.meaning.step import StepError, delay, initial_state, satisfies, successors
from tachk.model.builder import NetworkBuilder
from tachk.model.expressions import BOOL, Binary, Constant
from tachk.model.fault import EvaluationFault
from tachk.model.network import Network
from tachk.model.run import TimedState, Transition
from tachk.transform.doubled_edges import with_guessed_suffix
from tachk.verify.semantic_lint.deep_check import deep_check
from tachk.verify.semantic_lint.reached import unreached_locations
from tachk.verify.semantic_lint.zeno import ZenoRun, find_zeno_run
from tests.support import Shape, random_case
from tests.support.oracles.avoiding_runs import Budget, LimitError, avoiding_run, build
from tests.support.oracles.digitised import delayed, region_steps
from tests.support.seeds import enough, seeds

pytestmark = pytest.mark.drawn

SHAPES = {
    "plain": Shape(),
    "small": Shape(processes=2, locations=3, clocks=2, constant=3),
    "priorities": Shape(priorities=True, clocks=2),
    "copies": Shape(copies=0.5, clocks=2),
    "diagonals": Shape(diagonals=True, clocks=2, constant=3),
}
VARIANTS = (Options(), Options(order=SearchOrder.DFS), Options(extrapolation=Extrapolation.MAX))
AGES = Fraction(10**6)


@pytest.mark.parametrize("shape", SHAPES)
def test_edges_are_taken_where_the_reference_takes_them(shape: str) -> None:
    compared = untaken = unreached = 0
    for seed in seeds(range(30)):
        network = random_case(Random(seed), SHAPES[shape]).network
        with suppress(ValueError):  # the initial state violates an invariant
            graph = zone_graph(network, 150)
            if graph.reason:
                continue
            expected = {(p.process, p.edge) for _, move, _ in graph.edges for p in move.participants}
            for options in VARIANTS:
                program, _ = lower(network)
                outcome, taken = explore_everything(program, (), options)
                assert (outcome.reason, taken) == ("", expected), f"seed {seed}"
            places = {(n, here) for node, _ in graph.nodes for n, here in enumerate(node.locations)}
            every = {(n, here) for n, p in enumerate(network.processes) for here in range(len(p.locations))}
            assert set(unreached_locations(network, expected)) == every - places, f"seed {seed}"
            compared += 1
            untaken += sum(len(p.edges) for p in network.processes) - len(expected)
            unreached += len(every - places)
    assert enough(compared > 8)
    assert enough(min(untaken, unreached) > 5)


@pytest.mark.parametrize("shape", SHAPES)
def test_time_locks_do_not_let_time_pass_and_deadlocks_do(shape: str) -> None:
    met = {"W0605": 0, "W0606": 0}
    for seed in seeds(range(32)):
        network = random_case(Random(seed), SHAPES[shape]).network
        with suppress(InputError):
            check = deep_check(network, limits=Limits(states=2000))
            model = prepare(network)
            for evidence in check.evidence:
                if evidence.finding.code not in met:
                    continue
                met[evidence.finding.code] += 1
                try:
                    delay(model, evidence.run.states[-1], AGES)
                    passes = True
                except StepError:
                    passes = False
                assert passes == (evidence.finding.code == "W0606"), f"seed {seed}"
    assert enough(min(met.values()) > 0)


def network_of_circles(random: Random) -> Network:
    """A network of which many edges reset a clock or wait for one, change a variable or ask for its value."""
    builder = NetworkBuilder()
    n, channel = builder.integer("n", 0, 3), builder.channel("c")
    clocks = [builder.clock("x"), builder.clock("y")]
    for number in range(random.randint(1, 2)):
        process = builder.process(f"P{number}")
        places = [process.location(name, invariant=random.choice([None, None, clocks[0] <= 3])) for name in "abc"]
        for target in [*places, *random.sample(places, random.randint(0, 2))]:
            conditions = [clock >= random.randint(0, 2) for clock in clocks if random.random() < 0.4]
            conditions += [n == random.randint(0, 2)] if random.random() < 0.3 else []
            updates = [clock.assign(random.choice([0, 0, 0, 0, 1])) for clock in clocks if random.random() < 0.5]
            updates += (
                [random.choice([n.assign(random.randint(0, 2)), n.assign(n + 1)])] if random.random() < 0.3 else []
            )
            role = random.choice([{}, {}, {"send": channel}, {"receive": channel}]) if number < 2 else {}
            guard = None if not conditions else conditions[0] if len(conditions) == 1 else conditions[0] & conditions[1]
            process.edge(random.choice(places), target, guard=guard, updates=updates, **role)
    return builder.build()


def test_where_no_zeno_loop_is_possible_there_is_no_circle_without_time() -> None:
    """A circle of actions between states with the same clock values, found by trying, is a Zeno run."""
    excluded = circles = 0
    for seed in seeds(range(300)):
        network = network_of_circles(Random(seed))
        none_possible = not suspicious(frozenset(steps_of(network, known_values(network, []))))
        excluded += none_possible
        if none_possible or seed % 5 == 0:
            with suppress(EvaluationFault):
                met = goes_round(network, 80)
                circles += met
                assert not (none_possible and met), f"seed {seed}"
    assert enough(circles > 5)
    assert enough(excluded > 40)


def goes_round(network: Network, states: int) -> bool:
    """Whether actions alone lead from one of the first states back to it; time passes by halves."""
    model = prepare(network)
    start = initial_state(model)
    arcs = nx.DiGraph()
    seen = {(start.discrete, start.clocks)}
    waiting = [start]
    for state in waiting:
        after = [end for _, end in successors(model, state)]
        arcs.add_edges_from(((state.discrete, state.clocks), (end.discrete, end.clocks)) for end in after)
        later = delayed(model, state, Fraction(1, 2))
        for end in (*after, *([] if later is None else [later])):
            if (end.discrete, end.clocks) not in seen and len(waiting) < states:
                seen.add((end.discrete, end.clocks))
                waiting.append(end)
    return not nx.is_directed_acyclic_graph(arcs)


@pytest.mark.parametrize("shape", SHAPES)
def test_a_zeno_run_is_found_where_regions_have_one(shape: str) -> None:
    """The regions are those of the network with a clock that any action resets, and with every edge."""
    decided = Counter[bool]()
    for seed in seeds(range(9)):
        small = replace(SHAPES[shape], processes=2, locations=3, clocks=2 if shape == "diagonals" else 1, constant=2)
        network = random_case(Random(seed), small).network
        everything = frozenset((n, e) for n, process in enumerate(network.processes) for e in range(len(process.edges)))
        expected = _has_zeno_run(network, everything)
        if expected is None:
            continue
        known = known_values(network, [])
        for edges in (everything, lasting_edges(network, known, ())):
            found = find_zeno_run(prepare(network), edges, Options(), Limits(states=20_000))
            if isinstance(found, ZenoRun):
                assert expected and found.run is not None, f"seed {seed}"
            else:
                assert not found and not expected, f"seed {seed}"
        assert suspicious(frozenset(steps_of(network, known))) or not expected, f"seed {seed}"
        decided[expected] += 1
    assert enough(len(decided) == 2)


def _has_zeno_run(network: Network, edges: frozenset[tuple[int, int]]) -> bool | None:
    doubled = with_guessed_suffix(network, edges)
    late = Binary(BinaryOperator.GREATER_EQUAL, doubled.clock, Constant(1), BOOL)
    model = prepare(doubled.network)
    try:
        normalised, next_delay = region_steps(doubled.network, [late])
        start = initial_state(model)
    except (ValueError, StepError):
        return None

    def normal(state: TimedState) -> TimedState:
        return TimedState(state.discrete, normalised(state.clocks), Fraction(0))

    def steps(state: TimedState) -> list[tuple[Transition | None, TimedState]]:
        found: list[tuple[Transition | None, TimedState]] = [
            (t, normal(after)) for t, after in successors(model, state)
        ]
        duration = next_delay(state.clocks)
        later = delayed(model, state, Fraction(1) if duration is None else duration)
        return found if later is None else [*found, (None, normal(later))]

    def soon(state: TimedState) -> bool:
        return satisfies(model, state, doubled.mark) and not satisfies(model, state, late)

    budget = Budget(Limits(states=1500))
    try:
        begun = {state: () for state in build([normal(start)], steps, budget).came if soon(state)}
        acts = [lambda _before, transition, _after: transition is not None]
        run = avoiding_run(begun, lambda s: [x for x in steps(s) if soon(x[1])], lambda _: None, budget, acts)
    except (LimitError, EvaluationFault):
        return None
    return run is not None
