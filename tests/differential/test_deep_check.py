"""What `tachk check --deep` says that no run does, against the zone graph that is made in Python."""

from __future__ import annotations

from contextlib import suppress
from fractions import Fraction
from random import Random

import pytest

from tachk.compiler.lower import lower
from tachk.diagnostics.diagnostic import InputError
from tachk.engines.options import Extrapolation, Limits, Options, SearchOrder
from tachk.engines.zone import explore_everything
from tachk.engines.zone_graph import zone_graph
from tachk.properties.deep.deep_check import deep_check
from tachk.properties.deep.reached import unreached_locations
from tachk.semantics.discrete import prepare
from tachk.semantics.step import StepError, delay
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
