"""The plain explorers on networks whose answers are known by hand."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from tachk.engine.options import Limits
from tachk.engine.outcome import Status
from tachk.model.builder import NetworkBuilder
from tests.support.oracles import digitised, reference


def statuses(outcome: object) -> list[Status]:
    return [goal.status for goal in outcome.goals]  # type: ignore[attr-defined]


def fischer(processes: int, wait: int, strict: bool) -> tuple[NetworkBuilder, list]:
    """Fischer's mutual exclusion: set within 2, wait longer than that, enter. Wrong if the wait is too short."""
    network = NetworkBuilder()
    owner = network.integer("owner", 0, processes)
    critical = []
    for number in range(1, processes + 1):
        process = network.process(f"P{number}")
        x = process.clock("x")
        idle, trying = process.location("Idle"), process.location("Trying", invariant=x <= 2)
        waiting, inside = process.location("Waiting"), process.location("Inside")
        process.edge(idle, trying, guard=owner == 0, updates=[x.assign(0)])
        process.edge(trying, waiting, updates=[x.assign(0), owner.assign(number)])
        process.edge(waiting, idle, guard=owner == 0)
        process.edge(waiting, inside, guard=(owner == number) & (x > wait if strict else x >= wait))
        process.edge(inside, idle, updates=[owner.assign(0)])
        critical.append(inside)
    return network, critical


@pytest.mark.parametrize(
    ("wait", "strict", "answer"),
    [
        (2, True, Status.UNREACHABLE),
        (2, False, Status.REACHED),
        (1, True, Status.REACHED),
        (3, False, Status.UNREACHABLE),
    ],
)
def test_fischer_needs_a_strictly_longer_wait(wait: int, strict: bool, answer: Status) -> None:
    network, (first, second) = fischer(2, wait, strict)
    goal = (first.reached & second.reached).expression
    assert statuses(reference.explore(network.build(), [goal])) == [answer]
    assert statuses(digitised.explore_regions(network.build(), [goal])) == [answer]


def test_integer_time_is_exact_where_all_bounds_are_weak_and_not_where_they_are_strict() -> None:
    network, (first, second) = fischer(2, 2, strict=False)
    goal = (first.reached & second.reached).expression
    assert statuses(digitised.explore_grid(network.build(), [goal], Fraction(1))) == [Status.REACHED]
    between = NetworkBuilder()
    x = between.clock("x")
    between.process("P").location("A")
    inside = ((x > 1) & (x < 2)).expression
    assert statuses(digitised.explore_grid(between.build(), [inside], Fraction(1))) == [Status.UNREACHABLE]
    assert statuses(digitised.explore_grid(between.build(), [inside], Fraction(1, 2))) == [Status.REACHED]
    assert statuses(digitised.explore_regions(between.build(), [inside])) == [Status.REACHED]


def test_zones_are_split_on_diagonals_before_they_are_widened(monkeypatch: pytest.MonkeyPatch) -> None:
    """An automaton after Bouyer 2003: x2 - x1 = x4 - x3 in its last location, which ExtraM alone forgets."""
    network = NetworkBuilder()
    x1, x2, x3, x4 = (network.clock(f"x{n}") for n in range(1, 5))
    process = network.process("P")
    l0, l1, l2, l3, l4, l5, l6, last = (process.location(f"L{n}") for n in range(8))
    process.edge(l0, l1, guard=x3 <= 3, updates=[x1.assign(0), x3.assign(0)])
    process.edge(l1, l2, guard=x2 == 3, updates=[x2.assign(0)])
    process.edge(l2, l3, guard=x1 == 2, updates=[x1.assign(0)])
    process.edge(l3, l4, guard=x2 == 2, updates=[x2.assign(0)])
    process.edge(l4, l3, guard=x1 == 2, updates=[x1.assign(0)])
    process.edge(l3, l5, guard=x2 == 2, updates=[x2.assign(0)])
    process.edge(l5, l6, guard=x1 == 3, updates=[x1.assign(0)])
    process.edge(l6, last, guard=(x2 - x1 > 2) & (x4 - x3 < 2))
    goal = last.reached.expression
    assert statuses(reference.explore(network.build(), [goal])) == [Status.UNREACHABLE]

    constants = reference.clock_constants
    monkeypatch.setattr(
        reference, "clock_constants", lambda network, goals: replace(constants(network, goals), diagonals=())
    )
    assert statuses(reference.explore(network.build(), [goal])) == [Status.REACHED]


def test_a_state_limit_leaves_goals_undecided() -> None:
    network, (first, second) = fischer(2, 2, strict=True)
    goals = [first.reached.expression, (first.reached & second.reached).expression]
    for explore in (reference.explore, digitised.explore_regions):
        outcome = explore(network.build(), goals, Limits(states=20))
        assert outcome.goals[1].status is Status.UNDECIDED
        assert outcome.reason == "state limit"


def test_a_state_limit_ends_a_chain_of_ever_larger_zones() -> None:
    """Each zone of the only location covers the one before until y can be large: one state is stored at a time."""
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    process = network.process("P")
    turning, late = process.location("Turning", invariant=x <= 1), process.location("Late")
    process.edge(turning, turning, updates=[x.assign(0)])
    process.edge(turning, late, guard=y >= 1_000_000)
    outcome = reference.explore(network.build(), [late.reached.expression], Limits(states=30))
    assert statuses(outcome) == [Status.UNDECIDED]
    assert outcome.reason == "state limit"
    assert outcome.statistics.states_stored < 30 < outcome.statistics.states_explored


def test_a_depth_limit_leaves_goals_undecided() -> None:
    network, (first, second) = fischer(2, 2, strict=True)
    goals = [first.reached.expression, (first.reached & second.reached).expression]
    outcome = reference.explore(network.build(), goals, Limits(depth=3))
    assert statuses(outcome) == [Status.REACHED, Status.UNDECIDED]
    assert outcome.goals[0].path is not None
    assert len(outcome.goals[0].path) == 3


def test_regions_reject_stopwatches_and_the_grid_does_not() -> None:
    network = NetworkBuilder()
    x, y = network.clock("x"), network.clock("y")
    network.process("P").location("A", rates=[(x, 0)])
    with pytest.raises(ValueError, match="stop"):
        digitised.explore_regions(network.build(), [])
    goals = [(y - x >= 7).expression, (x - y >= 1).expression]
    found = digitised.explore_grid(network.build(), goals, Fraction(1), Limits(states=20))
    assert statuses(found) == [Status.REACHED, Status.UNDECIDED]
