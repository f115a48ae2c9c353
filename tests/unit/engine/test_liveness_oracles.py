"""What it takes never to meet a goal: each way of it, as both oracles for obligations see it."""

from __future__ import annotations

from random import Random

import pytest

from tachk.engine.options import Limits
from tachk.engine.outcome import LivenessStatus, Obligation, RunEnd
from tachk.model.builder import NetworkBuilder, Term, deadlock
from tests.support import Shape, random_case
from tests.support.obligations import random_obligations
from tests.support.oracles.liveness_reference import check_by_zones
from tests.support.oracles.liveness_regions import check_by_regions
from tests.support.seeds import enough, seeds

pytestmark = pytest.mark.drawn


def endings(network: NetworkBuilder, goal: Term, trigger: Term | None = None) -> set[RunEnd]:
    """How runs that never meet the goal end, one for each oracle; empty if they always meet it."""
    obligation = Obligation(goal.expression, None if trigger is None else trigger.expression)
    outcomes = [check(network.build(), obligation) for check in (check_by_regions, check_by_zones)]
    statuses = {outcome.status for outcome in outcomes}
    assert len(statuses) == 1 and LivenessStatus.UNDECIDED not in statuses, outcomes
    return {outcome.run.end for outcome in outcomes if outcome.run is not None}


def test_a_goal_may_be_avoided_by_staying_where_time_can_pass() -> None:
    network = NetworkBuilder()
    process = network.process("P")
    a, b = process.location("A"), process.location("B")
    process.edge(a, b)
    assert endings(network, b.reached) == {RunEnd.IDLE}


@pytest.mark.parametrize("strict", [False, True])
def test_an_invariant_forces_the_step_that_can_still_be_taken(strict: bool) -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    process = network.process("P")
    a, b = process.location("A", invariant=x < 5 if strict else x <= 5), process.location("B")
    process.edge(a, b, guard=x >= 3)
    assert endings(network, b.reached) == set()


def test_a_step_that_opens_only_after_the_invariant_has_stopped_time_comes_too_late() -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    process = network.process("P")
    a, b = process.location("A", invariant=x < 5), process.location("B")
    process.edge(a, b, guard=x >= 5)
    assert endings(network, b.reached) == {RunEnd.STUCK}


def test_a_window_that_closes_while_the_invariant_still_lets_time_pass_can_be_missed() -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    process = network.process("P")
    a, b = process.location("A", invariant=x <= 5), process.location("B")
    process.edge(a, b, guard=x <= 4)
    assert endings(network, b.reached) == {RunEnd.STUCK}


def test_a_circle_of_steps_that_take_no_time_is_a_run() -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    process = network.process("P")
    a, b = process.location("A", invariant=x <= 5), process.location("B")
    process.edge(a, b, guard=x >= 5)
    process.edge(a, a, guard=x <= 1)
    assert endings(network, b.reached) == {RunEnd.LOOP}


def test_a_circle_counts_only_as_long_as_time_lets_it_go_on() -> None:
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    process = network.process("P")
    a, b = process.location("A", invariant=(x <= 5) & (y <= 2)), process.location("B")
    process.edge(a, b, guard=x >= 4)
    process.edge(a, a, guard=y >= 2, updates=[y.assign(0)])
    assert endings(network, b.reached) == set()


@pytest.mark.parametrize(("bound", "avoided"), [(4, set()), (5, set()), (6, {RunEnd.STUCK})])
def test_a_goal_over_clocks_is_met_during_a_delay(bound: int, avoided: set[RunEnd]) -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    network.process("P").location("A", invariant=x <= 5)
    assert endings(network, x >= bound) == avoided


def test_a_goal_that_is_passed_by_a_delay_cannot_be_jumped_over() -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    network.process("P").location("A")
    assert endings(network, x == 3) == set()
    assert endings(network, (x > 2) & (x < 3)) == set()
    assert endings(network, x == 3, trigger=x > 3) == {RunEnd.IDLE}
    assert endings(network, x == 3, trigger=x < 3) == set()


