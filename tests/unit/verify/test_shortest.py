"""Runs of as few transitions as possible, where a breadth-first search alone finds longer ones."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from tachk.base.diagnostics.diagnostic import UsageError
from tachk.engine.options import Extrapolation, Limits, Options, SearchOrder
from tachk.verify.verdict import Verdict

Verdicts = Callable[..., dict[str, Verdict]]

SHORTEST = Options(shortest=True)

COVERED = """
process P() {
    clock x, y;
    init location A { invariant x <= 9; to A { assign y = 0; } to B; }
    location B { invariant x <= 9; to C { guard y <= 7 && x >= 3; } }
    location C;
}
P1 = P();
system P1;
property reached : E<> P1.C;
"""
"""B after a round in A has a larger zone than B at once, and comes before that has been explored."""

TWO = """
process P() { init location A { to B; } location B; }
P1 = P();
system P1;
property live : E<> !deadlock || P1.B;
property dead : E<> deadlock || P1.B;
property stuck : A[] deadlock && P1.A;
property end : E<> deadlock && P1.B;
"""


def steps(verdict: Verdict) -> int:
    assert verdict.trace is not None
    return sum(step.transition is not None for step in verdict.trace.steps)


def test_a_state_is_not_dropped_for_one_that_is_further_away(verdicts: Verdicts) -> None:
    assert steps(verdicts(COVERED, options=SHORTEST)["reached"]) == 2


@pytest.mark.parametrize("options", [SHORTEST, Options(shortest=True, extrapolation=Extrapolation.MAX)])
def test_deadlock_is_decided_at_the_step_of_the_rest(verdicts: Verdicts, options: Options) -> None:
    found = verdicts(TWO, options=options)
    assert {name: steps(verdict) for name, verdict in found.items()} == {"live": 0, "dead": 1, "stuck": 0, "end": 1}


def test_a_limit_on_depth_leaves_the_rest_of_a_disjunction_to_be_seen(verdicts: Verdicts) -> None:
    found = verdicts(TWO, options=SHORTEST, limits=Limits(depth=1))
    assert steps(found["dead"]) == 1
    assert found["end"].reason == "depth limit"


def test_only_breadth_first_search_finds_shortest_paths() -> None:
    with pytest.raises(UsageError, match="needs the search order bfs, not dfs"):
        Options(order=SearchOrder.DFS, shortest=True)


def test_a_deadlock_in_the_layer_under_way_is_nearer_than_what_its_states_lead_to(verdicts: Verdicts) -> None:
    text = """
    process P() { init location A { to B; to D; } location B { to C; } location C; location D; }
    P1 = P();
    system P1;
    property near : E<> deadlock || P1.C;
    """
    assert steps(verdicts(text, options=SHORTEST)["near"]) == 1
