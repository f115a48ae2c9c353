"""Runs that are drawn to reach goals: what they find, what they leave alone, and that the same run is found again."""

from __future__ import annotations

import pytest

import tachk
from tachk import _core
from tachk.engine import zone
from tachk.engine.compiler.lower import lower
from tachk.engine.options import Options
from tachk.engine.simulated_runs import SimulatedRuns
from tachk.model.run import TimedTrace
from tachk.verify.verdict import Answer, Verdict

pytestmark = pytest.mark.drawn

ALONE = Options().off("unblocked", "sliced", "symmetry", "local-times", "best-first", "one-order", "probe")


def verdict(text: str, query: str, options: Options = ALONE) -> Verdict:
    (found,) = tachk.loads(text).verify(query, options=options)
    return found


# The guards hold at single moments, and whoever misses one is lost: 3 ** 9 ways, one of which leads to the goal.
GATES = """
int gate;
process Key(const int steps, const int period) {
    clock x;
    int left = steps;
    init location L {
        to L { guard x == period && left > 1; assign left = left - 1, x = 0; }
        to done { guard x == period && left == 1; assign gate = gate + 1; }
    }
    location done;
}
process Unlocker() { init location waiting { to goal { guard gate == 9; } } location goal; }
k1 = Key(1, 1); k2 = Key(2, 2); k3 = Key(3, 3); k4 = Key(4, 4); k5 = Key(5, 5);
k6 = Key(6, 6); k7 = Key(7, 7); k8 = Key(8, 8); k9 = Key(9, 9);
system k1, k2, k3, k4, k5, k6, k7, k8, k9, Unlocker;
"""


def test_single_moments_are_met() -> None:
    found = verdict(GATES, "E<> Unlocker.goal")
    assert (found.answer, found.strategy) == (Answer.HOLDS, "simulated")
    assert found.statistics.states_stored < 40_000
    assert isinstance(found.trace, TimedTrace)
    assert found.trace.states[-1].time == 81
    plain = verdict(GATES, "E<> Unlocker.goal", Options().off("attempts"))
    assert plain.answer is Answer.HOLDS and plain.statistics.states_stored > 100_000


def test_a_violation_is_found() -> None:
    found = verdict(GATES, "A[] gate < 9")
    assert (found.answer, found.strategy) == (Answer.FAILS, "simulated")


def test_the_same_run_is_found_again() -> None:
    assert verdict(GATES, "E<> Unlocker.goal").path == verdict(GATES, "E<> Unlocker.goal").path


# Time stands still where the clock is taken again and again, as the earliest moment always is now.
RESTING = GATES.replace(
    "system ", "process Time() { clock t; init location L { to L { guard t >= 0; } } }\nsystem Time, "
)


def test_an_edge_that_changes_nothing_does_not_stop_time() -> None:
    found = verdict(RESTING, "E<> Unlocker.goal")
    assert (found.answer, found.strategy) == (Answer.HOLDS, "simulated")


@pytest.mark.parametrize(
    ("text", "query"),
    [
        (GATES, "E<> deadlock && gate == 9"),
        (GATES, "E<> gate == 10"),
    ],
    ids=["deadlock", "unreachable"],
)
def test_what_runs_cannot_say_is_left_to_the_search(text: str, query: str) -> None:
    small = text.replace("k6 = Key(6, 6); k7 = Key(7, 7); k8 = Key(8, 8); k9 = Key(9, 9);", "").replace(
        "k6, k7, k8, k9, ", ""
    )
    found = verdict(small.replace("== 9", "== 5"), query.replace("== 9", "== 5").replace("10", "6"))
    assert found.answer is not Answer.UNKNOWN
    assert found.strategy == "zones"


# Two hundred steps lead to the goal, in any order.
def together(processes: int) -> str:
    named = range(1, processes + 1)
    return "\n".join(
        (
            "process P(const int k) { clock x; init location a { to b { guard x >= k; } } location b; }",
            *(f"p{number} = P({number});" for number in named),
            f"system {', '.join(f'p{number}' for number in named)};",
        )
    )


