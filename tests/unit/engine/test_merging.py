"""Waiting states that become one where their zones together are a zone: fewer states, the same answers and runs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

import tachk
from tachk.base.resources import data_root
from tachk.engine.options import Extrapolation, Options, SearchOrder
from tachk.verify.verdict import Verdict
from tests.support.strategies import switched

CLASSICS = data_root() / "models" / "classics"

TWO_ORDERS = """
clock x, y;
int done = 0;
int left = 6;

process First() {
    init location Idle { to Done { assign done = done + 1, x = 0; } }
    location Done;
}

process Second() {
    init location Idle { to Done { assign done = done + 1, y = 0; } }
    location Done;
}

process Judge() {
    init location Waiting { to Judging { guard done == 2 && x - y >= 3; assign left = 6 / (done - 2); } }
    location Judging;
}

system First, Second, Judge;
"""
"""Either of two resets comes first: x <= y and y <= x, which is all there is. One of the orders divides by zero."""


def verdict(model: tachk.Model, query: str, options: Options) -> Verdict:
    (found,) = model.verify(query, options=options).record.verdicts
    return found


def options(merging: bool, order: SearchOrder = SearchOrder.AUTO) -> Options:
    return switched(Options(order=order).off("symmetry", "local-times"), merging, "merging")


@pytest.fixture
def two_orders(tmp_path: Path) -> tachk.Model:
    (tmp_path / "two_orders.ta").write_text(TWO_ORDERS)
    return tachk.load(tmp_path / "two_orders.ta")


@pytest.mark.parametrize("later", ["x - y", "y - x"])
def test_a_run_is_one_of_the_parts(two_orders: tachk.Model, later: str) -> None:
    """Which part a state of the union belongs to decides which run leads there; each run is replayed."""
    query = f"E<> First.Done && Second.Done && {later} > 4 && done == 2"
    together, apart = (verdict(two_orders, query, options(merging)) for merging in (True, False))
    assert together.answer.value == apart.answer.value == "holds"
    assert together.trace is not None and apart.trace is not None
    assert together.trace.path == apart.trace.path
    assert together.statistics.states_stored < apart.statistics.states_stored


def test_a_run_time_error_behind_a_union_has_a_run(two_orders: tachk.Model) -> None:
    together, apart = (verdict(two_orders, "A[] !Judge.Judging", options(merging)) for merging in (True, False))
    for found in (together, apart):
        assert found.answer.value == "unknown"
        assert found.fault is not None and found.fault.run is not None
    assert together.fault == apart.fault
    assert together.statistics.states_stored == 4
    assert apart.statistics.states_stored == 7


LATER = """
clock x, y;
process P() {
    init location I {
        to D { guard y >= 1 && y <= 3; assign x = 0; }
        to M { guard y <= 5; }
    }
    location M { invariant y <= 5; to N { } }
    location N { invariant y <= 5; to D { guard y >= 2; assign x = 0; } }
    location D { to E { guard x >= 1 && x <= 2 && y >= 4 && y <= 5; } }
    location E { }
}
p = P();
system p;
"""
"""D is entered in two ways that could be united, but it has been explored before the second one is found."""


def test_what_has_been_explored_is_not_merged() -> None:
    exact = [replace(options(m).off("pruning"), extrapolation=Extrapolation.NONE) for m in (True, False)]
    together, apart = (verdict(tachk.loads(LATER), "E<> p.E && y < 4", each) for each in exact)
    assert together.statistics.states_stored == apart.statistics.states_stored
    assert together.statistics.states_explored == apart.statistics.states_explored == 7


STOPPED = """
clock x, y, z;
int n;
chan c;
process P() {
    init location a { to b; }
    location b { to d { assign z = x; } }
    location d { to a { sync c?; assign y = z; } }
}
process Q() {
    init location a { to b { sync c!; } }
    location b { invariant x' == 0; to d { guard x < 1; assign n = (n + 1) % 3; } }
    location d { to a { assign z = 0; } }
}
system P, Q;
"""
"""Zones are larger than what is reachable where x stands still, those of a union more than those of its parts."""


def test_where_clocks_stop_nothing_is_merged() -> None:
    """No part of a united state led to the goal that it led to itself."""
    found = [
        verdict(tachk.loads(STOPPED), "E<> Q.d && z - y >= 2 && z < n + 1", options(merging))
        for merging in (True, False)
    ]
    assert [each.answer.value for each in found] == ["fails", "fails"]
    assert len({each.statistics.states_stored for each in found}) == 1


GOAL_NEARBY = """
clock x, y;
int n = 0;
int left = 6;
process P() {
    init location I {
        to D { }
        to D { guard y >= 1 && y <= 3; assign x = 0; }
    }
    location D {
        to T { }
        to D { guard x >= 2 && x <= 5; assign x = 0; }
    }
    location T { to T { assign left = 6 / n; } }
}
p = P();
system p;
"""
"""D is entered at once, and later in two ways that are united; the search comes to the error before it goes on."""


def test_the_run_to_an_error_is_searched_for_beyond_goals() -> None:
    found = tuple(
        verdict(
            tachk.loads(GOAL_NEARBY),
            "E<> p.T && x < 1 && y >= 1",
            replace(options(merging), extrapolation=Extrapolation.NONE),
        )
        for merging in (True, False)
    )
    assert [each.answer.value for each in found] == ["unknown", "holds"]
    assert found[0].fault is not None and found[0].fault.run is not None


def test_published_models_have_fewer_states() -> None:
    model = tachk.load(CLASSICS / "critical_region.ta", N=3)
    for name in ("exclusive", "can_be_safe", "can_fail", "in_time"):
        together, apart = (model.verify(property=name, options=options(m)).record.verdicts[0] for m in (True, False))
        assert together.answer is apart.answer
        assert together.statistics.states_stored < apart.statistics.states_stored


@pytest.mark.parametrize(
    ("query", "order"),
    [
        ("sup{ First.Done && Second.Done && Judge.Waiting }: x", SearchOrder.AUTO),
        ("A[] !(First.Done && Second.Done)", SearchOrder.DFS),
        ("A[] !(First.Done && Second.Done && Judge.Waiting && left > 6)", SearchOrder.PROGRESS),
        ("A<> First.Done", SearchOrder.AUTO),
    ],
)
def test_nothing_is_merged_where_more_matters_than_what_can_be_reached(query: str, order: SearchOrder) -> None:
    model = tachk.loads(TWO_ORDERS.replace("6 / (done - 2)", "6 / done"))
    together, apart = (verdict(model, query, options(merging, order)) for merging in (True, False))
    assert together.statistics.states_stored == apart.statistics.states_stored
    assert together.answer is apart.answer