def test_a_step_may_jump_over_a_goal_that_time_would_have_met() -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    process = network.process("P")
    a, b = process.location("A", invariant=x <= 5), process.location("B")
    process.edge(a, b, guard=x < 3, updates=[x.assign(4)])
    assert endings(network, x == 3) == {RunEnd.IDLE}


@pytest.mark.parametrize("kind", ["urgent", "committed"])
def test_where_time_stands_still_and_nothing_is_possible_the_run_ends(kind: str) -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    process = network.process("P")
    a, b = process.location("A", urgent=kind == "urgent", committed=kind == "committed"), process.location("B")
    process.edge(a, b, guard=x > 0)
    assert endings(network, b.reached) == {RunEnd.STUCK}
    assert endings(network, x > 0) == {RunEnd.STUCK}


def test_an_urgent_synchronisation_ends_idling() -> None:
    network = NetworkBuilder()
    x, hurry = network.clock("x"), network.channel("hurry", urgent=True)
    sender, receiver = network.process("S"), network.process("R")
    a, b = sender.location("A"), sender.location("B")
    c = receiver.location("C")
    sender.edge(a, b, send=hurry)
    receiver.edge(c, c, receive=hurry)
    assert endings(network, b.reached) == set()
    assert endings(network, x > 0, trigger=a.reached) == {RunEnd.IDLE} - {RunEnd.IDLE}


def test_a_goal_may_be_that_nothing_is_possible_any_more() -> None:
    network = NetworkBuilder()
    process = network.process("P")
    a, b = process.location("A"), process.location("B")
    process.edge(a, b)
    assert endings(network, deadlock()) == {RunEnd.IDLE}
    assert endings(network, deadlock(), trigger=b.reached) == set()


def test_leads_to_begins_anew_wherever_its_trigger_holds() -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    process = network.process("P")
    a, b, c = process.location("A"), process.location("B", invariant=x <= 3), process.location("C")
    process.edge(a, b, updates=[x.assign(0)])
    process.edge(b, a, guard=x >= 2)
    process.edge(a, c)
    assert endings(network, a.reached, trigger=b.reached) == set()
    assert endings(network, b.reached, trigger=a.reached) == {RunEnd.IDLE}
    assert endings(network, c.reached | a.reached, trigger=b.reached & (x > 1)) == set()


def test_limits_end_in_no_answer() -> None:
    network = NetworkBuilder()
    x = network.clock("x")
    process = network.process("P")
    a, b = process.location("A", invariant=x <= 5), process.location("B")
    process.edge(a, b, guard=x >= 3)
    obligation = Obligation(b.reached.expression)
    for check in (check_by_regions, check_by_zones):
        assert check(network.build(), obligation, Limits(states=0)).status is LivenessStatus.UNDECIDED
        assert check(network.build(), obligation, Limits(seconds=0.0)).reason == "time limit"


SHAPES = {
    "plain": Shape(),
    "small": Shape(processes=2, locations=3, clocks=2, constant=3),
    "priorities": Shape(priorities=True, clocks=2, constant=2),
    "copies": Shape(copies=0.5, clocks=2, constant=2),
    "diagonals": Shape(diagonals=True, clocks=2, constant=2, processes=2),
    "language": Shape(language=True, faults=0.1, exact=0.3, processes=2, locations=3, clocks=2, constant=3),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_the_oracles_agree(shape: str) -> None:
    told = set()
    for seed in seeds(range(8)):
        case = random_case(Random(seed), SHAPES[shape])
        for obligation in random_obligations(Random(seed), case):
            zones = check_by_zones(case.network, obligation, Limits(states=200)).status
            regions = check_by_regions(case.network, obligation, Limits(states=300)).status
            told.add(zones)
            assert {zones, regions} != {LivenessStatus.FOUND, LivenessStatus.NONE}, f"seed {seed}"
    assert enough({LivenessStatus.FOUND, LivenessStatus.NONE} <= told)