def test_independent_processes_reach_a_goal_about_all() -> None:
    query = "E<> " + " && ".join(f"p{number}.b" for number in range(1, 61))
    found = verdict(together(60), query, Options())
    assert (found.answer, found.strategy) == (Answer.HOLDS, "simulated")
    deep = verdict(together(60), query, Options().off("simulated", "best-first"))
    assert (deep.answer, deep.strategy) == (Answer.HOLDS, "probe")
    assert deep.statistics.states_stored < 20_000  # a run through 60 processes takes more than through few
    query = "E<> " + " && ".join(f"p{number}.b" for number in range(1, 41))
    directed = verdict(together(40), query, Options().off("simulated", "probe"))
    assert (directed.answer, directed.strategy) == (Answer.HOLDS, "best-first")


# One way leads on and two back to the beginning, which no run that is drawn avoids 30 times; beside it others count.
WAYS = """
process Walker() {
    int[0, 30] place;
    clock x;
    init location on {
        to on { guard x >= 1 && place < 30; assign place = place + 1, x = 0; }
        to on { guard x >= 1 && place > 0; assign place = 0, x = 0; }
        to on { guard x >= 1 && place > 1; assign place = 1, x = 0; }
    }
}
process Other() {
    int[0, 9] count;
    init location on { to on { assign count = (count + 1) % 10; } }
}
a = Other(); b = Other(); c = Other(); d = Other(); e = Other();
system Walker, a, b, c, d, e;
"""


def test_a_distance_leads_where_chance_does_not() -> None:
    found = verdict(
        WAYS, "E<> Walker.place == 30 && a.count == 3 && b.count == 4 && e.count == 9", ALONE.on("best-first")
    )
    assert (found.answer, found.strategy) == (Answer.HOLDS, "best-first")
    assert found.statistics.states_stored < 40_000


# Each tells where it is, so that none can be left out.
MEETING = """
const int N = 15;
typedef int[1, N] id_t;
int[0, N] inside;
process P(const id_t me) {
    clock x;
    init location out { to waiting { guard x >= 1; assign x = 0; } }
    location waiting { to in { guard x >= 1; assign inside = inside + 1; } to out; to out { guard x > 5; } }
    location in { to out { assign inside = inside - 1; } }
}
system P;
"""
ONE_IS_INSIDE = "E<> P(3).in && inside == 1"


def test_a_short_run_is_found_before_symmetries_are(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, steps in [("best-first", 2), ("simulated", 20)]:
        found = verdict(MEETING, ONE_IS_INSIDE, Options() if name == "best-first" else Options().off("best-first"))
        assert (found.answer, found.strategy) == (Answer.HOLDS, name)
        assert isinstance(found.trace, TimedTrace) and len(found.trace.steps) == steps
    monkeypatch.setattr(zone, "_SHORT_RUN", 1)
    for options in (Options(), Options().off("first-runs")):
        assert verdict(MEETING, ONE_IS_INSIDE, options).strategy == "few-states"


def test_a_goal_that_asks_much_leaves_time_for_fewer_transitions() -> None:
    text = """
    int[0, 100] n;
    process P() { init location l { to l { assign n = (n + 1) % 100; } } }
    p = P(); system p;
    """
    drawn = []
    for goal in ("n == 100", "exists (i : int[0, 99]) exists (j : int[0, 99]) i + j == n + 200"):
        model = tachk.loads(text)
        (verdict,) = model.verify(f"E<> {goal}")
        assert verdict.query.target is not None
        runs = SimulatedRuns(*lower(model.network, [verdict.query.target]))
        part = runs.budgeted(1_000)
        while (status := part.run(1)) is _core.Status.RUNNING:
            pass
        assert status is _core.Status.STATE_LIMIT
        drawn.append(runs.statistics()[2])
    assert drawn[0] > 5_000 and drawn[1] < 500
