"""What `tachk check --deep` says that no run does, against the zone graph that is made in Python."""

from __future__ import annotations

from contextlib import suppress
from fractions import Fraction
from random import Random

import networkx as nx
import pytest

from tachk.compiler.fold import known_values
from tachk.compiler.lower import lower
from tachk.diagnostics.diagnostic import InputError
from tachk.engines.digitised import delayed
from tachk.engines.options import Extrapolation, Limits, Options, SearchOrder
from tachk.engines.zone import explore_everything
from tachk.engines.zone_graph import zone_graph
from tachk.model.builder import NetworkBuilder
from tachk.model.fault import EvaluationFault
from tachk.model.network import Network
from tachk.properties.deep.deep_check import deep_check
from tachk.properties.deep.reached import unreached_locations
from tachk.properties.deep.steps import steps_of
from tachk.properties.deep.zeno import suspicious
from tachk.semantics.discrete import prepare
from tachk.semantics.step import StepError, delay, initial_state, successors
from tachk.testing import Shape, random_case

SHAPES = {
    "plain": Shape(),
    "small": Shape(processes=2, locations=3, clocks=2, constant=3),
    "priorities": Shape(priorities=True, clocks=2),
    "diagonals": Shape(diagonals=True, clocks=2, constant=3),
}
VARIANTS = (Options(), Options(order=SearchOrder.DFS), Options(extrapolation=Extrapolation.MAX), Options(passing=4))
AGES = Fraction(10**6)


@pytest.mark.parametrize("shape", SHAPES)
def test_edges_are_taken_where_the_reference_takes_them(shape: str) -> None:
    compared = untaken = unreached = 0
    for seed in range(60):
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
    assert compared > 15
    assert min(untaken, unreached) > 10


@pytest.mark.parametrize("shape", SHAPES)
def test_time_locks_do_not_let_time_pass_and_deadlocks_do(shape: str) -> None:
    met = {"W0605": 0, "W0606": 0}
    for seed in range(80):
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
    assert min(met.values()) > 2


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
    for seed in range(300):
        network = network_of_circles(Random(seed))
        none_possible = not suspicious(frozenset(steps_of(network, known_values(network, []))))
        excluded += none_possible
        if none_possible or seed < 60:
            with suppress(EvaluationFault):
                met = goes_round(network, 80)
                circles += met
                assert not (none_possible and met), f"seed {seed}"
    assert circles > 5
    assert excluded > 40


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
